//! Fixed steps of a splitting, the same in all lanes.

use std::marker::PhantomData;

use super::lane::first_lost;
use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
use crate::chain::stepper::lanes::WIDTH;
use crate::chain::stepper::layout::Across;
use crate::chain::stepper::parts::Steps;
use crate::chain::stepper::plan::Plan;
use crate::chain::stepper::steps::AT_ONCE;
use crate::chain::stepper::tasks;
use crate::chain::stepper::workspace::Workspace;
use crate::integrate::splitting::{Clock, Splitting};
use crate::integrate::{IntegrateError, Work};

/// A splitting at work.
pub struct Split {
    method: &'static Splitting,
    clock: Clock,
    time: f64,
    end: f64,
    pub last_step: (f64, f64),
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
            last_step: (0.0, 0.0),
            counts: Work { force_evaluations: 1, ..Work::default() },
            failed: vec![None; lanes],
        }
    }

    pub fn is_done(&self) -> bool {
        self.time >= self.end || self.failed.iter().all(Option::is_some)
    }

    /// Takes a step; tells in which lanes.
    pub fn step(
        &mut self,
        set: InstructionSet,
        plan: &Plan,
        work: &mut Workspace,
    ) -> [bool; WIDTH] {
        let (length, next) = self.clock.next(self.time, self.end);
        self.take((set, plan, work), (length, 1), next)
    }

    /// Takes all steps that are left.
    pub fn advance(&mut self, set: InstructionSet, plan: &Plan, work: &mut Workspace) {
        while !self.is_done() {
            let count = self.clock.room(AT_ONCE, self.end);
            if count > 1 {
                let (length, next) = (self.clock.step(), self.clock.go(count));
                self.take((set, plan, work), (length, count), next);
            } else {
                self.step(set, plan, work);
            }
        }
    }

    /// Takes `count` steps of `h` (s), the last of which ends at `next` (s).
    fn take(
        &mut self,
        (set, plan, work): (InstructionSet, &Plan, &mut Workspace),
        (h, count): (f64, u64),
        next: f64,
    ) -> [bool; WIDTH] {
        let steps = Steps { method: self.method, length: h, count };
        let task = tasks::Split::<Across> { plan, work, steps, layout: PhantomData };
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
        (self.time, self.last_step) = (next, (next - h, h));
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
