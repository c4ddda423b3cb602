//! What is tried to reach an accuracy, one after the other, and what runs are held against.

use super::Integration;
use super::losses::{controlled_for, paced_for};
use crate::integrate::Method;
use crate::integrate::pace::LOOSEST;
use crate::scene::Scene;

/// Steps that are not paced are first held to so many times the accuracy asked for: most runs are accurate enough then, and each is held against a
/// tighter one anyway (1).
const LOOSER: f64 = 10.0;
/// The same where contacts are linear: errors do not steepen there, and the shipped chain is off by less than 0.4 of the accuracy
/// (`cargo bench --bench accuracy`) (1).
const LOOSER_LINEAR: f64 = 30.0;
/// Steps are held to no more than this (1).
const LOOSEST_STEPS: f64 = 0.01;
/// A run that is not accurate enough is taken again to this share of its accuracy, to the square of it after the next, and so on: most need
/// but little more, and what needs much more comes there soon. By the shipped scenes from 1e-3 to 1e-6 (1).
const NEXT: f64 = 0.56;
/// Steps are held to no less than this: rounding would be mistaken for their error (1).
const TIGHTEST_STEPS: f64 = 1e-14;
/// Accuracy of the run that a run is held against, in terms of the one asked for, or of its own steps where they are held to less: so
/// much tighter that they do not err the same way (1).
const TIGHTER: f64 = 0.01;
/// It is no more than this: late in rattling chains, where whole bounces are missed or not, traces at 1e-3 and at 1e-5 may be equally far off, and
/// not off each other (1).
const LOOSEST_SECOND: f64 = 1e-6;

/// A method that is tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tried {
    /// The method.
    pub method: Method,
    /// What its steps are held to (1).
    pub steps: f64,
}

/// What is tried, one after the other, until readings of `scene` are as accurate as `accuracy` (1): paced steps first where they serve it, and
/// ones of a pair afterwards.
pub fn methods_tried(scene: &Scene, accuracy: f64) -> impl Iterator<Item = Tried> + '_ {
    let (chain, velocities) = (&scene.chain, &*scene.initial_velocities);
    let looser = if chain.is_linear() { LOOSER_LINEAR } else { LOOSER };
    let first = (looser * accuracy).min(LOOSEST_STEPS).max(accuracy);
    let mut share = 1.0;
    let steps = std::iter::successors(Some(first), move |steps| {
        share *= NEXT;
        Some(share * steps).filter(|next| *next >= TIGHTEST_STEPS)
    });
    let paced = [1.0, NEXT].map(|share| {
        let method = paced_for(chain, velocities, share * accuracy.min(LOOSEST))?;
        Some(Tried { method, steps: share * first })
    });
    let controlled = |steps| Tried { method: controlled_for(chain, velocities, steps), steps };
    // Steps as loose as the first are tried once.
    let skipped = usize::from(paced[0].is_some());
    paced.into_iter().flatten().chain(steps.map(controlled).skip(skipped))
}

/// What is tried first of what may come of `integration`, where runs are held to an accuracy. A recording names it before the work is done; what has been
/// done instead, if it was not enough, stands beside each shot.
pub fn first_tried(scene: &Scene, integration: Integration) -> Integration {
    let Integration::Accuracy(accuracy) = integration else { return integration };
    let first = methods_tried(scene, accuracy).next();
    first.map_or(integration, |Tried { method, .. }| Integration::Tried { method, accuracy })
}

/// Whether nothing but what comes of them tells that steps of `method` were too long.
pub(super) fn paces(method: Method) -> bool {
    matches!(method, Method::PacedForceGradient { .. })
}

/// Accuracy of the run that one to `accuracy` is held against (1).
#[must_use]
pub fn tighter(accuracy: f64) -> f64 {
    (TIGHTER * accuracy).clamp(TIGHTEST_STEPS, LOOSEST_SECOND)
}
