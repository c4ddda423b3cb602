//! The sequence of methods and tolerances that are attempted until a run is accurate enough, and the tolerance of its reference run.

use std::iter::Peekable;

use super::Integration;
use super::method_choice::{controlled_for, two_step};
use crate::integrate::Method;
use crate::integrate::two_step::LOOSEST_TOLERANCE;
use crate::scene::Scene;

/// Tolerance of the first attempt under error control, in terms of the accuracy asked: most runs are accurate enough then (1).
const FIRST_TOLERANCE_FACTOR: f64 = 10.0;
/// The same where contacts are linear, so that errors do not grow as contacts stiffen: the shipped chain is off by less than 0.4 of the
/// accuracy (1).
const FIRST_TOLERANCE_FACTOR_LINEAR: f64 = 30.0;
/// Largest tolerance of a step (1).
const MAX_TOLERANCE: f64 = 0.01;
/// Each further attempt has its tolerance times this factor, then its square, and so on: most need little more. From the shipped scenes at 1e-3 to
/// 1e-6 (1).
const TIGHTENING: f64 = 0.56;
/// Smallest tolerance of a step: below, rounding would be mistaken for its error (1).
const MIN_TOLERANCE: f64 = 1e-14;
/// Where it is known by how much an attempt's errors are too large, the next one aims at this share of what is allowed (1).
const AIM: f64 = 0.7;
/// Errors that have to shrink below this share are left to error control: steps of two lengths are of order 4 (1).
const MIN_SHARE_OF_TWO_LENGTHS: f64 = 0.1;
/// Most attempts that are made for a known share of an error.
const MAX_AIMED_ATTEMPTS: u8 = 4;
/// Tolerance of the reference run, in terms of the accuracy asked or of the run's own tolerance where that is smaller: so much smaller that both
/// do not err alike (1).
const REFERENCE_FACTOR: f64 = 0.01;
/// Largest tolerance of the reference run: late in rattling chains, traces at 1e-3 and at 1e-5 may be equally far off, and not differ (1).
const MAX_REFERENCE_TOLERANCE: f64 = 1e-6;

/// One attempt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attempt {
    /// The method.
    pub method: Method,
    /// The tolerance that its steps stand for (1).
    pub steps: f64,
}

/// The attempts, one after the other, until readings of `scene` are as accurate as `accuracy` (1): steps of two lengths first where they serve it,
/// error control afterwards.
pub fn attempted_methods(scene: &Scene, accuracy: f64) -> impl Iterator<Item = Attempt> + '_ {
    let (chain, velocities) = (&scene.chain, &*scene.initial_velocities);
    let looser =
        if chain.is_linear() { FIRST_TOLERANCE_FACTOR_LINEAR } else { FIRST_TOLERANCE_FACTOR };
    let first = (looser * accuracy).min(MAX_TOLERANCE).max(accuracy);
    let mut share = 1.0;
    let steps = std::iter::successors(Some(first), move |steps| {
        share *= TIGHTENING;
        Some(share * steps).filter(|next| *next >= MIN_TOLERANCE)
    });
    let two_lengths = [1.0, TIGHTENING].map(|share| {
        let method = two_step(chain, share * accuracy.min(LOOSEST_TOLERANCE))?;
        Some(Attempt { method, steps: share * first })
    });
    let controlled = |steps| Attempt { method: controlled_for(chain, velocities, steps), steps };
    // Steps as loose as the first are tried once.
    let skipped = usize::from(two_lengths[0].is_some());
    two_lengths.into_iter().flatten().chain(steps.map(controlled).skip(skipped))
}

/// The first attempt of `integration`, where it is an accuracy. A recording names it before the work is done; the attempt that was accurate enough
/// stands beside each shot.
pub fn first_attempt(scene: &Scene, integration: Integration) -> Integration {
    let Integration::Accuracy(accuracy) = integration else { return integration };
    let first = attempted_methods(scene, accuracy).next();
    first.map_or(integration, |Attempt { method, .. }| Integration::Attempt { method, accuracy })
}

/// The attempts of a run, with shortcuts where it is known by how much the last one's errors are too large.
pub struct Attempts<'a> {
    scene: &'a Scene,
    accuracy: f64,
    ladder: Peekable<Box<dyn Iterator<Item = Attempt> + 'a>>,
    asked: Option<Attempt>,
    /// How often more may be asked for.
    left: u8,
    /// Steps of a pair that were asked for: the ladder goes on below them (1).
    tightest: f64,
}

impl<'a> Attempts<'a> {
    /// Those of [`attempted_methods`].
    pub fn of(scene: &'a Scene, accuracy: f64) -> Self {
        let ladder: Box<dyn Iterator<Item = Attempt> + 'a> =
            Box::new(attempted_methods(scene, accuracy));
        let (ladder, tightest) = (ladder.peekable(), f64::INFINITY);
        Self { scene, accuracy, ladder, asked: None, left: MAX_AIMED_ATTEMPTS, tightest }
    }

    /// Whether there is nothing tighter.
    pub fn is_over(&mut self) -> bool {
        self.skip_down_to(self.tightest);
        self.asked.is_none() && self.ladder.peek().is_none()
    }

    /// Leaves out steps of the ladder that are no tighter than these (1).
    fn skip_down_to(&mut self, steps: f64) {
        while self.ladder.next_if(|next| next.steps >= steps).is_some() {}
    }

    /// Whether traces that may be off by `trace` (1) after `tried` are known to half of the digits, or it `is_told` from when on they are not; what comes
    /// next is made for what they lack.
    pub fn holds_traces(
        &mut self,
        tried: Attempt,
        trace: Option<f64>,
        is_told: impl FnOnce() -> bool,
    ) -> bool {
        let allowed = self.accuracy.sqrt();
        match trace {
            Some(trace) if trace > allowed && !is_told() => {
                self.tighten(tried, allowed / trace);
                false
            }
            _ => true,
        }
    }

    /// After `tried`, of which errors are to come to this `share` (1): they go about as the tolerance does.
    fn tighten(&mut self, tried: Attempt, share: f64) {
        let share = AIM * share;
        let steps = share * tried.steps;
        let method = match tried.method {
            Method::TwoStepForceGradient { tolerance } if share >= MIN_SHARE_OF_TWO_LENGTHS => {
                Method::TwoStepForceGradient { tolerance: share * tolerance }
            }
            // How far off a pair is is not known yet.
            Method::TwoStepForceGradient { .. } => return,
            _ => controlled_for(&self.scene.chain, &self.scene.initial_velocities, steps),
        };
        // Pairs of another order make less of the same tolerance: what the ladder has next may do, and tells more.
        self.skip_down_to(self.tightest.min(tried.steps));
        let looser = self.ladder.peek().is_some_and(|next| next.steps > steps);
        if self.left > 0 && steps >= MIN_TOLERANCE && (has_two_lengths(method) || !looser) {
            self.left -= 1;
            self.asked = Some(Attempt { method, steps });
        }
    }
}

impl Iterator for Attempts<'_> {
    type Item = Attempt;

    fn next(&mut self) -> Option<Attempt> {
        if let Some(asked) = self.asked.take() {
            if !has_two_lengths(asked.method) {
                self.tightest = asked.steps;
            }
            return Some(asked);
        }
        self.skip_down_to(self.tightest);
        self.ladder.next()
    }
}

/// Whether `method` does not control its error, so that only its result shows whether steps were too long.
pub(super) fn has_two_lengths(method: Method) -> bool {
    matches!(method, Method::TwoStepForceGradient { .. })
}

/// Tolerance of the reference run of one to `accuracy` (1).
pub fn reference_tolerance(accuracy: f64) -> f64 {
    (REFERENCE_FACTOR * accuracy).clamp(MIN_TOLERANCE, MAX_REFERENCE_TOLERANCE)
}

#[cfg(test)]
mod tests {
    use super::{Attempts, attempted_methods};
    use crate::scene::Scene;

    /// Whatever is asked for in between, steps get tighter, come to an end, and there is one after each that is not the last.
    #[test]
    fn tries_get_tighter_and_come_to_an_end() {
        for name in ["magnet-0.61g", "linear-300-cells", "gravity-2.75g"] {
            let scene = Scene::load(name).unwrap();
            for accuracy in [1e-3, 1e-6, 1e-11] {
                for share in [1e-9, 0.01, 0.3, 0.99] {
                    let mut tries = Attempts::of(&scene, accuracy);
                    let mut count = 0;
                    let mut pairs = f64::INFINITY;
                    while !tries.is_over() {
                        let found = tries.next().unwrap();
                        if !super::has_two_lengths(found.method) {
                            assert!(found.steps < pairs, "{name}: {found:?} after {pairs:e}");
                            pairs = found.steps;
                        }
                        tries.tighten(found, share);
                        count += 1;
                    }
                    assert!(tries.next().is_none());
                    let most = attempted_methods(&scene, accuracy).count() + 4;
                    assert!((1..=most).contains(&count), "{name}: {count}");
                }
            }
        }
    }
}
