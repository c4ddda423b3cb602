//! From overlaps to forces, accelerations and their rates, eight contacts at a time.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row};
use super::plan::{Form, Layout, Plan};
use super::workspace::Motion;

/// Forms as constants of the generic loops.
pub const PLAIN: u8 = 0;
/// Without cancellation.
pub const EXACT: u8 = 1;
/// Linearised.
pub const LINEAR: u8 = 2;

/// The plan's rows, all cut to the same length, so that the loops need not check it.
#[derive(Clone, Copy)]
pub struct Cut<'a> {
    stiffness: &'a [Row],
    pub static_overlap: &'a [Row],
    static_root: &'a [Row],
    static_force: &'a [Row],
    inverse_mass: &'a [Row],
    residual: &'a [Row],
    pub active: &'a [Row],
}

impl<'a> Cut<'a> {
    /// The first `rows` rows.
    #[inline(always)]
    pub fn new(plan: &'a Plan, rows: usize) -> Self {
        Self {
            stiffness: &plan.stiffness[..rows],
            static_overlap: &plan.static_overlap[..rows],
            static_root: &plan.static_root[..rows],
            static_force: &plan.static_force[..rows],
            inverse_mass: &plan.inverse_mass[..rows],
            residual: &plan.residual[..rows],
            active: &plan.active[..rows],
        }
    }
}

/// Change of the forces in row `r` for overlaps that have changed by `change`, and the overlaps themselves.
#[inline(always)]
pub fn forces<L: Lanes, const FORM: u8>(plan: Cut, r: usize, change: L::V) -> (L::V, L::V) {
    let stiffness = L::load(&plan.stiffness[r]);
    let static_overlap = L::load(&plan.static_overlap[r]);
    let overlap = L::add(change, static_overlap);
    let force = match FORM {
        // Every other row leaves the square-root unit alone: it and the multipliers work side by side.
        PLAIN if r % 2 == 1 => {
            let power = L::three_halves(L::max(overlap, L::splat(1e-200)));
            L::sub(L::mul(stiffness, power), L::load(&plan.static_force[r]))
        }
        PLAIN => {
            let closed = L::max(overlap, L::splat(0.0));
            let force = L::mul(L::mul(stiffness, closed), L::sqrt(closed));
            L::sub(force, L::load(&plan.static_force[r]))
        }
        EXACT => {
            // `hertz::force_change`
            let static_root = L::load(&plan.static_root[r]);
            let lost = L::sub(L::splat(0.0), static_overlap);
            let change = L::max(change, lost);
            let root = L::sqrt(L::add(static_overlap, change));
            let sum = L::add(root, static_root);
            let divisor = L::max(sum, L::splat(f64::MIN_POSITIVE));
            let rest = L::sub(sum, L::div(L::mul(root, static_root), divisor));
            L::mul(L::mul(stiffness, change), rest)
        }
        _ => L::mul(stiffness, change),
    };
    (force, overlap)
}

/// Writes the accelerations of row `r` between the forces above and those of the next row.
#[inline(always)]
pub fn accelerate<L: Lanes, Y: Layout>(plan: Cut, r: usize, force: [L::V; 2], out: &mut [Row]) {
    let net = L::sub(force[0], Y::below::<L>(force[0], force[1]));
    let inverse_mass = L::load(&plan.inverse_mass[r]);
    L::store(L::mul_add(net, inverse_mass, L::load(&plan.residual[r])), &mut out[r]);
}

/// Rates of the accelerations at `motion`.
#[inline(always)]
pub fn jerks<L: Lanes, Y: Layout>(plan: &Plan, motion: &Motion, out: &mut [Row]) {
    let rows = plan.rows();
    let linear = plan.form == Form::Linear;
    let plan = Cut::new(plan, rows);
    let (x, v, out) = (&motion.position[..rows], &motion.velocity[..rows], &mut out[..rows]);
    let mut last = [L::splat(0.0); 2];
    let mut rate = L::splat(0.0);
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
        if r > 0 {
            let sum = L::sub(rate, Y::below::<L>(rate, next));
            L::store(L::mul(sum, L::load(&plan.inverse_mass[r - 1])), &mut out[r - 1]);
        }
        (last, rate) = (here, next);
    }
    if rows > 0 {
        let net = L::sub(rate, Y::below::<L>(rate, L::splat(0.0)));
        L::store(L::mul(net, L::load(&plan.inverse_mass[rows - 1])), &mut out[rows - 1]);
    }
}
