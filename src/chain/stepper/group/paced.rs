//! Paced steps of a splitting, each lane's of its own length.

use std::marker::PhantomData;

use super::Member;
use super::lane::first_lost;
use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::layout::Across;
use crate::chain::stepper::notes::Notes;
use crate::chain::stepper::pacer::Pacer;
use crate::chain::stepper::parts::Steps;
use crate::chain::stepper::plan::Plan;
use crate::chain::stepper::split_tasks;
use crate::chain::stepper::workspace::{Motion, Workspace};
use crate::integrate::splitting::Splitting;
use crate::integrate::{IntegrateError, Work};

/// One chain of a group in paced steps.
#[derive(Debug, Clone)]
struct Lane {
    pacer: Pacer,
    time: f64,
    end: f64,
    last_step: (f64, f64),
    counts: Work,
    /// Why it stopped, if it did.
    failed: Option<IntegrateError>,
}

impl Lane {
    fn is_moving(&self) -> bool {
        self.time < self.end && self.failed.is_none()
    }
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
            Lane {
                pacer: Pacer::new(&pacing, tolerance, now, |body| (body, lane)),
                time: 0.0,
                end: member.duration,
                last_step: (0.0, 0.0),
                counts: Work { force_evaluations: 1, ..Work::default() },
                failed: None,
            }
        };
        Self { method, lanes: members.iter().enumerate().map(lane).collect() }
    }

    pub fn is_done(&self) -> bool {
        self.lanes.iter().all(|lane| !lane.is_moving())
    }

    /// Starts and lengths of the steps taken last (s).
    pub fn last_steps(&self) -> impl Iterator<Item = (f64, f64)> {
        self.lanes.iter().map(|lane| lane.last_step)
    }

    /// Takes a step in every lane that is still moving; tells which.
    pub fn step(
        &mut self,
        (set, plan, work): (InstructionSet, &Plan, &mut Workspace),
    ) -> [bool; WIDTH] {
        let (mut length, mut ends) = (Row::default(), [0.0; WIDTH]);
        for (index, lane) in self.lanes.iter().enumerate().filter(|(_, lane)| lane.is_moving()) {
            // Others stand.
            (length.0[index], ends[index]) = lane.pacer.beat.next(lane.time, lane.end);
        }
        let notes = &mut Notes::default();
        let steps = Steps { method: self.method, length: &length, count: 1, notes };
        let task = split_tasks::Split::<Across> { plan, work, steps, layout: PhantomData };
        let finite = dispatch(set, task);
        work.turn();
        let mut taken = [false; WIDTH];
        for (index, lane) in self.lanes.iter_mut().enumerate() {
            if !lane.is_moving() {
                continue;
            }
            if finite & (1 << index) == 0 {
                let (body, time) = (first_lost(&work.now, index), lane.time);
                lane.failed = Some(IntegrateError::NotFinite { body, time });
                continue;
            }
            let h = length.0[index];
            lane.pacer.pass(&work.now);
            lane.last_step = (lane.time, h);
            lane.time = ends[index];
            lane.counts.steps += 1;
            lane.counts.force_evaluations += self.method.drifts.len() as u64;
            taken[index] = true;
        }
        taken
    }

    /// What lane `index` has cost, or why it failed.
    pub fn outcome(&self, index: usize) -> Result<Work, IntegrateError> {
        match self.lanes.get(index) {
            Some(Lane { failed: Some(error), .. }) => Err(error.clone()),
            Some(lane) => Ok(lane.counts),
            None => Ok(Work::default()),
        }
    }
}
