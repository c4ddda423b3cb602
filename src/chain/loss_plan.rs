//! The losses of all contacts as a loop reads them: plain arrays with an entry a contact, and no question asked within.

use super::loss::{ContactLoss, KINDS, LossTerms, power_law};
use super::simd::{InstructionSet, Kernel, Simd};

/// Sums that are added up side by side.
const SIDE_BY_SIDE: usize = 8;

/// What contacts with losses take.
#[derive(Debug, Clone)]
pub struct LossPlan {
    set: InstructionSet,
    /// Static overlap of each contact (m).
    static_overlap: Vec<f64>,
    /// Coefficient of its dashpot (N s/m).
    dashpot: Vec<f64>,
    /// `3/2 A eta` of Kuwabara and Kono's (N s/m^1.5).
    viscous: Vec<f64>,
    /// Whether any contact has the latter: a square root each.
    has_viscous: bool,
    /// Force (N) at 1 m/s and exponent (1) of its power law.
    power_law: Vec<(f64, f64)>,
    has_power_law: bool,
    /// Inverse mass of each body (1/kg).
    inverse_mass: Vec<f64>,
    /// Displacements (m) and velocities (m/s), a resting ghost at each end.
    position: Vec<f64>,
    velocity: Vec<f64>,
    /// Rate of each overlap (m/s).
    closing: Vec<f64>,
    /// Force of each kind of loss (N).
    terms: [Vec<f64>; KINDS],
    /// Their sum (N).
    force: Vec<f64>,
}

impl LossPlan {
    /// Contacts with these static overlaps (m), nothing lost in any yet, and inverse masses of the bodies between them (1/kg).
    pub fn new(static_overlap: Vec<f64>, inverse_mass: Vec<f64>) -> Self {
        let zero = vec![0.0; static_overlap.len()];
        let ghosts = vec![0.0; static_overlap.len() + 1];
        Self {
            set: InstructionSet::best(),
            dashpot: zero.clone(),
            viscous: zero.clone(),
            has_viscous: false,
            power_law: vec![(0.0, 1.0); static_overlap.len()],
            has_power_law: false,
            inverse_mass,
            position: ghosts.clone(),
            velocity: ghosts,
            closing: zero.clone(),
            terms: std::array::from_fn(|_| zero.clone()),
            force: zero,
            static_overlap,
        }
    }

    /// Contact `j` of stiffness `A` (N/m^1.5) loses by `loss` from now on.
    pub fn set(&mut self, j: usize, stiffness: f64, loss: &ContactLoss) {
        self.dashpot[j] = loss.dashpot;
        self.viscous[j] = 1.5 * stiffness * loss.relaxation;
        self.power_law[j] = (loss.power_force, loss.power_exponent);
        self.has_viscous |= loss.relaxation > 0.0;
        self.has_power_law |= loss.power_force > 0.0;
    }

    /// Adds to the accelerations (m/s²) of bodies at `position` (m) with `velocity` (m/s) what contacts take, and for each
    /// of `held` the force that it has instead (N); the power that each kind takes (J/s).
    pub fn add(
        &mut self,
        (position, velocity): (&[f64], &[f64]),
        held: impl Iterator<Item = (usize, f64)>,
        acceleration: &mut [f64],
    ) -> LossTerms {
        let n = acceleration.len();
        self.position[1..=n].copy_from_slice(position);
        self.velocity[1..=n].copy_from_slice(velocity);
        let power = self.set.run(Terms(self));
        for (j, force) in held {
            self.force[j] = force;
        }
        let forces = self.force.iter().zip(&self.force[1..]);
        for (a, ((above, below), inverse_mass)) in
            acceleration.iter_mut().zip(forces.zip(&self.inverse_mass))
        {
            *a += (above - below) * inverse_mass;
        }
        power
    }
}

/// Computes the forces of all kinds, their sums and powers.
struct Terms<'a>(&'a mut LossPlan);

impl Kernel for Terms<'_> {
    type Output = LossTerms;

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
    fn run<S: Simd>(self, _simd: S) -> LossTerms {
        let plan = self.0;
        let (x, v) = (&plan.position, &plan.velocity);
        for (closing, (above, below)) in plan.closing.iter_mut().zip(v.iter().zip(&v[1..])) {
            *closing = above - below;
        }
        let [dashpot, viscous, by_speed] = &mut plan.terms;
        for ((force, gamma), closing) in dashpot.iter_mut().zip(&plan.dashpot).zip(&plan.closing) {
            *force = gamma * closing;
        }
        plan.force.copy_from_slice(dashpot);
        let mut power = [product(dashpot, &plan.closing), 0.0, 0.0];
        if plan.has_viscous {
            let overlaps = plan.static_overlap.iter().zip(x.iter().zip(&x[1..]));
            let contacts = plan.viscous.iter().zip(&plan.closing).zip(overlaps);
            for ((term, force), ((factor, closing), (overlap, (above, below)))) in
                viscous.iter_mut().zip(&mut plan.force).zip(contacts)
            {
                let overlap = overlap + (above - below);
                // A comparison instead of `max`, which would have to care for what is not a number.
                let closed = if overlap > 0.0 { overlap } else { 0.0 };
                *term = factor * closed.sqrt() * closing;
                *force += *term;
            }
            power[1] = product(viscous, &plan.closing);
        }
        if plan.has_power_law {
            let contacts = plan.power_law.iter().zip(&plan.closing);
            for ((term, force), ((at_one, exponent), closing)) in
                by_speed.iter_mut().zip(&mut plan.force).zip(contacts)
            {
                *term = power_law(*at_one, *exponent, *closing);
                *force += *term;
            }
            power[2] = product(by_speed, &plan.closing);
        }
        power
    }
}

/// `sum a b`, so many partial sums at a time (unit).
#[inline(always)]
#[allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loop")]
fn product(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<SIDE_BY_SIDE>(), b.as_chunks::<SIDE_BY_SIDE>());
    let mut sums = [0.0; SIDE_BY_SIDE];
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let rest = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f64>();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::loss::{EndOfContact, Touch};

    /// Contacts with and without each loss, open and held ones, overlapping and apart, as many as fill no whole vector: every instruction set against the formula
    /// of one contact.
    #[test]
    fn every_instruction_set_computes_the_formula() {
        let law = |j: u32| ContactLoss {
            dashpot: if j.is_multiple_of(2) { 0.8 } else { 0.0 },
            relaxation: if j.is_multiple_of(3) { 1e-6 } else { 0.0 },
            power_force: if j.is_multiple_of(5) { 2.0 } else { 0.0 },
            power_exponent: 1.81,
            end: EndOfContact::ZeroOverlap,
        };
        let (is_open, is_held) = (|j: u32| j % 7 == 1, |j: u32| j % 7 == 2);
        let wave = |i: u32| f64::from((i * 7) % 11) - 5.0;
        let (stiffness, instead) = (1e8, -0.25);
        for contacts in [2_u32, 8, 39] {
            let n = contacts as usize - 1;
            let overlap = |j: u32| 1e-6 * f64::from(j % 4);
            let position: Vec<f64> = (1..contacts).map(|i| 1e-6 * wave(i)).collect();
            let velocity: Vec<f64> = (1..contacts).map(|i| 0.1 * wave(i + 3)).collect();
            let [changes, closing] = [&position, &velocity].map(|of| {
                let at = |i: Option<usize>| i.and_then(|i| of.get(i)).copied().unwrap_or(0.0);
                let difference = |j: usize| at(j.checked_sub(1)) - at(Some(j));
                (0..=n).map(difference).collect::<Vec<f64>>()
            });
            let mut forces = Vec::new();
            let mut powers = [0.0; KINDS];
            for j in 0..contacts {
                let i = j as usize;
                let overlap = overlap(j) + changes[i];
                let touch =
                    Touch { overlap, closing: closing[i], elastic: 0.0, closed: !is_open(j) };
                let terms = law(j).terms(stiffness, touch);
                if is_held(j) {
                    forces.push(instead);
                    continue;
                }
                forces.push(terms.iter().sum::<f64>());
                for (power, term) in powers.iter_mut().zip(terms) {
                    *power += term * closing[i];
                }
            }
            for set in InstructionSet::available() {
                let mut plan = LossPlan::new((0..contacts).map(overlap).collect(), vec![2.0; n]);
                plan.set = set;
                for j in 0..contacts {
                    plan.set(j as usize, stiffness, &law(j).at_work(!is_open(j), is_held(j)));
                }
                let held = (0..contacts).filter(|j| is_held(*j)).map(|j| (j as usize, instead));
                let mut found = vec![1.0; n];
                let power = plan.add((&position, &velocity), held, &mut found);
                for (i, found) in found.iter().enumerate() {
                    let exact = 1.0 + 2.0 * (forces[i] - forces[i + 1]);
                    assert!((found - exact).abs() < 1e-14, "{set:?} {i}: {found} {exact}");
                }
                for (found, exact) in power.iter().zip(powers) {
                    assert!(
                        (found - exact).abs() <= 1e-14 * exact,
                        "{set:?}: {power:?} {powers:?}"
                    );
                }
            }
        }
    }
}
