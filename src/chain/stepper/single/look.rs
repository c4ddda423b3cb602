//! What is seen of a chain's last step.

use std::marker::PhantomData;
use std::ops::Range;

use super::{ChainStepper, Course};
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::force_track::{ForceTrack, Sample, View};
use crate::chain::stepper::frame::{Ends, Frame, Look, glance, rows_around};
use crate::chain::stepper::lanes::Row;
use crate::chain::stepper::plan::Along;
use crate::chain::stepper::tasks::Jerks;
use crate::chain::stepper::workspace::Workspace;

/// The first values of rows.
fn flat(rows: &[Row], count: usize) -> impl Iterator<Item = f64> {
    rows.iter().flat_map(|row| row.0).take(count)
}

impl ChainStepper {
    /// Brings `views` up to the end of the last step.
    pub fn glance(&self, views: &mut [View]) {
        glance::<Along>(self.course.work.now.seen(), self.last_step.1, 0, views);
    }

    /// Looks into the last step for those of `views` that want it.
    pub fn look(&mut self, views: &mut [View]) {
        let wanted = views.iter().filter(|view| view.wanted);
        let rows = wanted.map(|view| rows_around::<Along>(view.body));
        let Some(rows) = rows.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)) else { return };
        self.find_jerks(rows);
        let ends = self.ends();
        dispatch(self.course.set, Look::<Along> { ends, lane: 0, views, layout: PhantomData });
    }

    /// Displacements (m) and changes of the contact forces (N) at the fraction `theta` of the last step (1).
    pub fn frame(&mut self, theta: f64) -> (impl Iterator<Item = f64>, impl Iterator<Item = f64>) {
        self.find_jerks(0..self.course.plan.all_rows());
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

    /// Finds the rates of the accelerations at both ends of the last step, in `rows` at least.
    pub(super) fn find_jerks(&mut self, rows: Range<usize>) {
        let Self { course: Course { set, plan, work, counts, .. }, jerks, jerks_of, .. } = self;
        let covered = jerks_of.1.start <= rows.start && rows.end <= jerks_of.1.end;
        if covered && jerks_of.0 == counts.steps {
            return;
        }
        for out in &mut *jerks {
            out.resize(plan.all_rows(), Row::default());
        }
        let [before, after] = jerks;
        let (set, layout) = (*set, PhantomData);
        let find = |at, out| {
            dispatch(set, Jerks::<Along> { plan, at, rows: rows.clone(), out, layout });
        };
        if covered && jerks_of.0.wrapping_add(1) == counts.steps {
            std::mem::swap(before, after);
        } else {
            find(work.next.seen(), before);
        }
        find(work.now.seen(), after);
        *jerks_of = (counts.steps, rows);
    }

    /// The last step's ends: what was the start stays where the next step will end.
    pub(super) fn ends(&self) -> Ends<'_> {
        let Workspace { now, next, .. } = &self.course.work;
        Ends {
            from: [next.position(), next.velocity(), next.acceleration(), &self.jerks[0]],
            to: [now.position(), now.velocity(), now.acceleration(), &self.jerks[1]],
            span: self.last_step,
        }
    }
}
