//! Recordings: what the bench keeps. One file a format, one type for all of them.
//!
//! `experiment` fills a [`TraceSet`], [`mcap`] writes and reads it, [`tek_csv`] and [`isf`]
//! exchange captures with a real scope's files, [`set_file`] adds the front panel beside them;
//! `report`, `tui` and `analysis` read it.

use std::collections::BTreeMap;

mod binary;
mod command_text;
mod error;
mod finite;
pub mod format;
pub mod isf;
pub mod mcap;
mod rohde_schwarz;
pub mod set_file;
pub mod tek_csv;
pub mod true_signal;

pub use error::{FileLocation, RecordingError};
pub use format::open;
pub use mcap::write;
pub use true_signal::TrueSignal;

use crate::scope::Waveform;
use crate::trace::Trace;

/// The instrument that took a capture, as its files name it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InstrumentIdentity {
    /// Model without a space, e.g. `TDS2014`; empty where a file does not tell.
    pub model: String,
    /// Serial number, e.g. `C031611`; `0` on the original TDS 2014, empty where a file does not
    /// tell.
    pub serial: String,
    /// Firmware, e.g. `FV:v4.12`.
    pub firmware: String,
}

/// One channel's record of one trigger, with the instrument that took it.
#[derive(Debug, Clone, PartialEq)]
pub struct Capture {
    /// The record.
    pub waveform: Waveform,
    /// The instrument; `None` where a file does not tell.
    pub instrument: Option<InstrumentIdentity>,
    /// Notes on guesses and on suspicious values; empty for a file without any.
    pub notes: Vec<String>,
}

impl Capture {
    /// The record as an evenly sampled signal in time after the trigger; none for a record over
    /// frequency.
    pub fn trace(&self) -> Option<Trace> {
        let waveform = &self.waveform;
        (waveform.preamble.x_unit == "s").then(|| Trace {
            name: waveform.source.to_string(),
            unit: waveform.preamble.y_unit.clone(),
            start: waveform.time(0),
            interval: waveform.preamble.x_incr,
            values: waveform.values().collect(),
        })
    }
}

/// Whether a capture comes from this program's bench or from a real one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Origin {
    /// Made by a simulation.
    Simulated,
    /// Taken by a real instrument.
    Measured,
}

/// Everything that one trigger left: the scope's records, and of a simulation what no sensor saw.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot {
    /// Counted from 1.
    pub number: u32,
    /// Simulated or measured.
    pub origin: Origin,
    /// Time of the trigger, nanoseconds since 1970; simulations count from 0.
    pub timestamp_ns: u64,
    /// One capture a channel that was on, in channel order.
    pub captures: Vec<Capture>,
    /// Ground truth, on the simulation's clock (0 is the striker's first contact). Names are
    /// topics: `/truth/sensor/<name>`, `/truth/contact/<j>`, `/truth/bead/<i>`.
    pub truth: Vec<Trace>,
    /// Time of the captures' trigger on the simulation's clock (s).
    pub trigger_time: Option<f64>,
}

/// Which way a line of the remote interface went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// From a client to the instrument.
    Command,
    /// From the instrument to a client.
    Reply,
}

/// A message of the remote interface, received or sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScpiLine {
    /// When, nanoseconds since 1970.
    pub timestamp_ns: u64,
    /// Protocol and address of the client, e.g. `raw 127.0.0.1:50312`.
    pub peer: String,
    /// To the instrument or from it.
    pub direction: Direction,
    /// The bytes: a command without its end, a reply with its terminator.
    pub bytes: Vec<u8>,
}

/// A file carried along, such as the scene as typed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// File name.
    pub name: String,
    /// Media type, e.g. `application/toml`.
    pub media_type: String,
    /// Content.
    pub data: Vec<u8>,
}

/// A recording in memory: shots in order of time, and what is known about them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TraceSet {
    /// The triggers in order of time.
    pub shots: Vec<Shot>,
    /// Named groups of facts: `hertzscope:recording`, `hertzscope:scope`, `hertzscope:sensor/<n>`;
    /// `hertzscope:shot/<n>` and `hertzscope:shot/<n>/sensor/<k>` for a shot of another scene.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// Files carried along.
    pub attachments: Vec<Attachment>,
    /// Lines of the log, in order of time.
    pub log: Vec<String>,
    /// Messages of the remote interface, in order of time.
    pub lines: Vec<ScpiLine>,
    /// Notes of each shot beside captures and truth, by the shot's number; its lines are in `log`
    /// too.
    pub notes: BTreeMap<u32, mcap::ShotNotes>,
    /// Problems: parts that the reader skipped; empty for a sound file.
    pub problems: Vec<String>,
}

impl TraceSet {
    /// A set with `shot` alone, and what this one knows of its bench: metadata and attachments.
    #[must_use]
    pub fn with_shot(&self, shot: Shot) -> Self {
        Self {
            shots: vec![shot],
            metadata: self.metadata.clone(),
            attachments: self.attachments.clone(),
            ..Self::default()
        }
    }
}
