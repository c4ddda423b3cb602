//! Type and source of a measurement.

use crate::instrument::word::words;
use crate::scope::Source;

words! {
    /// The measurements of this instrument.
    MeasurementType {
        /// Nothing.
        None = "NONe",
        /// Frequency of the first cycle.
        Frequency = "FREQuency",
        /// Mean over the whole record.
        Mean = "MEAN",
        /// Length of the first cycle.
        Period = "PERIod",
        /// Highest less lowest level.
        PeakToPeak = "PK2pk",
        /// Root mean square over the first cycle.
        CycleRms = "CRMs",
        /// Lowest level.
        Minimum = "MINImum",
        /// Highest level.
        Maximum = "MAXImum",
        /// From 10 % to 90 % of the first rising edge.
        Rise = "RISe",
        /// From 90 % to 10 % of the first falling edge.
        Fall = "FALL",
        /// Width of the first pulse upward, at half height.
        PositiveWidth = "PWIdth",
        /// Width of the first pulse downward, at half height.
        NegativeWidth = "NWIdth",
    }
}

/// One measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Measurement {
    /// Type of the measurement.
    pub kind: MeasurementType,
    /// On which waveform.
    pub source: Source,
}

impl Default for Measurement {
    fn default() -> Self {
        Self { kind: MeasurementType::None, source: Source::Channel(1) }
    }
}
