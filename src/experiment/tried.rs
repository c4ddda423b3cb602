//! What is tried to reach an accuracy, one after the other, and what runs are held against.

use std::iter::Peekable;

use super::Integration;
use super::losses::{controlled_for, paced};
use crate::integrate::Method;
use crate::integrate::two_step::LOOSEST_TOLERANCE;
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
/// Share of the error that is allowed that tighter steps are made for, so that they need not be tightened again (1).
const ENOUGH: f64 = 0.7;
/// Errors of less than this share are left to a pair: paced steps are of order 4 (1).
const PACED_SHARE: f64 = 0.1;
/// How often steps are made for a share of an error.
const ASKED: u8 = 4;
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
        let method = paced(chain, share * accuracy.min(LOOSEST_TOLERANCE))?;
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

/// What is tried, and sooner what will do where it is known how much is lacking.
pub struct Tries<'a> {
    scene: &'a Scene,
    accuracy: f64,
    ladder: Peekable<Box<dyn Iterator<Item = Tried> + 'a>>,
    asked: Option<Tried>,
    /// How often more may be asked for.
    left: u8,
    /// Steps of a pair that were asked for: the ladder goes on below them (1).
    tightest: f64,
}

impl<'a> Tries<'a> {
    /// Those of [`methods_tried`].
    pub fn of(scene: &'a Scene, accuracy: f64) -> Self {
        let ladder: Box<dyn Iterator<Item = Tried> + 'a> = Box::new(methods_tried(scene, accuracy));
        let (ladder, tightest) = (ladder.peekable(), f64::INFINITY);
        Self { scene, accuracy, ladder, asked: None, left: ASKED, tightest }
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
        tried: Tried,
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
    fn tighten(&mut self, tried: Tried, share: f64) {
        let share = ENOUGH * share;
        let steps = share * tried.steps;
        let method = match tried.method {
            Method::TwoStepForceGradient { tolerance } if share >= PACED_SHARE => {
                Method::TwoStepForceGradient { tolerance: share * tolerance }
            }
            // How far off a pair is is not known yet.
            Method::TwoStepForceGradient { .. } => return,
            _ => controlled_for(&self.scene.chain, &self.scene.initial_velocities, steps),
        };
        // Pairs of another order make less of the same tolerance: what the ladder has next may do, and tells more.
        self.skip_down_to(self.tightest.min(tried.steps));
        let looser = self.ladder.peek().is_some_and(|next| next.steps > steps);
        if self.left > 0 && steps >= TIGHTEST_STEPS && (paces(method) || !looser) {
            self.left -= 1;
            self.asked = Some(Tried { method, steps });
        }
    }
}

impl Iterator for Tries<'_> {
    type Item = Tried;

    fn next(&mut self) -> Option<Tried> {
        if let Some(asked) = self.asked.take() {
            if !paces(asked.method) {
                self.tightest = asked.steps;
            }
            return Some(asked);
        }
        self.skip_down_to(self.tightest);
        self.ladder.next()
    }
}

/// Whether nothing but what comes of them tells that steps of `method` were too long.
pub(super) fn paces(method: Method) -> bool {
    matches!(method, Method::TwoStepForceGradient { .. })
}

/// Accuracy of the run that one to `accuracy` is held against (1).
pub fn tighter(accuracy: f64) -> f64 {
    (TIGHTER * accuracy).clamp(TIGHTEST_STEPS, LOOSEST_SECOND)
}

#[cfg(test)]
mod tests {
    use super::{Tries, methods_tried};
    use crate::scene::Scene;

    /// Whatever is asked for in between, steps get tighter, come to an end, and there is one after each that is not the last.
    #[test]
    fn tries_get_tighter_and_come_to_an_end() {
        for name in ["magnet-0.61g", "linear-300-cells", "gravity-2.75g"] {
            let scene = Scene::load(name).unwrap();
            for accuracy in [1e-3, 1e-6, 1e-11] {
                for share in [1e-9, 0.01, 0.3, 0.99] {
                    let mut tries = Tries::of(&scene, accuracy);
                    let mut count = 0;
                    let mut pairs = f64::INFINITY;
                    while !tries.is_over() {
                        let found = tries.next().unwrap();
                        if !super::paces(found.method) {
                            assert!(found.steps < pairs, "{name}: {found:?} after {pairs:e}");
                            pairs = found.steps;
                        }
                        tries.tighten(found, share);
                        count += 1;
                    }
                    assert!(tries.next().is_none());
                    let most = methods_tried(&scene, accuracy).count() + 4;
                    assert!((1..=most).contains(&count), "{name}: {count}");
                }
            }
        }
    }
}
