//! Numbers in a command's header.

use crate::scope::Source;

/// Value of the placeholder in a header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Placeholder {
    /// The number of `CH<x>`, `MEAS<x>`, `POSITION<x>`; 1 without placeholder.
    pub number: u8,
    /// The waveform of `CH<x>`, `REF<x>`, `<wfm>`; channel 1 without placeholder.
    pub source: Source,
}

impl Default for Placeholder {
    fn default() -> Self {
        Self { number: 1, source: Source::Channel(1) }
    }
}
