//! The threads behind the screen: one reads the recording or watches a served scope, the others do
//! jobs. Threads and terminal send their events to the screen's loop through one channel.

mod event;
mod recording_worker;
mod save;
pub mod served;

use std::io::IsTerminal as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use ratatui::crossterm::event as terminal;
use ratatui::layout::Size;
#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
#[cfg(unix)]
use signal_hook::iterator::Signals;

pub use event::ScreenEvent;

use super::job::{Job, Queue};
use super::model::{Request, ScreenState};
use crate::recording::mcap::IndexedRecording;

/// Interval between checks that the terminal still exists.
const TERMINAL_POLL_INTERVAL: Duration = Duration::from_millis(500);

/// Starts the thread of `queue`; it ends when all senders of jobs are dropped.
fn worker(queue: Queue, events: &Sender<ScreenEvent>) -> Sender<Job<ScreenState>> {
    let (jobs, received) = channel::<Job<ScreenState>>();
    let events = events.clone();
    thread::spawn(move || {
        while let Ok(mut job) = received.recv() {
            if queue.keeps_newest() {
                job = received.try_iter().last().unwrap_or(job);
            }
            // The screen may be closed already.
            let send = |change| drop(events.send(ScreenEvent::Changed(change)));
            send(job.run(&send));
        }
    });
    jobs
}

/// The worker threads of the screen.
pub struct Workers {
    events: Sender<ScreenEvent>,
    recording_worker: Option<Sender<usize>>,
    served: Option<(Sender<String>, Arc<AtomicBool>, JoinHandle<()>)>,
    /// The queues of jobs, in the order of [`Queue::ALL`].
    queues: Vec<Sender<Job<ScreenState>>>,
}

impl Workers {
    /// Starts the threads. `recording` is read on demand; with `follow`, new shots are added as
    /// they are written.
    pub fn start(
        recording: Option<IndexedRecording>,
        follow: bool,
    ) -> (Self, Receiver<ScreenEvent>) {
        let (events, receiver) = channel();
        let recording_worker =
            recording.map(|recording| recording_worker::start(recording, follow, &events));
        let queues = Queue::ALL.iter().map(|queue| worker(*queue, &events)).collect();
        (Self { events, recording_worker, served: None, queues }, receiver)
    }

    /// Watches a scope that is served somewhere else.
    pub fn watch(&mut self, scope: served::ServedConnection) {
        self.served = Some(served::start(scope, &self.events));
    }

    /// Listens to the terminal.
    pub fn listen(&self) {
        let events = self.events.clone();
        let end = events.clone();
        #[cfg(unix)]
        if let Ok(mut signals) = Signals::new([SIGTERM, SIGHUP, SIGINT]) {
            let ended = events.clone();
            thread::spawn(move || {
                // The screen's loop ends, and gives the terminal back.
                if signals.forever().next().is_some() {
                    let _ = ended.send(ScreenEvent::Closed);
                }
            });
        }
        thread::spawn(move || {
            while let Ok(event) = terminal::read() {
                if events.send(ScreenEvent::Terminal(event)).is_err() {
                    return;
                }
            }
            // A failure means that the screen is closed.
            let _ = events.send(ScreenEvent::Closed);
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
            let is_sent = match request {
                Request::Load(place) => {
                    let worker = self.recording_worker.as_ref();
                    worker.is_none_or(|worker| worker.send(place).is_ok())
                }
                Request::Send(command) => {
                    self.served.as_ref().is_none_or(|(scope, ..)| scope.send(command).is_ok())
                }
                Request::Save(file) => match save::job(model, size, file) {
                    Ok(job) => self.send(job),
                    Err(problem) => {
                        model.set_notice(problem);
                        true
                    }
                },
                Request::Job(job) => self.send(job),
            };
            if !is_sent {
                let words = "internal error in a thread of the screen: quit and start again";
                model.set_notice(words.to_owned());
            }
        }
    }

    fn send(&self, job: Job<ScreenState>) -> bool {
        let place = Queue::ALL.iter().position(|queue| *queue == job.queue);
        let queue = place.and_then(|place| self.queues.get(place));
        queue.is_some_and(|queue| queue.send(job).is_ok())
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
