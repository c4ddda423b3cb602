//! Writes the recording of a served session: every command and reply, and the records of triggered
//! acquisitions, with their times.

use std::io;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use tokio::time::Instant;

use super::ServeError;
use super::bench_thread::GroundTruth;
use super::writer::{BackgroundWriter, Sink};
use crate::experiment::facts::{scene_attachments, shot_facts};
use crate::instrument::{Finished, Instrument};
use crate::recording::RecordingError;
use crate::recording::mcap::{RecordingWriter, ShotNotes};
use crate::recording::{self, Capture, Direction, Origin, ScpiLine, Shot};
use crate::scene::Scene;
use crate::scope::{Source, Waveform};
use crate::scpi::{Preferences, Reply, Session, TranscriptLine};

/// Time that a recording whose disk takes nothing has at the end of the server.
const FINISH_TIMEOUT: Duration = Duration::from_secs(5);
/// Size of a line in the queue beside its bytes and its client's name (bytes).
const LINE_OVERHEAD: usize = 64;

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

/// The instrument's end of a session's recording; [`RecordingSink`] is the other one.
pub struct Recorder {
    writer: BackgroundWriter<RecordingSink>,
    opened: Instant,
    /// Unix time at `opened` (ns).
    began: u64,
    shots: u32,
}

impl Recorder {
    /// Takes over an open writer, which writes up to `limit` (bytes); `served` is the scene that
    /// the server was started with. `warn` is called if the recording ends before the server.
    ///
    /// # Errors
    /// The system's error if the writer's thread cannot be started.
    pub fn start(
        writer: RecordingWriter,
        served: &Scene,
        limit: Option<u64>,
        warn: fn(&str),
    ) -> io::Result<Self> {
        let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        let began = since_1970.map_or(0, nanoseconds);
        let attached = vec![served.name.clone()];
        let sink = RecordingSink { writer, attached, last: 0, limit };
        let writer = BackgroundWriter::start("recording", sink, warn)?;
        Ok(Self { writer, opened: Instant::now(), began, shots: 0 })
    }

    /// Records the messages that a connection received and sent.
    pub fn lines(&mut self, peer: &str, lines: Vec<TranscriptLine>) {
        let timestamp_ns = self.wall_clock_time();
        for line in lines {
            let (direction, bytes) = match line {
                TranscriptLine::Command(bytes) => (Direction::Command, bytes),
                TranscriptLine::Reply(bytes) => (Direction::Reply, bytes),
            };
            let size = bytes.len() + peer.len() + LINE_OVERHEAD;
            let line = ScpiLine { timestamp_ns, peer: peer.to_owned(), direction, bytes };
            self.writer.push(RecordingEntry::Line(line), size);
        }
    }

    /// Writes one acquisition and, where an impact triggered it, the simulated truth of the impact.
    pub fn add_acquisition(
        &mut self,
        finished: Finished,
        triggered_shot: Option<TriggeredShot>,
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
        let cause = match (&triggered_shot, finished.trigger) {
            (Some(TriggeredShot { shot, scene, .. }), _) => {
                format!("shot {}: impact {shot} on {}", self.shots, scene.name)
            }
            (None, Some(trigger)) => format!("shot {}: impact {}", self.shots, trigger.shot),
            (None, None) => format!("shot {}: not triggered by an impact", self.shots),
        };
        let other = triggered_shot.as_ref().filter(|triggered| !triggered.is_served);
        let other = other.map(|triggered| (Arc::clone(&triggered.scene), triggered.shot));
        let truth = triggered_shot.map(|triggered| triggered.truth);
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
        let captures = shot.captures.iter().map(|capture| 2 * capture.waveform.codes.len());
        let truth = shot.truth.iter().map(|trace| 8 * trace.values.len());
        let size = captures.chain(truth).sum::<usize>() + notes.set_up.len();
        self.writer.push(RecordingEntry::Shot(Box::new((shot, notes, other))), size);
    }

    /// Waits where the recording is far behind and the disk still works.
    pub async fn keep_pace(&mut self) {
        self.writer.keep_pace().await;
    }

    /// Waits until the operating system has everything, unless the disk has stalled: a shot that a
    /// client knows of survives the server.
    pub async fn drain(&mut self) {
        self.writer.drain().await;
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// [`ServeError::Record`] if it could not be written, [`ServeError::RecordStalled`] if the disk
    /// takes nothing.
    pub async fn finish(self) -> Result<(), ServeError> {
        match self.writer.finish(FINISH_TIMEOUT).await {
            Some(outcome) => outcome,
            None => Err(ServeError::RecordStalled { seconds: FINISH_TIMEOUT.as_secs() }),
        }
    }

    fn wall_clock_time(&self) -> u64 {
        self.began.saturating_add(nanoseconds(self.opened.elapsed()))
    }
}

/// What is recorded.
enum RecordingEntry {
    /// A command or reply.
    Line(ScpiLine),
    /// An acquisition; with the scene and the impact's number if it is not the served scene.
    Shot(Box<(Shot, ShotNotes, OtherScene)>),
}

/// A scene that is not the served one, and the number of the impact.
type OtherScene = Option<(Arc<Scene>, u32)>;

/// The recording's file.
struct RecordingSink {
    writer: RecordingWriter,
    /// Scenes that travel with the recording.
    attached: Vec<String>,
    /// Unix time of the last entry (ns).
    last: u64,
    limit: Option<u64>,
}

impl RecordingSink {
    /// Attaches a scene other than the served one, and what is known of a shot on it.
    fn attach(&mut self, scene: &Scene, shot: u32, impact: u32) -> Result<(), RecordingError> {
        if !self.attached.contains(&scene.name) {
            self.attached.push(scene.name.clone());
            for attachment in scene_attachments(scene) {
                self.writer.attach(&attachment)?;
            }
        }
        self.writer.add_facts(&shot_facts(scene, shot, impact))
    }
}

impl Sink for RecordingSink {
    type Entry = RecordingEntry;
    type Error = ServeError;

    fn write(&mut self, entry: RecordingEntry) -> Result<(), ServeError> {
        let written = match entry {
            RecordingEntry::Line(line) => {
                self.last = line.timestamp_ns;
                self.writer.add_line(&line)
            }
            RecordingEntry::Shot(shot) => {
                let (shot, notes, other) = *shot;
                self.last = shot.timestamp_ns;
                let attached = other
                    .map_or(Ok(()), |(scene, impact)| self.attach(&scene, shot.number, impact));
                attached.and_then(|()| self.writer.add(&shot, &notes))
            }
        };
        written.map_err(|reason| ServeError::Record { reason })
    }

    fn write_loss(&mut self, count: u64) -> Result<(), ServeError> {
        let bytes = format!("{count} messages or shots lost: the disk was too slow").into_bytes();
        let (peer, direction) = ("hertzscope".to_owned(), Direction::Reply);
        let line = ScpiLine { timestamp_ns: self.last, peer, direction, bytes };
        self.writer.add_line(&line).map_err(|reason| ServeError::Record { reason })
    }

    fn flush(&mut self) -> Result<(), ServeError> {
        self.writer.flush().map_err(|reason| ServeError::Record { reason })
    }

    fn limit_reached(&self) -> Option<String> {
        let limit = self.limit?;
        let written = std::fs::metadata(self.writer.file()).ok()?.len();
        (written >= limit).then(|| format!("the recording has reached its limit of {limit} bytes"))
    }

    fn finish(self) -> Result<(), ServeError> {
        let finished = self.writer.finish().map(|_| ());
        finished.map_err(|reason| ServeError::Record { reason })
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
