//! Fixed steps of a splitting.

use std::marker::PhantomData;

use super::{Course, Laid};
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::layout::{Striped, Tiled};
use crate::chain::stepper::notes::Notes;
use crate::chain::stepper::parts::Steps;
use crate::chain::stepper::split_tasks;
use crate::chain::stepper::steps::AT_ONCE;
use crate::integrate::IntegrateError;
use crate::integrate::splitting::{Clock, Splitting};

/// A splitting at work.
pub struct Split {
    method: &'static Splitting,
    clock: Clock,
}

impl Split {
    /// Steps of `step` from `time` on (s).
    pub fn new(method: &'static Splitting, step: f64, time: f64) -> Self {
        Self { method, clock: Clock::new(method, step, time) }
    }

    /// Takes a step, not beyond `end` (s); returns its length (s).
    pub fn step(&mut self, course: &mut Course, end: f64) -> Result<f64, IntegrateError> {
        let (h, next) = self.clock.next(course.time, end);
        self.take(course, (h, 1))?;
        course.time = next;
        Ok(h)
    }

    /// Takes up to [`AT_ONCE`] whole steps, none of which reaches `end` (s), if all rows are under way; start and length of the last (s).
    pub fn several(
        &mut self,
        course: &mut Course,
        end: f64,
    ) -> Result<Option<(f64, f64)>, IntegrateError> {
        if !course.is_all_under_way() {
            return Ok(None);
        }
        let count = self.clock.room(AT_ONCE, end);
        if count == 0 {
            return Ok(None);
        }
        self.take(course, (self.clock.step(), count))?;
        course.time = self.clock.go(count);
        let length = self.clock.step();
        Ok(Some((course.time - length, length)))
    }

    /// Takes `count` steps of `h` (s).
    fn take(&self, course: &mut Course, (h, count): (f64, u64)) -> Result<(), IntegrateError> {
        let Course { set, laid, plan, work, counts, .. } = course;
        let notes = &mut Notes::default();
        let steps = Steps { method: self.method, length: &Row([h; WIDTH]), count, notes };
        let finite = match laid {
            Laid::Striped => dispatch(
                *set,
                split_tasks::Split::<Striped> { plan, work, steps, layout: PhantomData },
            ),
            Laid::Tiled | Laid::Along => dispatch(
                *set,
                split_tasks::Split::<Tiled> { plan, work, steps, layout: PhantomData },
            ),
        };
        counts.steps += count;
        counts.force_evaluations += count * self.method.drifts.len() as u64;
        if finite == 0 {
            let (body, time) = (course.first_lost(), course.time);
            return Err(IntegrateError::NotFinite { body, time });
        }
        course.work.turn();
        Ok(())
    }
}
