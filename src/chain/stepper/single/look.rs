//! What is seen of a chain's last step.

use std::marker::PhantomData;

use super::{ChainStepper, Course};
use crate::chain::ForceProbe;
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::force_track::{SAMPLED_AT_ONCE, Sample};
use crate::chain::stepper::frame::{Ends, Frame};
use crate::chain::stepper::lanes::Row;
use crate::chain::stepper::layout::{Along, Striped};
use crate::chain::stepper::tasks::Jerks;
use crate::chain::stepper::view::{Look, View};
use crate::chain::stepper::workspace::Workspace;

impl ChainStepper {
    /// A view of the place of `probe`, at rest.
    #[must_use]
    pub fn view(&self, probe: &ForceProbe) -> View {
        View::new(probe, self.bodies, |body| self.course.place(body))
    }

    /// Brings `views` up to the end of the last step.
    pub fn glance(&self, views: &mut [View]) {
        for view in views {
            view.glance(self.course.work.now.seen(), self.last_step.1);
        }
    }

    /// Looks into the last step for those of `views` that want it.
    pub fn look(&self, views: &mut [View]) {
        let Course { set, work, counts, .. } = &self.course;
        if views.iter().any(|view| view.wanted) {
            let ends = [work.next.moving(), work.now.moving()];
            dispatch(*set, Look { ends, span: self.last_step, count: counts.steps, views });
        }
    }

    /// Displacements (m) and changes of the contact forces (N) at the fraction `theta` of the last step (1).
    pub fn frame(&mut self, theta: f64) -> (impl Iterator<Item = f64>, impl Iterator<Item = f64>) {
        self.find_jerks();
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

    /// Adds `count` forces of the step that `view` has looked into to `samples` (N), from the fraction `first` of the step on, every `interval` of it (1).
    pub fn sample(
        &self,
        view: &View,
        (first, interval): (f64, f64),
        count: usize,
        samples: &mut Vec<f64>,
    ) {
        let before = samples.len();
        // Whole rows are written; what is too much of the last is taken off again.
        samples.resize(before + count.next_multiple_of(SAMPLED_AT_ONCE), 0.0);
        let (out, _) = samples[before..].as_chunks_mut();
        let (Course { set, plan, .. }, View { place, span, .. }) = (&self.course, view);
        dispatch(*set, Sample { place, span, form: plan.form, first, interval, out });
        samples.truncate(before + count);
    }

    /// Finds the rates of the accelerations at both ends of the last step.
    pub(super) fn find_jerks(&mut self) {
        let Self { course, jerks: [before, after], jerks_of, .. } = self;
        let Course { set, striped, plan, work, counts, .. } = course;
        if *jerks_of == counts.steps {
            return;
        }
        for out in [&mut *before, &mut *after] {
            out.resize(plan.all_rows(), Row::default());
        }
        let find = |at, out| {
            laid!(*striped, Y => dispatch(*set, Jerks::<Y> { plan, at, out, layout: PhantomData }));
        };
        if jerks_of.wrapping_add(1) == counts.steps {
            std::mem::swap(before, after);
        } else {
            find(work.next.seen(), before);
        }
        find(work.now.seen(), after);
        *jerks_of = counts.steps;
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
