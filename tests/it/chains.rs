//! Chains for the tests, put together without scene files.

use hertzscope::chain::{
    Body, Chain, ChainSpec, EffectsSpec, Elasticity, End, ForceProbe, LinearisedContacts,
};
use hertzscope::experiment::bench::{Bench, Grid};
use hertzscope::motion::Method;

pub const PTFE: Elasticity = Elasticity { youngs_modulus: 1.46e9, poissons_ratio: 0.46 };
pub const STEEL: Elasticity = Elasticity { youngs_modulus: 193e9, poissons_ratio: 0.3 };
pub const ALUMINA: Elasticity = Elasticity { youngs_modulus: 400e9, poissons_ratio: 0.22 };

/// Never within a test's time: for grids that nobody reads.
pub const NEVER: Grid = Grid { start: 1e9, interval: 1.0 };

pub fn body(name: &str, mass: f64, radius: Option<f64>, elasticity: Elasticity) -> Body {
    Body {
        name: name.into(),
        mass,
        length: radius.map_or(3.12e-3, |r| 2.0 * r),
        curvature: radius.map_or(0.0, |r| 1.0 / r),
        elasticity,
        axis: None,
        yield_strength: None,
    }
}

pub fn ptfe_sphere() -> Body {
    body("ptfe_sphere", 0.1226e-3, Some(2.38e-3), PTFE)
}

pub fn steel_cylinder() -> Body {
    body("steel_cylinder", 0.485e-3, None, STEEL)
}

/// Bodies alone, pressed together by `force` (N) from both ends.
pub fn pressed(particles: Vec<Body>, force: f64, linear: bool) -> ChainSpec {
    let end = if force > 0.0 { End::Force(force) } else { End::Free };
    ChainSpec {
        striker: None,
        particles,
        top: end,
        bottom: end,
        wall_preload: 0.0,
        effects: EffectsSpec {
            linearised_contacts: linear.then_some(LinearisedContacts),
            ..EffectsSpec::default()
        },
    }
}

/// The light and heavy masses of the bench in turn, sphere first.
pub fn diatomic(cells: usize, force: f64, linear: bool) -> Chain {
    let particles = (0..cells).flat_map(|_| [ptfe_sphere(), steel_cylinder()]).collect();
    Chain::new(&pressed(particles, force, linear)).expect("a chain")
}

/// Sets `chain` in motion: body `kick.0` with the speed `kick.1` (m/s).
pub fn kicked<'a>(
    chain: &'a Chain,
    kick: (usize, f64),
    method: Method,
    probes: &[ForceProbe],
    grid: Grid,
) -> Bench<'a> {
    let mut velocities = vec![0.0; chain.bodies().len()];
    velocities[kick.0] = kick.1;
    Bench::new(chain, &velocities, method, probes, grid, NEVER)
}
