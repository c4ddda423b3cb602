//! An evenly sampled signal: what sensors hand to the scope and what analysis works on.
//!
//! The time of sample `i` is `start + i * interval`, computed afresh for each sample and never by a
//! running sum, whose error would grow with the record.

/// An evenly sampled signal.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Name of the signal, e.g. `force inside particle 14`.
    pub name: String,
    /// SI unit of the values, e.g. `N` or `V`.
    pub unit: String,
    /// Time of the first sample (s).
    pub start: f64,
    /// Time from one sample to the next (s).
    pub interval: f64,
    /// The samples, in the unit that the field `unit` names (unit).
    pub values: Vec<f64>,
}

impl Trace {
    /// Time of sample `index` (s).
    pub fn time(&self, index: usize) -> f64 {
        self.start + index as f64 * self.interval
    }
}
