//! Steps of splittings. A striped chain of few rows stays in the registers from one step to the next; longer ones go through [`super::parts`].
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::{Cut, begin_plain, finish, unbalanced};
use super::lanes::Lanes;
use super::layout::Layout;
use super::parts::{Steps, long};
use super::plan::{FEW, Plan};
use super::rows::{Rows, above, differences, load, nets, store};
use super::timing::{Fixed, Timing};
use super::workspace::{Parts, Workspace};
use crate::integrate::splitting::Splitting;

/// Tangents are carried as two thirds of themselves (1).
pub const TANGENT: f64 = 1.5;

/// What a kick weighs, steps included.
#[derive(Clone, Copy)]
pub struct Kick<L: Lanes> {
    /// Of accelerations (s).
    force: L::V,
    /// Of two thirds of their gradients (s³).
    gradient: L::V,
}

/// A step's kicks and drifts, its length included.
#[derive(Clone, Copy)]
pub struct Weights<'a, L: Lanes> {
    method: &'a Splitting,
    /// Length of the step (s).
    h: L::V,
    /// What two thirds of gradients are multiplied by (s³).
    cube: L::V,
}

impl<'a, L: Lanes> Weights<'a, L> {
    /// Of a step of `h` (s).
    #[inline(always)]
    pub fn new(method: &'a Splitting, h: L::V) -> Self {
        let cube = L::mul(L::mul(h, h), L::mul(h, L::splat(TANGENT)));
        Self { method, h, cube }
    }

    /// How many drifts there are.
    #[inline(always)]
    pub fn parts(&self) -> usize {
        self.method.drifts.len()
    }

    /// The kick before drift `index`, or after the last.
    #[inline(always)]
    pub fn kick<const GRADIENT: bool>(&self, index: usize) -> Kick<L> {
        let force = L::mul(self.h, L::splat(self.method.kicks[index]));
        let gradient = if GRADIENT {
            L::mul(self.cube, L::splat(self.method.gradients[index]))
        } else {
            L::splat(0.0)
        };
        Kick { force, gradient }
    }

    /// Drift `index` (s).
    #[inline(always)]
    pub fn drift(&self, index: usize) -> L::V {
        L::mul(self.h, L::splat(self.method.drifts[index]))
    }
}

impl<L: Lanes> Kick<L> {
    /// `velocity` after the kick by accelerations and two thirds of their gradients.
    #[inline(always)]
    pub fn on<const GRADIENT: bool>(self, velocity: L::V, of: [L::V; 2]) -> L::V {
        let velocity = L::mul_add(self.force, of[0], velocity);
        if GRADIENT { L::mul_add(self.gradient, of[1], velocity) } else { velocity }
    }
}

/// Takes `steps` from `work.now`; the last of them is left in `work`, its start in `now`, its end in `next`. Whether all
/// velocities are finite there, a bit for each lane.
#[inline(always)]
pub fn steps<L: Lanes, Y: Layout, const FORM: u8, const GRADIENT: bool>(
    plan: &Plan,
    work: &mut Workspace,
    mut steps: Steps,
) -> u8 {
    if Y::TILE == 0 {
        let weights = Weights::new(steps.method, L::load(steps.length));
        let (left, notes) = (steps.count, steps.notes);
        if GRADIENT && steps.method.gradients[0] == 0.0 {
            let mut timing = Fixed::<L, false> { weights, left, notes };
            timed::<L, Y, FORM, GRADIENT>(plan, work, &mut timing)
        } else {
            let mut timing = Fixed::<L, true> { weights, left, notes };
            timed::<L, Y, FORM, GRADIENT>(plan, work, &mut timing)
        }
    } else {
        long::<L, Y, FORM, GRADIENT>(plan, work, &mut steps);
        are_finite::<L, Y>(plan, work)
    }
}

/// Takes the steps of `timing` in the registers, as [`steps`] does.
#[inline(always)]
pub fn timed<'m, L: Lanes, Y: Layout, const FORM: u8, const GRADIENT: bool>(
    plan: &Plan,
    work: &mut Workspace,
    timing: &mut impl Timing<'m, L>,
) -> u8 {
    match plan.rows() {
        1 => short::<L, Y, _, FORM, GRADIENT, 1>(plan, work, timing),
        2 => short::<L, Y, _, FORM, GRADIENT, 2>(plan, work, timing),
        3 => short::<L, Y, _, FORM, GRADIENT, 3>(plan, work, timing),
        4 => short::<L, Y, _, FORM, GRADIENT, 4>(plan, work, timing),
        _ => short::<L, Y, _, FORM, GRADIENT, FEW>(plan, work, timing),
    }
    are_finite::<L, Y>(plan, work)
}

/// Whether all velocities are finite where the last step ends, a bit for each lane.
#[inline(always)]
fn are_finite<L: Lanes, Y: Layout>(plan: &Plan, work: &Workspace) -> u8 {
    let mut sum = L::splat(0.0);
    for row in &work.next.velocity()[..plan.rows()] {
        sum = L::add(sum, L::load(row));
    }
    Y::all(L::finite(sum))
}

/// Overlaps where bodies stand at `x` (m).
#[inline(always)]
fn overlaps<L: Lanes, Y: Layout, const R: usize>(plan: Cut, x: &Rows<L, R>) -> Rows<L, R> {
    let mut overlap = above::<L, Y, R>(x);
    for r in 0..R {
        // In this order one of the two need not wait for the neighbour.
        let short = L::sub(x[r], L::load(&plan.static_overlap[r]));
        overlap[r] = L::sub(overlap[r], short);
    }
    overlap
}

/// What contacts are pressed with where bodies stand at `x` (m): forces (N) and two thirds of tangent stiffnesses (N/m).
#[inline(always)]
fn pressed<L: Lanes, Y: Layout, const FORM: u8, const R: usize>(
    plan: Cut,
    x: &Rows<L, R>,
) -> [Rows<L, R>; 2] {
    let (overlap, mut force, mut tangent) = (overlaps::<L, Y, R>(plan, x), *x, *x);
    for r in 0..R {
        let begun = begin_plain::<L, FORM>(r, overlap[r]);
        [force[r], tangent[r]] = finish::<L, FORM>(plan.contacts(r), r, begun);
    }
    [force, tangent]
}

/// Position and velocity after a kick, by what weighs so much, and a drift.
#[inline(always)]
fn drifted<L: Lanes>([x, v]: [L::V; 2], [weight, push]: [L::V; 2], drift: L::V) -> [L::V; 2] {
    let kicked = L::mul_add(weight, push, v);
    if L::WAITS {
        // The drift does not wait for the velocities: all but what the newest forces add to it is there before them.
        let drifted = L::mul_add(drift, v, x);
        [L::mul_add(L::mul(drift, weight), push, drifted), kicked]
    } else {
        [L::mul_add(drift, kicked, x), kicked]
    }
}

/// Keeps positions (m), velocities (m/s) and accelerations (m/s²).
#[inline(always)]
fn keep<L: Lanes, const R: usize>([x, v, a]: [&Rows<L, R>; 3], parts: &mut Parts) {
    store::<L, R>(x, parts.position);
    store::<L, R>(v, parts.velocity);
    store::<L, R>(a, parts.acceleration);
}

/// Steps of a chain of `R` rows, in plain form.
#[inline(always)]
#[allow(clippy::many_single_char_names, reason = "the names of mechanics")]
fn short<
    'm,
    L: Lanes,
    Y: Layout,
    T: Timing<'m, L>,
    const FORM: u8,
    const GRADIENT: bool,
    const R: usize,
>(
    plan: &Plan,
    work: &mut Workspace,
    timing: &mut T,
) {
    let plan = Cut::new(plan, R);
    let none = L::splat(0.0);
    let (mut x, mut v) = (load::<L, R>(work.now.position()), load::<L, R>(work.now.velocity()));
    let (mut a, mut g) = (load::<L, R>(work.now.acceleration()), [none; R]);
    if GRADIENT && T::AT_ENDS {
        g = load::<L, R>(work.now.gradient());
    }
    let mut is_first = true;
    loop {
        let (weights, is_last) = (timing.weights(), timing.is_last());
        if is_last && !is_first {
            keep::<L, R>([&x, &v, &a], &mut work.now.parts());
        }
        let (kick, drift) = (weights.kick::<GRADIENT>(0), weights.drift(0));
        for r in 0..R {
            v[r] = kick.on::<GRADIENT>(v[r], [a[r], g[r]]);
            x[r] = L::mul_add(drift, v[r], x[r]);
        }
        for part in 1..=weights.parts() {
            let last = part == weights.parts();
            let [force, mut tangent] = pressed::<L, Y, FORM, R>(plan, &x);
            let kick = weights.kick::<GRADIENT>(part);
            let mut push = nets::<L, Y, R>(&force, L::load(&plan.beyond));
            for (r, push) in push.iter_mut().enumerate() {
                *push = unbalanced::<L>(plan.bodies(r), *push);
            }
            let mut weight = kick.force;
            if GRADIENT {
                for r in 0..R {
                    a[r] = L::mul(push[r], L::load(&plan.inverse_mass[r]));
                    v[r] = L::mul_add(kick.force, a[r], v[r]);
                }
                if last && !T::AT_ENDS {
                    break;
                }
                let bend = differences::<L, Y, R>(&a);
                for r in 0..R {
                    tangent[r] = L::mul(tangent[r], bend[r]);
                }
                push = nets::<L, Y, R>(&tangent, none);
                weight = kick.gradient;
            }
            if last {
                for r in 0..R {
                    let pushed = L::mul(push[r], L::load(&plan.inverse_mass[r]));
                    v[r] = L::mul_add(weight, pushed, v[r]);
                    if GRADIENT { g[r] = pushed } else { a[r] = pushed }
                }
                break;
            }
            let drift = weights.drift(part);
            for r in 0..R {
                let weight = L::mul(weight, L::load(&plan.inverse_mass[r]));
                [x[r], v[r]] = drifted::<L>([x[r], v[r]], [weight, push[r]], drift);
            }
        }
        if T::SEES {
            timing.see(&overlaps::<L, Y, R>(plan, &x));
        }
        for r in 0..R {
            timing.note(r, [x[r], v[r], a[r]]);
        }
        timing.finish();
        if is_last {
            break;
        }
        timing.go_on();
        is_first = false;
    }
    keep::<L, R>([&x, &v, &a], &mut work.next.parts());
    if GRADIENT && T::AT_ENDS {
        store::<L, R>(&g, work.next.parts().gradient);
    }
}
