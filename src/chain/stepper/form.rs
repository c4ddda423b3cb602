//! How forces are computed from overlaps, and what a chain needs of that.

use crate::chain::{Chain, Contact};

/// How forces are computed from overlaps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// `A overlap^1.5`: rounds to 2 ulp of the static force.
    #[default]
    Plain,
    /// Without cancellation, for waves far below the preload; one division more.
    Exact,
    /// Linearised contacts.
    Linear,
}

/// Relative rounding of a force in plain form (1).
const ROUNDING: f64 = 5e-16;
/// The plain form's rounding stays below this share of the accuracy asked for (1).
const ROUNDING_SHARE: f64 = 1e-3;

impl Form {
    /// What `chain` needs when its velocities (m/s) are to be followed to `accuracy` (1): the exact form only where the
    /// rounding of the static force could be seen in the wave.
    #[must_use]
    pub fn needed(chain: &Chain, velocity: &[f64], accuracy: f64) -> Self {
        if chain.is_linear() {
            return Self::Linear;
        }
        let overlap = chain.impact_overlap(velocity);
        // The wave presses a contact at least as it would without preload: where that is enough, nothing more need be known.
        let least = overlap * overlap.sqrt();
        let visible = |c: &&Contact| {
            let is_more = |wave| ROUNDING * c.static_force > ROUNDING_SHARE * accuracy * wave;
            is_more(c.stiffness * least) && is_more(c.force_change(overlap))
        };
        if chain.contacts().iter().filter(|c| c.stiffness > 0.0).any(|c| visible(&c)) {
            Self::Exact
        } else {
            Self::Plain
        }
    }
}
