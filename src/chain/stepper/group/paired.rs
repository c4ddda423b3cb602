//! A group's steps under a Runge-Kutta-Nystrom pair, with error control.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;

use super::lane::Lane;
use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
use crate::chain::stepper::foresight::MOST_SHORTENED;
use crate::chain::stepper::kinks;
use crate::chain::stepper::lanes::{Lanes, Row, Task, WIDTH};
use crate::chain::stepper::layout::Across;
use crate::chain::stepper::plan::Plan;
use crate::chain::stepper::steps::{UNMOVED, worth as worth_of};
use crate::chain::stepper::tasks::{Attempt, Correct, Evaluate};
use crate::chain::stepper::workspace::{Parts, Workspace};
use crate::integrate::Pair;

/// A pair at work.
pub struct Paired {
    pair: Pair,
    tolerance: f64,
    /// Room for accelerations (m/s²).
    fresh: Vec<Row>,
    /// Room for which contacts are closed, a bit each.
    fresh_closed: Vec<u8>,
}

impl Paired {
    /// With errors of `tolerance` a step (1), in `rows` rows.
    pub fn new(pair: Pair, tolerance: f64, rows: usize) -> Self {
        Self { pair, tolerance, fresh: vec![Row::default(); rows], fresh_closed: vec![0; rows] }
    }

    /// Tries a step in every lane; tells which lanes have taken theirs.
    pub fn step(
        &mut self,
        set: InstructionSet,
        plan: &Plan,
        (work, lanes): (&mut Workspace, &mut [Lane]),
        mut step: Row,
    ) -> [bool; WIDTH] {
        let mut worth = [Row::default(); 2];
        for (index, lane) in lanes.iter().enumerate() {
            for (worth, own) in worth.iter_mut().zip(worth_of(self.tolerance, lane.scales)) {
                worth.0[index] = own;
            }
        }
        Self::shorten(plan, (work, lanes), &mut step, worth[1]);
        self.attempt((set, plan), (work, lanes), step, worth);
        let mut taken = [false; WIDTH];
        for (index, lane) in lanes.iter_mut().enumerate() {
            taken[index] = lane.judge(work, index);
        }
        let left = (0..lanes.len()).filter(|lane| !taken[*lane]);
        keep(set, work, left.fold(0, |bits, lane| bits | 1 << lane));
        taken
    }

    /// Makes shorter what is not worth a try as it is.
    fn shorten(plan: &Plan, (work, lanes): (&Workspace, &mut [Lane]), step: &mut Row, worth: Row) {
        for _ in 0..MOST_SHORTENED {
            let mut any = false;
            for watched in &plan.watched {
                let (_, index) = watched.at;
                // Lanes never see each other: what one is looked at for is nothing to those that are not.
                let Some(lane) = lanes.get_mut(index).filter(|lane| lane.is_watched()) else {
                    continue;
                };
                let own = (step.0[index], worth.0[index]);
                if let Some(share) = watched.shorter(plan, &work.now, own) {
                    step.0[index] = lane.shorten(share);
                    any = true;
                }
            }
            if !any {
                break;
            }
        }
    }

    fn attempt(
        &mut self,
        (set, plan): (InstructionSet, &Plan),
        (work, lanes): (&mut Workspace, &mut [Lane]),
        step: Row,
        worth: [Row; 2],
    ) {
        let pair = self.pair;
        let sides = dispatch(set, Attempt::<Across> { plan, pair, work, step, worth });
        let stages = self.pair.evaluations() as u64;
        for lane in lanes.iter_mut().filter(|lane| lane.tries()) {
            lane.progress.counts.force_evaluations += stages;
        }
        if !sides.any() {
            return;
        }
        let mut slack = [Row::default(); 2];
        for (index, lane) in lanes.iter().enumerate() {
            let own = kinks::slack(self.tolerance, lane.scales, lane.lightest);
            for (slack, own) in slack.iter_mut().zip(own) {
                slack.0[index] = own;
            }
        }
        let attempt = Attempt::<Across> { plan, pair, work, step, worth };
        if !dispatch(set, Correct { attempt, sides, slack }) {
            return;
        }
        let moved = work.largest.moved;
        let mut again = false;
        for (lane, moved) in lanes.iter().zip(moved.0) {
            again |= lane.tries() && moved > UNMOVED * self.tolerance * lane.scales.0;
        }
        if again {
            self.evaluate_end(set, plan, (work, lanes), &moved);
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
        let Self { tolerance, fresh, fresh_closed, .. } = self;
        let Parts { position, closed, force, acceleration: kept, .. } = work.next.parts();
        let out = (&mut **fresh_closed, force, &mut **fresh);
        dispatch(set, Evaluate::<Across> { plan, position, out, layout: PhantomData });
        let mut lanes_moved = 0;
        for (index, lane) in lanes.iter_mut().enumerate() {
            if lane.tries() && moved.0[index] > UNMOVED * *tolerance * lane.scales.0 {
                lane.progress.counts.force_evaluations += 1;
                lanes_moved |= 1 << index;
            }
        }
        dispatch(set, Take { lanes: lanes_moved, rows: [(kept, &**fresh)] });
        take_bits(lanes_moved, closed, fresh_closed);
    }
}

/// Makes the step's end the present, but in `lanes`, which have not taken it.
fn keep(set: InstructionSet, work: &mut Workspace, lanes: u8) {
    work.turn();
    if lanes == 0 {
        return;
    }
    let (now, next) = (work.now.parts(), &*work.next);
    let rows = [
        (now.position, next.position()),
        (now.velocity, next.velocity()),
        (now.acceleration, next.acceleration()),
        (now.lost_position, next.lost_position()),
        (now.lost_velocity, next.lost_velocity()),
    ];
    dispatch(set, Take { lanes, rows });
    take_bits(lanes, now.closed, &next.closed);
}

/// Copies some lanes of bits.
fn take_bits(lanes: u8, to: &mut [u8], from: &[u8]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *to & !lanes | from & lanes;
    }
}

/// Copies some lanes of rows.
struct Take<'a, const N: usize> {
    lanes: u8,
    /// To where, from where.
    rows: [(&'a mut [Row], &'a [Row]); N],
}

impl<const N: usize> Task for Take<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        for (to, from) in self.rows {
            for (to, from) in to.iter_mut().zip(from) {
                L::store(L::select(self.lanes, L::load(from), L::load(to)), to);
            }
        }
    }
}
