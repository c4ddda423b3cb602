//! Reads a recording on its own thread: shots that are asked for first, the rest of the file in
//! between.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::thread;
use std::time::{Duration, Instant};

use super::event::ScreenEvent;
use crate::recording::mcap::{IndexedRecording, ReadState};
use crate::tui::job::{guarded, with_reasons};

/// Interval between looks at a file that may grow.
const FILE_POLL_INTERVAL: Duration = Duration::from_millis(50);
/// Interval between reports of how much was found.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

/// Starts the thread; it takes places of shots.
pub fn start(
    recording: IndexedRecording,
    follow: bool,
    events: &Sender<ScreenEvent>,
) -> Sender<usize> {
    let (places, received) = channel();
    let events = events.clone();
    thread::spawn(move || {
        let last = events.clone();
        let worker = RecordingWorker { recording, follow, events, reported: None, sent: None };
        // An error means that the screen is gone.
        if let Err(words) = guarded(|| Ok(worker.run(&received))) {
            let _ = last.send(ScreenEvent::Told(words));
        }
    });
    places
}

struct RecordingWorker {
    recording: IndexedRecording,
    follow: bool,
    events: Sender<ScreenEvent>,
    /// Time of the last report, and its shots and state.
    reported: Option<(Instant, usize, ReadState)>,
    /// The shot that was sent last, and of how many pieces of the file it and the messages
    /// around it were made.
    sent: Option<(usize, usize, (usize, u64))>,
}

/// The screen is closed.
struct Disconnected;

impl RecordingWorker {
    fn run(mut self, places: &Receiver<usize>) -> Result<(), Disconnected> {
        loop {
            if let Some(place) = latest(places)? {
                self.send_shot(place)?;
            }
            let end = self.recording.read_on();
            let end = match end {
                Ok(end) => end,
                Err(error) => {
                    self.send(ScreenEvent::Told(with_reasons(&error)))?;
                    ReadState::Finished
                }
            };
            self.report_progress(end)?;
            self.send_rest(end)?;
            let place = match end {
                ReadState::More => None,
                ReadState::Open if self.follow => match places.recv_timeout(FILE_POLL_INTERVAL) {
                    Ok(place) => Some(place),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => return Err(Disconnected),
                },
                ReadState::Open | ReadState::Finished => {
                    Some(places.recv().map_err(|_| Disconnected)?)
                }
            };
            if let Some(place) = place {
                let place = latest(places)?.unwrap_or(place);
                self.send_shot(place)?;
            }
        }
    }

    fn send(&self, events: ScreenEvent) -> Result<(), Disconnected> {
        self.events.send(events).map_err(|_| Disconnected)
    }

    /// The shot on screen again, where more of it has come since: its last pieces may not have been
    /// written yet. Messages around it are waited for until an end is reached.
    fn send_rest(&mut self, end: ReadState) -> Result<(), Disconnected> {
        let Some((place, pieces, lines)) = self.sent else { return Ok(()) };
        let has_lines = || end != ReadState::More && self.recording.line_pieces(place) != lines;
        if self.recording.pieces(place) > pieces || has_lines() {
            return self.send_shot(place);
        }
        Ok(())
    }

    fn send_shot(&mut self, place: usize) -> Result<(), Disconnected> {
        let (pieces, lines) = (self.recording.pieces(place), self.recording.line_pieces(place));
        self.sent = Some((place, pieces, lines));
        let lines = self.recording.lines_around(place);
        let found = lines.and_then(|lines| Ok((self.recording.shot_and_notes(place)?, lines)));
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
        let count = self.recording.shots();
        let due = match self.reported {
            None => count > 0 || end != ReadState::More,
            Some((at, reported, before)) => {
                (reported, before) != (count, end)
                    && (end != ReadState::More || at.elapsed() >= REPORT_INTERVAL)
            }
        };
        if !due {
            return Ok(());
        }
        self.reported = Some((Instant::now(), count, end));
        let mut facts = self.recording.facts();
        if end == ReadState::Open && self.follow {
            // It goes on.
            facts.problems.pop();
        }
        let open = end == ReadState::More || (end == ReadState::Open && self.follow);
        self.send(ScreenEvent::Read(count, open, Box::new(facts)))
    }
}

/// The newest order, the others are stale.
fn latest(places: &Receiver<usize>) -> Result<Option<usize>, Disconnected> {
    let mut latest = None;
    loop {
        match places.try_recv() {
            Ok(place) => latest = Some(place),
            Err(TryRecvError::Empty) => return Ok(latest),
            Err(TryRecvError::Disconnected) => return Err(Disconnected),
        }
    }
}
