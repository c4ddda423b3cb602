//! Watches a scope that is served somewhere else, or a real one, and sends it the commands of keys.
//!
//! A short query ten times a second tells whether there is anything new; only then set-up and
//! records are asked for. Over a slow line it comes less often, so that commands find the line
//! free. A line that fails is opened again; commands of the time between are not sent.

mod snapshot;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use super::event::ScreenEvent;
use crate::client::{
    Address, ClientError, ClientTiming, LineEvent, Scope, create_recording, wall_clock_time,
};
use crate::recording::RecordingError;
use crate::recording::mcap::{RecordingWriter, ShotNotes};
use crate::recording::{Capture, Shot, TraceSet};
use crate::scope::Model;
use crate::tui::job::{guarded, with_reasons};
use crate::tui::model::served::ServedUpdate;
use snapshot::ServedSnapshot;

/// Time from one query for the state to the next.
const STATE_POLL_INTERVAL: Duration = Duration::from_millis(100);
/// Time from one query for everything to the next, since another client may have set something.
const SNAPSHOT_INTERVAL: Duration = Duration::from_secs(1);
/// A line is free at least this many times as long as the last reply took (1).
const FREE_TIME_FACTOR: u32 = 3;

/// A connection to a served scope, or to a real one.
pub struct ServedConnection {
    scope: Scope,
    model: Model,
    /// Whether a bench is behind it that can be struck.
    bench: bool,
    recorder: Option<RecordingWriter>,
    stop: Arc<AtomicBool>,
}

impl ServedConnection {
    /// Connects to `address`. All that waits ends once `stop` is set.
    ///
    /// # Errors
    /// [`ClientError`]: no connection, or no oscilloscope of this family.
    pub fn connect(
        address: &Address,
        timing: ClientTiming,
        stop: Arc<AtomicBool>,
    ) -> Result<Self, ClientError> {
        let mut scope = Scope::connect(address, timing, &stop)?;
        let model = snapshot::model(scope.instrument());
        match (model, scope.has_bench()) {
            (Some(model), Ok(bench)) => Ok(Self { scope, model, bench, recorder: None, stop }),
            (model, bench) => {
                // The failure before is reported.
                let _ = scope.end("");
                let address = address.to_string();
                if let Err(source) = bench {
                    let doing = "no valid reply to HEADer?";
                    return Err(ClientError::Line { address, doing, source });
                }
                let problem = if model.is_none() { "no oscilloscope is included" } else { "" };
                Err(ClientError::NoScope { address, problem: problem.to_owned() })
            }
        }
    }

    /// Records what is shown in `file` or, if that exists, by the next free number; its name.
    ///
    /// # Errors
    /// [`RecordingError`] if the file cannot be written.
    pub fn record(&mut self, file: &Path) -> Result<PathBuf, RecordingError> {
        let recorder = create_recording(file, self.scope.address(), self.scope.instrument())?;
        let file = recorder.file().to_owned();
        self.recorder = Some(recorder);
        Ok(file)
    }
}

/// Starts the thread that watches; it takes commands, and ends when their sender is dropped or the
/// flag that is returned is set.
pub fn start(
    served: ServedConnection,
    events: &Sender<ScreenEvent>,
) -> (Sender<String>, Arc<AtomicBool>, JoinHandle<()>) {
    let (commands, received) = channel();
    let events = events.clone();
    let stop = Arc::clone(&served.stop);
    let thread = thread::spawn(move || {
        let ServedConnection { mut scope, model, bench, recorder, .. } = served;
        let address = scope.address().clone();
        let mut worker = ServedWorker {
            events: events.clone(),
            bench,
            model,
            recorder,
            shots: 0,
            last: None,
            records: None,
            state_time: Duration::ZERO,
            snapshot_time: Duration::ZERO,
        };
        let watched =
            guarded(|| worker.run(&mut scope, &received).map_err(|error| with_reasons(&error)));
        if let Err(words) = watched {
            let _ = events.send(ScreenEvent::Lost(format!("connection lost: {words}")));
        }
        // The screen may be closed already, and the line broken.
        if let Err(error) = scope.end("") {
            let _ = events.send(ScreenEvent::Told(format!("{address}: {}", with_reasons(&error))));
        }
        if let Some(Err(error)) = worker.recorder.take().map(RecordingWriter::finish) {
            let _ = events.send(ScreenEvent::Told(with_reasons(&error)));
        }
    });
    (commands, stop, thread)
}

struct ServedWorker {
    events: Sender<ScreenEvent>,
    bench: bool,
    model: Model,
    recorder: Option<RecordingWriter>,
    /// Number of recorded shots.
    shots: u32,
    last: Option<(Instant, ServedSnapshot)>,
    records: Option<Vec<Capture>>,
    /// Time of the last reply to the query for the state.
    state_time: Duration,
    /// Time of the last replies to the queries for everything.
    snapshot_time: Duration,
}

impl ServedWorker {
    /// Polls and sends commands until the screen is closed.
    fn run(&mut self, scope: &mut Scope, commands: &Receiver<String>) -> Result<(), ClientError> {
        loop {
            let mut pending = Vec::new();
            if self.last.is_some() {
                let pause = STATE_POLL_INTERVAL.max(FREE_TIME_FACTOR * self.state_time);
                match commands.recv_timeout(pause) {
                    Ok(command) => pending.push(command),
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => return Ok(()),
                }
                pending.extend(commands.try_iter());
            }
            let events = self.events.clone();
            let mut report = |event| {
                let event = match event {
                    LineEvent::Failed(why) => {
                        ScreenEvent::Lost(format!("connection lost: {why}; trying again"))
                    }
                    LineEvent::Back => {
                        // They were meant for the scope as it was shown then.
                        commands.try_iter().for_each(drop);
                        ScreenEvent::Told("connected again".to_owned())
                    }
                };
                // The screen may be closed already.
                let _ = events.send(event);
            };
            let update = scope.persist(&mut report, |scope| {
                let commands = std::mem::take(&mut pending);
                commands.iter().try_for_each(|command| scope.send(command))?;
                let update = self.poll(scope, !commands.is_empty());
                if update.is_err() {
                    self.last = None;
                }
                update
            })?;
            match update {
                None => return Ok(()),
                Some(None) => {}
                Some(Some(update)) => {
                    if self.events.send(ScreenEvent::Heard(Box::new(update))).is_err() {
                        return Ok(());
                    }
                }
            }
        }
    }

    /// Changes since the last call, if any.
    fn poll(&mut self, scope: &mut Scope, commanded: bool) -> io::Result<Option<ServedUpdate>> {
        let started = Instant::now();
        let state = scope.state()?;
        self.state_time = started.elapsed();
        let interval = SNAPSHOT_INTERVAL.max(FREE_TIME_FACTOR * self.snapshot_time);
        let is_known = |(at, last): &(Instant, ServedSnapshot)| {
            *last.state() == state && at.elapsed() < interval
        };
        if !commanded && self.last.as_ref().is_some_and(is_known) {
            return Ok(None);
        }
        let started = Instant::now();
        let before = self.last.take().map(|(_, snapshot)| snapshot);
        let mut snapshot = ServedSnapshot::new(state, scope.front_panel()?, self.model.clone());
        if self.bench {
            snapshot.on_bench(&scope.ask(":BENC:IMP?;SCEN?")?, before.as_ref());
            if let Some(query) = snapshot.knobs_query() {
                snapshot.turned(&scope.ask(&query)?);
            }
        }
        let same = before.as_ref() == Some(&snapshot);
        let sources = snapshot.displayed();
        let is_new = !same || snapshot.is_scanning();
        let wanted = is_new && snapshot.has_records() && !sources.is_empty();
        // In one message: another acquisition may be taken between two.
        let records = if wanted { scope.captures(&sources, snapshot.panel())? } else { None };
        self.snapshot_time = started.elapsed();
        let is_missing = wanted && records.is_none() && snapshot.state().count > 0;
        let new = records.filter(|records| self.records.as_ref() != Some(records));
        if let Some(records) = &new {
            self.records = Some(records.clone());
        }
        let same = same && new.is_none();
        let update = snapshot.update(self.bench, new);
        if let Some(set) = &update.set {
            self.record(set, snapshot.set_up());
        }
        // Without its records, the next look is for everything again.
        self.last = (!is_missing).then(|| (Instant::now(), snapshot));
        Ok((!same).then_some(update))
    }

    /// Adds what is shown to the recording; one that cannot be written ends, and the screen goes
    /// on.
    fn record(&mut self, set: &TraceSet, set_up: &str) {
        let (Some(recorder), Some(shot)) = (&mut self.recorder, set.shots.first()) else {
            return;
        };
        self.shots += 1;
        let number = self.shots;
        let mut line = format!("shot {number}: shown on the screen");
        if !self.bench {
            line.push_str("; if the scope ran on, channels may be of different triggers");
        }
        let notes = ShotNotes { set_up: set_up.to_owned(), energy: None, log: vec![(false, line)] };
        let shot = Shot { number, timestamp_ns: wall_clock_time(), ..shot.clone() };
        if let Err(error) = recorder.add(&shot, &notes) {
            self.recorder = None;
            let words = format!("the recording has ended: {}", with_reasons(&error));
            let _ = self.events.send(ScreenEvent::Told(words));
        }
    }
}
