//! Takes one shot after the other from a scope.
//!
//! For each shot the scope is armed for a single sequence, so that it holds the record of one
//! trigger until all channels are read. It is asked for its state until it has stopped; no query
//! blocks. A line that fails is opened again for as long as it takes: the scope holds its record
//! meanwhile, and the read-out begins anew. A shot counts if the scope was not started during the
//! read-out and all that was read twice was the same; otherwise it is dropped, and said. In the
//! trigger mode `AUTO` a scope also takes records without a trigger: it is `NORMAL` meanwhile.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use super::address::Address;
use super::connection::Client;
use super::error::ClientError;
use super::identity::identity;
use super::line::invalid_reply;
use super::transfer::{PLAIN_REPLIES, ReplyForm, capture, displayed, records};
use crate::quantity::engineering;
use crate::recording::set_file::SetFile;
use crate::recording::{Capture, InstrumentIdentity};
use crate::scope::Source;

/// Query for the state of the acquisition.
const STATE_QUERY: &str = ":ACQ:STATE?;STOPA?;NUMAC?;:TRIG:STATE?";
/// Arms the scope for one trigger. The reply says that it was done: otherwise the record of before
/// would be taken for a new one.
const ARM: &str = ":ACQ:STOPA SEQ;STATE RUN;STATE?";
/// A query that fails so often over a line that works has no answer: this is another kind of
/// instrument.
const MAX_FAILURES: u32 = 20;
/// How often it is looked whether to stop while a line is down.
const STOP_POLL_INTERVAL: Duration = Duration::from_millis(50);

/// How long things may take, and how often they are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClientTiming {
    /// Longest wait for the next byte of a reply.
    pub reply_timeout: Duration,
    /// Time from one query for the state to the next.
    pub poll_interval: Duration,
    /// Time from one attempt to open a line to the next.
    pub retry_interval: Duration,
}

impl Default for ClientTiming {
    fn default() -> Self {
        Self {
            reply_timeout: Duration::from_secs(5),
            poll_interval: Duration::from_millis(100),
            retry_interval: Duration::from_secs(2),
        }
    }
}

/// Something that happened while a shot was awaited.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AcquisitionEvent {
    /// The scope is armed.
    Armed,
    /// The scope has triggered, and its records are read.
    Triggered,
    /// The line failed, and why; it is opened again.
    LineFailed(String),
    /// The line works again.
    LineBack,
    /// The scope was started or stopped by another client or at its panel: it is armed again.
    ArmedAgain(&'static str),
    /// A record was dropped, and why.
    Dropped(&'static str),
}

/// What one trigger left.
#[derive(Debug, Clone, PartialEq)]
pub struct AcquiredShot {
    /// When the scope said that it had stopped, nanoseconds since 1970.
    pub timestamp_ns: u64,
    /// How much earlier the trigger may have been: since the scope last said that it was waiting.
    pub late: Duration,
    /// The front panel, as `SET?` tells it.
    pub set_up: String,
    /// The displayed traces.
    pub captures: Vec<Capture>,
}

/// State of the scope's acquisition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ScopeState {
    is_running: bool,
    is_single: bool,
    /// Acquisitions since it was started.
    count: u32,
}

impl ScopeState {
    fn read(reply: &str) -> io::Result<Self> {
        let fields: Vec<&str> = reply.split(';').collect();
        let &[running, stop_after, count, _] = fields.as_slice() else {
            return Err(invalid_reply("an invalid reply to the query for the state"));
        };
        let count = count.parse();
        match (running, stop_after, count) {
            ("0" | "1", "SEQUENCE" | "RUNSTOP", Ok(count)) => {
                Ok(Self { is_running: running == "1", is_single: stop_after == "SEQUENCE", count })
            }
            _ => Err(invalid_reply("an invalid reply to the query for the state")),
        }
    }
}

/// A scope from which shots are taken.
#[derive(Debug)]
pub struct ShotAcquisition {
    client: Client,
    timing: ClientTiming,
    instrument: InstrumentIdentity,
    displayed: Vec<Source>,
    /// What triggers it.
    trigger: String,
    /// Trigger mode that is replaced by `NORMAL`, if it was another.
    trigger_mode: Option<String>,
    /// What puts the scope back as it was, up to the form of replies.
    restore: String,
    form: ReplyForm,
}

impl ShotAcquisition {
    /// Connects to the scope at `address`, and notes what is to be put back at the end.
    ///
    /// # Errors
    /// [`ClientError`]: no line, no scope of this family, or no trace on its screen.
    pub fn begin(address: &Address, timing: ClientTiming) -> Result<Self, ClientError> {
        let failed =
            |doing| move |source| ClientError::Line { address: address.to_string(), doing, source };
        let mut client =
            Client::connect(address, timing.reply_timeout).map_err(failed("cannot be opened"))?;
        let no_answer = "no oscilloscope answers to *IDN? (is it on, and the line set as it is?)";
        let reply = client.ask("*IDN?").map_err(failed(no_answer))?;
        let instrument = identity(&reply)
            .map_err(|problem| ClientError::NoScope { address: address.to_string(), problem })?;
        let asked = failed("the scope does not tell its settings");
        let form = ReplyForm::replace(&mut client).map_err(&asked)?;
        let read = settings(&mut client).inspect_err(|_| {
            // The settings' failure is what is told.
            let _ = client.send(&form.commands());
        });
        let (trigger_mode, restore, panel) = read.map_err(asked)?;
        let (displayed, trigger) = (displayed(&panel), trigger(&panel));
        let begun =
            Self { client, timing, instrument, displayed, trigger, trigger_mode, restore, form };
        if begun.displayed.is_empty() {
            begun.end()?;
            return Err(ClientError::NoTrace { address: address.to_string() });
        }
        Ok(begun)
    }

    /// The scope.
    pub fn instrument(&self) -> &InstrumentIdentity {
        &self.instrument
    }

    /// The traces on its screen when this began.
    pub fn displayed(&self) -> &[Source] {
        &self.displayed
    }

    /// What triggered it when this began, e.g. `CH1 RISE at 500 mV`.
    pub fn trigger(&self) -> &str {
        &self.trigger
    }

    /// The trigger mode that is `NORMAL` until the end, if it was another.
    pub fn replaced_trigger_mode(&self) -> Option<&str> {
        self.trigger_mode.as_deref()
    }

    /// Arms the scope, waits for its trigger, and reads its records; none once `stop` is set.
    ///
    /// # Errors
    /// [`ClientError::Line`] where a line that works brings no sense again and again.
    pub fn shot(
        &mut self,
        stop: &AtomicBool,
        tell: &mut dyn FnMut(AcquisitionEvent),
    ) -> Result<Option<AcquiredShot>, ClientError> {
        loop {
            let Some((state, timestamp_ns, late)) = self.wait_for_trigger(stop, tell)? else {
                return Ok(None);
            };
            tell(AcquisitionEvent::Triggered);
            let mut seen = Vec::new();
            let read = self.persist(stop, tell, |scope| scope.read_out(state, &mut seen))?;
            match read {
                None => return Ok(None),
                Some(Ok((set_up, captures))) => {
                    return Ok(Some(AcquiredShot { timestamp_ns, late, set_up, captures }));
                }
                Some(Err(why)) => tell(AcquisitionEvent::Dropped(why)),
            }
        }
    }

    /// Puts the scope back as it was.
    ///
    /// # Errors
    /// [`ClientError::NotRestored`] with what to do.
    pub fn end(mut self) -> Result<(), ClientError> {
        let restored = self.restore().or_else(|_| {
            self.reopen()?;
            self.restore()
        });
        restored.map_err(|source| ClientError::NotRestored {
            address: self.client.address().to_string(),
            commands: format!("{};{}", self.restore, self.form.commands()),
            source,
        })
    }

    fn restore(&mut self) -> io::Result<()> {
        self.client.send(&self.restore)?;
        // The reply says that the line carries what is sent.
        self.client.ask("*IDN?")?;
        self.client.send(&self.form.commands())
    }

    /// Arms the scope and waits until it has triggered: its state, when it told, and how long ago
    /// it last told otherwise.
    fn wait_for_trigger(
        &mut self,
        stop: &AtomicBool,
        tell: &mut dyn FnMut(AcquisitionEvent),
    ) -> Result<Option<(ScopeState, u64, Duration)>, ClientError> {
        let Some(mut asked) = self.persist(stop, tell, Self::arm)? else { return Ok(None) };
        tell(AcquisitionEvent::Armed);
        while !stop.load(Ordering::Relaxed) {
            thread::sleep(self.timing.poll_interval);
            let Some((now, state)) = self.persist(stop, tell, Self::state)? else { break };
            let why = match state {
                ScopeState { is_single: false, .. } => "the scope was set to run on",
                ScopeState { is_running: true, .. } => {
                    asked = now;
                    continue;
                }
                ScopeState { count: 0, .. } => "the scope was stopped before it had triggered",
                _ => return Ok(Some((state, wall_clock_time(), asked.elapsed()))),
            };
            tell(AcquisitionEvent::ArmedAgain(why));
            let Some(now) = self.persist(stop, tell, Self::arm)? else { break };
            asked = now;
        }
        Ok(None)
    }

    /// Arms the scope; when that was.
    fn arm(&mut self) -> io::Result<Instant> {
        let now = Instant::now();
        let mode = if self.trigger_mode.is_some() { ":TRIG:MAI:MOD NORM;" } else { "" };
        self.client.ask(&format!("{mode}{ARM}"))?;
        Ok(now)
    }

    /// The state, and when it was asked for.
    fn state(&mut self) -> io::Result<(Instant, ScopeState)> {
        let now = Instant::now();
        Ok((now, ScopeState::read(&self.client.ask(STATE_QUERY)?)?))
    }

    /// Reads set-up and records of the scope, which has stopped in `held`; or why they are of no
    /// use. What was read before a line failed stands in `seen`.
    fn read_out(
        &mut self,
        held: ScopeState,
        seen: &mut Vec<Capture>,
    ) -> io::Result<Result<(String, Vec<Capture>), &'static str>> {
        const RESTARTED: &str = "the scope was started or set while its record was read";
        if self.state()?.1 != held {
            return Ok(Err(RESTARTED));
        }
        let (set_up, panel) = front_panel(&mut self.client)?;
        let mut captures = Vec::new();
        for source in displayed(&panel) {
            let found = records(&mut self.client, &[source])?;
            let [record] = found.as_slice() else {
                return Err(invalid_reply("no record, or several, in reply to WAVFrm?"));
            };
            let capture = capture(record, &panel, &self.instrument)
                .map_err(|problem| io::Error::new(io::ErrorKind::InvalidData, problem))?;
            if capture.waveform.source != source {
                return Err(invalid_reply("the record of another trace than was asked for"));
            }
            let earlier = seen.iter().find(|capture| capture.waveform.source == source);
            match earlier.map(|earlier| &earlier.waveform) {
                None => seen.push(capture.clone()),
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
        let is_held = self.state()?.1 == held;
        Ok(if is_held { Ok((set_up, captures)) } else { Err(RESTARTED) })
    }

    /// Does `act`, again after each failure of the line; none once `stop` is set while the line is
    /// down.
    fn persist<T>(
        &mut self,
        stop: &AtomicBool,
        tell: &mut dyn FnMut(AcquisitionEvent),
        mut act: impl FnMut(&mut Self) -> io::Result<T>,
    ) -> Result<Option<T>, ClientError> {
        let mut failures = 0;
        loop {
            let source = match act(self) {
                Ok(done) => return Ok(Some(done)),
                Err(source) => source,
            };
            failures += 1;
            if failures == MAX_FAILURES {
                let address = self.client.address().to_string();
                let doing = "the line works, but the scope's replies make no sense";
                return Err(ClientError::Line { address, doing, source });
            }
            tell(AcquisitionEvent::LineFailed(source.to_string()));
            let mut told = source.to_string();
            while let Err(error) = self.reopen() {
                if stop.load(Ordering::Relaxed) {
                    return Ok(None);
                }
                let why = error.to_string();
                if why != told {
                    tell(AcquisitionEvent::LineFailed(why.clone()));
                    told = why;
                }
                self.pause(stop);
            }
            tell(AcquisitionEvent::LineBack);
        }
    }

    /// Waits until the line may be tried again, or `stop` is set.
    fn pause(&self, stop: &AtomicBool) {
        let started = Instant::now();
        while started.elapsed() < self.timing.retry_interval && !stop.load(Ordering::Relaxed) {
            thread::sleep(STOP_POLL_INTERVAL.min(self.timing.retry_interval));
        }
    }

    /// Opens the line again, to the same scope.
    fn reopen(&mut self) -> io::Result<()> {
        self.client.reconnect()?;
        let found = identity(&self.client.ask("*IDN?")?).map_err(io::Error::other)?;
        if found != self.instrument {
            let (found, expected) = (found.model, &self.instrument.model);
            let words = format!(
                "found a {found} of another serial number or firmware, expected the {expected} of before"
            );
            return Err(io::Error::other(words));
        }
        self.client.send(PLAIN_REPLIES)
    }
}

/// What triggers a scope.
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

/// The trigger mode unless it is `NORMAL`, the commands that put mode and acquisition back, and the
/// front panel.
fn settings(client: &mut Client) -> io::Result<(Option<String>, String, SetFile)> {
    let told = client.ask(":ACQ:STOPA?;STATE?;:TRIG:MAI:MOD?")?;
    let [stop_after, state, mode] = words(&told)?;
    let other = (mode != "NORMAL").then_some(mode);
    let mode = other.as_ref().map(|mode| format!(":TRIG:MAI:MOD {mode};")).unwrap_or_default();
    let restore = format!("{mode}:ACQ:STOPA {stop_after};STATE {state}");
    Ok((other, restore, front_panel(client)?.1))
}

/// The front panel, as the scope tells it and as settings.
fn front_panel(client: &mut Client) -> io::Result<(String, SetFile)> {
    let told = client.ask("SET?")?;
    let panel = SetFile::read(told.as_bytes(), "reply to SET?")
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.to_string()))?;
    Ok((told, panel))
}

/// So many words with semicolons between them.
fn words<const COUNT: usize>(reply: &str) -> io::Result<[String; COUNT]> {
    let words: Vec<String> = reply.split(';').map(str::to_owned).collect();
    let is_word = |word: &String| !word.is_empty() && word.chars().all(char::is_alphanumeric);
    let words: Result<[String; COUNT], _> = words.try_into();
    words
        .ok()
        .filter(|words| words.iter().all(is_word))
        .ok_or_else(|| invalid_reply("another number of words than was asked for"))
}

/// Nanoseconds since 1970.
pub fn wall_clock_time() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    since.map_or(0, |time| u64::try_from(time.as_nanos()).unwrap_or(u64::MAX))
}
