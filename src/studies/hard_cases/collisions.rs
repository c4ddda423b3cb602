//! Collisions of unlike bodies: masses and stiffnesses far apart.

use super::HardCase;
use super::benches::{
    HEAVY, LIGHT, MovingChain, PTFE, STEEL, assemble, between, diatomic, pressed, set_moving,
    sphere,
};
use super::tally::CaseChecks;
use crate::chain::{Body, ChainSpec, EffectsSpec, Elasticity, End, hertz};

pub const CASES: &[HardCase] = &[
    HardCase {
        name: "two bodies, mass ratios 1e-6 to 1e6",
        why: "one body turns round a million times faster than the other moves",
        bound: "Hertz's collision: largest force, its time and both rebound speeds, to the accuracy of 1e-9",
        compute: two_bodies,
    },
    HardCase {
        name: "striker/bead mass ratios 1e-6 to 1e6",
        why: "from a striker that rings while the chain has not moved to one that drives the whole chain before it",
        bound: "peaks and times as Dormand-Prince 8(5,3) at 1e-13 finds them: the accuracy of 1e-6 for the loudest contact, as much more as a pulse is weaker elsewhere",
        compute: strikers,
    },
    HardCase {
        name: "stiffness ratios to 1e4",
        why: "the stiffest contact sets the step, the softest the time that matters",
        bound: "peaks and times as Dormand-Prince 8(5,3) at 1e-13 finds them: the accuracy of 1e-6 for the loudest contact, as much more as a pulse is weaker elsewhere",
        compute: stiffnesses,
    },
];

/// Duration of a collision times speed over largest overlap (1).
const DURATION: f64 = 2.943_275_184_324_705;

fn two_bodies(tally: &mut CaseChecks) -> Result<(), String> {
    const ACCURACY: f64 = 1e-9;
    const SPEED: f64 = 0.44;
    for decade in -6..=6 {
        let ratio = 10f64.powi(decade);
        let (striker, bead) = (ratio * LIGHT, LIGHT);
        let chain =
            between(vec![sphere(striker, STEEL), sphere(bead, PTFE)], (End::Free, End::Free))?;
        let stiffness = chain.contacts()[1].stiffness;
        let reduced = striker * bead / (striker + bead);
        let overlap = hertz::collision_overlap(stiffness, reduced, SPEED);
        let duration = DURATION * overlap / SPEED;
        let motion = MovingChain { velocities: set_moving(&chain, 0, SPEED), chain: &chain };
        let peaks = motion.contact_peaks(&[1], ACCURACY, 1.1 * duration)?;
        for peak in peaks {
            let force = peak.dynamic_n / hertz::force(stiffness, overlap) - 1.0;
            tally.check(format!("largest force at {ratio:e}"), force, ACCURACY);
            let time = peak.time_s / (0.5 * duration) - 1.0;
            tally.check(format!("its time at {ratio:e}"), time, ACCURACY);
        }
        let end = motion.after(1.1 * duration, ACCURACY)?;
        let total = striker + bead;
        let exact = [(striker - bead) / total * SPEED, 2.0 * striker / total * SPEED];
        for (found, exact) in end.state.velocity.iter().zip(exact) {
            tally.check(format!("rebound speed at {ratio:e}"), (found - exact) / SPEED, ACCURACY);
        }
    }
    Ok(())
}

fn strikers(tally: &mut CaseChecks) -> Result<(), String> {
    for ratio in [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6] {
        let chain = assemble(&ChainSpec {
            striker: Some(sphere(ratio * LIGHT, STEEL)),
            particles: diatomic(8, HEAVY),
            top: End::Free,
            bottom: End::Free,
            wall_preload: 0.0,
            effects: EffectsSpec::default(),
        })?;
        // Of equal energy, as far as the chain can take it.
        let speed = 0.4 * f64::min(1.0, ratio.powf(-0.25));
        let motion = MovingChain { velocities: set_moving(&chain, 0, speed), chain: &chain };
        motion.check_peaks(tally, &format!("{ratio:e}"), (&[1, 2, 8], 1e-6, 1e-3))?;
    }
    Ok(())
}

fn stiffnesses(tally: &mut CaseChecks) -> Result<(), String> {
    for ratio in [1e1, 1e2, 1e3, 1e4] {
        // Stiff spheres in pairs with a soft one between: A goes as the modulus E* = E/(2 - 2 nu^2)
        // of equal bodies, and as 1/E* = (1 - nu^2)(1/E1 + 1/E2) of unlike ones.
        let youngs_modulus = STEEL.youngs_modulus / (2.0 * ratio - 1.0);
        let soft = Elasticity { youngs_modulus, ..STEEL };
        let body = |elasticity| sphere(HEAVY, elasticity);
        let cell = || [body(STEEL), body(STEEL), body(soft)];
        let particles: Vec<Body> = (0..6).flat_map(|_| cell()).collect();
        let chain = pressed(particles, 1.0)?;
        let motion = MovingChain { velocities: set_moving(&chain, 0, 0.1), chain: &chain };
        let time = 2e-4 * ratio.powf(0.4);
        motion.check_peaks(tally, &format!("{ratio:e}"), (&[1, 2, 5], 1e-6, time))?;
    }
    Ok(())
}
