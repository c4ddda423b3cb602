//! How records are taken.

use crate::instrument::word::words;

words! {
    /// Acquisition mode.
    AcquireMode {
        /// The first sample of each interval.
        Sample = "SAMple",
        /// Lowest and highest sample of each two intervals.
        PeakDetect = "PEAKdetect",
        /// The mean of several records.
        Average = "AVErage",
    }

    /// Condition that ends an acquisition.
    StopAfter {
        /// The RUN/STOP key.
        RunStop = "RUNSTop",
        /// The end of one sequence.
        Sequence = "SEQuence",
    }
}

/// The acquisition's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Acquire {
    /// Sample, peak detect or average.
    pub mode: AcquireMode,
    /// Records in an average, one of the model's numbers.
    pub averages: u32,
    /// Condition that ends an acquisition.
    pub stop_after: StopAfter,
}

impl Acquire {
    /// Records that make one: one, unless they are averaged.
    pub fn depth(&self) -> u32 {
        if self.mode == AcquireMode::Average { self.averages.max(1) } else { 1 }
    }
}

impl Default for Acquire {
    fn default() -> Self {
        Self { mode: AcquireMode::Sample, averages: 16, stop_after: StopAfter::RunStop }
    }
}
