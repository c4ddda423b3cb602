//! Pulses through chains: without preload, under any preload, at any speed, and where a dimer lets
//! them through.

use super::HardCase;
use super::benches::{
    HEAVY, LIGHT, MovingChain, diatomic, drift_bound, pressed, set_moving, spheres,
};
use super::tally::CaseChecks;

pub const CASES: &[HardCase] = &[
    HardCase {
        name: "sonic vacuum",
        why: "nothing is linear: sound speed and stiffness are zero until the pulse comes",
        bound: "the discrete solitary wave's speed constant 0.905515776419, within what an accuracy of 1e-7 leaves to arrival times and force",
        compute: sonic_vacuum,
    },
    HardCase {
        name: "impact speeds 1e-6 to 10 m/s",
        why: "overlaps, forces and times span five, eight and one decades",
        bound: "peak and time at each speed as Dormand-Prince 8(5,3) at 1e-13 finds them: the accuracy of 1e-6; t s^(-1/5) and F s^(6/5) between any two: a millionth of it",
        compute: speeds,
    },
    HardCase {
        name: "preload 0 and 1e-9 to 1e3 N",
        why: "between contacts that open at once and waves a million times weaker than the static force",
        bound: "peaks and times as Dormand-Prince 8(5,3) at 1e-13 finds them: the accuracy of 1e-6 for the loudest contact, as much more as a pulse is weaker elsewhere",
        compute: preloads,
    },
    HardCase {
        name: "a wave 1e-9 of the preload",
        why: "differences of nearly equal forces lose every digit that they share",
        bound: "v0 [J_2n + J_2n+2](2wt) of the linear chain: the accuracy of 1e-9, and the curvature that is left of Hertz's law",
        compute: weak_wave,
    },
    HardCase {
        name: "10,000 particles",
        why: "errors and costs that grow with the chain would show",
        bound: "v0 [J_2n + J_2n+2](2wt) for the first hundred, the rest at rest: the accuracy of 1e-6 times the root of the number of steps, and the curvature of Hertz's law",
        compute: ten_thousand,
    },
    HardCase {
        name: "dimer anti-resonances",
        why: "at some mass ratios a pulse sheds nothing: the slightest loss in the method would show as decay",
        bound: "decay a cell below 1e-6 at m/M = 0.3428, 0.1548, 0.0901, and 3.1e-3 at the bench's 0.2528, within the 0.05e-3 that it is printed to",
        compute: anti_resonances,
    },
];

/// Speed of the solitary wave, `c sqrt(m) / (A^(1/3) F^(1/6))` (1).
const SOLITARY_WAVE_SPEED: f64 = 0.905_515_776_419;

/// Hertz's law scales, and so must its solutions: steps are relative to the impact, and but for
/// rounding the same (1).
const SCALE_FACTOR: f64 = 1e-6;

fn sonic_vacuum(tally: &mut CaseChecks) -> Result<(), String> {
    const ACCURACY: f64 = 1e-7;
    let chain = pressed(spheres(110), 0.0)?;
    let motion = MovingChain { velocities: set_moving(&chain, 0, 0.44), chain: &chain };
    let peaks = motion.contact_peaks(&[50, 90], ACCURACY, 3.2e-3)?;
    let [early, late] = peaks.as_slice() else { return Err("no pulse arrived".to_owned()) };
    let between = late.time_s - early.time_s;
    let contact = chain.contacts()[50].stiffness;
    let scale = LIGHT.sqrt() / (contact.cbrt() * late.dynamic_n.powf(1.0 / 6.0));
    // Both times may be off by the accuracy, and so may the force.
    let bound = ACCURACY * ((early.time_s + late.time_s) / between + 1.0 / 6.0);
    tally.check(
        "speed of the solitary wave",
        40.0 / between * scale / SOLITARY_WAVE_SPEED - 1.0,
        bound,
    );
    Ok(())
}

fn speeds(tally: &mut CaseChecks) -> Result<(), String> {
    const ACCURACY: f64 = 1e-6;
    let chain = pressed(diatomic(10, HEAVY), 0.0)?;
    let motion =
        |speed: f64| MovingChain { velocities: set_moving(&chain, 0, speed), chain: &chain };
    let long = |speed: f64| 1e-3 * speed.powf(-0.2);
    let peak = |speed: f64| motion(speed).contact_peaks(&[12], ACCURACY, long(speed));
    let unit = peak(1.0)?;
    for speed in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 10.0_f64] {
        motion(speed).check_peaks(
            tally,
            &format!("{speed:e} m/s"),
            (&[12], ACCURACY, long(speed)),
        )?;
        for (found, one) in peak(speed)?.iter().zip(&unit) {
            let time = found.time_s / one.time_s * speed.powf(0.2) - 1.0;
            let force = found.dynamic_n / one.dynamic_n * speed.powf(-1.2) - 1.0;
            tally.check(format!("{speed:e} m/s, scaled time"), time, SCALE_FACTOR * ACCURACY);
            tally.check(format!("{speed:e} m/s, scaled force"), force, SCALE_FACTOR * ACCURACY);
        }
    }
    Ok(())
}

fn preloads(tally: &mut CaseChecks) -> Result<(), String> {
    for force in [0.0, 1e-9, 1e-6, 1e-3, 1.0, 1e3] {
        let chain = pressed(diatomic(10, HEAVY), force)?;
        let motion = MovingChain { velocities: set_moving(&chain, 0, 0.1), chain: &chain };
        // Long enough for the pulse at its slowest, without preload.
        motion.check_peaks(tally, &format!("{force:e} N"), (&[1, 8, 16], 1e-6, 1.5e-3))?;
    }
    Ok(())
}

fn weak_wave(tally: &mut CaseChecks) -> Result<(), String> {
    // 2e-9 of the static force in the first contact.
    linear_wave(tally, (60, 1e3), 1e-8, 1e-9)
}

fn ten_thousand(tally: &mut CaseChecks) -> Result<(), String> {
    linear_wave(tally, (10_000, 2.38), 1e-6, 1e-6)
}

/// Holds a chain of `count` spheres under `force` (N), its first one kicked with `speed` (m/s),
/// against the linear solution, until the wave has passed 25 spheres.
fn linear_wave(
    tally: &mut CaseChecks,
    (count, force): (usize, f64),
    speed: f64,
    accuracy: f64,
) -> Result<(), String> {
    const PHASE: f64 = 50.0;
    let chain = pressed(spheres(count), force)?;
    let contact = chain.contacts()[1];
    let omega = (contact.static_stiffness() / LIGHT).sqrt();
    let motion = MovingChain { velocities: set_moving(&chain, 0, speed), chain: &chain };
    let end = motion.after(PHASE / (2.0 * omega), accuracy)?;
    // F = k u (1 + u/(4 d0) + ...): the overlaps change by v0/w at most, over as many periods as
    // the wave has taken.
    let curvature = speed / omega / (4.0 * contact.static_overlap) * PHASE;
    let steps = drift_bound(end.work, accuracy) / 2.0;
    for (n, found) in end.state.velocity.iter().enumerate() {
        let exact =
            if n < 100 { speed * (bessel(2 * n, PHASE) + bessel(2 * n + 2, PHASE)) } else { 0.0 };
        tally.check(
            format!("speed of particle {}", n + 1),
            (found - exact) / speed,
            steps + curvature,
        );
    }
    tally.check("energy", motion.drift(&end.state), 2.0 * steps);
    Ok(())
}

/// Bessel function of the first kind by its integral, `1/pi int_0^pi cos(n s - x sin s) ds`: the
/// trapezoidal rule converges exponentially for a periodic integrand.
fn bessel(order: usize, x: f64) -> f64 {
    const POINTS: usize = 1024;
    let term = |i: usize| {
        let s = std::f64::consts::TAU * i as f64 / POINTS as f64;
        (order as f64 * s - x * s.sin()).cos()
    };
    (0..POINTS).map(term).sum::<f64>() / POINTS as f64
}

fn anti_resonances(tally: &mut CaseChecks) -> Result<(), String> {
    // m/M, decay a cell, and how well that is known: below 1e-6, and 3.1e-3 as printed.
    for (ratio, decay, known) in
        [(0.3428, 0.0, 1e-6), (0.1548, 0.0, 1e-6), (0.0901, 0.0, 1e-6), (0.2528, 3.1e-3, 0.05e-3)]
    {
        let chain = pressed(diatomic(220, LIGHT / ratio), 0.0)?;
        let motion = MovingChain { velocities: set_moving(&chain, 0, 1.0), chain: &chain };
        let peaks = motion.contact_peaks(&[241, 401], 1e-8, 60e-3)?;
        let [early, late] = peaks.as_slice() else { return Err("no pulse arrived".to_owned()) };
        let found = 1.0 - (late.dynamic_n / early.dynamic_n).powf(1.0 / 80.0);
        tally.check(format!("decay a cell at m/M = {ratio}"), found - decay, known);
    }
    Ok(())
}
