//! The threads behind the screen: one reads the recording or watches a served scope, one strikes
//! the bench, one computes its bands, two answer long questions. All they say goes through one
//! channel to the screen's loop, and so do the terminal's events.

mod analysis_worker;
mod news;
mod recording_worker;
mod save;
pub mod served;
mod simulation_worker;

pub use news::{ScreenEvent, guarded, with_reasons};

use std::io::IsTerminal as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use ratatui::crossterm::event;
use ratatui::layout::Size;
#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
#[cfg(unix)]
use signal_hook::iterator::Signals;

use super::model::{BenchOption, Request, ScreenState, StrikeRequest};
use crate::recording::TraceSet;
use crate::recording::mcap::indexed_recording::IndexedRecording;
use analysis_worker::{ComparisonRequest, StudyRequest};

/// How often it is looked whether the terminal is still there.
const TERMINAL_POLL_INTERVAL: Duration = Duration::from_millis(500);

/// Starts a thread that does `work` for each order and sends events; it ends when all senders of
/// orders are dropped.
fn worker<Order: Send + 'static>(
    news: &Sender<ScreenEvent>,
    mut work: impl FnMut(Order, &Receiver<Order>, &Sender<ScreenEvent>) + Send + 'static,
) -> Sender<Order> {
    let (orders, received) = channel::<Order>();
    let news = news.clone();
    thread::spawn(move || {
        while let Ok(order) = received.recv() {
            work(order, &received, &news);
        }
    });
    orders
}

/// Notes in a set what an option says of the bench; an error is a message.
pub type NoteOption = fn(&mut TraceSet, BenchOption, &str) -> Result<(), String>;

/// The worker threads of the screen.
pub struct Workers {
    news: Sender<ScreenEvent>,
    recording_worker: Option<Sender<usize>>,
    served: Option<(Sender<String>, Arc<AtomicBool>, JoinHandle<()>)>,
    bench: Sender<StrikeRequest>,
    comparison: Sender<ComparisonRequest>,
    research: Sender<StudyRequest>,
    bands: Sender<StrikeRequest>,
    note_option: Option<NoteOption>,
}

impl Workers {
    /// Starts the threads; a recording that is read as it is looked at comes as `recording`, and
    /// may be followed.
    pub fn start(
        recording: Option<IndexedRecording>,
        follow: bool,
    ) -> (Self, Receiver<ScreenEvent>) {
        let (news, receiver) = channel();
        let recording_worker =
            recording.map(|recording| recording_worker::start(recording, follow, &news));
        let staff = Self {
            recording_worker,
            served: None,
            bench: worker(&news, simulation_worker::strike),
            comparison: worker(&news, analysis_worker::comparer()),
            research: worker(&news, analysis_worker::research),
            bands: worker(&news, simulation_worker::bands),
            note_option: None,
            news,
        };
        (staff, receiver)
    }

    /// Watches a scope that is served somewhere else.
    pub fn watch(&mut self, scope: served::ServedConnection) {
        self.served = Some(served::start(scope, &self.news));
    }

    /// Does with this what commands say of the bench.
    pub fn note_with(&mut self, note_option: NoteOption) {
        self.note_option = Some(note_option);
    }

    /// Listens to the terminal.
    pub fn listen(&self) {
        let news = self.news.clone();
        let end = news.clone();
        #[cfg(unix)]
        if let Ok(mut signals) = Signals::new([SIGTERM, SIGHUP, SIGINT]) {
            let ended = news.clone();
            thread::spawn(move || {
                // The screen's loop ends, and gives the terminal back.
                if signals.forever().next().is_some() {
                    let _ = ended.send(ScreenEvent::Closed);
                }
            });
        }
        thread::spawn(move || {
            while let Ok(event) = event::read() {
                if news.send(ScreenEvent::Terminal(event)).is_err() {
                    return;
                }
            }
            // A failure means that the screen is closed.
            let _ = news.send(ScreenEvent::Closed);
        });
        // Reading from a terminal that has gone never ends, and a hang-up signal need not come.
        thread::spawn(move || {
            while std::io::stdout().is_terminal() {
                thread::sleep(TERMINAL_POLL_INTERVAL);
            }
            let _ = end.send(ScreenEvent::Closed);
        });
    }

    /// Has everything done that the model asks for.
    pub fn serve(&self, model: &mut ScreenState, size: Size) {
        for request in model.take_requests() {
            // A worker that is gone has panicked; the screen's hook has told why.
            let sent = match request {
                Request::Load(place) => self
                    .recording_worker
                    .as_ref()
                    .is_none_or(|recording_worker| recording_worker.send(place).is_ok()),
                Request::Strike(strike) => self.bench.send(strike).is_ok(),
                Request::LiveBands(bench) => self.bands.send(bench).is_ok(),
                Request::Send(command) => {
                    self.served.as_ref().is_none_or(|(scope, ..)| scope.send(command).is_ok())
                }
                Request::Compare(other) => ComparisonRequest::of(model, other)
                    .is_none_or(|c| self.comparison.send(c).is_ok()),
                Request::Study => {
                    let scene = model.scene().cloned().map(Box::new);
                    scene.is_none_or(|scene| self.research.send(StudyRequest::Study(scene)).is_ok())
                }
                Request::Ledger => {
                    let scene = model.scene().cloned().map(Box::new);
                    scene
                        .is_none_or(|scene| self.research.send(StudyRequest::Ledger(scene)).is_ok())
                }
                Request::HardCases => self.research.send(StudyRequest::HardCases).is_ok(),
                Request::Note(option, value) => {
                    let mut set = model.set().clone();
                    let noted = self.note_option.map(|note| note(&mut set, option, &value));
                    match noted {
                        Some(Err(problem)) => model.set_notice(problem),
                        Some(Ok(())) => model.apply_bench_facts(set),
                        None => {}
                    }
                    true
                }
                Request::Save(file) => {
                    model.set_notice(
                        save::save(model, size, &file).unwrap_or_else(|problem| problem),
                    );
                    true
                }
            };
            if !sent {
                model
                    .set_notice("the thread that does this has stopped; please restart".to_owned());
            }
        }
    }
}

impl Drop for Workers {
    /// Waits until the scope's replies are as they were before, and its recording is finished.
    fn drop(&mut self) {
        if let Some((orders, stop, thread)) = self.served.take() {
            drop(orders);
            stop.store(true, Ordering::Relaxed);
            // A panic of the thread has been told.
            let _ = thread.join();
        }
    }
}
