//! A loss that follows a power of the closing speed:
//! `F = A d^1.5 + F1 sgn(ddot) (|ddot| / 1 m/s)^alpha` in closed contacts.
//!
//! R. Carretero-González, D. Khatri, M. A. Porter, P. G. Kevrekidis, C. Daraio, Phys. Rev. Lett.
//! 102, 024102 (2009) fit `alpha = 1.81` for steel, brass and PTFE, with the loss acting on each
//! bead by the difference of its two closing speeds. That conserves momentum only for `alpha = 1`;
//! here each contact has the loss of its own closing speed, which always does, and which is the
//! same for `alpha = 1`: their coefficients are no more than a start for a fit. Jumps as the
//! dashpot's do.

use super::{Effect, LossSpec};
use crate::quantity::engineering;

/// `[effects.power_law_loss]`
#[derive(Debug, Clone, PartialEq)]
pub struct PowerLawLoss {
    /// Forces `F1` at 1 m/s (N), contact by contact where they differ.
    pub force: LossSpec,
    /// Exponent `alpha` (1).
    pub exponent: f64,
}

impl Effect for PowerLawLoss {
    fn name(&self) -> &'static str {
        "power_law_loss"
    }

    fn summary(&self) -> String {
        let force = self.force.summary("force at 1 m/s", |force| engineering(force, "N", 4));
        format!("exponent {}, {force}", self.exponent)
    }
}
