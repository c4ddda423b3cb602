//! From overlaps to forces, accelerations and their rates, eight contacts at a time.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::plan::{Form, Plan, Rest};

/// Forms as constants of the generic loops.
pub const PLAIN: u8 = 0;
/// Without cancellation.
pub const EXACT: u8 = 1;
/// Linearised.
pub const LINEAR: u8 = 2;
/// As the plain one, in units of the stiffness that all contacts share.
pub const ALIKE: u8 = 3;

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
        Self {
            stiffness: &plan.stiffness[..rows],
            static_overlap: &plan.static_overlap[..rows],
            inverse_mass: &plan.inverse_mass[..rows],
            balanced: &plan.balanced[..rows],
            rest: &plan.rest[..rows],
            beyond: plan.rest.get(rows).map_or(Row::default(), |row| row.static_force),
        }
    }

    /// The same as `FORM` wants it: for contacts that are alike, masses and forces over their stiffness.
    #[inline(always)]
    pub fn of<const FORM: u8>(plan: &'a Plan, rows: usize) -> Self {
        let cut = Self::new(plan, rows);
        match &plan.alike {
            Some(alike) if FORM == ALIKE => Self {
                inverse_mass: &alike.mobility[..rows],
                balanced: &alike.balanced[..rows],
                beyond: alike.static_force.get(rows).copied().unwrap_or_default(),
                ..cut
            },
            _ => cut,
        }
    }
}

/// Forces of a row that are begun: what comes out of the square-root unit takes its time.
#[derive(Clone, Copy)]
pub struct Begun<L: Lanes> {
    /// Overlaps of closed contacts, or their changes (m).
    closed: L::V,
    /// Roots of overlaps, or what they start from (m^0.5).
    root: L::V,
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
        if r % 2 == 1 { L::weigh_root(closed, root, closed) } else { L::mul(closed, root) }
    }
}

/// Begins the forces in row `r` for overlaps that have changed by `change`; the overlaps themselves.
#[inline(always)]
pub fn begin<L: Lanes, const FORM: u8>(plan: Cut, r: usize, change: L::V) -> (Begun<L>, L::V) {
    let static_overlap = L::load(&plan.static_overlap[r]);
    let overlap = L::add(change, static_overlap);
    let begun = match FORM {
        PLAIN | ALIKE => begin_plain::<L>(r, overlap),
        EXACT => {
            let closed = L::max(change, L::sub(L::splat(0.0), static_overlap));
            Begun { closed, root: L::sqrt(L::add(static_overlap, closed)) }
        }
        _ => Begun { closed: change, root: L::splat(2.0 / 3.0) },
    };
    (begun, overlap)
}

/// Begins the forces in row `r` in plain form.
#[inline(always)]
pub fn begin_plain<L: Lanes>(r: usize, overlap: L::V) -> Begun<L> {
    // Every other row leaves the square-root unit alone: it and the multipliers work side by side.
    if r % 2 == 1 {
        let closed = L::max(overlap, L::splat(1e-200));
        Begun { closed, root: L::start_root(closed) }
    } else {
        let closed = L::max(overlap, L::splat(0.0));
        Begun { closed, root: L::sqrt(closed) }
    }
}

/// Forces in row `r`, or their changes in all forms but the plain one (N), and two thirds of the tangent stiffnesses (N/m); over the stiffness
/// where contacts are alike.
#[inline(always)]
pub fn finish<L: Lanes, const FORM: u8>(plan: Cut, r: usize, begun: Begun<L>) -> [L::V; 2] {
    let Begun { closed, root } = begun;
    if FORM == ALIKE {
        let one = L::splat(1.0);
        let root = if r % 2 == 1 { L::weigh_root(closed, root, one) } else { root };
        return [begun.power(r), root];
    }
    let stiffness = L::load(&plan.stiffness[r]);
    match FORM {
        PLAIN if r % 2 == 1 => {
            let force = L::weigh_root(closed, root, L::mul(stiffness, closed));
            [force, L::weigh_root(closed, root, stiffness)]
        }
        PLAIN => [L::mul(L::mul(stiffness, closed), root), L::mul(stiffness, root)],
        EXACT => {
            // `hertz::force_change`
            let static_root = L::load(&plan.rest[r].static_root);
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
    let (begun, overlap) = begin::<L, FORM>(plan, r, change);
    let [force, _] = finish::<L, FORM>(plan, r, begun);
    (force, overlap)
}

/// Net forces of the contacts on a row, between the forces above and those of the next row.
#[inline(always)]
pub fn net<L: Lanes, Y: Layout>(force: [L::V; 2]) -> L::V {
    L::sub(force[0], Y::below::<L>(force[0], force[1]))
}

/// What net forces of the contacts do to the accelerations of row `r`.
#[inline(always)]
pub fn pushed<L: Lanes, Y: Layout>(plan: Cut, r: usize, force: [L::V; 2]) -> L::V {
    L::mul(net::<L, Y>(force), L::load(&plan.inverse_mass[r]))
}

/// Forces on row `r` that nothing balances: exactly none where the contacts' are the static ones.
#[inline(always)]
pub fn unbalanced<L: Lanes, Y: Layout>(plan: Cut, r: usize, force: [L::V; 2]) -> L::V {
    L::sub(net::<L, Y>(force), L::load(&plan.balanced[r]))
}

/// Accelerations of row `r`.
#[inline(always)]
pub fn accelerations<L: Lanes, Y: Layout>(plan: Cut, r: usize, force: [L::V; 2]) -> L::V {
    L::mul(unbalanced::<L, Y>(plan, r, force), L::load(&plan.inverse_mass[r]))
}

/// Rates of the accelerations at positions `x` where bodies move at `v`, in the rows that live.
#[inline(always)]
pub fn jerks<L: Lanes, Y: Layout>(plan: &Plan, (x, v): (&[Row], &[Row]), out: &mut [Row]) {
    let rows = plan.rows();
    let linear = plan.form == Form::Linear;
    let plan = Cut::new(plan, rows);
    let (x, v, out) = (&x[..rows], &v[..rows], &mut out[..rows]);
    let none = L::splat(0.0);
    let mut last = match (x.last(), v.last()) {
        (Some(x), Some(v)) => [Y::before_first::<L>(L::load(x)), Y::before_first::<L>(L::load(v))],
        _ => [none; 2],
    };
    let (mut rate, mut top) = (none, none);
    for r in 0..rows {
        let here = [L::load(&x[r]), L::load(&v[r])];
        let change = L::sub(Y::above::<L>(last[0], here[0]), here[0]);
        let closing = L::sub(Y::above::<L>(last[1], here[1]), here[1]);
        let stiffness = L::load(&plan.stiffness[r]);
        let tangent = if linear {
            stiffness
        } else {
            let overlap = L::add(change, L::load(&plan.static_overlap[r]));
            let root = L::sqrt(L::max(overlap, L::splat(0.0)));
            L::mul(L::mul(L::splat(1.5), stiffness), root)
        };
        let next = L::mul(tangent, closing);
        if r == 0 {
            top = next;
        } else {
            L::store(pushed::<L, Y>(plan, r - 1, [rate, next]), &mut out[r - 1]);
        }
        (last, rate) = (here, next);
    }
    if let Some(end) = rows.checked_sub(1) {
        let next = Y::after_last::<L>(top, none);
        L::store(pushed::<L, Y>(plan, end, [rate, next]), &mut out[end]);
    }
}
