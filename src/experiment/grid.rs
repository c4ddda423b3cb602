//! Evenly spaced times.

use crate::trace::Trace;

/// Evenly spaced times at which something is sampled: `start + i * interval`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Time of sample 0 (s).
    pub start: f64,
    /// From one sample to the next (s).
    pub interval: f64,
}

impl Grid {
    /// A grid of which no time is ever reached.
    pub const NEVER: Self = Self { start: f64::MAX, interval: 1.0 };

    /// Time of sample `index` (s).
    pub fn time(&self, index: usize) -> f64 {
        self.start + index as f64 * self.interval
    }

    /// `values` at these times, as a trace.
    pub fn trace(&self, name: &str, unit: &str, values: Vec<f64>) -> Trace {
        let (name, unit) = (name.to_owned(), unit.to_owned());
        Trace { name, unit, start: self.start, interval: self.interval, values }
    }

    /// Number of samples at or before `time` (s).
    pub fn samples_until(&self, time: f64) -> usize {
        let mut count = ((time - self.start) / self.interval) as usize;
        // The quotient may be off by its rounding; the samples' own times decide.
        while self.time(count) <= time {
            count += 1;
        }
        count
    }
}
