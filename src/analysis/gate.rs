//! Time gates: the part of a record that is looked at.

use std::ops::Range;

use crate::trace::Trace;

/// A sample this close to a gate's edge, in sample intervals, stands on it: times are products and
/// carry rounding (1).
const EDGE_TOLERANCE: f64 = 1e-6;

/// The times from `from`, included, to `to`, excluded: gates that follow on one another share no
/// sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gate {
    /// First time (s).
    pub from: f64,
    /// First time that no longer belongs to it (s).
    pub to: f64,
}

impl Gate {
    /// Everything.
    pub const ALL: Self = Self { from: f64::NEG_INFINITY, to: f64::INFINITY };

    /// Indices of the samples of `trace` inside; empty where there is none.
    pub fn range(self, trace: &Trace) -> Range<usize> {
        let length = trace.values.len();
        let first_at = |time: f64| index_at(trace, time).min(length);
        let (start, end) = (first_at(self.from), first_at(self.to));
        start..end.max(start)
    }
}

/// Index of the first sample at or after `time` (s).
fn index_at(trace: &Trace, time: f64) -> usize {
    ((time - trace.start) / trace.interval - EDGE_TOLERANCE).ceil() as usize
}
