//! Contacts that open and close: a bead that bounces, and a column that rattles.

use std::f64::consts::FRAC_PI_2;

use super::HardCase;
use super::benches::{
    FinalState, HEAVY, LIGHT, MovingChain, PTFE, STEEL, assemble, between, diatomic, drift_bound,
    set_moving, sphere,
};
use super::tally::CaseChecks;
use crate::chain::{ChainSpec, Contact, EffectsSpec, End, Gravity, hertz};
use crate::motion::Method;
use crate::quantity::engineering;

pub const CASES: &[HardCase] = &[
    HardCase {
        name: "contact openings",
        why: "the force is only once differentiable where a contact opens: every method loses its order",
        bound: "the period of a bead that bounces under a constant force, by quadrature: the accuracy of 1e-8 for each of the steps; its energy: twice that times the root of their number",
        compute: openings,
    },
    HardCase {
        name: "chattering under weak gravity",
        why: "contact lasts a millionth of the flight, or the gap hardly opens: event finders drown in events",
        bound: "the period of a bead that bounces, by quadrature: the accuracy of 1e-8 for each of the steps; its energy: twice that times the root of their number; a rattling column's energy likewise, with no more force evaluations than Dormand-Prince 8(5,3), which looks for no events",
        compute: chatter,
    },
];

/// Times that a bead bounces.
const BOUNCE_COUNT: f64 = 50.0;

fn openings(tally: &mut CaseChecks) -> Result<(), String> {
    for force in [1e-3, 1.0, 1e3] {
        // Up to a gap a hundred times as wide as the static overlap.
        bounce(tally, force, 10.0)?;
    }
    Ok(())
}

fn chatter(tally: &mut CaseChecks) -> Result<(), String> {
    // Weights in a field of 1e-3 m/s²: gaps that hardly open, and flights of a million contact
    // times.
    for excess in [1e-6, 1e-3, 1e3] {
        bounce(tally, 1e-3 * LIGHT, excess)?;
    }
    column(tally)
}

/// A bead that `force` (N) presses against a wall, kicked away from it with the energy that opens
/// the contact and `excess` times that on top (1).
fn bounce(tally: &mut CaseChecks, force: f64, excess: f64) -> Result<(), String> {
    const ACCURACY: f64 = 1e-8;
    let chain = between(vec![sphere(LIGHT, PTFE)], (End::Force(force), End::Wall(STEEL)))?;
    let contact = chain.contacts()[1];
    // From rest at the static overlap: 2/5 F0 d0 are stored, F0 d0 are needed.
    let threshold = 1.2 * force * contact.static_overlap / LIGHT;
    let speed = (threshold * (1.0 + excess)).sqrt();
    let leaving = (threshold * excess).sqrt();
    let period = 2.0 * leaving * LIGHT / force + contact_time(&contact, force, leaving);
    let motion = MovingChain { velocities: vec![-speed], chain: &chain };
    let end = motion.after(BOUNCE_COUNT * period, ACCURACY)?;
    // After whole periods the bead is where it began; where it is instead tells how late it comes.
    let late = end.state.position[0] / speed;
    let what = |figure: &str| {
        format!(
            "{} and {excess:e} of the energy over that of opening, {figure}",
            engineering(force, "N", 2)
        )
    };
    // An error of the energy comes back in every later period.
    let late_bound = ACCURACY * end.work.steps as f64;
    tally.check(what("period"), late / (BOUNCE_COUNT * period), late_bound);
    tally.check(what("energy"), motion.drift(&end.state), drift_bound(end.work, ACCURACY));
    Ok(())
}

/// How long a bead that arrives with `speed` (m/s) under `force` (N) stays in contact: twice
/// `int_0^d dx / sqrt(v^2 + 2 F x/m - 4/5 A/m x^2.5)` up to where it turns round (s).
fn contact_time(contact: &Contact, force: f64, speed: f64) -> f64 {
    // Smooth in s, x = d sin^2 s: midpoints of many intervals, twice as many for Richardson's
    // extrapolation.
    let left =
        |x: f64| 0.5 * LIGHT * speed * speed + force * x - hertz::energy(contact.stiffness, x);
    let (mut low, mut high) = (contact.static_overlap, contact.static_overlap);
    while left(high) > 0.0 {
        high *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if left(middle) > 0.0 { low = middle } else { high = middle }
    }
    let deepest = 0.5 * (low + high);
    let integral = |intervals: u32| -> f64 {
        let width = FRAC_PI_2 / f64::from(intervals);
        let term = |i: u32| {
            let (sine, cosine) = (width * (f64::from(i) + 0.5)).sin_cos();
            let x = deepest * sine * sine;
            // left(x) without the cancellation at the deepest point: all terms as differences to
            // those there.
            let rest = deepest * cosine * cosine;
            let power = powers_difference(deepest, x, rest);
            let energy = 0.4 * contact.stiffness * power - force * rest;
            2.0 * deepest * sine * cosine / (2.0 * energy / LIGHT).sqrt()
        };
        (0..intervals).map(term).sum::<f64>() * width
    };
    let (coarse, fine) = (integral(2000), integral(4000));
    2.0 * (4.0 * fine - coarse) / 3.0
}

/// `a^2.5 - b^2.5` where `a - b` is `rest`, without cancellation.
fn powers_difference(a: f64, b: f64, rest: f64) -> f64 {
    let (r, s) = (a.sqrt(), b.sqrt());
    let roots = rest / (r + s);
    roots * (r.powi(4) + r.powi(3) * s + (r * s).powi(2) + r * s.powi(3) + s.powi(4))
}

/// A column that hardly weighs anything, kicked in its middle: every contact opens and closes again
/// and again.
fn column(tally: &mut CaseChecks) -> Result<(), String> {
    const ACCURACY: f64 = 1e-8;
    const TIME: f64 = 10e-3;
    let mut particles = diatomic(10, HEAVY);
    // A cylinder's flat face would make no Hertz contact with the wall.
    particles.push(sphere(LIGHT, PTFE));
    let gravity = Some(Gravity { acceleration: 1e-3 });
    let chain = assemble(&ChainSpec {
        striker: None,
        particles,
        top: End::Free,
        bottom: End::Wall(STEEL),
        wall_preload: 0.0,
        effects: EffectsSpec { gravity, ..EffectsSpec::default() },
    })?;
    let motion = MovingChain { velocities: set_moving(&chain, 10, 0.1), chain: &chain };
    let end = motion.after(TIME, ACCURACY)?;
    let bound = drift_bound(end.work, ACCURACY);
    tally.check("column, energy", motion.drift(&end.state), bound);
    let other = motion.by(Method::DormandPrince853 { tolerance: ACCURACY }, TIME)?;
    let evaluations = |end: &FinalState| end.work.force_evaluations as f64;
    tally.check("column, force evaluations", evaluations(&end), evaluations(&other));
    Ok(())
}
