//! A magnet that pulls one ferromagnetic particle with a constant force.
//!
//! The force of a real ring magnet changes by 3 to 8 % per 50 um of travel; the constant force is what the
//! paper's calculations use. Source: Herbold et al. (2009), section II; Daraio et al., Phys. Rev. E 73, 026610 (2006).

use super::Effect;
use crate::quantity::engineering;

/// `[effects.magnet_preload]`
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MagnetPreload {
    /// Force on the particle, downward positive (N).
    pub force: f64,
    /// The particle it acts on, counted from 1 at the top.
    pub particle: usize,
}

impl Effect for MagnetPreload {
    fn name(&self) -> &'static str {
        "magnet_preload"
    }

    fn summary(&self) -> String {
        format!("{} on particle {}", engineering(self.force, "N", 4), self.particle)
    }

    fn add_load(&self, _masses: &[f64], striker: bool, load: &mut [f64]) {
        let body = self.particle - usize::from(!striker);
        if let Some(force) = load.get_mut(body) {
            *force += self.force;
        }
    }
}
