//! What is seen of a chain's last step.

use std::marker::PhantomData;

use super::{ChainStepper, Course};
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::force_track::{ForceTrack, Sample, View};
use crate::chain::stepper::frame::{Ends, Frame, Look};
use crate::chain::stepper::lanes::Row;
use crate::chain::stepper::plan::Along;
use crate::chain::stepper::tasks::Jerks;
use crate::chain::stepper::workspace::Workspace;

/// The first values of rows.
fn flat(rows: &[Row], count: usize) -> impl Iterator<Item = f64> {
    rows.iter().flat_map(|row| row.0).take(count)
}

impl ChainStepper {
    /// Brings `views` up to the end of the last step; all of them if `all`, or only those that feel something.
    pub fn look(&mut self, views: &mut [View], all: bool) {
        self.find_jerks();
        let ends = self.ends();
        dispatch(self.course.set, Look::<Along> { ends, lane: 0, views, all, layout: PhantomData });
    }

    /// Displacements (m) and changes of the contact forces (N) at the fraction `theta` of the last step (1).
    pub fn frame(&mut self, theta: f64) -> (impl Iterator<Item = f64>, impl Iterator<Item = f64>) {
        self.find_jerks();
        let mut frame = std::mem::take(&mut self.frame);
        for rows in &mut frame {
            rows.resize(self.course.plan.all_rows(), Row::default());
        }
        let [position, force] = &mut frame;
        let task = Frame { plan: &self.course.plan, ends: self.ends(), theta, position, force };
        dispatch(self.course.set, task);
        self.frame = frame;
        let [position, force] = &self.frame;
        (flat(position, self.bodies), flat(force, self.bodies + 1))
    }

    /// The forces of `track` from the fraction `first` of the step on, every `interval` of it (1).
    pub fn sample(&self, track: &ForceTrack, (first, interval): (f64, f64), out: &mut [f64]) {
        dispatch(self.course.set, Sample { track, first, interval, out });
    }

    pub(super) fn find_jerks(&mut self) {
        if self.jerks_of == self.course.counts.steps {
            return;
        }
        let Self { course: Course { set, plan, work, .. }, jerks, .. } = self;
        for rows in &mut *jerks {
            rows.resize(plan.all_rows(), Row::default());
        }
        let [before, after] = jerks;
        if self.jerks_of.wrapping_add(1) == self.course.counts.steps {
            std::mem::swap(before, after);
        } else {
            let at = work.next.seen();
            dispatch(*set, Jerks::<Along> { plan, at, out: before, layout: PhantomData });
        }
        let at = work.now.seen();
        dispatch(*set, Jerks::<Along> { plan, at, out: after, layout: PhantomData });
        self.jerks_of = self.course.counts.steps;
    }

    /// The last step's ends: what was the start stays where the next step will end.
    pub(super) fn ends(&self) -> Ends<'_> {
        let Workspace { now, next, stages, .. } = &self.course.work;
        let last = stages.len() - 1;
        Ends {
            from: [&next.position, &next.velocity, &stages[last], &self.jerks[0]],
            to: [&now.position, &now.velocity, &stages[0], &self.jerks[1]],
            span: self.last_step,
        }
    }
}
