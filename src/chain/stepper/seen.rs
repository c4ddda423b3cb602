//! Steps as places in chains have felt them.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::force_track::{COEFFICIENTS, CONTACTS, LOOKS, Looks, Span};
use super::lanes::{Lanes, Row};

/// How far steps are looked into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Depth {
    /// Their ends, and into those that hold what is asked for, or may.
    Asked,
    /// So that forces within them can be sampled, besides.
    Sampled,
    /// All that there is.
    All,
}

/// Steps as they were felt, one in each lane.
#[derive(Debug, Clone, Default)]
pub struct Seen {
    /// Starts and lengths (s).
    starts: Row,
    lengths: Row,
    /// Dynamic force (N) and its rate of change where each begins (N/s), where steps come on end.
    pub(super) before: [Row; 2],
    /// Overlap changes as polynomials in the fraction of the step, where somebody has joined both ends (m).
    pub(super) overlaps: [[Row; COEFFICIENTS]; CONTACTS],
    /// Dynamic forces at the places where a step is looked at, the last of which is its end (N).
    pub(super) forces: [Row; LOOKS],
    /// Their rates of change (N/s).
    pub(super) rates: [Row; LOOKS],
}

impl Seen {
    /// Steps from `starts` on of `lengths` (s), at whose ends these forces (N) and rates of change (N/s) are felt.
    #[inline(always)]
    pub(super) fn begin<L: Lanes>(
        &mut self,
        (starts, lengths): (Row, &Row),
        [force, rate]: [L::V; 2],
    ) {
        (self.starts, self.lengths) = (starts, *lengths);
        L::store(force, &mut self.forces[LOOKS - 1]);
        L::store(rate, &mut self.rates[LOOKS - 1]);
    }

    /// Lengths of the steps (s).
    pub(super) fn lengths(&self) -> &Row {
        &self.lengths
    }

    /// The two contacts in the step of lane `lane`.
    #[must_use]
    pub fn span(&self, lane: usize) -> Span {
        let overlaps = self.overlaps.each_ref().map(|rows| rows.each_ref().map(|row| row.0[lane]));
        Span { start: self.starts.0[lane], length: self.lengths.0[lane], overlaps }
    }

    /// The force in a few places of that step, where somebody has looked into it.
    #[must_use]
    pub fn looks(&self, lane: usize) -> Looks {
        let at = |rows: &[Row; LOOKS]| rows.each_ref().map(|row| row.0[lane]);
        Looks { forces: at(&self.forces), rates: at(&self.rates) }
    }

    /// Force (N) and its rate of change at the end of that step (N/s), and the step's length (s).
    #[must_use]
    #[inline]
    pub fn end(&self, lane: usize) -> ([f64; 2], f64) {
        let felt = [&self.forces, &self.rates].map(|rows| rows[LOOKS - 1].0[lane]);
        (felt, self.lengths.0[lane])
    }
}
