//! Accelerations at given positions, and how far the overlaps have changed.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::Cut;
use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::plan::Plan;
use super::sweep::{Visit, sweep};

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
        let counted = L::abs(L::max(change, L::load(&self.plan.rest[r].floor)));
        // `max` leaves out what is not a number.
        self.change = L::max(counted, self.change);
    }
}

/// Closed contacts, their forces (N), and accelerations (m/s²): what is found at given positions.
pub type Found<'a> = (&'a mut [u8], &'a mut [Row], &'a mut [Row]);

struct Look<'a, L: Lanes> {
    position: &'a [Row],
    out: Found<'a>,
    largest: Largest<'a, L>,
}

impl<L: Lanes, Y: Layout> Visit<L, Y> for Look<'_, L> {
    #[inline(always)]
    fn enter(&mut self, r: usize) -> L::V {
        L::load(&self.position[r])
    }

    #[inline(always)]
    fn see(&mut self, r: usize, overlap: L::V, change: L::V) {
        self.out.0[r] = L::positive(overlap);
        self.largest.see(r, change);
    }

    #[inline(always)]
    fn leave(&mut self, r: usize, acceleration: L::V, [force, _]: [L::V; 2]) {
        L::store(force, &mut self.out.1[r]);
        L::store(acceleration, &mut self.out.2[r]);
    }
}

/// Looks at `position`; returns the largest change of an overlap.
#[inline(always)]
pub fn evaluate<L: Lanes, Y: Layout, const FORM: u8>(
    plan: &Plan,
    position: &[Row],
    (closed, force, acceleration): Found,
) -> L::V {
    let rows = plan.rows();
    let cut = Cut::new(plan, rows);
    let mut look = Look::<L> {
        position: &position[..rows],
        out: (&mut closed[..rows], &mut force[..rows], &mut acceleration[..rows]),
        largest: Largest::new(cut),
    };
    sweep::<L, Y, FORM>(cut, rows, &mut look);
    look.largest.change
}
