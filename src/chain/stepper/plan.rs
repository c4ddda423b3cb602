//! A chain as the loops read it: rows of eight, padded with contacts that bear nothing and bodies that never move.
//!
//! Along: one chain, eight neighbouring contacts in a row. Across: eight chains of equal length, contact `j` of each in row `j`.
//! Entry `j` holds contact `j` and the body below it; behind the last body stands a ghost, the bottom wall, that nothing moves.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row, WIDTH};
use crate::chain::{Chain, Contact, Law};

/// Most rows of a short chain: what moves of it fits into the registers.
pub const FEW: usize = 5;

/// How rows lie in the chain.
pub trait Layout: Copy {
    /// Whether a whole chain may be in a few rows.
    const IN_FEW_ROWS: bool;
    /// A number of each chain's own.
    type Own: Copy;
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
    /// Where entry `index` of the chain in `lane` is.
    fn place(index: usize, lane: usize) -> (usize, usize);
    /// Where the body above contact (`row`, `lane`) is; none above the first.
    fn upper(row: usize, lane: usize) -> Option<(usize, usize)>;
}

/// One chain along the rows.
#[derive(Debug, Clone, Copy)]
pub struct Along;

/// Eight chains across the rows.
#[derive(Debug, Clone, Copy)]
pub struct Across;

impl Layout for Along {
    const IN_FEW_ROWS: bool = true;
    type Own = f64;

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
    fn place(index: usize, _lane: usize) -> (usize, usize) {
        (index / WIDTH, index % WIDTH)
    }

    #[inline(always)]
    fn upper(row: usize, lane: usize) -> Option<(usize, usize)> {
        let index = (row * WIDTH + lane).checked_sub(1)?;
        Some((index / WIDTH, index % WIDTH))
    }
}

impl Layout for Across {
    const IN_FEW_ROWS: bool = false;
    type Own = Row;

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
    fn place(index: usize, lane: usize) -> (usize, usize) {
        (index, lane)
    }

    #[inline(always)]
    fn upper(row: usize, lane: usize) -> Option<(usize, usize)> {
        Some((row.checked_sub(1)?, lane))
    }
}

/// How forces are computed from overlaps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// `A overlap^1.5`: rounds to 2 ulp of the static force.
    Plain,
    /// Without cancellation, for waves far below the preload; one division more.
    Exact,
    /// Linearised contacts.
    Linear,
}

/// Contacts and bodies in rows.
#[derive(Debug, Clone)]
pub struct Plan {
    /// How forces are computed.
    pub form: Form,
    /// Rows from the first on that the loops go over; in those behind nothing has moved yet.
    pub live: usize,
    /// `A` of each contact, or its tangent where contacts are linearised (unit).
    pub stiffness: Vec<Row>,
    /// Static overlap of each contact (m).
    pub static_overlap: Vec<Row>,
    /// Inverse mass of each body (1/kg).
    pub inverse_mass: Vec<Row>,
    /// Net force of its contacts that leaves each body at rest: in plain form that of the static forces as these loops compute them, so that
    /// rest is rest to the last bit, less what statics does not balance (N).
    pub balanced: Vec<Row>,
    /// The rest, row by row.
    pub rest: Vec<Rest>,
}

/// What is asked for now and then of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// The least that a contact's overlap changes by, for it opens there (m); not a number where there is nothing to touch.
    pub floor: Row,
    /// Square root of the static overlap (m^0.5).
    pub static_root: Row,
    /// Force of each contact at rest as these loops compute it; none where they compute changes (N).
    pub static_force: Row,
}

impl Rest {
    /// Of contacts that there are none of.
    const NONE: Self = Self {
        floor: Row([f64::NAN; WIDTH]),
        static_root: Row([0.0; WIDTH]),
        static_force: Row([0.0; WIDTH]),
    };
}

/// Relative rounding of a force in plain form (1).
const ROUNDING: f64 = 5e-16;
/// The plain form's rounding stays below this share of the accuracy asked for (1).
const ROUNDING_SHARE: f64 = 1e-3;

impl Form {
    /// What `chain` needs when its velocities (m/s) are to be followed to `accuracy` (1): the exact form only where the
    /// rounding of the static force could be seen in the wave.
    #[must_use]
    pub fn needed(chain: &Chain, velocity: &[f64], accuracy: f64) -> Self {
        let contacts = chain.contacts();
        if contacts.iter().any(|c| c.law == Law::Linearised) {
            return Self::Linear;
        }
        let overlap = chain.impact_overlap(velocity);
        // The wave presses a contact at least as it would without preload: where that is enough, nothing more need be known.
        let least = overlap * overlap.sqrt();
        let visible = |c: &&Contact| {
            let is_more = |wave| ROUNDING * c.static_force > ROUNDING_SHARE * accuracy * wave;
            is_more(c.stiffness * least) && is_more(c.force_change(overlap))
        };
        if contacts.iter().filter(|c| c.stiffness > 0.0).any(|c| visible(&c)) {
            Self::Exact
        } else {
            Self::Plain
        }
    }
}

impl Plan {
    /// One chain along the rows.
    #[must_use]
    pub fn along(chain: &Chain, form: Form) -> Self {
        let rows = chain.contacts().len().div_ceil(WIDTH);
        let mut plan = Self::empty(form, rows);
        for j in 0..chain.contacts().len() {
            plan.set(chain, j, (j / WIDTH, j % WIDTH));
        }
        plan
    }

    /// Up to eight chains of the same number of bodies across the rows; lanes left over hold nothing.
    #[must_use]
    pub fn across(chains: &[&Chain], form: Form) -> Self {
        let rows = chains.first().map_or(0, |chain| chain.contacts().len());
        let mut plan = Self::empty(form, rows);
        for (lane, chain) in chains.iter().enumerate().take(WIDTH) {
            for j in 0..rows.min(chain.contacts().len()) {
                plan.set(chain, j, (j, lane));
            }
        }
        plan
    }

    /// Number of rows that the loops go over.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.live
    }

    /// Whether the whole chain fits into a few rows, where it has its own loops: they round in their own ways, and a chain is all its
    /// time in one or the other.
    #[must_use]
    pub fn in_few_rows<Y: Layout>(&self) -> bool {
        Y::IN_FEW_ROWS && self.form == Form::Plain && self.all_rows() <= FEW
    }

    /// Number of all rows.
    #[must_use]
    pub fn all_rows(&self) -> usize {
        self.rest.len()
    }

    fn empty(form: Form, rows: usize) -> Self {
        let zeros = || vec![Row::default(); rows];
        Self {
            form,
            live: rows,
            stiffness: zeros(),
            static_overlap: zeros(),
            inverse_mass: zeros(),
            balanced: zeros(),
            rest: vec![Rest::NONE; rows],
        }
    }

    fn set(&mut self, chain: &Chain, j: usize, place: (usize, usize)) {
        let (row, lane) = place;
        let rest = &mut self.rest[row];
        let contact = chain.contacts()[j];
        let touches = contact.stiffness > 0.0;
        let stiffness = match self.form {
            Form::Linear => contact.static_stiffness(),
            Form::Plain | Form::Exact => contact.stiffness,
        };
        // Where there is nothing to touch, there is a gap that nothing closes.
        let overlap = if touches { contact.static_overlap } else { -1.0 };
        self.stiffness[row].0[lane] = stiffness;
        self.static_overlap[row].0[lane] = overlap;
        rest.static_root.0[lane] = overlap.max(0.0).sqrt();
        rest.floor.0[lane] = if touches { -overlap } else { f64::NAN };
        if let (Some(body), Some(force)) = (chain.bodies().get(j), chain.residual.get(j)) {
            self.inverse_mass[row].0[lane] = 1.0 / body.mass;
            self.balanced[row].0[lane] = -force;
        }
    }
}
