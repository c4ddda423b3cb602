//! Results of signals at the inputs, and of an acquisition.

use crate::scope::Waveform;

/// Result of signals at the inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Accepted {
    /// The scope triggered; the record will be complete at this time (s).
    Triggered {
        /// When the record is complete (s).
        complete_at: f64,
    },
    /// The scope scans: the signals go onto the sweep, without a trigger.
    Scanned,
    /// No trigger was found.
    NoTrigger,
    /// The scope was stopped or still filling the part before the trigger.
    NotReady,
    /// The signals have another sample interval than the set-up: they were made for another time
    /// base, and are dropped.
    OtherInterval,
}

/// Where in the signals of a shot the scope triggered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriggerInstant {
    /// Number of the shot.
    pub shot: u32,
    /// Time after the first sample of the signals (s).
    pub time: f64,
}

/// Records on their way into memory.
#[derive(Debug, Clone, PartialEq)]
pub struct InFlight {
    /// When they are complete (s).
    pub complete_at: f64,
    /// One record a displayed channel.
    pub records: Vec<Waveform>,
    /// The trigger; none if it was not a signal of the bench.
    pub trigger: Option<TriggerInstant>,
}

/// A finished acquisition that is worth keeping: a triggered one, or the last of a single sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// One record a displayed channel, as in memory.
    pub records: Vec<Waveform>,
    /// The trigger; none if it was not a signal of the bench.
    pub trigger: Option<TriggerInstant>,
}
