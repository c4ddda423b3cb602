//! How records are taken.

use crate::instrument::word::words;
use crate::scope::{AcquireMode, AcquireSetup};

words! {
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
        self.scope().depth()
    }

    /// The part that front end and digitiser take.
    pub fn scope(&self) -> AcquireSetup {
        AcquireSetup { mode: self.mode, averages: self.averages }
    }
}

impl Default for Acquire {
    fn default() -> Self {
        let AcquireSetup { mode, averages } = AcquireSetup::default();
        Self { mode, averages, stop_after: StopAfter::RunStop }
    }
}
