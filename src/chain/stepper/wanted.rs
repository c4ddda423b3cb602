//! Which of eight steps may hold a maximum or a level that somebody asks for, by force and rate of change at their ends.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row, WIDTH};

/// A maximum within a step is at most this much above the larger of its ends, where what turns rises from zero: at `cos(4 pi/15)^1.5` of it at
/// least, or the step would not have been accepted (1).
const WITHIN_STEP: f64 = 2.0;
/// Where a force rises or falls at both ends of a step and the least rate of their cubic is below this share of both, it may turn in between (1).
const DOUBTFUL: f64 = 0.6;

/// What is asked of the steps of eight lanes.
#[derive(Debug, Clone, Default)]
pub struct Asked {
    /// A maximum counts above this (N).
    maximum: Row,
    /// Any force does above this (N).
    level: Row,
}

impl Asked {
    /// Nothing, of any lane.
    pub fn nothing() -> Self {
        Self { maximum: Row([f64::INFINITY; WIDTH]), level: Row([f64::INFINITY; WIDTH]) }
    }

    /// Asks lane `lane` for maxima above the first and any forces above the second (N).
    pub fn of(&mut self, lane: usize, [maximum, level]: [f64; 2]) {
        (self.maximum.0[lane], self.level.0[lane]) = (maximum, level);
    }

    /// Steps of `length` (s) that may hold it, where force (N) and rate of change (N/s) are `before` and at the `end`, a bit each.
    ///
    /// Where a force turns from rising to falling it is concave, and below its tangents at both ends: those meet above the maximum.
    #[inline(always)]
    pub fn wanted<L: Lanes>(&self, before: [L::V; 2], end: [L::V; 2], length: L::V) -> u8 {
        let (none, one) = (L::splat(0.0), L::splat(1.0));
        let [first, last] = [before[0], end[0]];
        let [climb, slope] = [L::mul(before[1], length), L::mul(end[1], length)];
        let (rose, rises) = (L::positive(climb), L::positive(slope));
        let change = L::sub(last, first);

        let turned = L::max(L::sub(climb, slope), L::splat(f64::MIN_POSITIVE));
        let meet = L::min(L::max(L::div(L::sub(change, slope), turned), none), one);
        let meet = L::select(rises, one, L::select(rose, meet, none));
        let fall = L::max(L::sub(none, slope), none);
        let highest = L::max(
            L::mul_add(L::max(climb, none), meet, first),
            L::mul_add(fall, L::sub(one, meet), last),
        );
        let likely = L::mul(L::splat(WITHIN_STEP), L::max(first, last));
        let counts = L::positive(L::sub(L::max(highest, likely), L::load(&self.maximum)));
        let exceeds = L::positive(L::sub(last, L::load(&self.level)));

        // As `experiment::turn::may_fall` has it; falling twice is rising twice, upside down.
        let mean = L::select(rises, change, L::sub(none, change));
        let (start, end) = (L::abs(climb), L::abs(slope));
        let three = L::splat(3.0);
        let both = L::add(start, end);
        let bend = L::mul(three, L::sub(both, L::add(mean, mean)));
        let turn = L::sub(L::add(start, both), L::mul(three, mean));
        let spare = L::sub(start, L::mul(L::splat(DOUBTFUL), L::min(start, end)));
        let turns = L::positive(bend)
            & L::positive(turn)
            & L::positive(L::sub(bend, turn))
            & L::positive(L::sub(L::mul(turn, turn), L::mul(spare, bend)));
        counts & (exceeds | rose & !rises | !(rose ^ rises) & turns)
    }
}
