//! Steps of a Runge-Kutta-Nystrom pair, with error control.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;

use super::{Course, first_lost};
use crate::chain::stepper::dispatch::{Task, dispatch};
use crate::chain::stepper::kinks;
use crate::chain::stepper::lanes::Lanes;
use crate::chain::stepper::plan::Along;
use crate::chain::stepper::quadrature::Quadrature;
use crate::chain::stepper::steps::{UNMOVED, control, worth};
use crate::chain::stepper::tasks::{Attempt, Evaluate};
use crate::integrate::IntegrateError;
use crate::integrate::Pair;
use crate::integrate::control::StepControl;

/// A pair at work.
pub struct Paired {
    pair: Pair,
    quadrature: Quadrature,
    control: StepControl,
    tolerance: f64,
    /// Largest overlap change (m) and speed (m/s) so far: what errors are relative to.
    scales: (f64, f64),
    /// Smallest mass (kg).
    lightest: f64,
    /// Steps tried in which contacts changed sides.
    pub events: u64,
    /// Whether kinks are corrected.
    pub corrects: bool,
}

impl Paired {
    /// With errors of `tolerance` a step (1) relative to `scales` of overlap (m) and speed (m/s); `lightest` is the smallest mass (kg).
    pub fn new(pair: Pair, tolerance: f64, scales: (f64, f64), lightest: f64) -> Self {
        let (quadrature, control) = (Quadrature::of(pair.coefficients()), control(scales, pair));
        let (events, corrects) = (0, true);
        Self { pair, quadrature, control, tolerance, scales, lightest, events, corrects }
    }

    /// Takes a step, not beyond `end` (s); returns its length (s).
    pub fn step(&mut self, course: &mut Course, end: f64) -> Result<f64, IntegrateError> {
        dispatch(course.set, Step { paired: self, course, end })
    }

    /// Tries a step of `h` (s) and returns its error as a multiple of the tolerance (1).
    #[inline(always)]
    fn attempt<L: Lanes>(&mut self, course: &mut Course, h: f64) -> f64 {
        let Self { pair, quadrature, .. } = self;
        let Course { plan, work, counts, .. } = course;
        // Without corrections no impulse is worth one.
        let tolerance = if self.corrects { self.tolerance } else { f64::INFINITY };
        let slack = kinks::slack(tolerance, self.scales, self.lightest);
        let worth = worth(self.tolerance, self.scales);
        let layout = PhantomData;
        let pair = *pair;
        let task = Attempt::<Along> { plan, pair, quadrature, work, step: h, worth, slack, layout };
        let guard = task.run::<L>();
        counts.force_evaluations += pair.evaluations() as u64;
        let error = work.error(0);
        if let Some(guard) = guard.filter(|_| error <= 1.0) {
            self.events += 1;
            let moved = guard.moved.0.into_iter().fold(0.0, f64::max);
            if moved > UNMOVED * self.tolerance * self.scales.0 {
                evaluate_end(course);
            }
        }
        error
    }
}

/// A step with all that decides on it: nothing leaves the registers that the next step waits for.
struct Step<'a> {
    paired: &'a mut Paired,
    course: &'a mut Course,
    end: f64,
}

impl Task for Step<'_> {
    type Output = Result<f64, IntegrateError>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { paired, course, end } = self;
        loop {
            let trial = paired.control.trial(course.time, end)?;
            let error = paired.attempt::<L>(course, trial.length);
            let work = &mut course.work;
            let culprit = || first_lost(&work.next.position, &work.next.velocity);
            if !paired.control.accepts(trial, error, culprit) {
                course.counts.rejected += 1;
                continue;
            }
            work.turn();
            course.time = trial.next;
            course.counts.steps += 1;
            let largest = &work.largest;
            paired.scales.0 = paired.scales.0.max(largest.overlap.0[0]);
            paired.scales.1 = paired.scales.1.max(largest.speed.0[0]);
            return Ok(trial.length);
        }
    }
}

/// Forces and accelerations where the step ended, after a correction.
fn evaluate_end(course: &mut Course) {
    let Course { set, plan, work, counts, .. } = course;
    work.largest.overlap = dispatch(*set, Evaluate::<Along>::at(plan, &mut work.next));
    counts.force_evaluations += 1;
}
