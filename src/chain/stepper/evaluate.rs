//! Accelerations at given positions, and how far the overlaps have changed.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::{Cut, accelerations, forces};
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
    if Y::STRIPED {
        look.all_round::<Y, FORM>(cut);
    } else {
        sweep::<L, Y, FORM>(cut, rows, &mut look);
    }
    look.largest.change
}

impl<L: Lanes> Look<'_, L> {
    /// Rows of which the last stands above the first: one after the other, for this is done once.
    #[inline(always)]
    fn all_round<Y: Layout, const FORM: u8>(&mut self, plan: Cut) {
        let Some(last) = self.position.last() else { return };
        let mut before = Y::before_first::<L>(L::load(last));
        for r in 0..self.position.len() {
            let here = L::load(&self.position[r]);
            let change = L::sub(Y::above::<L>(before, here), here);
            let (force, overlap) = forces::<L, FORM>(plan, r, change);
            Visit::<L, Y>::see(self, r, overlap, change);
            L::store(force, &mut self.out.1[r]);
            before = here;
        }
        let first = Y::after_last::<L>(L::load(&self.out.1[0]), L::load(&plan.beyond));
        for r in 0..self.position.len() {
            let next = self.out.1.get(r + 1).map_or(first, |row| L::load(row));
            let force = [L::load(&self.out.1[r]), next];
            L::store(accelerations::<L, Y>(plan, r, force), &mut self.out.2[r]);
        }
    }
}
