//! A chain as the loops read it: rows of eight, padded with contacts that bear nothing and bodies that never move.
//!
//! Entry `j` holds contact `j` and the body below it; behind the last body stands a ghost, the bottom wall, that nothing moves.

use super::dispatch::InstructionSet;
pub use super::form::Form;
use super::lanes::{Lanes, Row, WIDTH};
use super::layout::Layout;
use super::workspace::anew;
use crate::chain::{Body, Chain};
use crate::integrate::Scheme;

/// Most rows of a short chain: what moves of it fits into the registers.
pub const FEW: usize = 5;

/// With which instructions forces are computed, and how.
pub type How = (InstructionSet, Form);

/// Contacts and bodies in rows.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    /// How forces are computed.
    pub form: Form,
    /// Whether few roots go through the square-root unit, for it is slow and steps are a splitting's, which have less to do besides than a pair's.
    sparse: bool,
    /// Rows from the first on that the loops go over; in those behind nothing has moved yet.
    pub live: usize,
    /// Those of [`Constants`], one after the other in one piece of memory, as [`super::workspace::Motion`] has its parts.
    constants: Vec<Row>,
    /// The rest, row by row.
    pub rest: Vec<Rest>,
    /// The same chain in units in which the stiffness of its contacts is 1, for splittings that do not wait for their results, where all of a
    /// chain's contacts have the same.
    pub alike: Option<Alike>,
    /// Contacts that ask for shorter steps than others as they close and open: at most two that are as stiff for their bodies as the stiffest.
    pub watched: Vec<Watched>,
}

/// What becomes of forces over the stiffness `A` that all contacts of a chain share: an operation and a number less for each.
#[derive(Debug, Clone, Default)]
pub struct Alike {
    /// `A` over the mass of each body (m^-0.5 s^-2).
    pub mobility: Vec<Row>,
    /// [`Constants::balanced`] over `A` (m^1.5).
    pub balanced: Vec<Row>,
    /// [`Rest::static_force`] over `A` (m^1.5).
    pub static_force: Vec<Row>,
}

/// How many numbers there are of each contact or body.
const CONSTANTS: usize = 4;

/// What a chain's loops go by, in rows.
#[derive(Debug, Clone, Copy)]
pub struct Constants<'a> {
    /// `A` of each contact, or its tangent where contacts are linearised (unit).
    pub stiffness: &'a [Row],
    /// Static overlap of each contact (m).
    pub static_overlap: &'a [Row],
    /// Inverse mass of each body (1/kg).
    pub inverse_mass: &'a [Row],
    /// Net force of its contacts that leaves each body at rest: in plain form that of the static forces as these loops compute them, so that
    /// rest is rest to the last bit, less what statics does not balance (N).
    pub balanced: &'a [Row],
}

/// Stiffnesses are the same that differ by rounding (1).
const SAME: f64 = 4e-16;

/// A contact to be watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watched {
    /// Row and lane of it and of the body below.
    pub at: (usize, usize),
    /// Those of the body above; none at the top.
    pub above: Option<(usize, usize)>,
    /// Its stiffness over the reduced mass of its bodies (m^-0.5 s^-2).
    pub stiffness: f64,
}

/// More contacts of a chain that are all as stiff for their bodies are not watched: where there is one stiff striker there may be two.
const MOST_WATCHED: usize = 2;
/// A contact is as stiff for its bodies as the stiffest down to this share (1).
const AS_STIFF: f64 = 0.5;

/// What is asked for now and then of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// The least that a contact's overlap changes by, for it opens there (m); not a number where there is nothing to touch.
    pub floor: Row,
    /// Square root of the static overlap, once it is settled (m^0.5).
    pub static_root: Row,
    /// Force of each contact at rest as these loops compute it; none where they compute changes (N).
    pub static_force: Row,
}

impl Default for Rest {
    /// Of contacts that there are none of.
    fn default() -> Self {
        let (static_root, static_force) = Default::default();
        Self { floor: Row([f64::NAN; WIDTH]), static_root, static_force }
    }
}

/// Where there is nothing to touch, there is a gap that nothing closes (m).
const NOTHING: f64 = -1e100;

/// The stiffness that all contacts of `chain` share, if they do, where steps of `scheme` are fixed and forces are in plain form (N/m^1.5).
#[must_use]
pub fn shared_stiffness(chain: &Chain, scheme: Scheme, form: Form) -> Option<f64> {
    let all = || chain.contacts().iter().map(|contact| contact.stiffness).filter(|a| *a > 0.0);
    let first = all().next()?;
    let fits = form == Form::Plain && !matches!(scheme, Scheme::Pair(..));
    (fits && all().all(|stiffness| (stiffness - first).abs() <= SAME * first)).then_some(first)
}

/// Rows that one chain takes.
#[must_use]
pub fn rows_of(chain: &Chain) -> usize {
    chain.contacts().len().div_ceil(WIDTH)
}

/// Whether chains in so many `rows` have loops of their own.
#[must_use]
pub fn are_few(rows: usize, form: Form) -> bool {
    form == Form::Plain && rows <= FEW
}

impl Plan {
    /// One chain, for steps of `scheme`. Short chains wait for their results, not for arithmetic: they gain nothing by a shared stiffness.
    #[must_use]
    pub fn one<Y: Layout>(chain: &Chain, scheme: Scheme, how: How) -> Self {
        let rows = rows_of(chain);
        let mut plan = Self::default();
        plan.empty(scheme, how, rows);
        plan.fill(chain, chain.contacts().len(), |j| Y::place(rows, j, 0));
        if matches!(scheme, Scheme::Pair(..)) {
            plan.watch(chain, |j| Y::place(rows, j, 0));
        }
        let shared = shared_stiffness(chain, scheme, how.1).filter(|_| Y::TILE != 0);
        if let Some(stiffness) = shared {
            plan.share(Row([stiffness; WIDTH]), Alike::default());
        }
        plan
    }

    /// Has it be up to eight chains of the same number of bodies across the rows, which share stiffnesses or not; lanes left over hold nothing.
    pub fn across(&mut self, chains: &[&Chain], scheme: Scheme, how: How) {
        let rows = chains.first().map_or(0, |chain| chain.contacts().len());
        let alike = self.empty(scheme, how, rows);
        for (lane, chain) in chains.iter().enumerate().take(WIDTH) {
            self.fill(chain, rows.min(chain.contacts().len()), |j| (j, lane));
            if matches!(scheme, Scheme::Pair(..)) {
                self.watch(chain, |j| (j, lane));
            }
        }
        let shared = |chain: &&Chain| shared_stiffness(chain, scheme, how.1);
        if let Some(shared) = chains.iter().map(shared).collect::<Option<Vec<f64>>>() {
            let lane = |lane| shared.get(lane).copied().unwrap_or(1.0);
            self.share(Row(std::array::from_fn(lane)), alike);
        }
    }

    /// Whether the loops of `L` let few roots through the square-root unit.
    #[inline]
    #[must_use]
    pub fn is_sparse<L: Lanes>(&self) -> bool {
        L::IS_BESIDE && self.sparse
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
        Y::IN_FEW_ROWS && are_few(self.all_rows(), self.form)
    }

    /// Number of all rows.
    #[must_use]
    pub fn all_rows(&self) -> usize {
        self.rest.len()
    }

    /// All of it, part by part.
    #[inline]
    #[must_use]
    pub fn constants(&self) -> Constants<'_> {
        let (mut rows, count) = (self.constants.as_slice(), self.all_rows());
        let mut next = || rows.split_off(..count).unwrap_or_default();
        Constants {
            stiffness: next(),
            static_overlap: next(),
            inverse_mass: next(),
            balanced: next(),
        }
    }

    /// All of it and the rest, to be written.
    #[inline]
    pub fn parts(&mut self) -> ([&mut [Row]; CONSTANTS], &mut [Rest]) {
        let (mut rows, count) = (self.constants.as_mut_slice(), self.rest.len());
        let mut next = |_| rows.split_off_mut(..count).unwrap_or_default();
        (std::array::from_fn(&mut next), &mut self.rest)
    }

    /// Nothing in `rows` rows, for steps of `scheme`; gives back what there was of chains that shared a stiffness.
    fn empty(&mut self, scheme: Scheme, (set, form): How, rows: usize) -> Alike {
        (self.form, self.live) = (form, rows);
        self.sparse = !matches!(scheme, Scheme::Pair(..)) && set.has_slow_roots();
        anew(&mut self.constants, CONSTANTS * rows);
        anew(&mut self.rest, rows);
        self.watched.clear();
        self.alike.take().unwrap_or_default()
    }

    /// Has the chain of each lane in units of the stiffness that its contacts share, too (N/m^1.5), in the memory of `alike`; what is balanced is yet to be
    /// settled.
    fn share(&mut self, stiffness: Row, mut alike: Alike) {
        let Constants { inverse_mass, balanced, .. } = self.constants();
        let times = |of: &Row| Row(std::array::from_fn(|lane| of.0[lane] * stiffness.0[lane]));
        let over = |of: &Row| Row(std::array::from_fn(|lane| of.0[lane] / stiffness.0[lane]));
        alike.mobility.clear();
        alike.mobility.extend(inverse_mass.iter().map(times));
        alike.balanced.clear();
        alike.balanced.extend(balanced.iter().map(over));
        anew(&mut alike.static_force, self.all_rows());
        self.alike = Some(alike);
    }

    /// Watches those contacts of `chain` that are as stiff for their bodies as the stiffest, if they are few.
    fn watch(&mut self, chain: &Chain, place: impl Fn(usize) -> (usize, usize)) {
        let inverse_mass = |body: Option<&Body>| body.map_or(0.0, |body| 1.0 / body.mass);
        let stiffness = |j: usize| {
            let above = j.checked_sub(1).and_then(|i| chain.bodies().get(i));
            let mobility = inverse_mass(above) + inverse_mass(chain.bodies().get(j));
            chain.contacts()[j].stiffness * mobility
        };
        let all = 0..chain.contacts().len();
        let most = all.clone().map(stiffness).fold(0.0, f64::max);
        let stiff = |j: &usize| stiffness(*j) > AS_STIFF * most;
        if self.form == Form::Linear || all.clone().filter(stiff).nth(MOST_WATCHED).is_some() {
            return;
        }
        let watched = |j: usize| {
            let above = j.checked_sub(1).map(&place);
            Watched { at: place(j), above, stiffness: stiffness(j) }
        };
        self.watched.extend(all.filter(stiff).map(watched));
    }

    /// Puts the first `count` contacts of `chain` and the bodies below them where `place` tells.
    fn fill(&mut self, chain: &Chain, count: usize, place: impl Fn(usize) -> (usize, usize)) {
        let is_linear = self.form == Form::Linear;
        let ([stiffness, static_overlap, inverse_mass, balanced], rest) = self.parts();
        for (j, contact) in chain.contacts().iter().enumerate().take(count) {
            let (row, lane) = place(j);
            let touches = contact.stiffness > 0.0;
            let overlap = if touches { contact.static_overlap } else { NOTHING };
            stiffness[row].0[lane] =
                if is_linear { contact.static_stiffness() } else { contact.stiffness };
            static_overlap[row].0[lane] = overlap;
            rest[row].floor.0[lane] = if touches { -overlap } else { f64::NAN };
            if let (Some(body), Some(force)) = (chain.bodies().get(j), chain.residual.get(j)) {
                inverse_mass[row].0[lane] = 1.0 / body.mass;
                balanced[row].0[lane] = -force;
            }
        }
    }
}
