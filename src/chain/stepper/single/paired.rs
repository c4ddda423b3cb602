//! Steps of a Runge-Kutta-Nystrom pair, with error control.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::Course;
use super::burst::{Burst, Taken};
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::foresight::{MOST_SHORTENED, Watch};
use crate::chain::stepper::kinks;
use crate::chain::stepper::lanes::{Lanes, Task};
use crate::chain::stepper::layout::Along;
use crate::chain::stepper::notes::Times;
use crate::chain::stepper::passes::Sides;
use crate::chain::stepper::steps::{UNMOVED, control, worth};
use crate::chain::stepper::tasks::{Attempt, Correct, Evaluate};
use crate::integrate::IntegrateError;
use crate::integrate::Pair;
use crate::integrate::control::{StepControl, Trial};

/// A pair at work.
pub struct Paired {
    pair: Pair,
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
    /// Whether what contacts will do is foreseen.
    watch: Watch,
    times: Times,
}

impl Paired {
    /// With errors of `tolerance` a step (1) relative to `scales` of overlap (m) and speed (m/s); `lightest` is the smallest mass (kg).
    pub fn new(
        (pair, tolerance): (Pair, f64),
        scales: (f64, f64),
        lightest: f64,
        watched: bool,
    ) -> Self {
        let (control, watch) = (control(scales, pair, watched), Watch::new());
        let (events, corrects, times) = (0, true, Times::default());
        Self { pair, control, tolerance, scales, lightest, events, corrects, watch, times }
    }

    /// Takes steps at once, at least one.
    pub fn take(
        &mut self,
        course: &mut Course,
        burst: &mut Burst,
    ) -> Result<Taken, IntegrateError> {
        dispatch(course.set, Steps { paired: self, course, burst })
    }

    /// Start, length and end of the step that was `before` the last (s).
    pub fn times(&self, before: usize) -> [f64; 3] {
        self.times.before(before)
    }

    /// As much of `trial` as is worth a try.
    #[inline(always)]
    fn foresee(&mut self, course: &Course, mut trial: Trial) -> Trial {
        let Course { plan, work, time, .. } = course;
        let [_, worth] = worth(self.tolerance, self.scales);
        for _ in 0..MOST_SHORTENED {
            let step = (trial.length, worth);
            let shares = plan.watched.iter().filter_map(|w| w.shorter(plan, &work.now, step));
            let Some(share) = shares.reduce(f64::min) else { break };
            trial = trial.shortened(*time, share);
            self.watch.renew();
        }
        trial
    }

    /// Tries a step of `h` (s) and returns its error as a multiple of the tolerance (1).
    #[inline(always)]
    fn attempt<L: Lanes>(&mut self, course: &mut Course, h: f64) -> f64 {
        let (pair, worth) = (self.pair, worth(self.tolerance, self.scales));
        let Course { plan, work, counts, .. } = course;
        counts.force_evaluations += pair.evaluations() as u64;
        let sides = Attempt::<Along> { plan, pair, work, step: h, worth }.run::<L>();
        if sides.any() && self.corrects {
            self.correct::<L>(course, (h, worth), sides);
        }
        course.work.error(0)
    }

    /// Corrects a step of `h` (s) that was tried; an error of 1 m or 1 m/s is `worth` so many tolerated ones.
    #[inline(always)]
    fn correct<L: Lanes>(
        &mut self,
        course: &mut Course,
        (h, worth): (f64, [f64; 2]),
        sides: Sides,
    ) {
        let Course { plan, work, counts, .. } = course;
        let attempt = Attempt::<Along> { plan, pair: self.pair, work, step: h, worth };
        let slack = kinks::slack(self.tolerance, self.scales, self.lightest);
        // Apart from the loops that every step goes through, which are the quicker for it.
        let corrected = L::apart(Correct { attempt, sides, slack });
        if !corrected || work.error(0) > 1.0 {
            return;
        }
        self.events += 1;
        if work.largest.moved.0[0] > UNMOVED * self.tolerance * self.scales.0 {
            work.largest.overlap = L::apart(Evaluate::<Along>::at(plan, &mut work.next));
            counts.force_evaluations += 1;
        }
    }
}

/// Steps with all that decides on them: nothing leaves the registers that the next step waits for.
struct Steps<'a, 'b> {
    paired: &'a mut Paired,
    course: &'a mut Course,
    burst: &'a mut Burst<'b>,
}

impl Task for Steps<'_, '_> {
    type Output = Result<Taken, IntegrateError>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { paired, course, burst } = self;
        let Burst { end, pause, most, .. } = *burst;
        let mut taken = Taken { count: 0, last: (course.time, 0.0) };
        loop {
            let mut trial = match paired.control.trial(course.time, end) {
                // Steps that are taken count; asked again, the control says the same.
                Err(_) if taken.count > 0 => return Ok(taken),
                trial => trial?,
            };
            if paired.watch.is_on() && paired.corrects && !course.plan.watched.is_empty() {
                trial = paired.foresee(course, trial);
            }
            let error = paired.attempt::<L>(course, trial.length);
            if !paired.control.accepts(trial, error, || course.first_lost()) {
                course.counts.rejected += 1;
                paired.watch.renew();
                continue;
            }
            course.work.turn();
            let start = std::mem::replace(&mut course.time, trial.next);
            course.counts.steps += 1;
            paired.watch.pass();
            let largest = &course.work.largest;
            paired.scales.0 = paired.scales.0.max(largest.overlap.0[0]);
            paired.scales.1 = paired.scales.1.max(largest.speed.0[0]);
            burst.notes.keep(course.work.now.moving());
            paired.times.keep([start, trial.length, trial.next]);
            taken = Taken { count: taken.count + 1, last: (start, trial.length) };
            if taken.count >= most || course.time >= end.min(pause) {
                return Ok(taken);
            }
        }
    }
}
