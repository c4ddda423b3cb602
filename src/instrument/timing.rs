//! How long the parts of a record take, and on which grid signals are welcome.

use crate::scope::{Setup, TriggerMode};

/// Whether the scope scans instead of waiting for triggers.
pub fn scans(setup: &Setup) -> bool {
    setup.trigger.mode == TriggerMode::Auto && setup.model.scans(setup.time_base)
}

/// The nearest count of samples.
pub fn samples(number: f64) -> usize {
    number.round() as usize
}

/// Time that the part of the record before the trigger takes (s).
pub fn before_trigger(setup: &Setup) -> f64 {
    (-setup.record_span().0).max(0.0)
}

/// Time that the part of the record after the trigger takes (s).
pub fn after_trigger(setup: &Setup) -> f64 {
    setup.record_span().1.max(0.0)
}

/// The grid on which the instrument wants its signals, and how much of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleWindow {
    /// Time base (s/div).
    pub time_base: f64,
    /// From one sample to the next (s).
    pub interval: f64,
    /// Time before the trigger that the record shows (s).
    pub before: f64,
    /// Time after the trigger that the record shows (s).
    pub after: f64,
}

impl SampleWindow {
    /// The window for a scope with these settings.
    pub fn of(setup: &Setup) -> Self {
        Self {
            time_base: setup.time_base,
            interval: setup.signal_interval(),
            before: before_trigger(setup),
            after: after_trigger(setup),
        }
    }
}
