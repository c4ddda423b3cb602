//! A step that was tried, as its contacts see it.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::Cut;
use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::quintics::Ends;
use super::workspace::Motion;

/// Contacts, and how their bodies stand and move at both ends of a step.
#[derive(Clone, Copy)]
pub struct Tried<'a, L: Lanes> {
    /// Rows of contacts.
    pub plan: Cut<'a>,
    /// Positions (m), velocities (m/s) and accelerations (m/s²) at both ends.
    ends: [[&'a [Row]; 3]; 2],
    /// Length of the step, lane by lane (s).
    h: L::V,
}

/// How much more the bodies above have than those of row `r`.
#[inline(always)]
pub fn difference<L: Lanes, Y: Layout>(rows: &[Row], r: usize) -> L::V {
    let before = if r > 0 { L::load(&rows[r - 1]) } else { L::splat(0.0) };
    let here = L::load(&rows[r]);
    L::sub(Y::above::<L>(before, here), here)
}

impl<'a, L: Lanes> Tried<'a, L> {
    /// A step of `h` (s) from one end to another, with the contacts in the first rows of `plan`.
    #[inline(always)]
    pub fn new((plan, rows): (Cut<'a>, usize), [from, to]: [&'a Motion; 2], h: L::V) -> Self {
        let of = |motion: &'a Motion| {
            [&motion.position()[..rows], &motion.velocity()[..rows], &motion.acceleration()[..rows]]
        };
        Self { plan, ends: [of(from), of(to)], h }
    }

    /// Speeds at which the contacts of row `r` close or open, the larger of both ends' (m/s).
    #[inline(always)]
    pub fn speed<Y: Layout>(&self, r: usize) -> L::V {
        let [start, end] = [self.ends[0][1], self.ends[1][1]];
        let start = L::abs(difference::<L, Y>(start, r));
        L::max(start, L::abs(difference::<L, Y>(end, r)))
    }

    /// Overlaps and closing speeds of row `r` at both ends, in units of the step (m).
    #[inline(always)]
    pub fn moves<Y: Layout>(&self, r: usize) -> [[L::V; 2]; 2] {
        let [from, to] = self.ends;
        [self.move_of::<Y>(from, r), self.move_of::<Y>(to, r)]
    }

    #[inline(always)]
    fn move_of<Y: Layout>(&self, [position, velocity, _]: [&[Row]; 3], r: usize) -> [L::V; 2] {
        let change = difference::<L, Y>(position, r);
        let overlap = L::add(L::load(&self.plan.static_overlap[r]), change);
        [overlap, L::mul(self.h, difference::<L, Y>(velocity, r))]
    }

    /// The same and relative accelerations (m).
    #[inline(always)]
    pub fn ends<Y: Layout>(&self, r: usize) -> Ends<L> {
        let [[from, start], [to, end]] = self.moves::<Y>(r);
        let square = L::mul(self.h, self.h);
        let bend = L::mul(square, difference::<L, Y>(self.ends[0][2], r));
        let end_bend = L::mul(square, difference::<L, Y>(self.ends[1][2], r));
        [[from, start, bend], [to, end, end_bend]]
    }
}
