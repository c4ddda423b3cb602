//! Looks into eight steps: those of one place on end, or one at each of eight places.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
#![allow(
    clippy::needless_range_loop,
    reason = "closures would be compiled without the instruction set"
)]

use super::around::{Around, Bodies, Held, Moves};
use super::force_track::{COEFFICIENTS, CONTACTS, septic};
use super::lanes::{Lanes, Row, Task};
use super::seen::{Depth, Seen};
use super::wanted::Asked;

/// How two contacts move in steps of `length` (s) between the ends `from` and `to`.
#[inline(always)]
fn join<L: Lanes>([from, to]: [Held<L>; 2], length: &Row, seen: &mut Seen) {
    for which in 0..CONTACTS {
        let overlap = septic::<L>([from[which], to[which]], L::load(length));
        for power in 0..COEFFICIENTS {
            L::store(overlap[power], &mut seen.overlaps[which][power]);
        }
    }
}

/// Looks into steps on end.
pub struct OnEnd<'a> {
    pub around: &'a Around,
    /// How the contacts stood before: the last lane's are where the first step begins. Afterwards how they stand at the end of each step.
    pub moves: &'a mut Moves,
    pub bodies: &'a Bodies,
    /// Starts and lengths of the steps (s).
    pub times: (Row, &'a Row),
    pub seen: &'a mut Seen,
    /// Force (N) and its rate of change (N/s) before, as in `moves`, and afterwards at the end of each step.
    pub felt: &'a mut [Row; 2],
    pub asked: &'a Asked,
    /// Steps that may hold it whatever is asked, a bit each.
    pub always: u8,
    pub depth: Depth,
}

impl Task for OnEnd<'_> {
    /// Steps that hold what is asked for, or may, a bit each.
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u8 {
        let Self { around, moves, bodies, times: (starts, lengths), seen, felt, asked, .. } = self;
        let (to, pressed) = around.moves::<L>(bodies);
        let mut from = to;
        for which in 0..CONTACTS {
            for order in 0..4 {
                let row = &mut moves[which][order];
                from[which][order] = L::shift_up(L::load(row), to[which][order]);
                L::store(to[which][order], row);
            }
        }
        let end = around.feel_pressed::<L>(&to, &pressed);
        let mut before = end;
        for which in 0..felt.len() {
            before[which] = L::shift_up(L::load(&felt[which]), end[which]);
            L::store(end[which], &mut felt[which]);
            L::store(before[which], &mut seen.before[which]);
        }
        seen.begin::<L>((starts, lengths), end);
        let wanted = asked.wanted::<L>(before, end, L::load(lengths)) | self.always;
        if wanted != 0 || self.depth != Depth::Asked {
            join::<L>([from, to], lengths, seen);
        }
        if wanted != 0 || self.depth == Depth::All {
            around.look::<L>(lengths, seen);
        }
        wanted
    }
}

/// Looks into a step in each lane.
pub struct SideBySide<'a> {
    pub around: &'a Around,
    /// Both ends of the steps.
    pub ends: [&'a Bodies; 2],
    /// Starts and lengths of the steps (s).
    pub times: (Row, &'a Row),
    pub seen: &'a mut Seen,
}

impl Task for SideBySide<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { around, ends: [from, to], times, seen } = self;
        let ((from, _), (to, pressed)) = (around.moves::<L>(from), around.moves::<L>(to));
        seen.begin::<L>(times, around.feel_pressed::<L>(&to, &pressed));
        join::<L>([from, to], times.1, seen);
        around.look::<L>(times.1, seen);
    }
}
