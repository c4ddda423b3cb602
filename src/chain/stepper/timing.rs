//! When the steps of a splitting end that follow each other in the registers.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row};
use super::notes::{Notes, Times};
use super::pacer::{Pacer, Stiff};
use super::rows::Rows;
use super::splits::Weights;
use crate::integrate::pace::{Beat, NOTHING};
use crate::integrate::splitting::Splitting;

/// Steps, one after the other.
pub trait Timing<'m, L: Lanes> {
    /// Whether kicks at steps' ends go by gradients, too.
    const AT_ENDS: bool;
    /// Whether it sees overlaps.
    const SEES: bool;
    /// What the present one weighs.
    fn weights(&self) -> Weights<'m, L>;
    /// Whether it is the last.
    fn is_last(&self) -> bool;
    /// Sees the overlaps of all rows at its end (m).
    fn see<const R: usize>(&mut self, overlap: &Rows<L, R>);
    /// Sees how its bodies stand (m) and move (m/s, m/s²) there.
    fn note(&mut self, r: usize, moving: [L::V; 3]);
    /// It is done.
    fn finish(&mut self);
    /// Goes on with the next.
    fn go_on(&mut self);
}

/// Steps of one length.
pub struct Fixed<'a, L: Lanes, const AT_ENDS: bool> {
    pub weights: Weights<'a, L>,
    /// How many there are still to be.
    pub left: u64,
    pub notes: &'a mut Notes,
}

impl<'m, L: Lanes, const AT_ENDS: bool> Timing<'m, L> for Fixed<'m, L, AT_ENDS> {
    const AT_ENDS: bool = AT_ENDS;
    const SEES: bool = false;

    #[inline(always)]
    fn weights(&self) -> Weights<'m, L> {
        self.weights
    }

    #[inline(always)]
    fn is_last(&self) -> bool {
        self.left == 1
    }

    #[inline(always)]
    fn see<const R: usize>(&mut self, _overlap: &Rows<L, R>) {}

    #[inline(always)]
    fn note(&mut self, r: usize, moving: [L::V; 3]) {
        if let Some(rows) = self.notes.room((0, r)) {
            store::<L>(moving, rows);
        }
    }

    #[inline(always)]
    fn finish(&mut self) {}

    #[inline(always)]
    fn go_on(&mut self) {
        self.left -= 1;
    }
}

/// Paced steps of one chain.
pub struct Paced<'a> {
    /// One without gradients at the ends.
    pub method: &'a Splitting,
    pub pacer: &'a mut Pacer,
    /// Which contacts are closed, a bit each of a row.
    pub closed: &'a mut [u8],
    /// How bodies stand (m) and move (m/s, m/s²) in the rows of those above and below the stiff contact.
    pub noted: &'a mut [[Row; 3]; 2],
    pub going: &'a mut Going,
    pub times: &'a mut Times,
    pub notes: &'a mut Notes,
}

/// How far paced steps are.
#[derive(Debug, Clone, Copy)]
pub struct Going {
    /// Length of the present step, and where it starts and ends (s).
    pub step: [f64; 3],
    /// Up to where they go (s).
    pub end: f64,
    /// None begins then or later (s).
    pause: f64,
    /// How many may be taken at once.
    many: u64,
    /// Steps taken.
    pub taken: u64,
    /// Those in which contacts have changed sides.
    pub events: u64,
}

impl Going {
    /// Up to so `many` from `start` to `end` (s), none begun at `pause` or later but the first.
    pub fn new(beat: &Beat, start: f64, [end, pause]: [f64; 2], many: u64) -> Self {
        let (h, next) = beat.next(start, end);
        Self { step: [h, start, next], end, pause, many, taken: 0, events: 0 }
    }

    /// The present step is taken.
    #[inline(always)]
    pub fn pass(&mut self, times: &mut Times) {
        let [length, start, end] = self.step;
        times.keep([start, length, end]);
        self.taken += 1;
    }
}

#[inline(always)]
fn store<L: Lanes>(moving: [L::V; 3], rows: &mut [Row; 3]) {
    for (value, row) in moving.into_iter().zip(rows) {
        L::store(value, row);
    }
}

impl<'m, L: Lanes> Timing<'m, L> for Paced<'m> {
    const AT_ENDS: bool = false;
    const SEES: bool = true;

    #[inline(always)]
    fn weights(&self) -> Weights<'m, L> {
        Weights::new(self.method, L::splat(self.going.step[0]))
    }

    #[inline(always)]
    fn is_last(&self) -> bool {
        let Going { step: [.., next], end, pause, many, taken, .. } = *self.going;
        next >= end.min(pause) || taken + 1 >= many
    }

    #[inline(always)]
    fn see<const R: usize>(&mut self, overlap: &Rows<L, R>) {
        let (was_closed, mut changed) = (&mut self.closed[..R], 0);
        for (was_closed, overlap) in was_closed.iter_mut().zip(overlap) {
            let closed = L::positive(*overlap);
            changed |= closed ^ *was_closed;
            *was_closed = closed;
        }
        self.going.events += u64::from(changed != 0);
    }

    #[inline(always)]
    fn note(&mut self, r: usize, moving: [L::V; 3]) {
        if let Some(rows) = self.notes.room((0, r)) {
            store::<L>(moving, rows);
        }
        let Some(stiff) = self.pacer.stiff else { return };
        let [above, below] = &mut *self.noted;
        if stiff.at.0 == r {
            store::<L>(moving, below);
        }
        if stiff.above.is_some_and(|(row, _)| row == r) {
            store::<L>(moving, above);
        }
    }

    #[inline(always)]
    fn finish(&mut self) {
        self.going.pass(self.times);
        let [above, below] = &*self.noted;
        let course = |stiff: Stiff| stiff.course([above.each_ref(), below.each_ref()]);
        self.pacer.beat.pass(self.pacer.stiff.map_or(NOTHING, course));
    }

    #[inline(always)]
    fn go_on(&mut self) {
        let going = &mut *self.going;
        let start = going.step[2];
        let (h, next) = self.pacer.beat.next(start, going.end);
        going.step = [h, start, next];
    }
}
