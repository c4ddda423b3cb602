//! Evenly spaced times.

/// Evenly spaced times at which something is sampled: `start + i * interval`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Time of sample 0 (s).
    pub start: f64,
    /// From one sample to the next (s).
    pub interval: f64,
}

impl Grid {
    /// Time of sample `index` (s).
    pub fn time(&self, index: usize) -> f64 {
        self.start + index as f64 * self.interval
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
