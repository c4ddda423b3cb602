//! A chain whose motion is chaotic.

use super::HardCase;
use super::benches::{
    HEAVY, LIGHT, MovingChain, PTFE, STEEL, assemble, diatomic, drift_bound, set_moving, sphere,
};
use super::tally::CaseChecks;
use crate::chain::State;
use crate::chain::{Chain, ChainSpec, EffectsSpec, End, Gravity};
use crate::experiment::horizon::horizon;
use crate::motion::Method;
use crate::quantity::engineering;

pub const CASES: &[HardCase] = &[HardCase {
    name: "600-bead chaos",
    why: "under gravity alone every contact opens and closes, and errors grow exponentially",
    bound: "up to the horizon that the run itself states, the state of Dormand-Prince 8(5,3) at 1e-13 within sqrt(accuracy) of 1e-6; beyond it statistics: energy, and the share of it in motion within four standard deviations of eight perturbed runs by that method",
    compute: chaos,
}];

/// Accuracy asked for (1).
const ACCURACY: f64 = 1e-6;
/// Time simulated (s).
const TIME: f64 = 14e-3;
/// Tolerance of the reference's steps (1).
const REFERENCE: f64 = 1e-13;
/// Speed of the first sphere (m/s).
const SPEED: f64 = 0.44;

fn column() -> Result<Chain, String> {
    let mut particles = diatomic(300, HEAVY);
    // A cylinder's flat face would make no Hertz contact with the wall.
    particles.push(sphere(LIGHT, PTFE));
    assemble(&ChainSpec {
        striker: None,
        particles,
        top: End::Free,
        bottom: End::Wall(STEEL),
        wall_preload: 0.0,
        effects: EffectsSpec {
            gravity: Some(Gravity { acceleration: 9.81 }),
            ..EffectsSpec::default()
        },
    })
}

fn chaos(tally: &mut CaseChecks) -> Result<(), String> {
    let chain = column()?;
    let motion = MovingChain { velocities: set_moving(&chain, 0, SPEED), chain: &chain };
    let found = horizon(&chain, &motion.velocities, TIME, ACCURACY).map_err(|e| e.to_string())?;
    let Some(time) = found else {
        tally.check("no horizon was found where there must be one", f64::INFINITY, 1.0);
        return Ok(());
    };
    let reference = Method::DormandPrince853 { tolerance: REFERENCE };
    let (found, exact) = (motion.after(time, ACCURACY)?, motion.by(reference, time)?);
    let what = format!("speeds at the horizon, {}", engineering(time, "s", 2));
    let pairs = found.state.velocity.iter().zip(&exact.state.velocity);
    let off = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    tally.check(what, off / SPEED, ACCURACY.sqrt());
    beyond(tally, &motion)
}

/// Bounds at the end: energy, and the share of it that is in motion.
fn beyond(tally: &mut CaseChecks, motion: &MovingChain<'_>) -> Result<(), String> {
    let end = motion.after(TIME, ACCURACY)?;
    tally.check("energy", motion.drift(&end.state), drift_bound(end.work, ACCURACY));
    let share = |state: &State| {
        motion.chain.energy(state).kinetic / motion.chain.energy_above_static(state)
    };
    let mut shares = Vec::new();
    for seed in 1..=8 {
        // Far below the accuracy, far above rounding: another member of the same ensemble.
        let factor = 1.0 + 1e-9 * f64::from(seed);
        let velocities = motion.velocities.iter().map(|v| v * factor).collect();
        let other = MovingChain { velocities, chain: motion.chain };
        let method = Method::DormandPrince853 { tolerance: ACCURACY };
        shares.push(share(&other.by(method, TIME)?.state));
    }
    let mean = shares.iter().sum::<f64>() / 8.0;
    let variance = shares.iter().map(|share| (share - mean).powi(2)).sum::<f64>() / 7.0;
    // The mean of eight is uncertain itself.
    let deviation = (variance * (1.0 + 1.0 / 8.0)).sqrt();
    tally.check(
        "share of the energy in motion at 14 ms",
        share(&end.state) - mean,
        4.0 * deviation,
    );
    Ok(())
}
