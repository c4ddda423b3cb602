//! Paced steps of a splitting.

use std::marker::PhantomData;

use super::burst::{Burst, Taken};
use super::{Course, Laid};
use crate::chain::Chain;
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::layout::Tiled;
use crate::chain::stepper::notes::{Notes, Times};
use crate::chain::stepper::pacer::Pacer;
use crate::chain::stepper::parts::Steps;
use crate::chain::stepper::split_tasks::{self, Close, InPace};
use crate::chain::stepper::timing::{Going, Paced};
use crate::integrate::IntegrateError;
use crate::integrate::splitting::Splitting;

/// A splitting at work, in paced steps.
pub struct InSteps {
    method: &'static Splitting,
    pacer: Pacer,
    /// Which contacts are closed, a bit each of a row.
    closed: Vec<u8>,
    /// Steps in which contacts changed sides.
    pub events: u64,
    times: Times,
}

impl InSteps {
    /// The steps that `tolerance` (1) asks of `chain`, let go with these velocities (m/s), from where `course` is.
    pub fn new(
        method: &'static Splitting,
        tolerance: f64,
        (chain, velocities): (&Chain, &[f64]),
        course: &Course,
    ) -> Self {
        let pacing = chain.pacing(velocities);
        let pacer = Pacer::new(&pacing, tolerance, &course.work.now, |body| course.place(body));
        Self {
            method,
            pacer,
            closed: course.work.now.closed.clone(),
            events: 0,
            times: Times::default(),
        }
    }

    /// Start, length and end of the step that was `before` the last and taken at once with it (s).
    pub fn times(&self, before: usize) -> [f64; 3] {
        self.times.before(before)
    }

    /// Takes steps at once, at least one.
    pub fn take(
        &mut self,
        course: &mut Course,
        burst: &mut Burst,
    ) -> Result<Taken, IntegrateError> {
        let Burst { end, pause, most, notes } = burst;
        let going = &mut Going::new(&self.pacer.beat, course.time, [*end, *pause], *most);
        let Course { set, laid, plan, work, .. } = course;
        let Self { method, pacer, closed, events, times } = self;
        let finite = match laid {
            Laid::Striped => {
                let noted = &mut Default::default();
                let paced = Paced { method, pacer, closed, noted, going, times, notes };
                dispatch(*set, InPace { plan, work, paced })
            }
            Laid::Tiled | Laid::Along => {
                let notes = &mut Notes::default();
                let length = &Row([going.step[0]; WIDTH]);
                let steps = Steps { method, length, count: 1, notes, keeps_start: false };
                let task = split_tasks::Split::<Tiled> { plan, work, steps, layout: PhantomData };
                let finite = dispatch(*set, task);
                pacer.pass(&work.next);
                let position = work.next.position();
                let close = Close::<Tiled> { plan, position, closed, layout: PhantomData };
                going.pass(times);
                going.events = u64::from(dispatch(*set, close));
                finite
            }
        };
        *events += going.events;
        let [length, start, next] = going.step;
        course.counts.steps += going.taken;
        course.counts.force_evaluations += going.taken * self.method.drifts.len() as u64;
        if finite == 0 {
            let (body, time) = (course.first_lost(), course.time);
            return Err(IntegrateError::NotFinite { body, time });
        }
        course.work.turn();
        course.time = next;
        Ok(Taken { count: going.taken, last: (start, length) })
    }
}
