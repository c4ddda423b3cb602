//! How far ahead a rattling chain can be predicted.
//!
//! Contacts that open and close amplify every error, those of the method included. How much is not
//! known beforehand, but it can be seen: the same motion a hundred times more accurately, and the
//! difference is the first one's error. The horizon is where half of the digits that were asked for
//! may be gone, an error of `sqrt(accuracy)`. First peaks lie before it, or `--accuracy` has not
//! kept its word. Source: two tolerances as an error estimate: Hairer, Norsett, Wanner, Solving
//! ODEs I (1993), II.4.

use super::bench::start;
use super::method_choice::method_for;
use crate::chain::Chain;
use crate::chain::State;
use crate::motion::IntegrateError;

/// From one time at which states are compared to the next (1): a horizon is known to a twentieth,
/// however long is simulated.
const LOOK_RATIO: f64 = 1.05;
/// How much more accurate the second motion is (1).
const TIGHTENING: f64 = 0.01;
/// Two motions of the same accuracy share the size of their errors, not the errors: the estimate
/// may be off by so much (1).
const SAFETY_FACTOR: f64 = 4.0;
/// The second motion's steps tolerate at least this much: rounding is no error of the method (1).
const MIN_TOLERANCE: f64 = 1e-14;

/// The last of the times at which states were compared before the error of a motion at `accuracy`,
/// from rest under `velocities` (m/s) over `duration` (s), may have exceeded `sqrt(accuracy)` of
/// the largest overlap or speed so far (1); none if it never did (s).
///
/// # Errors
/// [`IntegrateError`] where the integrator cannot go on.
pub fn horizon(
    chain: &Chain,
    velocities: &[f64],
    duration: f64,
    accuracy: f64,
) -> Result<Option<f64>, IntegrateError> {
    let mut motions = [accuracy, (accuracy * TIGHTENING).max(MIN_TOLERANCE)].map(|accuracy| {
        let method = method_for(chain, velocities, accuracy);
        start(chain, method, chain.initial_state(velocities))
    });
    let mut scales = (0.0_f64, 0.0_f64);
    let (mut before, mut end) = (0.0, first_look(chain, velocities));
    while before < duration {
        end = duration.min(end);
        for motion in &mut motions {
            while motion.time() < end {
                motion.step(end)?;
            }
        }
        let [found, exact] = motions.each_ref().map(|motion| motion.state());
        let (overlap, speed) = difference(chain, &found, &exact, &mut scales);
        if SAFETY_FACTOR * (overlap / scales.0).max(speed / scales.1) > accuracy.sqrt() {
            return Ok(Some(before));
        }
        (before, end) = (end, LOOK_RATIO * end);
    }
    Ok(None)
}

/// The time that the fastest body takes to go as far as an impact presses its contact, or where
/// nothing is struck a microsecond (s).
fn first_look(chain: &Chain, velocities: &[f64]) -> f64 {
    let fastest = velocities.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let time = chain.impact_overlap(velocities) / fastest;
    if time.is_normal() { time } else { 1e-6 }
}

/// Largest differences of overlaps (m) and speeds (m/s); `scales` take in the largest of both so
/// far.
fn difference(chain: &Chain, found: &State, exact: &State, scales: &mut (f64, f64)) -> (f64, f64) {
    let (mut overlap, mut speed) = (0.0_f64, 0.0_f64);
    for (j, contact) in chain.contacts().iter().enumerate().filter(|(_, c)| c.stiffness > 0.0) {
        // The width of a gap bears nothing.
        let change =
            |state: &State| chain.overlap_change_in(state, j).max(-contact.static_approach());
        overlap = overlap.max((change(found) - change(exact)).abs());
        scales.0 = scales.0.max(change(exact).abs());
    }
    for (found, exact) in found.velocity.iter().zip(&exact.velocity) {
        speed = speed.max((found - exact).abs());
        scales.1 = scales.1.max(exact.abs());
    }
    (overlap, speed)
}
