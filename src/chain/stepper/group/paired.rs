//! A group's steps under a Runge-Kutta-Nystrom pair, with error control.

use std::marker::PhantomData;

use super::lane::Lane;
use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
use crate::chain::stepper::kinks;
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::plan::{Across, Plan};
use crate::chain::stepper::quadrature::Quadrature;
use crate::chain::stepper::steps::{UNMOVED, worth as worth_of};
use crate::chain::stepper::tasks::{Attempt, Evaluate};
use crate::chain::stepper::workspace::{Motion, Workspace};
use crate::integrate::Pair;

/// A pair at work.
pub struct Paired {
    pair: Pair,
    quadrature: Quadrature,
    tolerance: f64,
    /// Room for accelerations (m/s²).
    fresh: Vec<Row>,
}

impl Paired {
    /// With errors of `tolerance` a step (1), in `rows` rows.
    pub fn new(pair: Pair, tolerance: f64, rows: usize) -> Self {
        Self {
            pair,
            quadrature: Quadrature::of(pair.coefficients()),
            tolerance,
            fresh: vec![Row::default(); rows],
        }
    }

    /// Tries a step in every lane; tells which lanes have taken theirs.
    pub fn step(
        &mut self,
        set: InstructionSet,
        plan: &Plan,
        (work, lanes): (&mut Workspace, &mut [Lane]),
        step: Row,
    ) -> [bool; WIDTH] {
        self.attempt(set, plan, (work, lanes), step);
        let mut taken = [false; WIDTH];
        for (index, lane) in lanes.iter_mut().enumerate() {
            taken[index] = lane.judge(work, index);
        }
        keep(work, &taken[..lanes.len()]);
        taken
    }

    fn attempt(
        &mut self,
        set: InstructionSet,
        plan: &Plan,
        (work, lanes): (&mut Workspace, &mut [Lane]),
        step: Row,
    ) {
        let Self { pair, quadrature, .. } = self;
        let (mut slack, mut worth) = ([Row::default(); 2], [Row::default(); 2]);
        for (index, lane) in lanes.iter().enumerate() {
            let own = worth_of(self.tolerance, lane.scales);
            let least = kinks::slack(self.tolerance, lane.scales, lane.lightest);
            for kind in 0..2 {
                (slack[kind].0[index], worth[kind].0[index]) = (least[kind], own[kind]);
            }
        }
        let layout = PhantomData;
        let pair = *pair;
        let task = Attempt::<Across> { plan, pair, quadrature, work, step, worth, slack, layout };
        let guard = dispatch(set, task);
        let stages = self.pair.evaluations() as u64;
        for lane in lanes.iter_mut().filter(|lane| lane.tries()) {
            lane.counts.force_evaluations += stages;
        }
        let Some(guard) = guard else { return };
        let moved = lanes.iter().zip(guard.moved.0);
        let mut again = false;
        for (lane, moved) in moved {
            again |= lane.tries() && moved > UNMOVED * self.tolerance * lane.scales.0;
        }
        if again {
            self.evaluate_end(set, plan, (work, lanes), &guard.moved);
        }
    }

    /// The accelerations where the step ended, after corrections; lanes whose positions hardly moved keep theirs.
    fn evaluate_end(
        &mut self,
        set: InstructionSet,
        plan: &Plan,
        (work, lanes): (&mut Workspace, &mut [Lane]),
        moved: &Row,
    ) {
        let Self { tolerance, fresh, .. } = self;
        let Motion { position, closed, force, acceleration: kept, .. } = &mut *work.next;
        let out = (&mut **closed, &mut **force, &mut **fresh);
        dispatch(set, Evaluate::<Across> { plan, position, out, layout: PhantomData });
        for (index, lane) in lanes.iter_mut().enumerate() {
            if lane.tries() && moved.0[index] > UNMOVED * *tolerance * lane.scales.0 {
                lane.counts.force_evaluations += 1;
                for (kept, fresh) in kept.iter_mut().zip(&*fresh) {
                    kept.0[index] = fresh.0[index];
                }
            }
        }
    }
}

/// Makes the step's end the present in all lanes that have `taken` it.
fn keep(work: &mut Workspace, taken: &[bool]) {
    work.turn();
    let Workspace { now, next, .. } = work;
    for (index, _) in taken.iter().enumerate().filter(|(_, taken)| !**taken) {
        now.take_lane(next, index);
    }
}

impl Motion {
    /// Takes lane `index` from `from`.
    fn take_lane(&mut self, from: &Self, index: usize) {
        copy_lane(&mut self.position, &from.position, index);
        copy_lane(&mut self.velocity, &from.velocity, index);
        copy_lane(&mut self.lost_position, &from.lost_position, index);
        copy_lane(&mut self.lost_velocity, &from.lost_velocity, index);
        copy_lane(&mut self.acceleration, &from.acceleration, index);
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
