//! Long runs, and runs back in time.

use super::HardCase;
use super::benches::{
    HEAVY, LIGHT, MovingChain, assemble, diatomic, drift_bound, pressed, set_moving, spheres,
};
use super::tally::CaseChecks;
use crate::chain::State;
use crate::chain::{Chain, ChainSpec, EffectsSpec, End, LinearisedContacts};
use crate::experiment::bench::start;
use crate::experiment::for_accuracy;
use crate::motion::Method;
use crate::scene::Scene;

pub const CASES: &[HardCase] = &[
    HardCase {
        name: "ten million steps",
        why: "rounding adds up, in the state and in the clock",
        bound: "velocity Verlet on an oscillator is known in closed form, w t = 2 asin(w h/2) a step: roundings of the phase, as often up as down: the root of the number of steps; and of the spring's stiffness: a quarter of an ulp of the phase",
        compute: ten_million_steps,
    },
    HardCase {
        name: "3 s of a preloaded chain",
        why: "fifteen hundred times as long as a record of the bench",
        bound: "energy: twice the accuracy of 1e-9, times the root of the number of steps",
        compute: three_seconds,
    },
    HardCase {
        name: "3 s of a rattling chain",
        why: "the bench without magnet, fifteen hundred times as long as a record: hundreds of thousands of openings and closings",
        bound: "energy: twice the accuracy of 1e-9, times the root of the number of steps; by ten million fixed steps: each of them may miss a kink, A (v h)^(5/2) at the striker's speed, as often up as down",
        compute: rattling,
    },
    HardCase {
        name: "time reversal",
        why: "nothing is lost, so the film must run backwards to where it began, openings and all",
        bound: "back to rest: the error of each step, grown for the time of the run",
        compute: time_reversal,
    },
];

/// Two spheres under 2.38 N from both ends, their contact linearised: an oscillator.
fn oscillator() -> Result<Chain, String> {
    assemble(&ChainSpec {
        striker: None,
        particles: spheres(2),
        top: End::Force(2.38),
        bottom: End::Force(2.38),
        wall_preload: 0.0,
        effects: EffectsSpec {
            linearised_contacts: Some(LinearisedContacts),
            ..EffectsSpec::default()
        },
    })
}

fn ten_million_steps(tally: &mut CaseChecks) -> Result<(), String> {
    const STEPS: f64 = 1e7;
    let chain = oscillator()?;
    let omega = (2.0 * chain.contacts()[1].static_stiffness() / LIGHT).sqrt();
    // 3 s, at 60 steps a period.
    let step = 3.0 / STEPS;
    let motion = MovingChain { velocities: vec![0.5, -0.5], chain: &chain };
    let end = motion.by(Method::VelocityVerlet { step }, STEPS * step)?;
    let steps = end.work.steps as f64;
    tally.check("steps", steps - STEPS, 0.5);
    // Each step turns by this angle; position and velocity of the numerical solution are its sine
    // and cosine.
    let half = 0.5 * omega * step;
    let phase = STEPS * 2.0 * half.asin();
    let exact = phase.sin() / (omega * (1.0 - half * half).sqrt());
    let (position, velocity) = (&end.state.position, &end.state.velocity);
    // The spring's stiffness is rounded, too: by half an ulp, the phase by a quarter of one.
    let rounding =
        STEPS.sqrt() * f64::EPSILON * std::f64::consts::TAU + 0.25 * f64::EPSILON * phase;
    let found = position[0] - position[1];
    tally.check("overlap after 3 s", (found - exact) * omega, rounding);
    tally.check("closing speed after 3 s", velocity[0] - velocity[1] - phase.cos(), rounding);
    Ok(())
}

fn three_seconds(tally: &mut CaseChecks) -> Result<(), String> {
    const ACCURACY: f64 = 1e-9;
    let chain = pressed(diatomic(4, HEAVY), 2.38)?;
    let motion = MovingChain { velocities: set_moving(&chain, 0, 0.05), chain: &chain };
    let end = motion.after(3.0, ACCURACY)?;
    tally.check("energy", motion.drift(&end.state), drift_bound(end.work, ACCURACY));
    let momentum = |state: &State| chain.momentum(state);
    // Equal forces at both ends: momentum stays. Rounding takes half an ulp a step and body at
    // most.
    let before = LIGHT * 0.05;
    let rounding = 8.0 * end.work.steps as f64 * f64::EPSILON;
    tally.check("momentum", momentum(&end.state) / before - 1.0, rounding);
    Ok(())
}

fn rattling(tally: &mut CaseChecks) -> Result<(), String> {
    const ACCURACY: f64 = 1e-9;
    const STEPS: f64 = 1e7;
    let scene = Scene::load("gravity-0.61g").map_err(|error| error.to_string())?;
    let (chain, velocities) = (&scene.chain, scene.initial_velocities.clone());
    let motion = MovingChain { chain, velocities };
    let end = motion.after(3.0, ACCURACY)?;
    tally.check("energy", motion.drift(&end.state), drift_bound(end.work, ACCURACY));
    let step = 3.0 / STEPS;
    let end = motion.by(Method::ForceGradient { step }, 3.0)?;
    let speed = scene.striker_speed().ok_or("a scene without a striker")?;
    let stiffest = chain.contacts().iter().map(|contact| contact.stiffness).fold(0.0, f64::max);
    let kinetic = chain.energy_above_static(&motion.start());
    let kink = stiffest * (speed * step).powf(2.5) / kinetic;
    tally.check("energy, ten million steps", motion.drift(&end.state), STEPS.sqrt() * kink);
    Ok(())
}

/// Runs `chain` for `time` (s), turns every velocity round, and runs it back; returns how far
/// overlaps and speeds are from where they began, relative to their largest, and the number of
/// steps.
fn there_and_back(chain: &Chain, method: Method, time: f64) -> Result<(f64, f64), String> {
    const SPEED: f64 = 0.1;
    let motion = MovingChain { velocities: set_moving(chain, 0, SPEED), chain };
    let there = motion.by(method, time)?;
    let mut state = State { time: 0.0, ..there.state };
    for velocity in &mut state.velocity {
        *velocity = -*velocity;
    }
    let mut back = start(chain, method, state);
    back.advance(time).map_err(|error| error.to_string())?;
    let state = back.state();
    let scale = chain.impact_overlap(&motion.velocities);
    let position = state.position.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let off = |(found, exact): (&f64, &f64)| (found + exact).abs();
    let speed = state.velocity.iter().zip(&motion.velocities).map(off).fold(0.0_f64, f64::max);
    let steps = (there.work.steps + back.work().steps) as f64;
    // An error in a speed becomes one in position with the time, in units of the overlap.
    Ok(((position / scale).max(speed / SPEED), steps * SPEED * time / scale))
}

fn time_reversal(tally: &mut CaseChecks) -> Result<(), String> {
    for force in [0.0, 2.38] {
        let chain = pressed(diatomic(10, HEAVY), force)?;
        for accuracy in [1e-6, 1e-9] {
            let (error, growth) = there_and_back(&chain, for_accuracy(accuracy), 1e-3)?;
            tally.check(format!("{force} N, accuracy {accuracy:e}"), error, accuracy * growth);
        }
        // Symplectic and symmetric: these come back to where they began at any step, but for
        // rounding.
        let step = 0.5e-6;
        let method = Method::VelocityVerlet { step };
        {
            let (error, growth) = there_and_back(&chain, method, 1e-3)?;
            tally.check(format!("{force} N, {}", method.name()), error, f64::EPSILON * growth);
        }
    }
    Ok(())
}
