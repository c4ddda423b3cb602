//! Weight: `F = m g` on every body, the striker too.

use super::Effect;
use crate::quantity::engineering;

/// `[effects.gravity]`
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gravity {
    /// Acceleration along the chain, from the striker's end to the other (m/s²).
    pub acceleration: f64,
}

impl Effect for Gravity {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn summary(&self) -> String {
        engineering(self.acceleration, "m/s²", 4)
    }

    fn add_load(&self, masses: &[f64], _striker: bool, load: &mut [f64]) {
        for (force, mass) in load.iter_mut().zip(masses) {
            *force += mass * self.acceleration;
        }
    }
}
