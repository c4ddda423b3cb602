//! Reads a recording on its own thread: shots that are asked for first, the rest of the file in
//! between.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::thread;
use std::time::{Duration, Instant};

use super::event::ScreenEvent;
use crate::recording::mcap::indexed_recording::{IndexedRecording, ReadState};
use crate::tui::job::{guarded, with_reasons};

/// A file that may grow is looked at so often.
const FILE_POLL_INTERVAL: Duration = Duration::from_millis(50);
/// How much is found is told so often.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

/// Starts the thread; it takes places of shots.
pub fn start(tape: IndexedRecording, follow: bool, news: &Sender<ScreenEvent>) -> Sender<usize> {
    let (orders, received) = channel();
    let news = news.clone();
    thread::spawn(move || {
        let last = news.clone();
        let player = Player { tape, follow, news, told: None, brought: None };
        // An error means that the screen is gone.
        if let Err(words) = guarded(|| Ok(player.play(&received))) {
            let _ = last.send(ScreenEvent::Told(words));
        }
    });
    orders
}

struct Player {
    tape: IndexedRecording,
    follow: bool,
    news: Sender<ScreenEvent>,
    /// When it was last told how much there is, and what.
    told: Option<(Instant, usize, ReadState)>,
    /// The shot that was brought last, and of how many pieces of the file it and the messages
    /// around it were made.
    brought: Option<(usize, [usize; 2])>,
}

/// The other end is gone.
struct Disconnected;

impl Player {
    fn play(mut self, orders: &Receiver<usize>) -> Result<(), Disconnected> {
        loop {
            if let Some(place) = latest(orders)? {
                self.apply(place)?;
            }
            let end = self.tape.read_on();
            let end = match end {
                Ok(end) => end,
                Err(error) => {
                    self.send(ScreenEvent::Told(with_reasons(&error)))?;
                    ReadState::Finished
                }
            };
            self.report_progress(end)?;
            self.load_rest(end)?;
            let place = match end {
                ReadState::More => None,
                ReadState::Open if self.follow => match orders.recv_timeout(FILE_POLL_INTERVAL) {
                    Ok(place) => Some(place),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => return Err(Disconnected),
                },
                ReadState::Open | ReadState::Finished => {
                    Some(orders.recv().map_err(|_| Disconnected)?)
                }
            };
            if let Some(place) = place {
                let place = latest(orders)?.unwrap_or(place);
                self.apply(place)?;
            }
        }
    }

    fn send(&self, news: ScreenEvent) -> Result<(), Disconnected> {
        self.news.send(news).map_err(|_| Disconnected)
    }

    /// The shot on screen again, where more of it has come since: its last pieces may not have been
    /// written yet. Messages around it are waited for until an end is reached.
    fn load_rest(&mut self, end: ReadState) -> Result<(), Disconnected> {
        let Some((place, [pieces, lines])) = self.brought else { return Ok(()) };
        let has_lines = || end != ReadState::More && self.tape.line_pieces(place) != lines;
        if self.tape.pieces(place) > pieces || has_lines() {
            return self.apply(place);
        }
        Ok(())
    }

    fn apply(&mut self, place: usize) -> Result<(), Disconnected> {
        self.brought = Some((place, [self.tape.pieces(place), self.tape.line_pieces(place)]));
        let lines = self.tape.lines_around(place);
        let found = lines.and_then(|lines| Ok((self.tape.shot_and_notes(place)?, lines)));
        match found {
            Ok((Some((shot, notes)), lines)) => {
                self.send(ScreenEvent::Shot(place, Box::new((shot, notes, lines))))
            }
            Ok((None, _)) => {
                self.send(ScreenEvent::Told(format!("shot {} cannot be read", place + 1)))
            }
            Err(error) => self.send(ScreenEvent::Told(with_reasons(&error))),
        }
    }

    /// Tells how much there is: the first shot at once, then now and then, and whenever an end is
    /// reached.
    fn report_progress(&mut self, end: ReadState) -> Result<(), Disconnected> {
        let count = self.tape.shots();
        let due = match self.told {
            None => count > 0 || end != ReadState::More,
            Some((at, told, before)) => {
                (told, before) != (count, end)
                    && (end != ReadState::More || at.elapsed() >= REPORT_INTERVAL)
            }
        };
        if !due {
            return Ok(());
        }
        self.told = Some((Instant::now(), count, end));
        let mut facts = self.tape.facts();
        if end == ReadState::Open && self.follow {
            // It goes on.
            facts.problems.pop();
        }
        let open = end == ReadState::More || (end == ReadState::Open && self.follow);
        self.send(ScreenEvent::Read(count, open, Box::new(facts)))
    }
}

/// The newest order, the others are stale.
fn latest(orders: &Receiver<usize>) -> Result<Option<usize>, Disconnected> {
    let mut latest = None;
    loop {
        match orders.try_recv() {
            Ok(place) => latest = Some(place),
            Err(TryRecvError::Empty) => return Ok(latest),
            Err(TryRecvError::Disconnected) => return Err(Disconnected),
        }
    }
}
