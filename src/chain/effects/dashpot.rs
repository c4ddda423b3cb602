//! A dashpot in every closed contact: `F = A d^1.5 + gamma ddot`.
//!
//! The force jumps where a contact closes and, if it ends at zero overlap, where it opens.
//! Restitution falls with falling speed. Source: E. B. Herbold, V. F. Nesterenko, Phys. Rev. E 75,
//! 021304 (2007); of the two ends of contact, T. Schwager, T. Pöschel, Granular Matter 9, 465
//! (2007). Valid as an effective loss fitted to one experiment; no material has this `gamma`.

use super::{Effect, LossSpec};
use crate::quantity::engineering;

/// `[effects.dashpot]`
#[derive(Debug, Clone, PartialEq)]
pub struct Dashpot {
    /// Coefficients `gamma` (N s/m), contact by contact where they differ.
    pub gamma: LossSpec,
}

impl Effect for Dashpot {
    fn name(&self) -> &'static str {
        "dashpot"
    }

    fn summary(&self) -> String {
        self.gamma.summary("gamma", |gamma| engineering(gamma, "N*s/m", 4))
    }
}
