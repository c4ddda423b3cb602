//! How records are taken.

use crate::instrument::word::words;

words! {
    /// What a point of the record is made of.
    AcquireMode {
        /// The first sample of each interval.
        Sample = "SAMple",
        /// Lowest and highest sample of each two intervals.
        PeakDetect = "PEAKdetect",
        /// The mean of several records.
        Average = "AVErage",
    }

    /// What ends an acquisition.
    StopAfter {
        /// The RUN/STOP key.
        RunStop = "RUNSTop",
        /// The end of one sequence.
        Sequence = "SEQuence",
    }

    /// Records that make an average.
    Averages {
        /// Four.
        Four = "4",
        /// Sixteen.
        Sixteen = "16",
        /// Sixty-four.
        SixtyFour = "64",
        /// One hundred and twenty-eight.
        OneHundredTwentyEight = "128",
    }
}

impl Averages {
    /// The choices as numbers.
    pub const NUMBERS: [(Self, u32); 4] = [
        (Self::Four, 4),
        (Self::Sixteen, 16),
        (Self::SixtyFour, 64),
        (Self::OneHundredTwentyEight, 128),
    ];

    /// As a number.
    #[must_use]
    pub fn number(self) -> u32 {
        Self::NUMBERS.iter().find(|(choice, _)| *choice == self).map_or(16, |(_, number)| *number)
    }
}

/// The acquisition's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Acquire {
    /// Sample, peak detect or average.
    pub mode: AcquireMode,
    /// Records in an average.
    pub averages: Averages,
    /// What ends an acquisition.
    pub stop_after: StopAfter,
}

impl Default for Acquire {
    fn default() -> Self {
        Self {
            mode: AcquireMode::Sample,
            averages: Averages::Sixteen,
            stop_after: StopAfter::RunStop,
        }
    }
}
