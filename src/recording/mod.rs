//! Recordings: what the bench keeps. One file a format.

pub mod tek_csv;

use crate::scope::Waveform;

/// The instrument that took a capture, as its files name it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Instrument {
    /// Model without a space, e.g. `TDS2014`; empty where a file does not tell.
    pub model: String,
    /// Serial number, e.g. `C031611`; `0` on the original TDS 2014, empty where a file does not tell.
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
    pub instrument: Option<Instrument>,
}
