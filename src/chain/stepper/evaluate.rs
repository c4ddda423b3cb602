//! Accelerations at given positions, and how far the overlaps have changed.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::{Cut, accelerations, forces};
use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::plan::{Plan, Rest};
use super::strip::{At, Strip, StripMut};
use super::sweep::{Visit, sweep};

/// The largest change of an overlap, an open contact counting as having lost its static one.
pub struct Largest<L: Lanes> {
    /// (m)
    pub change: L::V,
}

impl<L: Lanes> Largest<L> {
    /// None so far.
    #[inline(always)]
    pub fn none() -> Self {
        Self { change: L::splat(0.0) }
    }

    /// Overlaps of a row that have changed by `change` (m).
    #[inline(always)]
    pub fn see(&mut self, rest: &Rest, change: L::V) {
        let counted = L::abs(L::max(change, L::load(&rest.floor)));
        // `max` leaves out what is not a number.
        self.change = L::max(counted, self.change);
    }
}

/// Closed contacts, their forces (N), and accelerations (m/s²): what is found at given positions.
pub type Found<'a> = (&'a mut [u8], &'a mut [Row], &'a mut [Row]);

struct Look<'a, L: Lanes> {
    rest: Strip<'a, Rest>,
    position: Strip<'a, Row>,
    closed: StripMut<'a, u8>,
    force: StripMut<'a, Row>,
    acceleration: StripMut<'a, Row>,
    largest: Largest<L>,
}

impl<L: Lanes> Visit<L> for Look<'_, L> {
    #[inline(always)]
    fn enter(&mut self, at: At) -> L::V {
        self.foresee(at)
    }

    #[inline(always)]
    fn foresee(&self, at: At) -> L::V {
        L::load(self.position.at(at))
    }

    #[inline(always)]
    fn see(&mut self, at: At, overlap: L::V, change: L::V) {
        *self.closed.at_mut(at) = L::positive(overlap);
        self.largest.see(self.rest.at(at), change);
    }

    #[inline(always)]
    fn press(&mut self, at: At, [force, _]: [L::V; 2]) {
        L::store(force, self.force.at_mut(at));
    }

    #[inline(always)]
    fn leave(&mut self, at: At, acceleration: L::V, _tangent: L::V) {
        L::store(acceleration, self.acceleration.at_mut(at));
    }
}

/// Looks at `position`; returns the largest change of an overlap.
#[inline(always)]
pub fn evaluate<L: Lanes, Y: Layout, const FORM: u8>(
    plan: &Plan,
    position: &[Row],
    found: Found,
) -> L::V {
    let rows = plan.rows();
    let cut = Cut::new(plan, rows);
    if Y::TILE == 0 {
        return all_round::<L, Y, FORM>(cut, &position[..rows], found);
    }
    let (closed, force, acceleration) = found;
    let mut look = Look::<L> {
        rest: Strip::new(cut.rest, rows),
        position: Strip::new(position, rows),
        closed: StripMut::new(closed, rows),
        force: StripMut::new(force, rows),
        acceleration: StripMut::new(acceleration, rows),
        largest: Largest::none(),
    };
    sweep::<L, Y, FORM>(cut, rows, &mut look);
    look.largest.change
}

/// The same of rows that are one tile: one after the other, for this is done once.
#[inline(always)]
fn all_round<L: Lanes, Y: Layout, const FORM: u8>(
    plan: Cut,
    position: &[Row],
    (closed, force, acceleration): Found,
) -> L::V {
    let rows = position.len();
    let force = &mut force[..rows];
    let mut largest = Largest::<L>::none();
    for r in 0..rows {
        let change = L::sub(Y::above_in::<L>(position, r), L::load(&position[r]));
        let (pressed, overlap) = forces::<L, FORM>(plan, r, change);
        closed[r] = L::positive(overlap);
        largest.see(&plan.rest[r], change);
        L::store(pressed, &mut force[r]);
    }
    for r in 0..rows {
        let after = force.get(r + 1).map_or(L::load(&plan.beyond), |row| L::load(row));
        let net = L::sub(L::load(&force[r]), Y::below_in::<L>(force, r, after));
        L::store(accelerations::<L>(plan.bodies(r), net), &mut acceleration[r]);
    }
    largest.change
}
