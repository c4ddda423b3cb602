//! Where the entries of chains stand in rows of eight.
//!
//! Along: one chain, eight neighbouring contacts in a row. Tiled: one chain in tiles of four rows, of which each lane holds four contacts on end,
//! so that three of four rows have their neighbours in the rows before and after, which costs nothing; rows left over lie along. Striped: the same
//! with one tile for all of a chain of few rows. Across: eight chains of equal length, contact `j` of each in row `j`.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row, WIDTH};

/// How rows lie in the chain: in tiles of which each lane holds some contacts on end.
pub trait Layout: Copy {
    /// Rows of a tile, but for those left over, which are tiles of their own; none if all are one tile.
    const TILE: usize;
    /// Whether a whole chain along them may be in a few rows, for which there are other loops.
    const IN_FEW_ROWS: bool;
    /// A number of each chain's own.
    type Own: Copy;
    /// How rows lie that are tiles of their own.
    type Alone: Layout;
    /// What stands above the first row of a tile, given the last row of the tile before and of its own.
    fn above<L: Lanes>(before: L::V, here: L::V) -> L::V;
    /// What stands below the last row of a tile, given the first row of its own and of the tile after.
    fn below<L: Lanes>(here: L::V, after: L::V) -> L::V;
    /// Largest value of a chain, in all its lanes.
    fn largest<L: Lanes>(values: L::V) -> L::V;
    /// `own` in the lanes of its chain.
    fn spread<L: Lanes>(own: Self::Own) -> L::V;
    /// Bits of lanes whose chain has all its bits set.
    fn all(bits: u8) -> u8;
    /// Where entry `index` of the chain in `lane` is, in one of `rows` rows.
    fn place(rows: usize, index: usize, lane: usize) -> (usize, usize);

    /// First and last row of the tile that holds row `r` of `rows`.
    #[inline(always)]
    fn tile(rows: usize, r: usize) -> (usize, usize) {
        if Self::TILE == 0 {
            return (0, rows - 1);
        }
        let first = r / Self::TILE * Self::TILE;
        let last = first + Self::TILE - 1;
        if last < rows { (first, last) } else { (r, r) }
    }

    /// What stands above row `r` of `rows`.
    #[inline(always)]
    fn above_in<L: Lanes>(rows: &[Row], r: usize) -> L::V {
        let (first, last) = Self::tile(rows.len(), r);
        let before = if r > 0 { L::load(&rows[r - 1]) } else { L::splat(0.0) };
        if r > first { before } else { Self::above::<L>(before, L::load(&rows[last])) }
    }

    /// What stands below row `r` of `rows`, given what is in the row after it.
    #[inline(always)]
    fn below_in<L: Lanes>(rows: &[Row], r: usize, after: L::V) -> L::V {
        let (first, last) = Self::tile(rows.len(), r);
        if r < last { after } else { Self::below::<L>(L::load(&rows[first]), after) }
    }
}

/// One chain, in tiles of so many rows.
#[derive(Debug, Clone, Copy)]
pub struct OneChain<const TILE: usize>;

/// One chain along the rows.
pub type Along = OneChain<1>;

/// One chain in tiles.
pub type Tiled = OneChain<4>;

/// One chain in stripes.
pub type Striped = OneChain<0>;

/// Eight chains across the rows.
#[derive(Debug, Clone, Copy)]
pub struct Across;

impl<const TILE: usize> Layout for OneChain<TILE> {
    const TILE: usize = TILE;
    const IN_FEW_ROWS: bool = TILE == 1;
    type Own = f64;
    type Alone = Along;

    #[inline(always)]
    fn above<L: Lanes>(before: L::V, here: L::V) -> L::V {
        L::shift_up(before, here)
    }

    #[inline(always)]
    fn below<L: Lanes>(here: L::V, after: L::V) -> L::V {
        L::shift_down(here, after)
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
        if TILE == 0 {
            return (index % rows, index / rows);
        }
        let (tile, within) = (index / (TILE * WIDTH), index % (TILE * WIDTH));
        if (tile + 1) * TILE <= rows {
            (tile * TILE + within % TILE, within / TILE)
        } else {
            (index / WIDTH, index % WIDTH)
        }
    }
}

impl Layout for Across {
    const TILE: usize = 1;
    const IN_FEW_ROWS: bool = false;
    type Own = Row;
    type Alone = Self;

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
