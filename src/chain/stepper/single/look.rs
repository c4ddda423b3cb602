//! What is seen of a chain's last step.

use std::marker::PhantomData;
use std::ops::Range;

use super::{ChainStepper, Course};
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::force_track::{ForceTrack, Sample, View};
use crate::chain::stepper::frame::{Ends, Frame, Look, glance, rows_around};
use crate::chain::stepper::lanes::Row;
use crate::chain::stepper::layout::{Along, Striped};
use crate::chain::stepper::tasks::Jerks;
use crate::chain::stepper::workspace::Workspace;

impl ChainStepper {
    /// Brings `views` up to the end of the last step.
    pub fn glance(&self, views: &mut [View]) {
        let to = self.course.work.now.seen();
        laid!(self.course.striped, Y => glance::<Y>(to, self.last_step.1, 0, views));
    }

    /// Looks into the last step for those of `views` that want it.
    pub fn look(&mut self, views: &mut [View]) {
        let Course { set, striped, plan, .. } = &self.course;
        let (set, striped, all) = (*set, *striped, plan.all_rows());
        let wanted = views.iter().filter(|view| view.wanted);
        let rows = wanted.map(|view| laid!(striped, Y => rows_around::<Y>(all, view.body)));
        let Some(rows) = rows.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)) else { return };
        self.find_jerks(rows);
        let ends = self.ends();
        laid!(striped, Y => dispatch(set, Look::<Y> { ends, lane: 0, views, layout: PhantomData }));
    }

    /// Displacements (m) and changes of the contact forces (N) at the fraction `theta` of the last step (1).
    pub fn frame(&mut self, theta: f64) -> (impl Iterator<Item = f64>, impl Iterator<Item = f64>) {
        self.find_jerks(0..self.course.plan.all_rows());
        let mut frame = std::mem::take(&mut self.frame);
        for rows in &mut frame {
            rows.resize(self.course.plan.all_rows(), Row::default());
        }
        let [position, force] = &mut frame;
        let (Course { set, striped, plan, .. }, ends) = (&self.course, self.ends());
        laid!(*striped, Y => {
            dispatch(*set, Frame::<Y> { plan, ends, theta, position, force, layout: PhantomData });
        });
        self.frame = frame;
        let [position, force] = &self.frame;
        (self.course.flat(position, self.bodies), self.course.flat(force, self.bodies + 1))
    }

    /// The forces of `track` from the fraction `first` of the step on, every `interval` of it (1).
    pub fn sample(&self, track: &ForceTrack, (first, interval): (f64, f64), out: &mut [f64]) {
        dispatch(self.course.set, Sample { track, first, interval, out });
    }

    /// Finds the rates of the accelerations at both ends of the last step, in `rows` at least.
    pub(super) fn find_jerks(&mut self, rows: Range<usize>) {
        let Self { course, jerks, jerks_of, .. } = self;
        let Course { set, striped, plan, work, counts, .. } = course;
        let covered = jerks_of.1.start <= rows.start && rows.end <= jerks_of.1.end;
        if covered && jerks_of.0 == counts.steps {
            return;
        }
        for out in &mut *jerks {
            out.resize(plan.all_rows(), Row::default());
        }
        let [before, after] = jerks;
        let set = *set;
        let find = |at, out| {
            let rows = rows.clone();
            laid!(*striped, Y => dispatch(set, Jerks::<Y> { plan, at, rows, out, layout: PhantomData }));
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
