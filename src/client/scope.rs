//! One scope over any line: who it is, its state and settings, its records, and reconnection.
//!
//! Replies are made plain (no headers, words in full) until the end, and the settings of the
//! transfer (`DATa`) are set, used and restored within one message, which the instrument executes
//! as a whole: other clients notice nothing.

use std::io::{self, ErrorKind};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::{Duration, Instant};

use super::address::Address;
use super::connection::Client;
use super::record::{Record, has_empty_bytes};
use super::transport::POLL_INTERVAL;
use super::transport::invalid_reply;
use crate::quantity::printable_line;
use crate::recording::set_file::SetFile;
use crate::recording::{Capture, InstrumentIdentity};
use crate::scope::Source;

/// Query for the state of the acquisition.
const STATE_QUERY: &str = ":ACQ:STATE?;STOPA?;NUMAC?;:TRIG:STATE?";
/// Replies without headers, words in full.
const PLAIN_REPLIES: &str = ":HEAD OFF;:VERB ON";
/// Settings of the transfer, in the order of the reply.
const TRANSFER_FIELDS: [&str; 5] = ["ENC", "WID", "STAR", "STOP", "SOU"];
/// A query that fails so often over a line that works has no answer: this is another kind of
/// instrument.
const MAX_FAILURES: u32 = 20;
/// Longest part of a foreign reply to `*IDN?` that a message quotes (characters).
const MAX_QUOTED_IDENTITY: usize = 80;

/// Time limits and intervals of a client.
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

/// Why a scope gave no traces.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The line could not be opened, or failed again and again.
    #[error("{address}: {doing}")]
    Line {
        /// The address.
        address: String,
        /// What was being done.
        doing: &'static str,
        /// The system's error.
        source: io::Error,
    },
    /// Another kind of instrument answers.
    #[error("{address}: {problem}")]
    NoScope {
        /// The address.
        address: String,
        /// What was found, and what was expected.
        problem: String,
    },
    /// No trace is displayed.
    #[error("{address}: no trace is displayed: switch the channels on that are to be recorded")]
    NoTrace {
        /// The address.
        address: String,
    },
    /// The scope's settings could not be restored.
    #[error(
        "{address}: no confirmation that the scope is as it was: send `{commands}`, or set it at its front panel"
    )]
    NotRestored {
        /// The address.
        address: String,
        /// The commands that restore it.
        commands: String,
        /// The system's error.
        source: io::Error,
    },
}

/// A change of the line to a scope.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LineEvent {
    /// The line failed, and why; it is opened again.
    Failed(String),
    /// The line works again.
    Back,
}

/// State of a scope's acquisition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScopeState {
    /// Whether it acquires.
    pub is_running: bool,
    /// Whether it stops after one sequence.
    pub is_single: bool,
    /// Acquisitions since it was started; 0 in scan mode.
    pub count: u32,
    /// State of the trigger, e.g. `READY`.
    pub trigger: String,
}

impl ScopeState {
    fn read(reply: &str) -> io::Result<Self> {
        let fields: Vec<&str> = reply.split(';').collect();
        if let &[running @ ("0" | "1"), stop_after @ ("SEQUENCE" | "RUNSTOP"), count, trigger] =
            fields.as_slice()
            && let Ok(count) = count.parse()
        {
            return Ok(Self {
                is_running: running == "1",
                is_single: stop_after == "SEQUENCE",
                count,
                trigger: trigger.to_owned(),
            });
        }
        Err(invalid_reply("an invalid reply to the query for the state"))
    }
}

/// A scope on a line.
#[derive(Debug)]
pub struct Scope {
    client: Client,
    timing: ClientTiming,
    instrument: InstrumentIdentity,
    /// The reply to `*IDN?`.
    identity: String,
    /// The commands that give replies the form that they had.
    reply_form: String,
    /// Bytes of a point: two, until a record has shown a converter of 8 bits.
    width: u8,
}

impl Scope {
    /// Connects to the scope at `address`, and makes its replies plain. All that waits ends once
    /// `stop` is set.
    ///
    /// # Errors
    /// [`ClientError`]: no line, or no scope of this family.
    pub fn connect(
        address: &Address,
        timing: ClientTiming,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, ClientError> {
        let failed =
            |doing| move |source| ClientError::Line { address: address.to_string(), doing, source };
        let mut client = Client::connect(address, timing.reply_timeout, stop)
            .map_err(failed("cannot be opened"))?;
        let no_answer = "no oscilloscope answers to *IDN? (is it on, and the line set as it is?)";
        let identity = client.ask("*IDN?").map_err(failed(no_answer))?;
        let instrument = instrument(&identity)
            .map_err(|problem| ClientError::NoScope { address: address.to_string(), problem })?;
        let no_form = "no valid reply to HEADer? and VERBose?";
        let reply_form = reply_form(&mut client).map_err(failed(no_form))?;
        let mut scope = Self { client, timing, instrument, identity, reply_form, width: 2 };
        if let Err(source) = scope.client.send(PLAIN_REPLIES) {
            // The failure before is reported.
            let _ = scope.end("");
            return Err(failed("cannot be written to")(source));
        }
        Ok(scope)
    }

    /// The scope's model, serial number and firmware.
    pub fn instrument(&self) -> &InstrumentIdentity {
        &self.instrument
    }

    /// Its address.
    pub fn address(&self) -> &Address {
        self.client.address()
    }

    /// Time limits and intervals.
    pub fn timing(&self) -> ClientTiming {
        self.timing
    }

    /// Whether the user has asked to stop.
    pub fn is_stopped(&self) -> bool {
        self.client.is_stopped()
    }

    /// Sends a message, and waits for its reply, without the line's end.
    ///
    /// # Errors
    /// The system's error; also for a reply that is not a text.
    pub fn ask(&mut self, message: &str) -> io::Result<String> {
        self.client.ask(message)
    }

    /// Sends a message.
    ///
    /// # Errors
    /// The system's error.
    pub fn send(&mut self, message: &str) -> io::Result<()> {
        self.client.send(message)
    }

    /// The state of the acquisition.
    ///
    /// # Errors
    /// The system's error; also for an invalid reply.
    pub fn state(&mut self) -> io::Result<ScopeState> {
        ScopeState::read(&self.client.ask(STATE_QUERY)?)
    }

    /// The front panel, as the scope sends it and as settings.
    ///
    /// # Errors
    /// The system's error; also for an invalid reply.
    pub fn front_panel(&mut self) -> io::Result<(String, SetFile)> {
        let text = self.client.ask("SET?")?;
        let panel = SetFile::read(text.as_bytes(), "reply to SET?")
            .map_err(|error| io::Error::new(ErrorKind::InvalidData, error.to_string()))?;
        Ok((text, panel))
    }

    /// The records of `sources`, from one message, with what `panel` says of them; none if there is
    /// not one for each, as after another client has switched a trace off. A capture's notes list
    /// what the scope says twice and differently.
    ///
    /// # Errors
    /// The system's error; also for an invalid record, or one of another trace.
    pub fn captures(
        &mut self,
        sources: &[Source],
        panel: &SetFile,
    ) -> io::Result<Option<Vec<Capture>>> {
        let records = self.records(sources)?;
        if records.len() != sources.len() {
            return Ok(None);
        }
        let pairs = records.iter().zip(sources);
        let captures = pairs.map(|(record, source)| {
            let capture = Record(record).capture(*source, panel, &self.instrument);
            capture.map_err(|problem| io::Error::new(ErrorKind::InvalidData, problem))
        });
        let captures: Vec<Capture> = captures.collect::<io::Result<_>>()?;
        if self.width == 2 && captures.iter().any(has_empty_bytes) {
            self.width = 1;
            return self.captures(sources, panel);
        }
        Ok(Some(captures))
    }

    /// The records of `sources`, each as an ISF file holds it.
    fn records(&mut self, sources: &[Source]) -> io::Result<Vec<Vec<u8>>> {
        let fields = TRANSFER_FIELDS.map(|word| format!("{word}?")).join(";");
        let before = self.client.ask(&format!(":DAT:{fields}"))?;
        let restore = transfer_commands(&before)?;
        let records: Vec<String> =
            sources.iter().map(|source| format!(":DAT:SOU {source};:WAVF?")).collect();
        let records = records.join(";");
        let message = format!(
            ":DAT:{fields};ENC RIB;WID {};STAR 1;STOP 2500;:HEAD ON;{records};:HEAD OFF;:DAT:{restore}",
            self.width
        );
        let (found, records) = self.client.ask_for_records(&message)?;
        if found != before {
            // Another client changed the setting between the two messages.
            self.client.send(&format!(":DAT:{}", transfer_commands(&found)?))?;
        }
        Ok(records)
    }

    /// Does `act`, and again after each failure of the line, which is opened again as often as it
    /// takes; none once it is stopped.
    ///
    /// # Errors
    /// [`ClientError::Line`] if replies over a working line are invalid again and again.
    pub fn persist<T>(
        &mut self,
        report: &mut dyn FnMut(LineEvent),
        mut act: impl FnMut(&mut Self) -> io::Result<T>,
    ) -> Result<Option<T>, ClientError> {
        let mut failures = 0;
        loop {
            let source = match act(self) {
                Ok(done) => return Ok(Some(done)),
                Err(_) if self.is_stopped() => return Ok(None),
                Err(source) => source,
            };
            failures += 1;
            if failures == MAX_FAILURES {
                let address = self.address().to_string();
                let doing = "connected, but 20 replies in a row were invalid; the last one";
                return Err(ClientError::Line { address, doing, source });
            }
            let mut reported = source.to_string();
            report(LineEvent::Failed(reported.clone()));
            while let Err(error) = self.reconnect() {
                if self.is_stopped() {
                    return Ok(None);
                }
                let why = error.to_string();
                if why != reported {
                    report(LineEvent::Failed(why.clone()));
                    reported = why;
                }
                self.pause(self.timing.retry_interval);
            }
            report(LineEvent::Back);
        }
    }

    /// Waits `time`, or until it is stopped.
    pub fn pause(&self, time: Duration) {
        let started = Instant::now();
        while let left = time.saturating_sub(started.elapsed())
            && !left.is_zero()
            && !self.is_stopped()
        {
            thread::sleep(left.min(POLL_INTERVAL));
        }
    }

    /// Opens the line again, to the same scope.
    fn reconnect(&mut self) -> io::Result<()> {
        self.client.reconnect()?;
        let found = instrument(&self.client.ask("*IDN?")?).map_err(io::Error::other)?;
        if found != self.instrument {
            let (found, expected) = (found.model, &self.instrument.model);
            let words = format!(
                "found a {found} of another serial number or firmware, expected the {expected} of before"
            );
            return Err(io::Error::other(words));
        }
        self.client.send(PLAIN_REPLIES)
    }

    /// Whether a simulated bench is behind the scope. Only a socket may have one; a scope without
    /// one answers the second query alone, or nothing.
    ///
    /// # Errors
    /// The system's error.
    pub fn has_bench(&mut self) -> io::Result<bool> {
        if !matches!(self.address(), Address::Socket(_)) {
            return Ok(false);
        }
        match self.ask(":BENC:IMP?;:HEAD?") {
            Ok(reply) => Ok(reply.contains(';')),
            Err(error) if error.kind() == ErrorKind::TimedOut => {
                self.reconnect()?;
                Ok(false)
            }
            Err(error) => Err(error),
        }
    }

    /// Sends `restore`, the commands that restore the scope, and gives replies the form that they
    /// had.
    ///
    /// # Errors
    /// [`ClientError::NotRestored`] with the commands.
    pub fn end(mut self, restore: &str) -> Result<(), ClientError> {
        let separator = if restore.is_empty() { "" } else { ";" };
        let commands = format!("{restore}{separator}{}", self.reply_form);
        let address = self.address().to_string();
        let restored = self.client.restore(&commands, &self.identity);
        restored.map_err(|source| ClientError::NotRestored { address, commands, source })
    }
}

/// Reads the reply to `*IDN?`, e.g. `TEKTRONIX,TDS 2014,0,CF:91.1CT FV:v4.12 TDS2CM:CMV:v1.04`; or
/// a message for the user if this is no oscilloscope of the family.
fn instrument(reply: &str) -> Result<InstrumentIdentity, String> {
    let reply = printable_line(reply);
    let mut fields = reply.split(',');
    let (maker, model) = (fields.next().unwrap_or_default(), fields.next().unwrap_or_default());
    let model = model.replace(' ', "");
    let is_family = ["TDS", "TPS", "TBS"].iter().any(|family| model.starts_with(family));
    if maker != "TEKTRONIX" || !is_family {
        let start: String = reply.chars().take(MAX_QUOTED_IDENTITY).collect();
        return Err(format!(
            "found {start}, expected a Tektronix oscilloscope of the TDS2000 family"
        ));
    }
    let serial = fields.next().unwrap_or_default().to_owned();
    let firmware =
        fields.next().and_then(|rest| rest.split(' ').find(|word| word.starts_with("FV:")));
    Ok(InstrumentIdentity { model, serial, firmware: firmware.unwrap_or_default().to_owned() })
}

/// The commands that give replies the form that they have now.
fn reply_form(client: &mut Client) -> io::Result<String> {
    let mut is_on = |query| {
        let reply = client.ask(query)?;
        // With a header or without.
        match reply.rsplit(' ').next() {
            Some("1" | "ON") => Ok("1"),
            Some("0" | "OFF") => Ok("0"),
            _ => Err(invalid_reply("a reply to HEADer? or VERBose? that is neither 0 nor 1")),
        }
    };
    let (header, verbose) = (is_on("HEAD?")?, is_on("VERB?")?);
    Ok(format!(":VERB {verbose};:HEAD {header}"))
}

/// The commands that set the transfer as `reply` says.
fn transfer_commands(reply: &str) -> io::Result<String> {
    let values: [String; TRANSFER_FIELDS.len()] = words(reply)?;
    let pairs = TRANSFER_FIELDS.iter().zip(values).map(|(word, value)| format!("{word} {value}"));
    Ok(pairs.collect::<Vec<_>>().join(";"))
}

/// The words of a reply, with semicolons between them.
///
/// # Errors
/// Another number of words than `COUNT`, or something other than words.
pub fn words<const COUNT: usize>(reply: &str) -> io::Result<[String; COUNT]> {
    let words: Vec<String> = reply.split(';').map(str::to_owned).collect();
    let is_word = |word: &String| !word.is_empty() && word.chars().all(char::is_alphanumeric);
    let words: Result<[String; COUNT], _> = words.try_into();
    words.ok().filter(|words| words.iter().all(is_word)).ok_or_else(|| {
        invalid_reply(&format!("a reply that is not {COUNT} words with semicolons between them"))
    })
}
