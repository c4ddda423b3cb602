//! Steps at the edge of stability.

use super::HardCase;
use super::benches::{HEAVY, MovingChain, diatomic, pressed, set_moving, spheres};
use super::tally::CaseChecks;
use crate::chain::Chain;
use crate::experiment::outcome::EnergyLedger;
use crate::experiment::{Integration, RunError, run};
use crate::motion::Method;
use crate::scene::Scene;

pub const CASES: &[HardCase] = &[
    HardCase {
        name: "just below the edge of stability",
        why: "a step that is a little too long lets the energy grow from rounding",
        bound: "energy over 1e5 steps at 0.999 of the limit: at most 1/(1 - 0.999^2) = 500 times what it was, as velocity Verlet on an oscillator has it; an unstable step would leave no number",
        compute: below_the_edge,
    },
    HardCase {
        name: "just above the edge of stability",
        why: "nothing in the method would say so",
        bound: "refused, with contact, limit and step",
        compute: above_the_edge,
    },
    HardCase {
        name: "the edge of what dashpots let be stable",
        why: "velocities decay a hundred times faster than contacts oscillate: a step that would do for the chain alone makes energy of the losses",
        bound: "a step of 1.001 times the limit refused, with contact, limit and decay; energy at 0.999 times it: never more than there was",
        compute: edge_of_losses,
    },
];

/// Symplectic methods, with a step (s).
const SYMPLECTIC: [fn(f64) -> Method; 2] =
    [|step| Method::VelocityVerlet { step }, |step| Method::ForceGradient { step }];

/// The one that damps what it does not resolve, and is stable as far.
const RUNGE_KUTTA: fn(f64) -> Method = |step| Method::RungeKutta4 { step };

fn longest_step(
    chain: &Chain,
    velocities: &[f64],
    method: fn(f64) -> Method,
) -> Result<f64, String> {
    let (_, reach) = method(1.0).fixed_step().ok_or("a method without a fixed step")?;
    let limit = chain.stability_limit(velocities, reach).ok_or("a chain without contacts")?;
    Ok(limit.step)
}

fn below_the_edge(tally: &mut CaseChecks) -> Result<(), String> {
    const CLOSE: f64 = 0.999;
    let most = 1.0 / (1.0 - CLOSE * CLOSE);
    for (name, chain) in [
        ("two spheres", pressed(spheres(2), 2.38)?),
        ("forty equal spheres", pressed(spheres(40), 2.38)?),
        ("twenty cells", pressed(diatomic(20, HEAVY), 2.38)?),
    ] {
        let motion = MovingChain { velocities: set_moving(&chain, 0, 1e-4), chain: &chain };
        for method in SYMPLECTIC {
            let step = CLOSE * longest_step(&chain, &motion.velocities, method)?;
            let method = method(step);
            let end = motion.by(method, 1e5 * step)?;
            tally.check(format!("{name}, {}", method.name()), motion.drift(&end.state), most);
        }
    }
    Ok(())
}

fn above_the_edge(tally: &mut CaseChecks) -> Result<(), String> {
    let scene = Scene::load("magnet-0.61g").map_err(|error| error.to_string())?;
    let mut cause = None;
    for method in SYMPLECTIC.into_iter().chain([RUNGE_KUTTA]) {
        let step = 1.001 * longest_step(&scene.chain, &scene.initial_velocities, method)?;
        let done = run(&scene, Integration::Method(method(step)), 1, &mut |_| ());
        let Err(refusal @ RunError::Unstable { .. }) = done else {
            tally.check("a step beyond the limit was taken", step, 0.0);
            return Ok(());
        };
        let refusal = refusal.to_string();
        cause.get_or_insert(refusal);
    }
    cause.map_or(Ok(()), Err)
}

fn edge_of_losses(tally: &mut CaseChecks) -> Result<(), String> {
    for (gamma, end) in [(100, "zero_overlap"), (100, "zero_force"), (1000, "zero_force")] {
        let text = format!(
            "base = \"magnet-0.61g\"\n[effects.dashpot]\ngamma = \"{gamma} N*s/m\"\nend_of_contact = \"{end}\"\n"
        );
        let scene = Scene::from_text("edge", "edge.toml", &text).map_err(|e| e.to_string())?;
        let by = |step: f64| run(&scene, Integration::Method(RUNGE_KUTTA(step)), 1, &mut |_| ());
        let what = format!("{gamma} N s/m, {end}");
        let Err(RunError::UnstableLoss { limit, .. }) = by(scene.duration) else {
            tally.check(format!("{what}: a step as long as the scene was taken"), 1.0, 0.0);
            continue;
        };
        let refused = matches!(by(1.001 * limit.step), Err(RunError::UnstableLoss { .. }));
        tally.check(format!("{what}: steps taken beyond the limit"), f64::from(!refused), 0.5);
        let energy = by(0.999 * limit.step).map_err(|error| error.to_string())?.summary.energy;
        let made = (energy.r#final - energy.initial) / energy.initial_by_kind.kinetic;
        tally.check(format!("{what}: energy made"), made.max(0.0), drift_rounding(&energy));
    }
    Ok(())
}

/// Rounding error of a sum of energies, relative to the initial energy in motion (1).
fn drift_rounding(energy: &EnergyLedger) -> f64 {
    1e-12 * energy.initial / energy.initial_by_kind.kinetic
}
