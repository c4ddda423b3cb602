//! A short chain's rows all at once, their number known to the compiler.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row};
use super::layout::{Along, Layout};

/// A value of each contact, or of the body below it.
pub type Rows<L, const R: usize> = [<L as Lanes>::V; R];

/// The first `R` of `rows`.
#[inline(always)]
pub fn load<L: Lanes, const R: usize>(rows: &[Row]) -> Rows<L, R> {
    let mut values = [L::splat(0.0); R];
    for (value, row) in values.iter_mut().zip(&rows.as_chunks::<R>().0[0]) {
        *value = L::load(row);
    }
    values
}

/// Into the first `R` of `rows`.
#[inline(always)]
pub fn store<L: Lanes, const R: usize>(values: &Rows<L, R>, rows: &mut [Row]) {
    for (value, row) in values.iter().zip(&mut rows.as_chunks_mut::<R>().0[0]) {
        L::store(*value, row);
    }
}

/// `by` times all of them.
#[inline(always)]
pub fn scaled<L: Lanes, const R: usize>(by: L::V, mut values: Rows<L, R>) -> Rows<L, R> {
    for value in &mut values {
        *value = L::mul(by, *value);
    }
    values
}

/// Those above.
#[inline(always)]
pub fn above<L: Lanes, Y: Layout, const R: usize>(of: &Rows<L, R>) -> Rows<L, R> {
    let mut out = *of;
    for r in 0..R {
        let (first, last) = Y::tile(R, r);
        let before = if r > 0 { of[r - 1] } else { L::splat(0.0) };
        out[r] = if r > first { before } else { Y::above::<L>(before, of[last]) };
    }
    out
}

/// Those below; behind the last is what is `beyond` the chain.
#[inline(always)]
fn below<L: Lanes, Y: Layout, const R: usize>(of: &Rows<L, R>, beyond: L::V) -> Rows<L, R> {
    let mut out = *of;
    for r in 0..R {
        let (first, last) = Y::tile(R, r);
        let after = if r + 1 < R { of[r + 1] } else { beyond };
        out[r] = if r < last { after } else { Y::below::<L>(of[first], after) };
    }
    out
}

/// How much more the bodies above have than those below.
#[inline(always)]
pub fn differences<L: Lanes, Y: Layout, const R: usize>(of: &Rows<L, R>) -> Rows<L, R> {
    let mut out = above::<L, Y, R>(of);
    for r in 0..R {
        out[r] = L::sub(out[r], of[r]);
    }
    out
}

/// Net of the contacts above and below each body, with what is `beyond` the chain below the last.
#[inline(always)]
pub fn nets<L: Lanes, Y: Layout, const R: usize>(of: &Rows<L, R>, beyond: L::V) -> Rows<L, R> {
    let mut out = below::<L, Y, R>(of, beyond);
    for r in 0..R {
        out[r] = L::sub(of[r], out[r]);
    }
    out
}

/// Largest magnitude of the rows, lane by lane: in pairs, for each waits for those before.
#[inline(always)]
pub fn largest_of<L: Lanes, const R: usize>(mut values: Rows<L, R>) -> L::V {
    for value in &mut values {
        *value = L::abs(*value);
    }
    let mut apart = 1;
    while apart < R {
        let mut r = 0;
        while r + apart < R {
            values[r] = L::max(values[r + apart], values[r]);
            r += 2 * apart;
        }
        apart *= 2;
    }
    values[0]
}

/// What forces do to overlaps by way of the bodies' masses.
#[derive(Clone, Copy)]
pub struct Mobility<L: Lanes, const R: usize> {
    /// Inverse masses of the bodies above each contact.
    above: Rows<L, R>,
    /// Of both its bodies together, with a minus.
    both: Rows<L, R>,
    /// Of those below.
    pub below: Rows<L, R>,
}

impl<L: Lanes, const R: usize> Mobility<L, R> {
    /// Of bodies of these inverse masses, times anything.
    #[inline(always)]
    pub fn new(inverse_mass: Rows<L, R>) -> Self {
        let (above, mut both) = (above::<L, Along, R>(&inverse_mass), inverse_mass);
        for r in 0..R {
            both[r] = L::sub(L::sub(L::splat(0.0), above[r]), inverse_mass[r]);
        }
        Self { above, both, below: inverse_mass }
    }

    /// `at` plus what `push` makes of it: `push` above over the mass above, less what it is here over both, plus below over the one below.
    #[inline(always)]
    pub fn moved(&self, mut at: Rows<L, R>, push: &Rows<L, R>) -> Rows<L, R> {
        for r in 0..R {
            let before = if r > 0 { push[r - 1] } else { L::splat(0.0) };
            let next = if r + 1 < R { push[r + 1] } else { L::splat(0.0) };
            let here = L::mul_add(self.both[r], push[r], at[r]);
            let here = L::mul_add(self.above[r], Along::above::<L>(before, push[r]), here);
            at[r] = L::mul_add(self.below[r], Along::below::<L>(push[r], next), here);
        }
        at
    }
}
