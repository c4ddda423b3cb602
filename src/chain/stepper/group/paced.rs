//! Paced steps of a splitting, each lane's of its own length.

use std::marker::PhantomData;

use super::Member;
use super::lane::first_lost;
use super::progress::Progress;
use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::layout::Across;
use crate::chain::stepper::notes::Notes;
use crate::chain::stepper::pacer::Pacer;
use crate::chain::stepper::parts::Steps;
use crate::chain::stepper::plan::Plan;
use crate::chain::stepper::split_tasks;
use crate::chain::stepper::workspace::{Motion, Workspace};
use crate::integrate::IntegrateError;
use crate::integrate::splitting::Splitting;

/// One chain of a group in paced steps.
#[derive(Debug, Clone)]
struct Lane {
    pacer: Pacer,
    progress: Progress,
}

/// A splitting at work, in paced steps.
pub struct InSteps {
    method: &'static Splitting,
    lanes: Vec<Lane>,
}

impl InSteps {
    /// The steps that `tolerance` (1) asks of each of `members`, which move as `now`.
    pub fn new(
        method: &'static Splitting,
        tolerance: f64,
        members: &[Member<'_>],
        now: &Motion,
    ) -> Self {
        let lane = |(lane, member): (usize, &Member<'_>)| {
            let pacing = member.chain.pacing(member.velocities);
            let pacer = Pacer::new(&pacing, tolerance, now, |body| (body, lane));
            Lane { pacer, progress: Progress::new(member) }
        };
        Self { method, lanes: members.iter().enumerate().map(lane).collect() }
    }

    /// How far lane `index` is.
    pub fn progress(&self, index: usize) -> Option<&Progress> {
        self.lanes.get(index).map(|lane| &lane.progress)
    }

    /// Takes a step in every lane that is still moving; tells which.
    pub fn step(
        &mut self,
        (set, plan, work): (InstructionSet, &Plan, &mut Workspace),
    ) -> [bool; WIDTH] {
        let (mut length, mut ends) = (Row::default(), [0.0; WIDTH]);
        for (index, Lane { pacer, progress }) in self.lanes.iter().enumerate() {
            // Others stand.
            if progress.is_moving() {
                (length.0[index], ends[index]) = pacer.beat.next(progress.time, progress.end);
            }
        }
        let notes = &mut Notes::default();
        let steps = Steps { method: self.method, length: &length, count: 1, notes };
        let task = split_tasks::Split::<Across> { plan, work, steps, layout: PhantomData };
        let finite = dispatch(set, task);
        work.turn();
        let mut taken = [false; WIDTH];
        for (index, Lane { pacer, progress }) in self.lanes.iter_mut().enumerate() {
            if !progress.is_moving() {
                continue;
            }
            if finite & (1 << index) == 0 {
                let (body, time) = (first_lost(&work.now, index), progress.time);
                progress.failed = Some(IntegrateError::NotFinite { body, time });
                continue;
            }
            pacer.pass(&work.now);
            progress.pass(length.0[index], ends[index]);
            progress.counts.force_evaluations += self.method.drifts.len() as u64;
            taken[index] = true;
        }
        taken
    }
}
