//! Fixed steps of a splitting, the same in all lanes.

use std::marker::PhantomData;

use super::lane::first_lost;
use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::layout::Across;
use crate::chain::stepper::notes::Notes;
use crate::chain::stepper::parts::Steps;
use crate::chain::stepper::plan::Plan;
use crate::chain::stepper::split_tasks;
use crate::chain::stepper::workspace::Workspace;
use crate::integrate::splitting::{Clock, Splitting};
use crate::integrate::{IntegrateError, Work};

/// A splitting at work.
pub struct Split {
    method: &'static Splitting,
    clock: Clock,
    time: f64,
    end: f64,
    /// Length of the step taken last (s).
    length: f64,
    counts: Work,
    /// Why each lane stopped, if it did.
    failed: Vec<Option<IntegrateError>>,
}

impl Split {
    /// Steps of `step` up to `end` (s) in `lanes` lanes.
    pub fn new(method: &'static Splitting, (step, end): (f64, f64), lanes: usize) -> Self {
        Self {
            method,
            clock: Clock::new(method, step, 0.0),
            time: 0.0,
            end,
            length: 0.0,
            counts: Work { force_evaluations: 1, ..Work::default() },
            failed: vec![None; lanes],
        }
    }

    pub fn is_done(&self) -> bool {
        self.time >= self.end || self.failed.iter().all(Option::is_some)
    }

    /// Takes up to `most` steps at once, of which `notes` are kept; tells how many, and in which lanes.
    pub fn step(
        &mut self,
        (set, plan, work): (InstructionSet, &Plan, &mut Workspace),
        most: usize,
        notes: &mut Notes,
    ) -> (usize, [bool; WIDTH]) {
        let count = self.clock.room(most as u64, self.end).max(1);
        let (length, next) = if count > 1 {
            (self.clock.step(), self.clock.go(count))
        } else {
            self.clock.next(self.time, self.end)
        };
        let taken = self.take((set, plan, work), (length, count, notes), next);
        (usize::try_from(count).unwrap_or(most), taken)
    }

    /// Start and length of the step that was `before` the last, and taken at once with it (s).
    pub fn last_step(&self, before: usize) -> (f64, f64) {
        let end = if before > 0 { self.clock.before(before as u64) } else { self.time };
        (end - self.length, self.length)
    }

    /// Takes `count` steps of `h` (s), the last of which ends at `next` (s).
    fn take(
        &mut self,
        (set, plan, work): (InstructionSet, &Plan, &mut Workspace),
        (h, count, notes): (f64, u64, &mut Notes),
        next: f64,
    ) -> [bool; WIDTH] {
        let (method, length) = (self.method, &Row([h; WIDTH]));
        let steps = Steps { method, length, count, notes, keeps_start: true };
        let task = split_tasks::Split::<Across> { plan, work, steps, layout: PhantomData };
        let finite = dispatch(set, task);
        work.turn();
        let mut taken = [false; WIDTH];
        for (lane, failed) in self.failed.iter_mut().enumerate() {
            if finite & (1 << lane) == 0 && failed.is_none() {
                let (body, time) = (first_lost(&work.now, lane), self.time);
                *failed = Some(IntegrateError::NotFinite { body, time });
            }
            taken[lane] = failed.is_none();
        }
        (self.time, self.length) = (next, h);
        self.counts.steps += count;
        self.counts.force_evaluations += count * self.method.drifts.len() as u64;
        taken
    }

    /// What lane `lane` has cost, or why it failed.
    pub fn outcome(&self, lane: usize) -> Result<Work, IntegrateError> {
        match self.failed.get(lane) {
            Some(Some(error)) => Err(error.clone()),
            Some(None) => Ok(self.counts),
            None => Ok(Work::default()),
        }
    }
}
