//! Steps that are taken at once, without a look at what has come of each.

use crate::chain::stepper::notes::Notes;

/// Steps that may be taken at once.
pub struct Burst<'a> {
    /// Up to where they go (s).
    pub end: f64,
    /// None begins then or later but the first (s).
    pub pause: f64,
    /// How many.
    pub most: u64,
    /// What is noted of them.
    pub notes: &'a mut Notes,
}

/// Steps that were taken at once.
pub struct Taken {
    /// How many.
    pub count: u64,
    /// Start and length of the last (s).
    pub last: (f64, f64),
}
