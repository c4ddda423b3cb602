//! A chain that nobody can predict for long.

use super::HardCase;
use super::benches::{HEAVY, LIGHT, Motion, PTFE, STEEL, assemble, diatomic, drift_bound, kick, sphere};
use super::tally::Tally;
use crate::chain::{Chain, ChainSpec, EffectsSpec, End, Gravity};
use crate::experiment::horizon::horizon;
use crate::integrate::Method;

pub const CASES: &[HardCase] = &[HardCase {
    name: "600-bead chaos",
    why: "under gravity alone every contact rattles and doubles every error again and again",
    bound: "up to the horizon that the run itself states, the state of Dormand-Prince 8(5,3) at 1e-13 within sqrt(accuracy) of 1e-6; beyond it statistics: energy, and the share of it in motion within four standard deviations of eight perturbed runs by that method",
    compute: chaos,
}];

/// Accuracy asked for (1).
const ACCURACY: f64 = 1e-6;
/// Time simulated (s).
const TIME: f64 = 14e-3;

fn column() -> Result<Chain, String> {
    let mut particles = diatomic(300, HEAVY);
    // A cylinder's flat face would make no Hertz contact with the wall.
    particles.push(sphere(LIGHT, PTFE));
    assemble(ChainSpec {
        striker: None,
        particles,
        top: End::Free,
        bottom: End::Wall(STEEL),
        wall_preload: 0.0,
        effects: EffectsSpec { gravity: Some(Gravity { acceleration: 9.81 }), ..EffectsSpec::default() },
    })
}

fn chaos(tally: &mut Tally) -> Result<(), String> {
    let chain = column()?;
    let motion = Motion { velocities: kick(&chain, 0, 0.44), chain: &chain };
    let found = horizon(&chain, &motion.velocities, (TIME, ACCURACY)).map_err(|e| e.to_string())?;
    println!("{:?}", found);
    Ok(())
}
