//! One connection: takes bytes, gives replies, remembers what waits.

use std::collections::VecDeque;

use super::input::{InputBuffer, InputPiece, MAXIMUM_BYTES};
use super::message::{MessageUnit, units};
use super::reply;
use super::reply::Preferences;
use super::table::{Context, Deferred};
use super::tree;
use super::value::none;
use crate::instrument::{Event, Instrument};

/// A reply to be sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reply {
    /// Nothing.
    None,
    /// These bytes, terminators included.
    Now(Vec<u8>),
    /// These bytes, which may be none; more comes from [`Session::resume`] when the acquisition is
    /// done.
    WhenIdle(Vec<u8>),
}

/// A message that is being executed.
#[derive(Debug, Clone, Default)]
struct Progress {
    units: VecDeque<Result<MessageUnit, Event>>,
    path: Vec<String>,
    replies: Vec<Vec<u8>>,
    raw: Vec<u8>,
    indefinite: bool,
    /// Whether the instrument replies, and not only the bench behind it.
    by_instrument: bool,
    /// Units of the device trigger (`*DDT`) that are still to come, and the path after them.
    trigger: (usize, Vec<String>),
}

/// Longest reply to one message. Where replies outgrow it, all of them and the rest of the message
/// are lost.
pub const MAXIMUM_REPLY: usize = 1 << 20;

/// A message that a connection received or sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TranscriptLine {
    /// A message without its end.
    Command(Vec<u8>),
    /// A reply with its terminator.
    Reply(Vec<u8>),
}

/// One connection.
#[derive(Debug, Clone)]
pub struct Session {
    input: InputBuffer,
    preferences: Preferences,
    waiting: Option<Progress>,
    backlog: VecDeque<Vec<u8>>,
    transcript: Option<Vec<TranscriptLine>>,
    by_instrument: bool,
}

impl Session {
    /// A fresh connection.
    pub fn new(preferences: Preferences) -> Self {
        Self {
            input: InputBuffer::default(),
            preferences,
            waiting: None,
            backlog: VecDeque::new(),
            transcript: None,
            by_instrument: false,
        }
    }

    /// The same, recording its messages until [`Self::take_transcript`].
    pub fn with_transcript(self) -> Self {
        Self { transcript: Some(Vec::new()), ..self }
    }

    /// The messages received and sent since the last call.
    pub fn take_transcript(&mut self) -> Vec<TranscriptLine> {
        self.transcript.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Whether the instrument made the last reply, and not only the bench behind it.
    pub fn is_by_instrument(&self) -> bool {
        self.by_instrument
    }

    /// Takes bytes as they come, in pieces of any size.
    pub fn receive(&mut self, instrument: &mut Instrument, bytes: &[u8]) -> Reply {
        let mut out = Vec::new();
        for byte in bytes {
            if let Some(piece) = self.input.push(*byte) {
                self.take(instrument, piece, &mut out);
            }
        }
        self.reply(out)
    }

    /// Ends a message whose protocol marks its end instead of a line end.
    pub fn end_of_message(&mut self, instrument: &mut Instrument) -> Reply {
        let mut out = Vec::new();
        if let Some(piece) = self.input.finish() {
            self.take(instrument, piece, &mut out);
        }
        self.reply(out)
    }

    /// Device trigger (IEEE 488.2, group execute trigger): executes what `*TRG` stands for, beside
    /// a message that may have begun.
    pub fn trigger(&mut self, instrument: &mut Instrument) -> Reply {
        let mut out = Vec::new();
        self.take(instrument, InputPiece::Message(b"*TRG".to_vec()), &mut out);
        self.reply(out)
    }

    /// Goes on with what waits, if the acquisition is done. To be called whenever time has passed.
    pub fn resume(&mut self, instrument: &mut Instrument) -> Reply {
        let mut out = Vec::new();
        if let Some(progress) = self.waiting.take() {
            self.execute(instrument, progress, &mut out);
        }
        while self.waiting.is_none()
            && let Some(message) = self.backlog.pop_front()
        {
            self.start(instrument, &message, &mut out);
        }
        self.reply(out)
    }

    /// Device clear: forgets input and whatever waits.
    pub fn clear(&mut self) {
        self.input.clear();
        self.waiting = None;
        self.backlog.clear();
    }

    /// Another message came before the reply was read: a reply that is still to come is lost.
    pub fn interrupt(&mut self, instrument: &mut Instrument) {
        if self.owes_reply() {
            self.waiting = None;
        }
        instrument.status.report(Event::QueryInterrupted);
    }

    /// Whether a reply waits for the end of an acquisition.
    pub fn owes_reply(&self) -> bool {
        self.waiting.as_ref().is_some_and(|progress| {
            !progress.replies.is_empty()
                || progress.units.iter().any(|unit| unit.as_ref().is_ok_and(|u| u.is_query))
        })
    }

    /// Whether a reply or a message waits for the end of an acquisition.
    pub fn is_waiting(&self) -> bool {
        self.waiting.is_some()
    }

    fn reply(&self, out: Vec<u8>) -> Reply {
        match (self.is_waiting(), out.is_empty()) {
            (true, _) => Reply::WhenIdle(out),
            (false, true) => Reply::None,
            (false, false) => Reply::Now(out),
        }
    }

    fn take(&mut self, instrument: &mut Instrument, piece: InputPiece, out: &mut Vec<u8>) {
        let message = match piece {
            InputPiece::Message(message) => message,
            InputPiece::Overrun => return instrument.status.report(Event::InputOverrun),
        };
        if let Some(transcript) = &mut self.transcript {
            transcript.push(TranscriptLine::Command(message.clone()));
        }
        let waits_for_reply = self.waiting.as_ref().map(|progress| {
            progress.units.front().is_some_and(|unit| unit.as_ref().is_ok_and(|u| u.is_query))
        });
        let asks = || units(&message).iter().any(|unit| unit.as_ref().is_ok_and(|u| u.is_query));
        match waits_for_reply {
            None => self.start(instrument, &message, out),
            Some(true) if asks() => {
                self.waiting = None;
                instrument.status.report(Event::QueryInterrupted);
                self.start(instrument, &message, out);
            }
            Some(true) => {
                // What waits is only its reply: commands go on.
                let waiting = self.waiting.take();
                self.start(instrument, &message, out);
                if self.waiting.is_some() {
                    self.defer(instrument, message);
                }
                self.waiting = waiting;
            }
            Some(false) => self.defer(instrument, message),
        }
    }

    fn defer(&mut self, instrument: &mut Instrument, message: Vec<u8>) {
        let held: usize = self.backlog.iter().map(Vec::len).sum();
        if held + message.len() > MAXIMUM_BYTES {
            instrument.status.report(Event::InputOverrun);
        } else {
            self.backlog.push_back(message);
        }
    }

    fn start(&mut self, instrument: &mut Instrument, message: &[u8], out: &mut Vec<u8>) {
        let progress = Progress { units: units(message).into(), ..Progress::default() };
        self.execute(instrument, progress, out);
    }

    fn execute(&mut self, instrument: &mut Instrument, mut progress: Progress, out: &mut Vec<u8>) {
        while let Some(unit) = progress.units.pop_front() {
            let in_trigger = progress.trigger.0 > 0;
            let done = match &unit {
                Ok(unit) => self.execute_unit(instrument, unit, &mut progress),
                Err(event) => Err(Deferred::Event(*event)),
            };
            match done {
                Ok(()) => {}
                Err(Deferred::Event(event)) => {
                    instrument.status.report(event);
                    // The query ends without the reply that its client waits for.
                    if event == Event::NotActive && unit.is_ok_and(|unit| unit.is_query) {
                        instrument.status.report(Event::QueryUnterminated);
                    }
                }
                // `*TRG` among its own commands would never end.
                Err(Deferred::Execute(_)) if in_trigger => {
                    instrument.status.report(Event::SettingsConflict);
                }
                Err(Deferred::Execute(commands)) => {
                    let commands = units(commands.as_bytes());
                    progress.trigger = (commands.len(), std::mem::take(&mut progress.path));
                    commands.into_iter().rev().for_each(|unit| progress.units.push_front(unit));
                    continue;
                }
                Err(Deferred::UntilIdle) => {
                    progress.units.push_front(unit);
                    self.waiting = Some(progress);
                    return;
                }
            }
            if in_trigger {
                progress.trigger.0 -= 1;
                if progress.trigger.0 == 0 {
                    progress.path = std::mem::take(&mut progress.trigger.1);
                }
            }
        }
        if !(progress.replies.is_empty() && progress.raw.is_empty()) {
            self.by_instrument = progress.by_instrument || !progress.raw.is_empty();
        }
        if !progress.replies.is_empty() {
            let start = out.len();
            out.extend_from_slice(&progress.replies.join(&b';'));
            out.extend_from_slice(self.preferences.terminator.bytes());
            if let Some(transcript) = &mut self.transcript {
                transcript
                    .push(TranscriptLine::Reply(out.get(start..).unwrap_or_default().to_vec()));
            }
        }
        out.append(&mut progress.raw);
    }

    fn execute_unit(
        &mut self,
        instrument: &mut Instrument,
        unit: &MessageUnit,
        progress: &mut Progress,
    ) -> Result<(), Deferred> {
        let is_common = unit.header.first().is_some_and(|word| word.starts_with('*'));
        let mut words =
            if unit.from_root || is_common { Vec::new() } else { progress.path.clone() };
        words.extend(unit.header.iter().cloned());
        let channels = instrument.model.channels;
        let found = tree::find(&words, channels).filter(|_| !(is_common && unit.from_root));
        let found = found.ok_or(Event::UndefinedHeader)?;
        if !is_common {
            words.pop();
            progress.path = words;
        }
        let mut context = Context {
            instrument,
            preferences: &mut self.preferences,
            suffix: found.suffix,
            message_available: !progress.replies.is_empty(),
            raw: &mut progress.raw,
        };
        if !unit.is_query {
            found.row.set(&mut context, &unit.arguments)?;
            if progress.raw.len() > MAXIMUM_REPLY {
                progress.raw.clear();
                progress.units.clear();
                return Err(Event::QueryDeadlocked.into());
            }
            return Ok(());
        }
        none(&unit.arguments)?;
        if progress.indefinite {
            return Err(Event::QueryAfterIndefinite.into());
        }
        let answers = tree::query(found, &mut context)?;
        progress.by_instrument |= !found.row.header.starts_with("BENCh");
        let is_setup = matches!(found.row.header, "SET" | "*LRN");
        let header = self.preferences.header || is_setup;
        let preferences = Preferences { header, ..self.preferences };
        progress.replies.push(reply::write(&answers, &preferences));
        if progress.replies.iter().map(Vec::len).sum::<usize>() > MAXIMUM_REPLY {
            progress.replies.clear();
            progress.units.clear();
            return Err(Event::QueryDeadlocked.into());
        }
        progress.indefinite = matches!(found.row.header, "*IDN" | "ID");
        Ok(())
    }
}
