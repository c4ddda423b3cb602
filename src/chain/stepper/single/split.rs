//! Fixed steps of a splitting.

use std::marker::PhantomData;

use super::burst::{Burst, Taken};
use super::{Course, Laid};
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::layout::{Striped, Tiled};
use crate::chain::stepper::notes::Notes;
use crate::chain::stepper::parts::Steps;
use crate::chain::stepper::split_tasks;
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
        self.take(course, (h, 1), &mut Notes::default())?;
        course.time = next;
        Ok(h)
    }

    /// Takes whole steps at once, none of which reaches the end or the pause, if there are any.
    pub fn several(
        &mut self,
        course: &mut Course,
        burst: &mut Burst,
    ) -> Result<Option<Taken>, IntegrateError> {
        let count = self.clock.room(burst.most, burst.end.min(burst.pause));
        if count == 0 {
            return Ok(None);
        }
        self.take(course, (self.clock.step(), count), burst.notes)?;
        course.time = self.clock.go(count);
        let [start, length, _] = self.times(0);
        Ok(Some(Taken { count, last: (start, length) }))
    }

    /// Start, length and end of the whole step that was `before` the last, and taken at once with it (s).
    pub fn times(&self, before: usize) -> [f64; 3] {
        let before = before as u64;
        [self.clock.before(before + 1), self.clock.step(), self.clock.before(before)]
    }

    /// Takes `count` steps of `h` (s), of which `notes` are kept.
    fn take(
        &self,
        course: &mut Course,
        (h, count): (f64, u64),
        notes: &mut Notes,
    ) -> Result<(), IntegrateError> {
        let Course { set, laid, plan, work, counts, .. } = course;
        let (method, length) = (self.method, &Row([h; WIDTH]));
        let steps = Steps { method, length, count, notes, keeps_start: false };
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
