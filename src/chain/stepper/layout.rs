//! Where the entries of chains stand in rows of eight.
//!
//! Along: one chain, eight neighbouring contacts in a row. Striped: one chain in a few rows, a part of it in each lane, so that neighbours stand
//! in neighbouring rows and the last row stands above the first, a lane further. Across: eight chains of equal length, contact `j` of each in
//! row `j`.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row, WIDTH};

/// How rows lie in the chain.
pub trait Layout: Copy {
    /// Whether the last row stands above the first.
    const STRIPED: bool;
    /// Whether a whole chain along them may be in a few rows, for which there are other loops.
    const IN_FEW_ROWS: bool;
    /// A number of each chain's own.
    type Own: Copy;
    /// What stands before the first row, given the last.
    fn before_first<L: Lanes>(last: L::V) -> L::V;
    /// What stands after the last row, given the first and what is behind the chain.
    fn after_last<L: Lanes>(first: L::V, beyond: L::V) -> L::V;
    /// What stands above `here`, given the row before.
    fn above<L: Lanes>(before: L::V, here: L::V) -> L::V;
    /// What stands below `here`, given the row after.
    fn below<L: Lanes>(here: L::V, after: L::V) -> L::V;
    /// Largest value of a chain, in all its lanes.
    fn largest<L: Lanes>(values: L::V) -> L::V;
    /// `own` in the lanes of its chain.
    fn spread<L: Lanes>(own: Self::Own) -> L::V;
    /// Bits of lanes whose chain has all its bits set.
    fn all(bits: u8) -> u8;
    /// Where entry `index` of the chain in `lane` is, in one of `rows` rows.
    fn place(rows: usize, index: usize, lane: usize) -> (usize, usize);
}

/// One chain, along the rows or striped.
#[derive(Debug, Clone, Copy)]
pub struct OneChain<const STRIPED: bool>;

/// One chain along the rows.
pub type Along = OneChain<false>;

/// One chain in stripes.
pub type Striped = OneChain<true>;

/// Eight chains across the rows.
#[derive(Debug, Clone, Copy)]
pub struct Across;

impl<const STRIPED: bool> Layout for OneChain<STRIPED> {
    const STRIPED: bool = STRIPED;
    const IN_FEW_ROWS: bool = !STRIPED;
    type Own = f64;

    #[inline(always)]
    fn before_first<L: Lanes>(last: L::V) -> L::V {
        let none = L::splat(0.0);
        if STRIPED { L::shift_up(none, last) } else { none }
    }

    #[inline(always)]
    fn after_last<L: Lanes>(first: L::V, beyond: L::V) -> L::V {
        if STRIPED { L::shift_down(first, beyond) } else { beyond }
    }

    #[inline(always)]
    fn above<L: Lanes>(before: L::V, here: L::V) -> L::V {
        if STRIPED { before } else { L::shift_up(before, here) }
    }

    #[inline(always)]
    fn below<L: Lanes>(here: L::V, after: L::V) -> L::V {
        if STRIPED { after } else { L::shift_down(here, after) }
    }

    #[inline(always)]
    fn largest<L: Lanes>(values: L::V) -> L::V {
        L::splat(L::largest(values))
    }

    #[inline(always)]
    fn spread<L: Lanes>(own: f64) -> L::V {
        L::splat(own)
    }

    #[inline(always)]
    fn all(bits: u8) -> u8 {
        if bits == u8::MAX { bits } else { 0 }
    }

    #[inline(always)]
    fn place(rows: usize, index: usize, _lane: usize) -> (usize, usize) {
        if STRIPED { (index % rows, index / rows) } else { (index / WIDTH, index % WIDTH) }
    }
}

impl Layout for Across {
    const STRIPED: bool = false;
    const IN_FEW_ROWS: bool = false;
    type Own = Row;

    #[inline(always)]
    fn before_first<L: Lanes>(_last: L::V) -> L::V {
        L::splat(0.0)
    }

    #[inline(always)]
    fn after_last<L: Lanes>(_first: L::V, beyond: L::V) -> L::V {
        beyond
    }

    #[inline(always)]
    fn above<L: Lanes>(before: L::V, _here: L::V) -> L::V {
        before
    }

    #[inline(always)]
    fn below<L: Lanes>(_here: L::V, after: L::V) -> L::V {
        after
    }

    #[inline(always)]
    fn largest<L: Lanes>(values: L::V) -> L::V {
        values
    }

    #[inline(always)]
    fn spread<L: Lanes>(own: Row) -> L::V {
        L::load(&own)
    }

    #[inline(always)]
    fn all(bits: u8) -> u8 {
        bits
    }

    #[inline(always)]
    fn place(_rows: usize, index: usize, lane: usize) -> (usize, usize) {
        (index, lane)
    }
}
