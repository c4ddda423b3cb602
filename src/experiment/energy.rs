//! The energy ledger of a run: what was there, what is left, what was taken, and what the method has made of it.

use serde::Serialize;

use crate::chain::{Dissipated, Energy};
use crate::scene::LOOSEST_ACCURACY;

/// A run that has made or lost more of the energy in motion is not taken for what the bench would show without a word (1).
pub const TOLERABLE: f64 = 0.01;
/// What sums of energies may be off, relative to all that is stored (1).
const ROUNDING: f64 = 1e-12;

/// No run that is held to an accuracy makes or loses more of the energy in motion: where late motion is known only in its statistics, these would be
/// those of another bench (1).
pub const MOST: f64 = LOOSEST_ACCURACY;

/// The energy ledger of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnergyLedger {
    /// At the striker's first contact (J).
    pub initial: f64,
    /// At the end (J).
    pub r#final: f64,
    /// Booked as lost by the effects that were on (J).
    pub dissipated: f64,
    /// What [`drift`] says: the integrator's error (1).
    pub drift: f64,
    /// The initial energy by kind.
    pub initial_by_kind: Energy,
    /// The final energy by kind, without what is left in contacts held at zero force.
    pub final_by_kind: Energy,
    /// What was lost, by loss, and what is left in contacts.
    pub dissipated_by_kind: Dissipated,
}

impl EnergyLedger {
    /// The ledger of a run from its `initial` to its `last` energy.
    pub fn new(initial: Energy, last: Energy, taken: Dissipated) -> Self {
        let (before, after, dissipated) = (initial.total(), last.total(), taken.total());
        Self {
            initial: before,
            r#final: after,
            dissipated,
            drift: drift(&initial, &last, &taken),
            initial_by_kind: initial,
            final_by_kind: last,
            dissipated_by_kind: taken,
        }
    }

    /// Whether no more than `share` (1) of the energy in motion has been made or lost, but for rounding of all that is stored.
    pub fn is_kept(&self, share: f64) -> bool {
        self.drift.abs() <= share || self.is_rounding()
    }

    /// Whether what has been made or lost may be rounding of all that is stored.
    pub fn is_rounding(&self) -> bool {
        let made = self.r#final + self.dissipated - self.initial;
        made.abs() <= ROUNDING * self.initial.abs()
    }
}

/// `(after + taken - before)` over the kinetic energy before or after, whichever is more: what a method has made of energy, as a share of
/// that in motion. Static overlaps, which may hold a thousand times as much, do not hide it; what they round to is in it (1).
pub fn drift(before: &Energy, after: &Energy, taken: &Dissipated) -> f64 {
    (after.total() + taken.total() - before.total()) / before.kinetic.max(after.kinetic)
}
