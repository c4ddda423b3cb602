//! The whole chain within its last step.

use std::marker::PhantomData;

use super::{ChainStepper, Course, Laid};
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::frame::{Ends, Frame};
use crate::chain::stepper::lanes::Row;
use crate::chain::stepper::layout::{Along, Striped, Tiled};
use crate::chain::stepper::tasks::Jerks;
use crate::chain::stepper::workspace::Workspace;

impl ChainStepper {
    /// Displacements (m) and changes of the contact forces (N) at the fraction `theta` of the last step (1).
    pub fn frame(&mut self, theta: f64) -> (impl Iterator<Item = f64>, impl Iterator<Item = f64>) {
        self.find_jerks();
        let mut frame = std::mem::take(&mut self.frame);
        for rows in &mut frame {
            rows.resize(self.course.plan.all_rows(), Row::default());
        }
        let [position, force] = &mut frame;
        let (Course { set, laid, plan, .. }, ends) = (&self.course, self.ends());
        laid!(*laid, Y => {
            dispatch(*set, Frame::<Y> { plan, ends, theta, position, force, layout: PhantomData });
        });
        self.frame = frame;
        let [position, force] = &self.frame;
        (self.course.flat(position, self.bodies), self.course.flat(force, self.bodies + 1))
    }

    /// Finds the rates of the accelerations at both ends of the last step.
    pub(super) fn find_jerks(&mut self) {
        let Self { course, jerks: [before, after], jerks_of, .. } = self;
        let Course { set, laid, plan, work, counts, .. } = course;
        if *jerks_of == counts.steps {
            return;
        }
        for out in [&mut *before, &mut *after] {
            out.resize(plan.all_rows(), Row::default());
        }
        let find = |at, out| {
            laid!(*laid, Y => dispatch(*set, Jerks::<Y> { plan, at, out, layout: PhantomData }));
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
