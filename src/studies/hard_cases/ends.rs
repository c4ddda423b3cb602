//! Contacts that yield, and walls that move.

use std::f64::consts::{PI, TAU};

use super::HardCase;
use super::benches::{
    HEAVY, LIGHT, MovingChain, PTFE, STEEL, assemble, diatomic, drift_bound, set_moving, sphere,
    spheres,
};
use super::tally::CaseChecks;
use crate::chain::{
    Backing, Body, Carrier, Chain, ChainSpec, Drive, EffectsSpec, End, LinearisedContacts,
    PlasticModel, Plasticity, Signal, Support,
};
use crate::experiment::bench::{Bench, Grid};
use crate::experiment::method_choice::method_for;
use crate::motion::Method;

pub const CASES: &[HardCase] = &[
    HardCase {
        name: "contacts that yield as they close",
        why: "loading, turning and unloading begin at zero overlap, at the largest overlap of a collision, or at the static one",
        bound: "restitution of two bodies to 1e-9: Walton and Braun's e, who yield from zero overlap on; 1 at the speed of first yield; a chain whose preload is its yield load: as for dashpots",
        compute: yielding,
    },
    HardCase {
        name: "a resonance in the band gap",
        why: "a drive at the frequency of a defect's mode: the motion grows without end in a gap where nothing else moves",
        bound: "the sum of the modes of the linear chain (Jacobi's rotations): the accuracy of 1e-9 for each of the steps, relative to the largest displacement",
        compute: resonance,
    },
    HardCase {
        name: "walls of impedance near zero and near infinity",
        why: "the wall follows the body at once, which is stiff, or moves less than rounding",
        bound: "momentum m (v0 - v) = Z x_w to the accuracy of 1e-9; a soft wall slows the body as e^(-Z t/m), but for the second order of the overlap; restitution by a hard one 1 - 1.7301733 lambda, but for 2 lambda^2",
        compute: impedances,
    },
    HardCase {
        name: "a drive whose stroke opens contacts",
        why: "bodies fly between a wall that hits them and one that rests",
        bound: "peaks and times as Dormand-Prince 5(4) at 1e-12 finds them; energy less the work of the drive: twice the accuracy of 1e-6 times the root of the number of steps",
        compute: strokes,
    },
];

const ACCURACY: f64 = 1e-9;
/// Accuracy where a reference run is of lower order (1).
const CHAIN_ACCURACY: f64 = 1e-6;
/// `4/5 (5/4)^1.6 B(8/5, 1/2)`: the integral of the cube of the overlap over a collision, in its
/// own units (1).
const RADIATION: f64 = 1.730_173_287_142_933;

/// `chain` after `time` (s), let go at these velocities (m/s), to `accuracy` (1).
fn moved<'a>(
    chain: &'a Chain,
    velocities: &[f64],
    accuracy: f64,
    time: f64,
) -> Result<Bench<'a>, String> {
    let method = method_for(chain, velocities, accuracy);
    let mut bench = Bench::new(chain, velocities, method, &[], Grid::NEVER, Grid::NEVER);
    bench.run_until(time, false, &mut |_| ()).map_err(|error| error.to_string())?;
    Ok(bench)
}

fn yielding(tally: &mut CaseChecks) -> Result<(), String> {
    const STRENGTH: f64 = 1e9;
    let plastic =
        |model| EffectsSpec { plasticity: Some(Plasticity::new(model)), ..EffectsSpec::default() };
    let yields = |strength: f64| Body { yield_strength: Some(strength), ..sphere(LIGHT, STEEL) };
    let pair = |model| {
        assemble(&ChainSpec {
            striker: Some(yields(STRENGTH)),
            particles: vec![yields(STRENGTH)],
            top: End::Free,
            bottom: End::Free,
            wall_preload: 0.0,
            effects: plastic(model),
        })
    };
    let mut rebound = |chain: &Chain, speed: f64, expected: f64, what: &str| {
        let bench = moved(chain, &[speed, 0.0], ACCURACY, 1e-3)?;
        let velocity = bench.state().velocity;
        tally.check(what, (velocity[1] - velocity[0]) / speed - expected, ACCURACY);
        Ok::<(), String>(())
    };
    for restitution in [0.1, 0.5, 0.9, 0.99] {
        let chain = pair(PlasticModel::WaltonBraun(restitution))?;
        rebound(&chain, 0.44, restitution, &format!("Walton and Braun, {restitution}"))?;
    }
    let (modulus, radius): (f64, f64) = (0.5 * STEEL.youngs_modulus / (1.0 - 0.09), 0.5 * 2.38e-3);
    let first = (0.5 * PI / modulus).powi(2)
        * (8.0 * PI * radius.powi(3) / (15.0 * 0.5 * LIGHT)).sqrt()
        * (1.6 * STRENGTH).powf(2.5);
    let chain = pair(PlasticModel::Thornton)?;
    for off in [-1e-9, 0.0, 1e-9] {
        rebound(&chain, first * (1.0 + off), 1.0, &format!("Thornton at 1 + {off:e} of v_y"))?;
    }
    // F_y = pi^3 p^3 R^2/(6 E*^2) is the preload.
    for preload in [0.1, 10.0] {
        let pressure = (6.0 * preload * (modulus / radius).powi(2)).cbrt() / PI;
        let chain = assemble(&ChainSpec {
            striker: None,
            particles: vec![yields(pressure / 1.6); 8],
            top: End::Force(preload),
            bottom: End::Force(preload),
            wall_preload: 0.0,
            effects: plastic(PlasticModel::Thornton),
        })?;
        let motion = MovingChain { velocities: set_moving(&chain, 0, 0.1), chain: &chain };
        let asked = (&[1, 2, 5][..], CHAIN_ACCURACY, 2e-4);
        motion.check_lossy(tally, &format!("a preload of {preload} N"), asked)?;
    }
    Ok(())
}

/// A sine from the top.
fn driven(amplitude: f64, frequency: f64) -> Support {
    let signal = Signal { carrier: Carrier::Sine { frequency }, length: f64::INFINITY, edge: 0.0 };
    Support::Driven(Drive { amplitude, stiffness: None, signal })
}

/// Light spheres and heavy flat bodies in turn between a driven and a resting wall, the sphere in
/// the middle heavier: its mode is in the gap.
fn with_defect(drive: Support) -> Result<Chain, String> {
    let mut particles = diatomic(5, HEAVY);
    particles.pop();
    particles[4].mass = 2.5 * LIGHT;
    assemble(&ChainSpec {
        striker: None,
        particles,
        top: End::Wall(STEEL),
        bottom: End::Wall(STEEL),
        wall_preload: 2.38,
        effects: EffectsSpec {
            linearised_contacts: Some(LinearisedContacts),
            supports: [drive, Support::Rigid],
            ..EffectsSpec::default()
        },
    })
}

fn resonance(tally: &mut CaseChecks) -> Result<(), String> {
    const AMPLITUDE: f64 = 1e-9;
    const CYCLES: f64 = 300.0;
    let chain = with_defect(driven(AMPLITUDE, 1e4))?;
    let masses: Vec<f64> = chain.bodies().iter().map(|body| body.mass).collect();
    let stiffness = chain.contacts()[0].static_stiffness();
    let (squares, modes) = modes(&masses, stiffness);
    let gap = [2.0 * stiffness / HEAVY, 2.0 * stiffness / LIGHT];
    let inside = squares.iter().filter(|square| gap[0] < **square && **square < gap[1]);
    let [square] = inside.collect::<Vec<_>>()[..] else {
        return Err("found no single mode in the gap".to_owned());
    };
    let angular = square.sqrt();
    let chain = with_defect(driven(AMPLITUDE, angular / TAU))?;
    let time = CYCLES * TAU / angular;
    let bench = moved(&chain, &[0.0; 9], ACCURACY, time)?;
    // q'' + w_k^2 q = f sin(w t), from rest.
    let mode = |(square, mode): (&f64, &Vec<f64>)| {
        let (own, force) = (square.sqrt(), mode[0] * stiffness * AMPLITUDE / masses[0].sqrt());
        let q = if (own / angular - 1.0).abs() < 1e-9 {
            0.5 * force / square * ((own * time).sin() - own * time * (own * time).cos())
        } else {
            force * (own * (angular * time).sin() - angular * (own * time).sin())
                / (own * (square - angular * angular))
        };
        mode.iter().map(|part| part * q).collect::<Vec<f64>>()
    };
    let parts: Vec<Vec<f64>> = squares.iter().zip(&modes).map(mode).collect();
    let exact = |i: usize| parts.iter().map(|part| part[i]).sum::<f64>() / masses[i].sqrt();
    let exact: Vec<f64> = (0..masses.len()).map(exact).collect();
    let largest = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let bound = ACCURACY * bench.work().steps as f64;
    for (i, (found, exact)) in bench.state().position.iter().zip(&exact).enumerate() {
        tally.check(format!("particle {}", i + 1), (found - exact) / largest, bound);
    }
    Ok(())
}

/// Squares of the angular frequencies (1/s²) and modes, in units of the roots of the masses, of
/// bodies of these masses (kg) between walls, all contacts of one stiffness (N/m): the eigenvalues
/// of a symmetric matrix by Jacobi's rotations.
fn modes(masses: &[f64], stiffness: f64) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = masses.len();
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 => 2.0 * stiffness / masses[i],
        1 => -stiffness / (masses[i] * masses[j]).sqrt(),
        _ => 0.0,
    };
    let mut a: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    let mut v: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for _ in 0..50 {
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let (c, s) = (1.0 / t.hypot(1.0), t / t.hypot(1.0));
                let turn = |row: &mut Vec<f64>| {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                };
                a.iter_mut().for_each(turn);
                v.iter_mut().for_each(turn);
                let (upper, lower) = a.split_at_mut(q);
                for (above, below) in upper[p].iter_mut().zip(&mut lower[0]) {
                    (*above, *below) = (c * *above - s * *below, s * *above + c * *below);
                }
            }
        }
    }
    let mode = |k: usize| v.iter().map(|row| row[k]).collect();
    ((0..n).map(|k| a[k][k]).collect(), (0..n).map(mode).collect())
}

fn impedances(tally: &mut CaseChecks) -> Result<(), String> {
    const SPEED: f64 = 0.44;
    for impedance in [1e-6, 1e-4, 1e-2, 1e4, 1e6, 1e9, 1e12] {
        let backing = Backing { impedance, echo: None };
        let chain = assemble(&ChainSpec {
            striker: None,
            particles: vec![sphere(LIGHT, PTFE)],
            top: End::Free,
            bottom: End::Wall(STEEL),
            wall_preload: 0.0,
            effects: EffectsSpec {
                supports: [Support::Rigid, Support::Yielding(backing)],
                ..EffectsSpec::default()
            },
        })?;
        let stiffness = chain.contacts()[1].stiffness;
        let is_soft = impedance < 1.0;
        let time = if is_soft { 2e-5 } else { 2e-4 };
        let bench = moved(&chain, &[SPEED], ACCURACY, time)?;
        let state = bench.state();
        let (velocity, wall) = (state.velocity[0], chain.walls(&state)[1]);
        let momentum = (velocity - SPEED + impedance * wall / LIGHT) / SPEED;
        tally.check(format!("momentum at {impedance:e} N s/m"), momentum, ACCURACY);
        if is_soft {
            // With k = Z/m, v' + k v = k s', s the overlap, which bears Z v.
            let rate = impedance / LIGHT;
            let lag = rate * (impedance * SPEED / stiffness).powf(2.0 / 3.0) / SPEED;
            let slowed = velocity / SPEED - (-rate * time).exp() - lag;
            let bound = ACCURACY + 2.0 * lag * rate * time;
            tally.check(format!("slowing at {impedance:e} N s/m"), slowed, bound);
        } else {
            let lambda = stiffness.powf(0.4) * LIGHT.powf(0.6) * SPEED.powf(0.2) / impedance;
            let restitution = -velocity / SPEED - 1.0 + RADIATION * lambda;
            let bound = ACCURACY + 2.0 * lambda * lambda;
            tally.check(format!("restitution at {impedance:e} N s/m"), restitution, bound);
        }
    }
    Ok(())
}

fn strokes(tally: &mut CaseChecks) -> Result<(), String> {
    const TIME: f64 = 4e-4;
    for (preload, stroke) in [(0.1, 5.0), (0.1, 50.0), (0.0, 0.0)] {
        let mut spec = ChainSpec {
            striker: None,
            particles: spheres(4),
            top: End::Wall(STEEL),
            bottom: End::Wall(STEEL),
            wall_preload: preload,
            effects: EffectsSpec::default(),
        };
        let overlap = assemble(&spec)?.contacts()[1].static_overlap;
        let amplitude = if stroke > 0.0 { stroke * overlap } else { 1e-6 };
        spec.effects.supports = [driven(amplitude, 5e3), Support::Rigid];
        let chain = assemble(&spec)?;
        let motion = MovingChain { velocities: vec![0.0; 4], chain: &chain };
        let what = format!("preload {preload} N, stroke {amplitude:.1e} m");
        let method = method_for(&chain, &motion.velocities, CHAIN_ACCURACY);
        let reference = Method::DormandPrince54 { tolerance: 1e-12 };
        motion.hold_peaks(tally, &what, (&[1, 2, 3], CHAIN_ACCURACY, TIME), [method, reference])?;
        let bench = moved(&chain, &motion.velocities, CHAIN_ACCURACY, TIME)?;
        let (before, after) = bench.energies();
        let taken = bench.dissipated();
        let missing = after.total() + taken.total() - before.total();
        let work = taken.work_of_drive.unwrap_or(0.0).abs().max(after.kinetic);
        let bound = drift_bound(bench.work(), CHAIN_ACCURACY);
        tally.check(format!("{what}, energy"), missing / work, bound);
    }
    Ok(())
}
