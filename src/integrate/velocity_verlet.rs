//! Velocity Verlet: half a kick, a drift, half a kick. Order 2, one force evaluation a step.

use super::splitting::Splitting;

/// The method's fractions.
pub static VELOCITY_VERLET: Splitting = Splitting {
    name: "velocity-verlet",
    source: "W. C. Swope, H. C. Andersen, P. H. Berens, K. R. Wilson, J. Chem. Phys. 76, 637 (1982)",
    order: 2,
    kicks: &[0.5, 0.5],
    drifts: &[1.0],
    gradients: &[],
    first_step: &[],
    stability: 2.0,
};
