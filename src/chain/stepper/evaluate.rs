//! Accelerations at given positions, and how far the overlaps have changed.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::Cut;
use super::lanes::{Lanes, Row};
use super::plan::{Layout, Plan};
use super::sweep::{Visit, sweep};
use super::workspace::Motion;

/// The largest change of an overlap, an open contact counting as having lost its static one.
pub struct Largest<'a, L: Lanes> {
    plan: Cut<'a>,
    /// (m)
    pub change: L::V,
}

impl<'a, L: Lanes> Largest<'a, L> {
    /// None so far.
    #[inline(always)]
    pub fn new(plan: Cut<'a>) -> Self {
        Self { plan, change: L::splat(0.0) }
    }

    /// Overlaps of row `r` that have changed by `change` (m).
    #[inline(always)]
    pub fn see(&mut self, r: usize, change: L::V) {
        let floor = L::sub(L::splat(0.0), L::load(&self.plan.static_overlap[r]));
        let counted = L::mul(L::abs(L::max(change, floor)), L::load(&self.plan.active[r]));
        self.change = L::max(counted, self.change);
    }
}

/// Accelerations, closed contacts and the largest overlap change at given positions.
struct Look<'a, L: Lanes> {
    position: &'a [Row],
    closed: &'a mut [u8],
    out: &'a mut [Row],
    largest: Largest<'a, L>,
}

impl<L: Lanes, Y: Layout> Visit<L, Y> for Look<'_, L> {
    #[inline(always)]
    fn enter(&mut self, r: usize) -> L::V {
        L::load(&self.position[r])
    }

    #[inline(always)]
    fn see(&mut self, r: usize, overlap: L::V, change: L::V) {
        self.closed[r] = L::positive(overlap);
        self.largest.see(r, change);
    }

    #[inline(always)]
    fn leave(&mut self, r: usize, acceleration: L::V, _tangent: L::V) {
        L::store(acceleration, &mut self.out[r]);
    }
}

/// Accelerations at the positions of `motion`, and which contacts are closed there; the largest change of an overlap.
#[inline(always)]
pub fn evaluate<L: Lanes, Y: Layout, const FORM: u8>(
    plan: &Plan,
    motion: &mut Motion,
    out: &mut [Row],
) -> L::V {
    let rows = plan.rows();
    let cut = Cut::new(plan, rows);
    let mut look = Look::<L> {
        position: &motion.position[..rows],
        closed: &mut motion.closed[..rows],
        out: &mut out[..rows],
        largest: Largest::new(cut),
    };
    sweep::<L, Y, FORM>(cut, rows, &mut look);
    look.largest.change
}
