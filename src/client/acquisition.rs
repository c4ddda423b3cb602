//! Takes one shot after the other from a scope, and makes recordings of them.
//!
//! For each shot the scope is armed for a single sequence, so that it keeps the record of one
//! trigger until all channels are read. It is asked for its state until it has stopped; no query
//! blocks. A line that fails is opened again for as long as it takes: the scope keeps its record
//! meanwhile, and the read-out begins again. A shot counts if the scope was not started during the
//! read-out and all that was read twice was the same; otherwise it is dropped, and reported. A
//! record that contradicts the front panel is read a second time; what it says then is recorded,
//! with a note if it is a contradiction still. In the trigger mode `AUTO` a scope also takes
//! records without a trigger: it is `NORMAL` meanwhile.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant, SystemTime};

use super::address::Address;
use super::record::displayed;
use super::scope::{ClientError, ClientTiming, LineEvent, Scope, ScopeState, words};
use super::transport::invalid_reply;
use crate::quantity::engineering;
use crate::recording::RecordingError;
use crate::recording::mcap::{RecordingWriter, ShotNotes};
use crate::recording::set_file::SetFile;
use crate::recording::{Capture, InstrumentIdentity, Origin, Shot, TraceSet};
use crate::scope::Source;

/// Arms the scope for one trigger. The reply confirms it: otherwise the record of before would be
/// taken for a new one.
const ARM: &str = ":ACQ:STOPA SEQ;STATE RUN;STATE?";
/// Facts by group.
type Facts = BTreeMap<String, BTreeMap<String, String>>;

/// Progress of an acquisition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AcquisitionEvent {
    /// The scope is armed.
    Armed,
    /// The scope has triggered, and its records are read.
    Triggered,
    /// The line failed or works again.
    Line(LineEvent),
    /// The scope was started or stopped by another client or at its panel: it is armed again.
    ArmedAgain(&'static str),
    /// A record was dropped, and why.
    Dropped(&'static str),
    /// A record contradicted the front panel, and did so no longer when it was read again.
    ReadAgain(String),
    /// A record contradicts the front panel: it is recorded with this note.
    Contradiction(String),
}

/// One acquired shot.
#[derive(Debug, Clone, PartialEq)]
pub struct AcquiredShot {
    /// Time at which the scope reported that it had stopped, nanoseconds since 1970.
    pub timestamp_ns: u64,
    /// How much earlier the trigger may have been: since the scope last reported that it was
    /// waiting.
    pub late: Duration,
    /// The front panel, as the reply to `SET?`.
    pub set_up: String,
    /// The displayed traces.
    pub captures: Vec<Capture>,
}

/// A scope from which shots are taken.
#[derive(Debug)]
pub struct ShotAcquisition {
    scope: Scope,
    displayed: Vec<Source>,
    trigger: String,
    /// Trigger mode that is replaced by `NORMAL`, if it was another.
    trigger_mode: Option<String>,
    /// The commands that restore trigger mode and acquisition.
    restore: String,
}

/// Records of one trigger that are read while the line may fail.
#[derive(Default)]
struct ReadOut {
    /// Captures that were read before the line failed.
    seen: Vec<Capture>,
    /// Contradictions that were gone when the record was read again.
    read_again: Vec<String>,
}

impl ShotAcquisition {
    /// Connects to the scope at `address`, and notes the settings that are restored at the end. All
    /// that waits ends once `stop` is set.
    ///
    /// # Errors
    /// [`ClientError`]: no line, no scope of this family, or no trace on its screen.
    pub fn begin(
        address: &Address,
        timing: ClientTiming,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, ClientError> {
        let mut scope = Scope::connect(address, timing, stop)?;
        let (trigger_mode, restore, panel) = match settings(&mut scope) {
            Ok(settings) => settings,
            Err(source) => {
                // The failure before is reported.
                let _ = scope.end("");
                let doing = "no valid reply to the query for its settings";
                return Err(ClientError::Line { address: address.to_string(), doing, source });
            }
        };
        let (displayed, trigger) = (displayed(&panel), trigger(&panel));
        if displayed.is_empty() {
            scope.end("")?;
            return Err(ClientError::NoTrace { address: address.to_string() });
        }
        Ok(Self { scope, displayed, trigger, trigger_mode, restore })
    }

    /// The scope.
    pub fn instrument(&self) -> &InstrumentIdentity {
        self.scope.instrument()
    }

    /// The traces on its screen when this began.
    pub fn displayed(&self) -> &[Source] {
        &self.displayed
    }

    /// Its trigger when this began, e.g. `CH1 RISE at 500 mV`.
    pub fn trigger(&self) -> &str {
        &self.trigger
    }

    /// The trigger mode that is `NORMAL` until the end, if it was another.
    pub fn replaced_trigger_mode(&self) -> Option<&str> {
        self.trigger_mode.as_deref()
    }

    /// Arms the scope, waits for its trigger, and reads its records; none once it is stopped.
    ///
    /// # Errors
    /// [`ClientError::Line`] if replies over a working line are invalid again and again.
    pub fn shot(
        &mut self,
        report: &mut dyn FnMut(AcquisitionEvent),
    ) -> Result<Option<AcquiredShot>, ClientError> {
        loop {
            let Some((state, timestamp_ns, late)) = self.wait_for_trigger(report)? else {
                return Ok(None);
            };
            report(AcquisitionEvent::Triggered);
            let mut read_out = ReadOut::default();
            let found = self
                .scope
                .persist(&mut |event| report(AcquisitionEvent::Line(event)), |scope| {
                    read_out.read(scope, &state)
                })?;
            for note in read_out.read_again {
                report(AcquisitionEvent::ReadAgain(note));
            }
            match found {
                None => return Ok(None),
                Some(Ok((set_up, captures))) => {
                    for capture in &captures {
                        let source = capture.waveform.source;
                        let notes = capture.notes.iter().map(|note| format!("{source}: {note}"));
                        notes.for_each(|note| report(AcquisitionEvent::Contradiction(note)));
                    }
                    return Ok(Some(AcquiredShot { timestamp_ns, late, set_up, captures }));
                }
                Some(Err(why)) => report(AcquisitionEvent::Dropped(why)),
            }
        }
    }

    /// Restores the scope's settings.
    ///
    /// # Errors
    /// [`ClientError::NotRestored`] with the commands that do.
    pub fn end(self) -> Result<(), ClientError> {
        self.scope.end(&self.restore)
    }

    /// Arms the scope and waits until it has triggered: its state, the time, and the time since it
    /// was last known to wait.
    fn wait_for_trigger(
        &mut self,
        report: &mut dyn FnMut(AcquisitionEvent),
    ) -> Result<Option<(ScopeState, u64, Duration)>, ClientError> {
        let mode = if self.trigger_mode.is_some() { ":TRIG:MAI:MOD NORM;" } else { "" };
        let arm = |scope: &mut Scope| -> io::Result<Instant> {
            let now = Instant::now();
            scope.ask(&format!("{mode}{ARM}"))?;
            Ok(now)
        };
        let scope = &mut self.scope;
        let mut line = |event| report(AcquisitionEvent::Line(event));
        let Some(mut last_waiting) = scope.persist(&mut line, arm)? else { return Ok(None) };
        report(AcquisitionEvent::Armed);
        loop {
            scope.pause(scope.timing().poll_interval);
            let asked = |scope: &mut Scope| Ok((Instant::now(), scope.state()?));
            let mut line = |event| report(AcquisitionEvent::Line(event));
            let Some((now, state)) = scope.persist(&mut line, asked)? else { return Ok(None) };
            let why = match state {
                ScopeState { is_single: false, .. } => "the scope was set to run on",
                ScopeState { is_running: true, .. } => {
                    last_waiting = now;
                    continue;
                }
                ScopeState { count: 0, .. } => "the scope was stopped before it had triggered",
                _ => return Ok(Some((state, wall_clock_time(), last_waiting.elapsed()))),
            };
            report(AcquisitionEvent::ArmedAgain(why));
            let mut line = |event| report(AcquisitionEvent::Line(event));
            let Some(now) = scope.persist(&mut line, arm)? else { return Ok(None) };
            last_waiting = now;
        }
    }
}

impl ReadOut {
    /// Reads set-up and records of `scope`, which has stopped in the state `stopped`; or why they
    /// cannot be used.
    fn read(
        &mut self,
        scope: &mut Scope,
        stopped: &ScopeState,
    ) -> io::Result<Result<(String, Vec<Capture>), &'static str>> {
        const RESTARTED: &str = "the scope was started or set while its record was read";
        let is_stopped = |scope: &mut Scope| -> io::Result<bool> {
            let now = scope.state()?;
            Ok(ScopeState { trigger: stopped.trigger.clone(), ..now } == *stopped)
        };
        if !is_stopped(scope)? {
            return Ok(Err(RESTARTED));
        }
        let (mut set_up, mut panel) = scope.front_panel()?;
        let mut captures = Vec::new();
        for source in displayed(&panel) {
            let mut capture = one_capture(scope, source, &panel)?;
            if let Some(note) = capture.notes.first() {
                let note = format!("{source}: {note}");
                (set_up, panel) = scope.front_panel()?;
                capture = one_capture(scope, source, &panel)?;
                if capture.notes.is_empty() {
                    self.read_again.push(note);
                }
            }
            let earlier = self.seen.iter().find(|capture| capture.waveform.source == source);
            match earlier.map(|earlier| &earlier.waveform) {
                None => self.seen.push(capture.clone()),
                Some(earlier)
                    if earlier.codes == capture.waveform.codes
                        && earlier.preamble == capture.waveform.preamble => {}
                Some(_) => return Ok(Err("the scope took another record while its line was down")),
            }
            captures.push(capture);
        }
        if captures.is_empty() {
            return Ok(Err("no trace was displayed"));
        }
        Ok(if is_stopped(scope)? { Ok((set_up, captures)) } else { Err(RESTARTED) })
    }
}

fn one_capture(scope: &mut Scope, source: Source, panel: &SetFile) -> io::Result<Capture> {
    let captures = scope.captures(&[source], panel)?.unwrap_or_default();
    let invalid = || invalid_reply("no record, or several, in reply to WAVFrm?");
    captures.into_iter().next().ok_or_else(invalid)
}

/// The trigger in words.
fn trigger(panel: &SetFile) -> String {
    let value = |key: &str| panel.value(&format!("TRIGGER:MAIN:{key}")).unwrap_or("?");
    match value("TYPE") {
        "EDGE" => {
            let level = engineering(panel.trigger_level().unwrap_or_default(), "V", 3);
            format!("{} {} at {level}", value("EDGE:SOURCE"), value("EDGE:SLOPE"))
        }
        other => format!("type {other}"),
    }
}

/// The trigger mode unless it is `NORMAL`, the commands that restore mode and acquisition, and the
/// front panel.
fn settings(scope: &mut Scope) -> io::Result<(Option<String>, String, SetFile)> {
    let reply = scope.ask(":ACQ:STOPA?;STATE?;:TRIG:MAI:MOD?")?;
    let [stop_after, state, mode] = words(&reply)?;
    let other = (mode != "NORMAL").then_some(mode);
    let mode = other.as_ref().map(|mode| format!(":TRIG:MAI:MOD {mode};")).unwrap_or_default();
    let restore = format!("{mode}:ACQ:STOPA {stop_after};STATE {state}");
    Ok((other, restore, scope.front_panel()?.1))
}

/// Begins the recording `file` of the scope at `address` or, if that exists, one with the next free
/// number.
///
/// # Errors
/// [`RecordingError`] if the file cannot be written.
pub fn create_recording(
    file: &Path,
    address: &Address,
    instrument: &InstrumentIdentity,
) -> Result<RecordingWriter, RecordingError> {
    RecordingWriter::create_live(file, &facts(address, instrument), &[])
}

/// What holds for all shots.
fn facts(address: &Address, instrument: &InstrumentIdentity) -> Facts {
    let group = |pairs: &[(&str, &str)]| {
        pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
    };
    let recording = [
        ("version", env!("CARGO_PKG_VERSION")),
        ("address", &address.to_string()),
        ("time_base", "of shots: nanoseconds since 1970; of records: seconds after the trigger"),
    ];
    let scope = [
        ("model", instrument.model.as_str()),
        ("serial", &instrument.serial),
        ("firmware", &instrument.firmware),
    ];
    Facts::from([
        ("hertzscope:recording".to_owned(), group(&recording)),
        ("hertzscope:scope".to_owned(), group(&scope)),
    ])
}

impl AcquiredShot {
    /// The shot with this number in a recording, and what is kept beside it.
    pub fn numbered(self, number: u32, address: &Address) -> (Shot, ShotNotes) {
        let late = self.late.as_secs_f64();
        let line = format!(
            "shot {number}: read from {address}; the trigger came up to {late:.2} s before the time of this shot"
        );
        let notes = ShotNotes { set_up: self.set_up, energy: None, log: vec![(false, line)] };
        let shot = Shot {
            number,
            origin: Origin::Measured,
            timestamp_ns: self.timestamp_ns,
            captures: self.captures,
            truth: Vec::new(),
            trigger_time: None,
        };
        (shot, notes)
    }

    /// A recording in memory of this shot alone.
    pub fn into_set(self, address: &Address, instrument: &InstrumentIdentity) -> TraceSet {
        let (shot, notes) = self.numbered(1, address);
        TraceSet {
            log: notes.log.iter().map(|(_, line)| line.clone()).collect(),
            notes: BTreeMap::from([(1, notes)]),
            metadata: facts(address, instrument),
            shots: vec![shot],
            ..TraceSet::default()
        }
    }
}

/// Nanoseconds since 1970.
pub fn wall_clock_time() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    since.map_or(0, |time| u64::try_from(time.as_nanos()).unwrap_or(u64::MAX))
}
