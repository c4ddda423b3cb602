//! Settings of the cursors.

use crate::instrument::word::words;
use crate::scope::Source;

words! {
    /// Which cursors are shown.
    CursorFunction {
        /// None.
        Off = "OFF",
        /// Two levels.
        HorizontalBars = "HBArs",
        /// Two times.
        VerticalBars = "VBArs",
    }

    /// How the distance between vertical bars is told.
    BarUnits {
        /// As a time.
        Seconds = "SECOnds",
        /// As a frequency.
        Hertz = "HERtz",
    }
}

/// The cursors' part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cursor {
    /// Which are shown.
    pub function: CursorFunction,
    /// The waveform that they read.
    pub source: Source,
    /// Seconds or hertz.
    pub vertical_units: BarUnits,
    /// Vertical bars after the trigger (s).
    pub vertical: [f64; 2],
    /// Horizontal bars (V).
    pub horizontal: [f64; 2],
}

impl Default for Cursor {
    /// Bars 3.2 divisions to either side of the centre, at the factory's scales.
    fn default() -> Self {
        Self {
            function: CursorFunction::Off,
            source: Source::Channel(1),
            vertical_units: BarUnits::Seconds,
            vertical: [-1.6e-3, 1.6e-3],
            horizontal: [-3.2, 3.2],
        }
    }
}
