//! Chains that lose energy, from weak losses to overdamped contacts.

use super::HardCase;
use super::benches::{
    HEAVY, LIGHT, MovingChain, PTFE, STEEL, assemble, diatomic, set_moving, sphere,
};
use super::tally::CaseChecks;
use crate::chain::{Body, Chain, ChainSpec, EffectsSpec, End, EndOfContact, LossKind, LossSpec};

pub const CASES: &[HardCase] = &[
    HardCase {
        name: "dashpots from 0 to 1000 N s/m",
        why: "forces jump where contacts close, and strong dashpots decay a thousand times faster than the chain moves",
        bound: "peaks and times as Dormand-Prince 5(4) at 1e-12 finds them: the accuracy of 1e-6 for the loudest contact, as much more as a pulse is weaker elsewhere; energy and what the dashpots have taken: twice the accuracy times the root of the number of steps, and at no instant more than there was",
        compute: dashpots,
    },
    HardCase {
        name: "viscoelastic and power-law losses",
        why: "slopes without bound where contacts close or stand still: sqrt(overlap), and closing speed to a power below one",
        bound: "as for dashpots",
        compute: others,
    },
];

const ACCURACY: f64 = 1e-6;
const TIME: f64 = 0.4e-3;
const SPEED: f64 = 0.44;

/// The bench, short: a striker, four cells, a wall, and `force` (N) on the first particle.
fn bench(effects: EffectsSpec, force: f64) -> Result<Chain, String> {
    let mut particles = diatomic(4, HEAVY);
    particles.push(sphere(LIGHT, PTFE));
    let top = if force > 0.0 { End::Force(force) } else { End::Free };
    assemble(&ChainSpec {
        striker: Some(Body { curvature: 0.0, ..sphere(0.61e-3, STEEL) }),
        particles,
        top,
        bottom: End::Wall(STEEL),
        wall_preload: 0.0,
        effects,
    })
}

fn check(tally: &mut CaseChecks, what: &str, effects: &EffectsSpec) -> Result<(), String> {
    for force in [0.0, 2.38] {
        let chain = bench(effects.clone(), force)?;
        let motion = MovingChain { velocities: set_moving(&chain, 0, SPEED), chain: &chain };
        motion.check_lossy(tally, &format!("{what}, {force} N"), (&[1, 2, 5], ACCURACY, TIME))?;
    }
    Ok(())
}

fn dashpots(tally: &mut CaseChecks) -> Result<(), String> {
    for gamma in [1e-3, 1e-1, 1.0, 10.0, 100.0, 1000.0] {
        for end in [EndOfContact::ZeroOverlap, EndOfContact::ZeroForce] {
            let dashpot = LossSpec::everywhere(gamma, end);
            let effects = EffectsSpec::default().with_loss(LossKind::Dashpot, dashpot);
            check(tally, &format!("{gamma} N s/m, {}", end.name()), &effects)?;
        }
    }
    Ok(())
}

fn others(tally: &mut CaseChecks) -> Result<(), String> {
    for end in [EndOfContact::ZeroOverlap, EndOfContact::ZeroForce] {
        for eta in [1e-9, 1e-7, 1e-6, 1e-5, 1e-4] {
            let viscous = LossSpec::everywhere(eta, end);
            let effects = EffectsSpec::default().with_loss(LossKind::KuwabaraKono, viscous);
            check(tally, &format!("Kuwabara-Kono, {eta:e} s, {}", end.name()), &effects)?;
        }
        for (newton, exponent) in [(1e-3, 0.5), (0.1, 1.0), (1.0, 1.5), (10.0, 2.0)] {
            let power = LossSpec { exponent, ..LossSpec::everywhere(newton, end) };
            let effects = EffectsSpec::default().with_loss(LossKind::PowerLaw, power);
            check(
                tally,
                &format!("{newton} N at 1 m/s, power {exponent}, {}", end.name()),
                &effects,
            )?;
        }
    }
    Ok(())
}
