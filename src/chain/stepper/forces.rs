//! From overlaps to forces, accelerations and their rates, eight contacts at a time.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::plan::{Constants, Form, Plan, Rest};
use super::strip::{At, FOUR, Strip};

/// Forms as constants of the generic loops.
pub const PLAIN: u8 = 0;
/// Without cancellation.
pub const EXACT: u8 = 1;
/// Linearised.
pub const LINEAR: u8 = 2;
/// As the plain one, in units of the stiffness that all contacts share.
pub const ALIKE: u8 = 3;
/// With this bit one row of four goes through the square-root unit, without it every other: a second row would wait for a slow unit longer than for the
/// multipliers.
const SPARSE: u8 = 4;
/// As [`PLAIN`], through a slow unit.
pub const PLAIN_SPARSE: u8 = PLAIN | SPARSE;
/// As [`ALIKE`], through a slow unit.
pub const ALIKE_SPARSE: u8 = ALIKE | SPARSE;

/// The plan's rows, all cut to the same length, so that the loops need not check it.
#[derive(Clone, Copy)]
pub struct Cut<'a> {
    pub stiffness: &'a [Row],
    pub static_overlap: &'a [Row],
    pub inverse_mass: &'a [Row],
    balanced: &'a [Row],
    pub rest: &'a [Rest],
    /// Forces in the row behind the last: nothing has moved there (N).
    pub beyond: Row,
}

impl<'a> Cut<'a> {
    /// The first `rows` rows.
    #[inline(always)]
    pub fn new(plan: &'a Plan, rows: usize) -> Self {
        let Constants { stiffness, static_overlap, inverse_mass, balanced } = plan.constants();
        Self {
            stiffness: &stiffness[..rows],
            static_overlap: &static_overlap[..rows],
            inverse_mass: &inverse_mass[..rows],
            balanced: &balanced[..rows],
            rest: &plan.rest[..rows],
            beyond: plan.rest.get(rows).map_or(Row::default(), |row| row.static_force),
        }
    }

    /// The same as `FORM` wants it: for contacts that are alike, masses and forces over their stiffness.
    #[inline(always)]
    pub fn of<const FORM: u8>(plan: &'a Plan, rows: usize) -> Self {
        let cut = Self::new(plan, rows);
        match &plan.alike {
            Some(alike) if FORM & !SPARSE == ALIKE => Self {
                inverse_mass: &alike.mobility[..rows],
                balanced: &alike.balanced[..rows],
                beyond: alike.static_force.get(rows).copied().unwrap_or_default(),
                ..cut
            },
            _ => cut,
        }
    }
}

/// A row of contacts.
#[derive(Clone, Copy)]
pub struct Contacts<'a> {
    pub stiffness: &'a Row,
    pub static_overlap: &'a Row,
    pub rest: &'a Rest,
}

/// A row of bodies.
#[derive(Clone, Copy)]
pub struct Bodies<'a> {
    pub inverse_mass: &'a Row,
    pub balanced: &'a Row,
}

impl<'a> Cut<'a> {
    /// The contacts of row `r`.
    #[inline(always)]
    pub fn contacts(&self, r: usize) -> Contacts<'a> {
        Contacts {
            stiffness: &self.stiffness[r],
            static_overlap: &self.static_overlap[r],
            rest: &self.rest[r],
        }
    }

    /// The bodies of row `r`.
    #[inline(always)]
    pub fn bodies(&self, r: usize) -> Bodies<'a> {
        Bodies { inverse_mass: &self.inverse_mass[r], balanced: &self.balanced[r] }
    }
}

/// The plan's rows, four at a time.
#[derive(Clone, Copy)]
pub struct Strips<'a> {
    stiffness: Strip<'a, Row>,
    static_overlap: Strip<'a, Row>,
    inverse_mass: Strip<'a, Row>,
    balanced: Strip<'a, Row>,
    rest: Strip<'a, Rest>,
    /// Forces in the row behind the last (N).
    pub beyond: Row,
}

impl<'a> Strips<'a> {
    /// The first `rows` rows of `plan`.
    #[inline(always)]
    pub fn new(plan: Cut<'a>, rows: usize) -> Self {
        Self {
            stiffness: Strip::new(plan.stiffness, rows),
            static_overlap: Strip::new(plan.static_overlap, rows),
            inverse_mass: Strip::new(plan.inverse_mass, rows),
            balanced: Strip::new(plan.balanced, rows),
            rest: Strip::new(plan.rest, rows),
            beyond: plan.beyond,
        }
    }

    /// The contacts of row `at`.
    #[inline(always)]
    pub fn contacts(&self, at: At) -> Contacts<'a> {
        Contacts {
            stiffness: self.stiffness.at(at),
            static_overlap: self.static_overlap.at(at),
            rest: self.rest.at(at),
        }
    }

    /// The bodies of row `at`.
    #[inline(always)]
    pub fn bodies(&self, at: At) -> Bodies<'a> {
        Bodies { inverse_mass: self.inverse_mass.at(at), balanced: self.balanced.at(at) }
    }
}

/// Forces of a row that are begun: what comes out of the square-root unit takes its time.
#[derive(Clone, Copy)]
pub struct Begun<L: Lanes> {
    /// Overlaps of closed contacts, or their changes (m).
    pub closed: L::V,
    /// Roots of overlaps, or what they start from (m^0.5).
    pub root: L::V,
}

impl<L: Lanes> Begun<L> {
    /// Nothing.
    #[inline(always)]
    pub fn none() -> Self {
        Self { closed: L::splat(0.0), root: L::splat(0.0) }
    }

    /// `closed^1.5` of row `r` (m^1.5).
    #[inline(always)]
    pub fn power(self, r: usize) -> L::V {
        let Self { closed, root } = self;
        if is_beside::<PLAIN>(r) {
            L::weigh_root(closed, root, closed)
        } else {
            L::mul(closed, root)
        }
    }
}

/// Begins the forces of `contacts` in row `r` for overlaps that have changed by `change`; the overlaps themselves.
#[inline(always)]
pub fn begin<L: Lanes, const FORM: u8>(
    contacts: Contacts,
    r: usize,
    change: L::V,
) -> (Begun<L>, L::V) {
    let static_overlap = L::load(contacts.static_overlap);
    let overlap = L::add(change, static_overlap);
    let begun = match FORM & !SPARSE {
        PLAIN | ALIKE => begin_plain::<L, FORM>(r, overlap),
        EXACT => {
            let closed = L::max(change, L::sub(L::splat(0.0), static_overlap));
            Begun { closed, root: L::sqrt(L::add(static_overlap, closed)) }
        }
        _ => Begun { closed: change, root: L::splat(2.0 / 3.0) },
    };
    (begun, overlap)
}

/// Number of a row whose roots come from the square-root unit.
pub const BY_UNIT: usize = 1;
/// One that leaves it alone.
pub const BESIDE: usize = 0;

/// Whether row `r` leaves the square-root unit alone: some do, so that it and the multipliers work side by side.
#[inline(always)]
const fn is_beside<const FORM: u8>(r: usize) -> bool {
    if FORM & SPARSE == 0 { r % 2 == BESIDE } else { r % FOUR != BY_UNIT }
}

/// Begins the forces in row `r` in plain form.
#[inline(always)]
pub fn begin_plain<L: Lanes, const FORM: u8>(r: usize, overlap: L::V) -> Begun<L> {
    if is_beside::<FORM>(r) {
        let closed = L::max(overlap, L::splat(1e-200));
        Begun { closed, root: L::start_root(closed) }
    } else {
        let closed = L::max(overlap, L::splat(0.0));
        Begun { closed, root: L::sqrt(closed) }
    }
}

/// Forces of `contacts` in row `r`, or their changes in all forms but the plain one (N), and two thirds of the tangent stiffnesses (N/m); over
/// the stiffness where contacts are alike.
#[inline(always)]
pub fn finish<L: Lanes, const FORM: u8>(
    contacts: Contacts,
    r: usize,
    begun: Begun<L>,
) -> [L::V; 2] {
    let Begun { closed, root } = begun;
    let form = FORM & !SPARSE;
    if form == ALIKE {
        let one = L::splat(1.0);
        let root = if is_beside::<FORM>(r) { L::weigh_root(closed, root, one) } else { root };
        return [L::mul(closed, root), root];
    }
    let stiffness = L::load(contacts.stiffness);
    match form {
        PLAIN if is_beside::<FORM>(r) => {
            let force = L::weigh_root(closed, root, L::mul(stiffness, closed));
            [force, L::weigh_root(closed, root, stiffness)]
        }
        PLAIN => [L::mul(L::mul(stiffness, closed), root), L::mul(stiffness, root)],
        EXACT => {
            // `hertz::force_change`
            let static_root = L::load(&contacts.rest.static_root);
            let sum = L::add(root, static_root);
            let divisor = L::max(sum, L::splat(f64::MIN_POSITIVE));
            let rest = L::sub(sum, L::div(L::mul(root, static_root), divisor));
            [L::mul(L::mul(stiffness, closed), rest), L::mul(stiffness, root)]
        }
        _ => [L::mul(stiffness, closed), L::mul(stiffness, root)],
    }
}

/// Forces in row `r`, as [`finish`] has them, for overlaps that have changed by `change`, and the overlaps themselves.
#[inline(always)]
pub fn forces<L: Lanes, const FORM: u8>(plan: Cut, r: usize, change: L::V) -> (L::V, L::V) {
    let (begun, overlap) = begin::<L, FORM>(plan.contacts(r), r, change);
    let [force, _] = finish::<L, FORM>(plan.contacts(r), r, begun);
    (force, overlap)
}

/// Net forces on `bodies` that nothing balances: exactly none where the contacts' are the static ones.
#[inline(always)]
pub fn unbalanced<L: Lanes>(bodies: Bodies, net: L::V) -> L::V {
    L::sub(net, L::load(bodies.balanced))
}

/// Accelerations of `bodies` under net forces of their contacts.
#[inline(always)]
pub fn accelerations<L: Lanes>(bodies: Bodies, net: L::V) -> L::V {
    L::mul(unbalanced::<L>(bodies, net), L::load(bodies.inverse_mass))
}

/// Rates of the accelerations at positions `x` where bodies move at `v`, in the rows that live.
#[inline(always)]
pub fn jerks<L: Lanes, Y: Layout>(plan: &Plan, (x, v): (&[Row], &[Row]), out: &mut [Row]) {
    let rows = plan.rows();
    let linear = plan.form == Form::Linear;
    let plan = Cut::new(plan, rows);
    let (x, v, out) = (&x[..rows], &v[..rows], &mut out[..rows]);
    let none = L::splat(0.0);
    for r in 0..rows {
        let change = L::sub(Y::above_in::<L>(x, r), L::load(&x[r]));
        let closing = L::sub(Y::above_in::<L>(v, r), L::load(&v[r]));
        let stiffness = L::load(&plan.stiffness[r]);
        let tangent = if linear {
            stiffness
        } else {
            let overlap = L::add(change, L::load(&plan.static_overlap[r]));
            let root = L::sqrt(L::max(overlap, none));
            L::mul(L::mul(L::splat(1.5), stiffness), root)
        };
        L::store(L::mul(tangent, closing), &mut out[r]);
    }
    // From behind, for each row's rates are overwritten once those above them are known.
    let mut after = none;
    for r in (0..rows).rev() {
        let rate = L::load(&out[r]);
        let net = L::sub(rate, Y::below_in::<L>(out, r, after));
        L::store(L::mul(net, L::load(&plan.inverse_mass[r])), &mut out[r]);
        after = rate;
    }
}
