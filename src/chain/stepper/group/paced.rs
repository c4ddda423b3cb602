//! Paced steps of a splitting, each lane's of its own length.
//!
//! A step's length follows from where it starts, which is known once the one before has been taken. Mostly it is that of the one before: several are
//! taken at once, and all from where they started over again if a step turns out to have another.

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
    /// Lengths of the steps taken last, lane by lane (s).
    lengths: [f64; WIDTH],
    /// Where the last of them started, and those before that were taken at once with it, as many as there are lanes (s).
    starts: [[f64; WIDTH]; WIDTH],
}

impl Lane {
    /// Rows of the contact that it goes by.
    fn asks(&self) -> impl Iterator<Item = usize> {
        let rows = self.pacer.stiff.map(|stiff| [Some(stiff.at), stiff.above]);
        rows.into_iter().flatten().flatten().map(|(row, _)| row)
    }

    /// Length of the next step (s), and how many are as long as far as can be told, up to `most`.
    fn ahead(&self, now: &Motion, most: usize) -> (f64, usize) {
        let Self { pacer, progress: Progress { time, end, .. } } = self;
        (pacer.beat.next(*time, *end).0, pacer.alike(now, [*time, *end], most))
    }

    /// How many it takes indeed of `count` steps of `length` (s), of which these are the `notes`: none that starts where another is due.
    fn holds(&self, notes: &Notes, (length, count): (f64, usize)) -> usize {
        debug_assert!(count == 1 || self.asks().all(|row| notes.place_of(row).is_some()));
        let Self { pacer, progress: Progress { time, end, .. } } = self;
        let (mut beat, mut time) = (pacer.beat, *time);
        for step in 1..count {
            (_, time) = beat.next(time, *end);
            beat.pass(pacer.course(|row| notes.at(step - 1, row)));
            if beat.next(time, *end).0.to_bits() != length.to_bits() {
                return step;
            }
        }
        count
    }
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
        let lanes = members.iter().enumerate().map(lane).collect();
        Self { method, lanes, lengths: Default::default(), starts: Default::default() }
    }

    /// How far lane `index` is.
    pub fn progress(&self, index: usize) -> Option<&Progress> {
        self.lanes.get(index).map(|lane| &lane.progress)
    }

    /// Rows that it goes by, of which notes are to be kept.
    pub fn asks(&self) -> impl Iterator<Item = usize> {
        self.lanes.iter().flat_map(Lane::asks)
    }

    /// Starts and lengths of the steps that were `before` the last, and taken at once with those (s).
    pub fn last_steps(&self, before: usize) -> (Row, Row) {
        (Row(self.starts[before % WIDTH]), Row(self.lengths))
    }

    /// Takes up to `most` steps in every lane that is still moving, of which `notes` are kept; tells how many, and in which lanes.
    pub fn step(
        &mut self,
        (set, plan, work): (InstructionSet, &Plan, &mut Workspace),
        most: usize,
        notes: &mut Notes,
    ) -> (usize, [bool; WIDTH]) {
        let (mut length, mut count) = (Row::default(), most);
        // Others stand.
        for (index, lane) in self.lanes.iter().enumerate() {
            if lane.progress.is_moving() {
                (length.0[index], count) = lane.ahead(&work.now, count);
            }
        }
        self.lengths = length.0;
        let (mut finite, mut taken) = (0, 0);
        while taken != count {
            taken = count;
            notes.clear();
            let (method, length) = (self.method, &length);
            let (notes, work) = (&mut *notes, &mut *work);
            let steps = Steps { method, length, count: taken as u64, notes, keeps_start: true };
            let task = split_tasks::Split::<Across> { plan, work, steps, layout: PhantomData };
            finite = dispatch(set, task);
            for (index, lane) in self.lanes.iter().enumerate() {
                if lane.progress.is_moving() && finite & (1 << index) != 0 {
                    count = count.min(lane.holds(notes, (length.0[index], taken)));
                }
            }
        }
        work.turn();
        (count, self.pass(&work.now, finite, count))
    }

    /// `count` steps have come to `now`, in lanes that are `finite`; tells which have taken theirs.
    fn pass(&mut self, now: &Motion, finite: u8, count: usize) -> [bool; WIDTH] {
        let mut taken = [false; WIDTH];
        for (index, Lane { pacer, progress }) in self.lanes.iter_mut().enumerate() {
            if !progress.is_moving() {
                continue;
            }
            if finite & (1 << index) == 0 {
                let (body, time) = (first_lost(now, index), progress.time);
                progress.failed = Some(IntegrateError::NotFinite { body, time });
                continue;
            }
            for before in (0..count).rev() {
                self.starts[before % WIDTH][index] = progress.time;
                let (length, next) = pacer.beat.next(progress.time, progress.end);
                progress.pass(length, next);
            }
            pacer.pass(now);
            progress.counts.force_evaluations += (count * self.method.drifts.len()) as u64;
            taken[index] = true;
        }
        taken
    }
}
