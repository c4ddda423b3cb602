//! Eight chains side by side, one in each lane, each with a step of its own.
//!
//! Lanes never see each other: a chain's results are the same to the last bit whatever its neighbours are.

use std::marker::PhantomData;

use super::dispatch::{InstructionSet, dispatch};
use super::force_track::View;
use super::frame::{Ends, Look};
use super::kinks;
use super::lanes::{Row, WIDTH};
use super::plan::{Across, Form, Plan};
use super::quadrature::Quadrature;
use super::steps::{UNMOVED, control, worth as worth_of};
use super::tasks::{Attempt, Evaluate, Jerks, Settle};
use super::workspace::{Motion, Workspace};
use crate::chain::Chain;
use crate::integrate::control::{StepControl, Trial};
use crate::integrate::nystrom::NystromPair;
use crate::integrate::{IntegrateError, Work};

/// One chain of a group.
#[derive(Debug, Clone)]
struct Lane {
    control: StepControl,
    /// Largest overlap change (m) and speed (m/s) so far: what errors are relative to.
    scales: (f64, f64),
    /// Smallest mass (kg).
    lightest: f64,
    time: f64,
    end: f64,
    last_step: (f64, f64),
    counts: Work,
    /// Why it stopped, if it did.
    failed: Option<IntegrateError>,
    trial: Option<Trial>,
}

/// Up to eight lossless chains with the same number of bodies under a Runge-Kutta-Nystrom pair.
pub struct ChainGroup {
    set: InstructionSet,
    plan: Plan,
    pair: &'static NystromPair,
    quadrature: Quadrature,
    work: Workspace,
    tolerance: f64,
    lanes: Vec<Lane>,
    jerks: [Vec<Row>; 2],
}

/// One chain to be put into a group.
#[derive(Debug, Clone, Copy)]
pub struct Member<'a> {
    /// The chain.
    pub chain: &'a Chain,
    /// Initial velocities of its bodies (m/s).
    pub velocities: &'a [f64],
    /// How long it is followed (s).
    pub duration: f64,
}

impl ChainGroup {
    /// Lanes of a group.
    pub const LANES: usize = WIDTH;

    /// Whether chains may share a group: as many bodies, and forces computed in the same way.
    #[must_use]
    pub fn fit(a: &Member<'_>, b: &Member<'_>, tolerance: f64) -> bool {
        let form = |member: &Member<'_>| Form::needed(member.chain, member.velocities, tolerance);
        a.chain.contacts().len() == b.chain.contacts().len() && form(a) == form(b)
    }

    /// Starts `pair` on up to [`Self::LANES`] members that fit each other, tolerating errors of `tolerance` a step (1).
    #[must_use]
    pub fn new(
        members: &[Member<'_>],
        pair: &'static NystromPair,
        tolerance: f64,
        set: InstructionSet,
    ) -> Self {
        let members = &members[..members.len().min(WIDTH)];
        let chains: Vec<&Chain> = members.iter().map(|member| member.chain).collect();
        let form =
            members.first().map_or(Form::Plain, |m| Form::needed(m.chain, m.velocities, tolerance));
        let mut plan = Plan::across(&chains, form);
        dispatch(set, Settle::<Across>(&mut plan, PhantomData));
        let mut work = Workspace::new(plan.rows(), pair.nodes.len());
        for (lane, member) in members.iter().enumerate() {
            for (row, velocity) in work.now.velocity.iter_mut().zip(member.velocities) {
                row.0[lane] = *velocity;
            }
        }
        let (motion, acceleration) = (&mut work.now, work.stages[0].as_mut_slice());
        let task = Evaluate::<Across> { plan: &plan, motion, acceleration, layout: PhantomData };
        dispatch(set, task);
        Self {
            set,
            pair,
            quadrature: Quadrature::of(pair),
            work,
            tolerance,
            lanes: members.iter().map(|member| Lane::new(member, pair)).collect(),
            jerks: std::array::from_fn(|_| vec![Row::default(); plan.rows()]),
            plan,
        }
    }

    /// Whether every lane has come to its end, or failed.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.lanes.iter().all(|lane| !lane.is_moving())
    }

    /// Tries a step in every lane that is still moving; tells which lanes have taken theirs.
    pub fn step(&mut self) -> [bool; WIDTH] {
        let mut step = Row::default();
        for (lane, h) in self.lanes.iter_mut().zip(&mut step.0) {
            *h = lane.choose();
        }
        self.attempt(step);
        let mut taken = [false; WIDTH];
        for (index, lane) in self.lanes.iter_mut().enumerate() {
            taken[index] = lane.judge(&self.work, index);
        }
        self.keep(taken);
        taken
    }

    fn attempt(&mut self, step: Row) {
        let Self { set, plan, pair, quadrature, work, .. } = self;
        let (mut slack, mut worth) = ([Row::default(); 2], [Row::default(); 2]);
        for (index, lane) in self.lanes.iter().enumerate() {
            let own = worth_of(self.tolerance, lane.scales);
            let least = kinks::slack(self.tolerance, lane.scales, lane.lightest);
            for kind in 0..2 {
                (slack[kind].0[index], worth[kind].0[index]) = (least[kind], own[kind]);
            }
        }
        let layout = PhantomData;
        let task = Attempt::<Across> { plan, pair, quadrature, work, step, worth, slack, layout };
        let guard = dispatch(*set, task);
        let stages = self.pair.nodes.len() as u64 - 1;
        for lane in self.lanes.iter_mut().filter(|lane| lane.trial.is_some()) {
            lane.counts.force_evaluations += stages;
        }
        let Some(guard) = guard else { return };
        let moved = self.lanes.iter().zip(guard.moved.0);
        let mut again = false;
        for (lane, moved) in moved {
            again |= lane.trial.is_some() && moved > UNMOVED * self.tolerance * lane.scales.0;
        }
        if again {
            self.evaluate_end(&guard.moved);
        }
    }

    /// The accelerations where the step ended, after corrections; lanes whose positions hardly moved keep theirs.
    fn evaluate_end(&mut self, moved: &Row) {
        let Self { set, plan, work, lanes, tolerance, jerks, .. } = self;
        let Some(kept) = work.stages.last_mut() else { return };
        let fresh = &mut jerks[0];
        let task = Evaluate::<Across> {
            plan,
            motion: &mut work.next,
            acceleration: fresh,
            layout: PhantomData,
        };
        dispatch(*set, task);
        for (index, lane) in lanes.iter_mut().enumerate() {
            if lane.trial.is_some() && moved.0[index] > UNMOVED * *tolerance * lane.scales.0 {
                lane.counts.force_evaluations += 1;
                for (kept, fresh) in kept.iter_mut().zip(&*fresh) {
                    kept.0[index] = fresh.0[index];
                }
            }
        }
    }

    /// Makes the step's end the present in all lanes that have taken it.
    fn keep(&mut self, taken: [bool; WIDTH]) {
        let last = self.pair.nodes.len() - 1;
        std::mem::swap(&mut self.work.now, &mut self.work.next);
        self.work.stages.swap(0, last);
        let Workspace { now, next, stages, .. } = &mut self.work;
        let (first, rest) = stages.split_at_mut(1);
        for (index, taken) in taken.iter().enumerate().take(self.lanes.len()) {
            if !taken {
                now.take_lane(next, index);
                copy_lane(&mut first[0], &rest[last - 1], index);
            }
        }
    }

    /// Brings the views of every lane that has just `taken` a step up to its end.
    pub fn look(&mut self, views: &mut [Vec<View>], taken: [bool; WIDTH]) {
        let Self { set, plan, work, jerks, .. } = self;
        let [before, after] = jerks;
        let Workspace { now, next, stages, .. } = work;
        let out = before.as_mut_slice();
        dispatch(*set, Jerks::<Across> { plan, motion: next, out, layout: PhantomData });
        let out = after.as_mut_slice();
        dispatch(*set, Jerks::<Across> { plan, motion: now, out, layout: PhantomData });
        let last = self.pair.nodes.len() - 1;
        for (index, (lane, views)) in self.lanes.iter().zip(views).enumerate() {
            if taken[index] {
                let ends = Ends {
                    from: [&next.position, &next.velocity, &stages[last], before],
                    to: [&now.position, &now.velocity, &stages[0], after],
                    span: lane.last_step,
                };
                let task =
                    Look::<Across> { ends, lane: index, views, all: false, layout: PhantomData };
                dispatch(*set, task);
            }
        }
    }

    /// What lane `index` has cost, or why it failed.
    ///
    /// # Errors
    /// [`IntegrateError`] where the error control could not go on.
    pub fn outcome(&self, index: usize) -> Result<Work, IntegrateError> {
        match self.lanes.get(index) {
            Some(Lane { failed: Some(error), .. }) => Err(error.clone()),
            Some(lane) => Ok(lane.counts),
            None => Ok(Work::default()),
        }
    }
}

impl Lane {
    fn new(member: &Member<'_>, pair: &NystromPair) -> Self {
        let speed = member.velocities.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let scales = (member.chain.impact_overlap(member.velocities), speed);
        Self {
            control: control(scales, pair),
            scales,
            lightest: member.chain.lightest(),
            time: 0.0,
            end: member.duration,
            last_step: (0.0, 0.0),
            counts: Work { force_evaluations: 1, ..Work::default() },
            failed: None,
            trial: None,
        }
    }

    fn is_moving(&self) -> bool {
        self.time < self.end && self.failed.is_none()
    }

    /// The next step (s); 0 for a lane that stands.
    fn choose(&mut self) -> f64 {
        self.trial = None;
        if self.is_moving() {
            match self.control.trial(self.time, self.end) {
                Ok(trial) => self.trial = Some(trial),
                Err(error) => self.failed = Some(error),
            }
        }
        self.trial.map_or(0.0, |trial| trial.length)
    }

    /// Whether the step just tried is taken.
    fn judge(&mut self, work: &Workspace, index: usize) -> bool {
        let Some(trial) = self.trial else { return false };
        let largest = &work.largest;
        let error = work.error(index);
        if !self.control.accepts(trial, error, || 0) {
            self.counts.rejected += 1;
            return false;
        }
        self.last_step = (self.time, trial.length);
        self.time = trial.next;
        self.counts.steps += 1;
        self.scales.0 = self.scales.0.max(largest.overlap.0[index]);
        self.scales.1 = self.scales.1.max(largest.speed.0[index]);
        true
    }
}

impl Motion {
    /// Takes lane `index` from `from`.
    fn take_lane(&mut self, from: &Self, index: usize) {
        copy_lane(&mut self.position, &from.position, index);
        copy_lane(&mut self.velocity, &from.velocity, index);
        copy_lane(&mut self.lost_position, &from.lost_position, index);
        copy_lane(&mut self.lost_velocity, &from.lost_velocity, index);
        let bit = 1_u8 << index;
        for (closed, from) in self.closed.iter_mut().zip(&from.closed) {
            *closed = *closed & !bit | from & bit;
        }
    }
}

fn copy_lane(to: &mut [Row], from: &[Row], index: usize) {
    for (to, from) in to.iter_mut().zip(from) {
        to.0[index] = from.0[index];
    }
}
