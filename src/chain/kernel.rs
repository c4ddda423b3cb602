//! The force loop, compiled for several instruction sets and chosen at run time.
//!
//! The same source runs everywhere; what differs is how many contacts the compiler puts into one instruction: eight with
//! AVX-512, four with AVX2, two with the x86-64 baseline. Results may differ by rounding only where the compiler may fuse
//! a multiplication with an addition, and Rust does not: they are the same to the last bit.

use super::Law;
use super::simd::{InstructionSet, Kernel, Simd};

/// Contacts and masses as the loop reads them.
#[derive(Debug, Clone)]
pub struct Plan {
    /// How forces follow overlaps.
    pub law: Law,
    /// `A` of each contact, or its tangent where contacts are linearised (unit).
    pub stiffness: Vec<f64>,
    /// Static overlap of each contact (m).
    pub static_overlap: Vec<f64>,
    /// Its square root (m^0.5).
    pub static_root: Vec<f64>,
    /// Inverse mass of each body (1/kg).
    pub inverse_mass: Vec<f64>,
    /// Acceleration of each body that statics does not balance (m/s²).
    pub residual_acceleration: Vec<f64>,
}

/// Writes the accelerations (m/s²) of all bodies at `displacement` (m), which has a resting ghost at either end;
/// `force` is room for the contacts' force changes (N).
pub fn accelerate(
    set: InstructionSet,
    plan: &Plan,
    displacement: &[f64],
    force: &mut [f64],
    acceleration: &mut [f64],
) {
    set.run(Accelerate { plan, displacement, force, acceleration });
}

struct Accelerate<'a> {
    plan: &'a Plan,
    displacement: &'a [f64],
    force: &'a mut [f64],
    acceleration: &'a mut [f64],
}

impl Kernel for Accelerate<'_> {
    type Output = ();

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loop")]
    fn run<S: Simd>(self, _simd: S) {
        body(self.plan, self.displacement, self.force, self.acceleration);
    }
}

/// `hertz::force_change` over all contacts, written without calls and branches, then Newton's law for all bodies.
#[inline(always)]
#[allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loop")]
fn body(plan: &Plan, displacement: &[f64], force: &mut [f64], acceleration: &mut [f64]) {
    let contacts = force.len();
    let (Some(above), Some(below)) = (displacement.get(..contacts), displacement.get(1..)) else {
        return;
    };
    let changes = above.iter().zip(below).map(|(above, below)| above - below);
    match plan.law {
        Law::Hertz => {
            let contacts =
                plan.stiffness.iter().zip(plan.static_overlap.iter().zip(&plan.static_root));
            for ((force, change), (stiffness, (overlap, static_root))) in
                force.iter_mut().zip(changes).zip(contacts)
            {
                // Comparisons instead of `max`, which would have to care for what is not a number.
                let change = if change > -overlap { change } else { -overlap };
                let root = (overlap + change).sqrt();
                let sum = root + static_root;
                let divisor = if sum > f64::MIN_POSITIVE { sum } else { f64::MIN_POSITIVE };
                *force = stiffness * change * (sum - root * static_root / divisor);
            }
        }
        Law::Linearised => {
            for ((force, change), stiffness) in force.iter_mut().zip(changes).zip(&plan.stiffness) {
                *force = stiffness * change;
            }
        }
    }
    let forces = force.iter().zip(force.get(1..).unwrap_or_default());
    let bodies = plan.inverse_mass.iter().zip(&plan.residual_acceleration);
    for (a, ((above, below), (inverse_mass, residual))) in
        acceleration.iter_mut().zip(forces.zip(bodies))
    {
        *a = (above - below) * inverse_mass + residual;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::hertz;

    /// Closed, opened and never-loaded contacts, lengths around the vectors': every set against the formula.
    #[test]
    fn every_instruction_set_computes_the_formula() {
        for contacts in [2_u32, 7, 8, 9, 40, 129] {
            let overlap =
                |j: u32| if j.is_multiple_of(3) { 0.0 } else { 1e-6 * f64::from(1 + j % 5) };
            let overlaps: Vec<f64> = (0..contacts).map(overlap).collect();
            let bodies = contacts as usize - 1;
            let plan = Plan {
                law: Law::Hertz,
                stiffness: (0..contacts).map(|j| 1e8 * f64::from(1 + j)).collect(),
                static_root: overlaps.iter().map(|d| d.sqrt()).collect(),
                static_overlap: overlaps,
                inverse_mass: vec![1.0; bodies],
                residual_acceleration: vec![0.0; bodies],
            };
            let wave = |i: u32| 3e-6 * f64::from((i * 7) % 11) - 1e-5;
            let displacement: Vec<f64> = (0..=contacts).map(wave).collect();
            for set in InstructionSet::available() {
                let mut force = vec![0.0; contacts as usize];
                let mut acceleration = vec![0.0; bodies];
                accelerate(set, &plan, &displacement, &mut force, &mut acceleration);
                for j in 0..contacts as usize {
                    let change = displacement[j] - displacement[j + 1];
                    let exact = hertz::force_change(plan.stiffness[j], plan.static_root[j], change);
                    let scale = plan.stiffness[j] * 1e-5_f64.powf(1.5);
                    assert!((force[j] - exact).abs() <= 1e-15 * scale, "{set:?} contact {j}");
                }
                for i in 0..bodies {
                    assert!((acceleration[i] - (force[i] - force[i + 1])).abs() <= 0.0);
                }
            }
        }
    }
}
