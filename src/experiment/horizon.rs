//! How far ahead a rattling chain can be predicted.
//!
//! Contacts that open and close amplify every error, those of the method included. How much is not known beforehand, but it can
//! be seen: the same motion a hundred times more accurately, and the difference is the first one's error. The horizon is where
//! half of the digits that were asked for are gone, an error of `sqrt(accuracy)`: from there on the state holds in its statistics
//! only. First peaks lie before it, or `--accuracy` has not kept its word.
//! Source: two tolerances as an error estimate: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.4.

use super::bench::start;
use super::for_accuracy;
use crate::chain::Chain;
use crate::integrate::{IntegrateError, State};
use crate::quantity::engineering;
use crate::scene::Scene;

/// Times at which states are compared.
const LOOKS: u32 = 64;
/// How much more accurate the second motion is (1).
const TIGHTER: f64 = 0.01;
/// Two motions of the same accuracy share the size of their errors, not the errors: the estimate may be off by so much (1).
const LUCK: f64 = 4.0;
/// The second motion's steps tolerate at least this much: rounding is no error of the method (1).
const TIGHTEST: f64 = 1e-14;

/// The error of a motion, as far as a second, tighter one can tell.
#[derive(Debug, Clone, PartialEq)]
pub struct Horizon {
    /// The last time before the error may have exceeded `sqrt(accuracy)`; none if it never did (s).
    pub time: Option<f64>,
    /// Largest error of overlaps and speeds, relative to the largest so far, up to each of the times that were looked at (1).
    pub errors: Vec<f64>,
}

/// Estimates the error of a motion from rest under `velocities` (m/s) over `duration` (s) at `accuracy` (1). None if no contact
/// opened: such chains forget nothing and amplify nothing.
///
/// # Errors
/// [`IntegrateError`] where the integrator cannot go on.
pub fn horizon(
    chain: &Chain,
    velocities: &[f64],
    (duration, accuracy): (f64, f64),
) -> Result<Option<Horizon>, IntegrateError> {
    // Losses make chains forget; their methods make no such estimate.
    if chain.is_dissipative() {
        return Ok(None);
    }
    let found = states(chain, velocities, duration, accuracy)?;
    if !rattles(chain, &found) {
        return Ok(None);
    }
    let tighter = (accuracy * TIGHTER).max(TIGHTEST);
    let exact = states(chain, velocities, duration, tighter)?;
    let mut horizon = Horizon { time: None, errors: Vec::new() };
    let mut scales = (0.0_f64, 0.0_f64);
    let mut most = 0.0_f64;
    let mut before = 0.0;
    for (found, exact) in found.iter().zip(&exact) {
        let (overlap, speed) = difference(chain, found, exact, &mut scales);
        most = most.max(overlap / scales.0).max(speed / scales.1);
        horizon.errors.push(most);
        if LUCK * most > accuracy.sqrt() && horizon.time.is_none() {
            horizon.time = Some(before);
        }
        before = exact.time;
    }
    Ok(Some(horizon))
}

/// What a user should know of a scene that runs beyond its horizon.
#[must_use]
pub fn note(scene: &Scene, accuracy: f64) -> Option<String> {
    let setting = (scene.duration, accuracy);
    // A motion that cannot be computed has been refused already.
    let time = horizon(&scene.chain, &scene.initial_velocities, setting).ok()??.time?;
    let (time, left) = (engineering(time, "s", 2), accuracy.sqrt());
    Some(format!(
        "contacts open and amplify every error: from {time} on it exceeds {left:.0e} of the largest overlap or speed, and the motion is known only in its statistics"
    ))
}

/// The motion at even times.
fn states(
    chain: &Chain,
    velocities: &[f64],
    duration: f64,
    accuracy: f64,
) -> Result<Vec<State>, IntegrateError> {
    let position = vec![0.0; velocities.len()];
    let state = State { time: 0.0, position, velocity: velocities.to_vec() };
    let mut integrator = start(chain, for_accuracy(accuracy), state);
    (1..=LOOKS)
        .map(|look| {
            let end = duration * f64::from(look) / f64::from(LOOKS);
            while integrator.time() < end {
                integrator.step(end)?;
            }
            Ok(integrator.state())
        })
        .collect()
}

/// Whether a contact that was closed was found open later.
fn rattles(chain: &Chain, states: &[State]) -> bool {
    chain.contacts().iter().enumerate().any(|(j, contact)| {
        let mut closed = contact.static_overlap > 0.0;
        states.iter().any(|state| {
            let overlap = contact.static_overlap + chain.overlap_change(&state.position, j);
            let opened = closed && overlap <= 0.0 && contact.stiffness > 0.0;
            closed |= overlap > 0.0;
            opened
        })
    })
}

/// Largest differences of overlaps (m) and speeds (m/s); `scales` take in the largest of both so far.
fn difference(chain: &Chain, found: &State, exact: &State, scales: &mut (f64, f64)) -> (f64, f64) {
    let (mut overlap, mut speed) = (0.0_f64, 0.0_f64);
    for (j, contact) in chain.contacts().iter().enumerate().filter(|(_, c)| c.stiffness > 0.0) {
        // The width of a gap bears nothing.
        let change =
            |state: &State| chain.overlap_change(&state.position, j).max(-contact.static_overlap);
        overlap = overlap.max((change(found) - change(exact)).abs());
        scales.0 = scales.0.max(change(exact).abs());
    }
    for (found, exact) in found.velocity.iter().zip(&exact.velocity) {
        speed = speed.max((found - exact).abs());
        scales.1 = scales.1.max(exact.abs());
    }
    (overlap, speed)
}
