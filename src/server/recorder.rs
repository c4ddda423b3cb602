//! Writes the recording of a served session: every command and reply, and the records of triggered
//! acquisitions, with their times.

use std::time::{Duration, Instant, SystemTime};

use std::sync::Arc;

use super::ServeError;
use super::bench_thread::GroundTruth;
use crate::experiment::facts::{scene_attachment, shot_facts};
use crate::instrument::{Finished, Instrument};
use crate::recording::mcap::{RecordingWriter, ShotNotes, WriteError};
use crate::recording::{self, Capture, Direction, Origin, ScpiLine, Shot};
use crate::scene::Scene;
use crate::scope::{Source, Waveform};
use crate::scpi::{Preferences, Reply, Session, TranscriptLine};

/// Messages are flushed at the latest after this time.
const FLUSH_INTERVAL: Duration = Duration::from_secs(1);

/// A shot that the scope triggered on.
pub struct TriggeredShot {
    /// Number of the impact.
    pub shot: u32,
    /// Its ground truth.
    pub truth: GroundTruth,
    /// The scene of the bench that was struck.
    pub scene: Arc<Scene>,
    /// Whether that is the scene that the server was started with.
    pub is_served: bool,
}

/// An open recording of a session.
pub struct Recorder {
    writer: RecordingWriter,
    opened: Instant,
    /// Unix time at `opened` (ns).
    began: u64,
    /// When lines were last handed to the operating system, if any came since.
    unflushed: Option<Instant>,
    shots: u32,
    /// Scenes that travel with the recording.
    attached: Vec<String>,
    failed: Option<WriteError>,
}

impl Recorder {
    /// Takes over an open writer; `served` is the scene that the server was started with.
    pub fn new(writer: RecordingWriter, served: &Scene) -> Self {
        let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        let began = since_1970.map_or(0, nanoseconds);
        let opened = Instant::now();
        Self {
            writer,
            opened,
            began,
            unflushed: None,
            shots: 0,
            attached: vec![served.name.clone()],
            failed: None,
        }
    }

    /// Records the messages that a connection received and sent.
    pub fn lines(&mut self, peer: &str, lines: Vec<TranscriptLine>) {
        let timestamp_ns = self.wall_clock_time();
        for line in lines {
            let (direction, bytes) = match line {
                TranscriptLine::Command(bytes) => (Direction::Command, bytes),
                TranscriptLine::Reply(bytes) => (Direction::Reply, bytes),
            };
            let line = ScpiLine { timestamp_ns, peer: peer.to_owned(), direction, bytes };
            let written = self.writer.add_line(&line);
            self.keep_first_error(written);
            self.unflushed.get_or_insert_with(Instant::now);
        }
    }

    /// Writes one acquisition and, where an impact triggered it, the simulated truth of the impact.
    pub fn add_acquisition(
        &mut self,
        finished: Finished,
        caught: Option<TriggeredShot>,
        instrument: &mut Instrument,
    ) {
        self.shots += 1;
        let model = &instrument.model;
        let taken_by = recording::InstrumentIdentity {
            model: model.name.replace(' ', ""),
            serial: model.serial.clone(),
            firmware: model.firmware.clone(),
        };
        let capture =
            |waveform| Capture { waveform, instrument: Some(taken_by.clone()), notes: Vec::new() };
        let cause = match (&caught, finished.trigger) {
            (Some(caught), _) => {
                self.attach_other_scene(caught);
                let TriggeredShot { shot, scene, .. } = caught;
                format!("shot {}: impact {shot} on {}", self.shots, scene.name)
            }
            (None, Some(trigger)) => format!("shot {}: impact {}", self.shots, trigger.shot),
            (None, None) => format!("shot {}: not triggered by an impact", self.shots),
        };
        let truth = caught.map(|caught| caught.truth);
        // The scope also saves the displayed math and reference traces.
        let others = [Source::Math].into_iter().chain(('A'..='D').map(Source::Reference));
        let others: Vec<Waveform> = others
            .filter_map(|source| Some(instrument.waveform(source).ok()?.into_owned()))
            .collect();
        let shot = Shot {
            number: self.shots,
            origin: Origin::Simulated,
            timestamp_ns: self.wall_clock_time(),
            captures: finished.records.into_iter().chain(others).map(capture).collect(),
            trigger_time: truth
                .as_ref()
                .zip(finished.trigger)
                .map(|(truth, t)| truth.start + t.time),
            truth: truth.map(|truth| truth.traces).unwrap_or_default(),
        };
        let set_up = set_up_of(instrument);
        let notes = ShotNotes { set_up, energy: None, log: vec![(false, cause)] };
        let written = self.writer.add(&shot, &notes);
        self.keep_first_error(written);
        self.unflushed = None;
    }

    /// Attaches the scene and its metadata if it is not the one that the server was started with.
    fn attach_other_scene(&mut self, caught: &TriggeredShot) {
        let TriggeredShot { shot, scene, is_served, .. } = caught;
        if *is_served {
            return;
        }
        if !self.attached.contains(&scene.name) {
            self.attached.push(scene.name.clone());
            let written = self.writer.attach(&scene_attachment(scene));
            self.keep_first_error(written);
        }
        let written = self.writer.add_facts(&shot_facts(scene, self.shots, *shot));
        self.keep_first_error(written);
    }

    /// Hands lines to the operating system when it is time for it.
    ///
    /// # Errors
    /// [`ServeError::Record`] where something could not be written since the last call.
    pub fn flush_if_due(&mut self) -> Result<(), ServeError> {
        if self.unflushed.is_some_and(|since| since.elapsed() >= FLUSH_INTERVAL) {
            let written = self.writer.flush();
            self.keep_first_error(written);
            self.unflushed = None;
        }
        self.failed.take().map_or(Ok(()), |reason| Err(ServeError::Record { reason }))
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// [`ServeError::Record`] where it could not be written.
    pub fn finish(self) -> Result<(), ServeError> {
        let written = self.writer.finish().map(|_| ());
        // What failed first is the cause.
        self.failed.map_or(written, Err).map_err(|reason| ServeError::Record { reason })
    }

    fn keep_first_error(&mut self, written: Result<(), WriteError>) {
        if let Err(reason) = written {
            self.failed.get_or_insert(reason);
        }
    }

    fn wall_clock_time(&self) -> u64 {
        self.began.saturating_add(nanoseconds(self.opened.elapsed()))
    }
}

/// All front-panel settings, as `SET?` returns them.
fn set_up_of(instrument: &mut Instrument) -> String {
    let mut session = Session::new(Preferences::new(true));
    match session.receive(instrument, b"SET?\n") {
        Reply::Now(bytes) => String::from_utf8_lossy(&bytes).trim_end().to_owned(),
        Reply::None | Reply::WhenIdle(_) => String::new(),
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
