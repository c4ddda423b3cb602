//! Steps of splittings. A chain of few rows stays in the registers from one step to the next; longer ones go through [`super::parts`].
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::{Cut, accelerations, begin, finish, pushed};
use super::lanes::{Lanes, Row};
use super::parts::long;
use super::plan::{Layout, Plan};
use super::workspace::Workspace;
use crate::integrate::splitting::Splitting;

/// Tangents are carried as two thirds of themselves (1).
const TANGENT: f64 = 1.5;

/// What a kick weighs, steps included.
#[derive(Clone, Copy)]
pub struct Kick<L: Lanes> {
    /// Of accelerations (s).
    force: L::V,
    /// Of two thirds of their gradients (s³).
    gradient: L::V,
}

impl<L: Lanes> Kick<L> {
    /// Kick `index` of a step of `h` (s).
    #[inline(always)]
    pub fn new(method: &Splitting, index: usize, h: L::V) -> Self {
        let cube = L::mul(L::mul(h, h), L::mul(h, L::splat(TANGENT)));
        let gradient = method.gradients.get(index).copied().unwrap_or(0.0);
        Self {
            force: L::mul(h, L::splat(method.kicks[index])),
            gradient: L::mul(cube, L::splat(gradient)),
        }
    }

    /// `velocity` after the kick by accelerations and two thirds of their gradients.
    #[inline(always)]
    pub fn on<const GRADIENT: bool>(self, velocity: L::V, of: [L::V; 2]) -> L::V {
        let velocity = L::mul_add(self.force, of[0], velocity);
        if GRADIENT { L::mul_add(self.gradient, of[1], velocity) } else { velocity }
    }
}

/// Takes `count` steps of `h` (s) from `work.now`; the last of them is left in `work`, its start in `now`, its end in `next`. Whether all
/// velocities are finite there, a bit for each lane.
#[inline(always)]
pub fn steps<L: Lanes, Y: Layout, const FORM: u8, const GRADIENT: bool>(
    plan: &Plan,
    method: &Splitting,
    work: &mut Workspace,
    (h, count): (L::V, u64),
) -> u8 {
    match plan.rows() {
        1 => short::<L, Y, FORM, GRADIENT, 1>(plan, method, work, (h, count)),
        2 => short::<L, Y, FORM, GRADIENT, 2>(plan, method, work, (h, count)),
        3 => short::<L, Y, FORM, GRADIENT, 3>(plan, method, work, (h, count)),
        4 => short::<L, Y, FORM, GRADIENT, 4>(plan, method, work, (h, count)),
        5 => short::<L, Y, FORM, GRADIENT, 5>(plan, method, work, (h, count)),
        _ => long::<L, Y, FORM, GRADIENT>(plan, method, work, (h, count)),
    }
    let rows = plan.rows();
    let sum = |sum, row: &Row| L::add(sum, L::load(row));
    Y::all(L::finite(work.next.velocity[..rows].iter().fold(L::splat(0.0), sum)))
}

/// Steps of a chain of `R` rows.
#[inline(always)]
#[allow(clippy::many_single_char_names, reason = "the names of mechanics")]
fn short<L: Lanes, Y: Layout, const FORM: u8, const GRADIENT: bool, const R: usize>(
    plan: &Plan,
    method: &Splitting,
    work: &mut Workspace,
    (h, count): (L::V, u64),
) {
    let plan = Cut::new(plan, R);
    let none = L::splat(0.0);
    let load = |rows: &[Row]| {
        let rows = &rows[..R];
        std::array::from_fn::<L::V, R, _>(|r| L::load(&rows[r]))
    };
    let (mut x, mut v) = (load(&work.now.position), load(&work.now.velocity));
    let (mut a, mut g) = (load(&work.stages[0]), [none; R]);
    if GRADIENT {
        g = load(&work.gradients[0]);
    }
    for step in 1..=count {
        if step == count && count > 1 {
            store::<L, R>(&x, &mut work.now.position);
            store::<L, R>(&v, &mut work.now.velocity);
            store::<L, R>(&a, &mut work.stages[0]);
        }
        let kick = Kick::<L>::new(method, 0, h);
        for r in 0..R {
            v[r] = kick.on::<GRADIENT>(v[r], [a[r], g[r]]);
        }
        for (index, drift) in method.drifts.iter().enumerate() {
            let drift = L::mul(h, L::splat(*drift));
            let kick = Kick::<L>::new(method, index + 1, h);
            let (mut force, mut tangent) = ([none; R], [none; R]);
            for r in 0..R {
                x[r] = L::mul_add(drift, v[r], x[r]);
                let above = if r > 0 { x[r - 1] } else { none };
                let change = L::sub(Y::above::<L>(above, x[r]), x[r]);
                let (begun, _) = begin::<L, FORM>(plan, r, change);
                [force[r], tangent[r]] = finish::<L, FORM>(plan, r, begun);
            }
            for r in 0..R {
                let next = if r + 1 < R { force[r + 1] } else { L::load(&plan.beyond) };
                a[r] = accelerations::<L, Y>(plan, r, [force[r], next]);
            }
            if GRADIENT {
                for r in 0..R {
                    let above = if r > 0 { a[r - 1] } else { none };
                    tangent[r] = L::mul(tangent[r], L::sub(Y::above::<L>(above, a[r]), a[r]));
                }
                for r in 0..R {
                    let next = if r + 1 < R { tangent[r + 1] } else { none };
                    g[r] = pushed::<L, Y>(plan, r, [tangent[r], next]);
                }
            }
            for r in 0..R {
                v[r] = kick.on::<GRADIENT>(v[r], [a[r], g[r]]);
            }
        }
    }
    store::<L, R>(&x, &mut work.next.position);
    store::<L, R>(&v, &mut work.next.velocity);
    store::<L, R>(&a, &mut work.stages[1]);
    if GRADIENT {
        store::<L, R>(&g, &mut work.gradients[1]);
    }
}

#[inline(always)]
fn store<L: Lanes, const R: usize>(values: &[L::V; R], rows: &mut [Row]) {
    for (value, row) in values.iter().zip(&mut rows[..R]) {
        L::store(*value, row);
    }
}
