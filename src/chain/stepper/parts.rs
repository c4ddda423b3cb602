//! A splitting's steps in parts, one sweep along the rows each: a drift, the forces, where the method asks for it how they change where
//! they point, and a kick.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::{Cut, pushed};
use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::plan::Plan;
use super::splits::{Kick, Weights};
use super::sweep::{Visit, sweep};
use super::workspace::Workspace;

/// Positions, velocities, accelerations, and their gradients where a method asks for them.
type Rows<'a> = [&'a mut [Row]; 4];

/// A part of a step that goes on where the one before ended.
const ON: u8 = 0;
/// The first part of a step, from its start elsewhere.
const FROM: u8 = 1;
/// The first part of a step, from its start in the same place.
const HERE: u8 = 2;

/// Steps of a chain that does not fit into the registers, as [`super::splits::steps`] takes them. All but the last are taken in place:
/// less memory is read and written.
#[inline(always)]
pub fn long<L: Lanes, Y: Layout, const FORM: u8, const GRADIENT: bool>(
    plan: &Plan,
    work: &mut Workspace,
    (weights, count): (&Weights<L>, u64),
) {
    let rows = plan.rows();
    let plan = Cut::of::<FORM>(plan, rows);
    let shown = if GRADIENT { rows } else { 0 };
    let (now, next) = (work.now.parts(), work.next.parts());
    let mut from: Rows = [
        &mut now.position[..rows],
        &mut now.velocity[..rows],
        &mut now.acceleration[..rows],
        &mut now.gradient[..shown],
    ];
    for _ in 1..count {
        step::<L, Y, FORM, GRADIENT, HERE>(plan, weights, ([&[]; 4], &mut from));
    }
    let mut to: Rows = [
        &mut next.position[..rows],
        &mut next.velocity[..rows],
        &mut next.acceleration[..rows],
        &mut next.gradient[..shown],
    ];
    let from = [&*from[0], &*from[1], &*from[2], &*from[3]];
    step::<L, Y, FORM, GRADIENT, FROM>(plan, weights, (from, &mut to));
}

#[inline(always)]
fn step<L: Lanes, Y: Layout, const FORM: u8, const GRADIENT: bool, const START: u8>(
    plan: Cut,
    weights: &Weights<L>,
    (from, to): ([&[Row]; 4], &mut Rows),
) {
    let parts = weights.parts();
    if parts == 1 {
        part::<L, Y, FORM, GRADIENT, START, true>(plan, weights, 0, (from, to));
        return;
    }
    part::<L, Y, FORM, GRADIENT, START, false>(plan, weights, 0, (from, to));
    for index in 1..parts - 1 {
        part::<L, Y, FORM, GRADIENT, ON, false>(plan, weights, index, (from, to));
    }
    part::<L, Y, FORM, GRADIENT, ON, true>(plan, weights, parts - 1, (from, to));
}

/// Part `index` of a step, the last of it or not.
#[inline(always)]
fn part<
    L: Lanes,
    Y: Layout,
    const FORM: u8,
    const GRADIENT: bool,
    const START: u8,
    const LAST: bool,
>(
    plan: Cut,
    weights: &Weights<L>,
    index: usize,
    (from, to): ([&[Row]; 4], &mut Rows),
) {
    let rows = to[0].len();
    let kicks = [weights.kick::<GRADIENT>(index), weights.kick::<GRADIENT>(index + 1)];
    let drift = weights.drift(index);
    let mut part = Part::<L, GRADIENT, START, LAST>::new(plan, kicks, drift, (from, to));
    sweep::<L, Y, FORM>(plan, rows, &mut part);
    part.end::<Y>();
}

/// Drift, forces, gradients and the second of `kicks`; before it the first of them, where a step begins. In the last part of a step,
/// accelerations are kept for the next.
struct Part<'a, L: Lanes, const GRADIENT: bool, const START: u8, const LAST: bool> {
    plan: Cut<'a>,
    kicks: [Kick<L>; 2],
    drift: L::V,
    from: [&'a [Row]; 4],
    to: Rows<'a>,
    /// Accelerations of the row left last (m/s²), and two thirds of what their differences do to the forces (N/s²).
    bent: [L::V; 2],
}

impl<'a, L: Lanes, const GRADIENT: bool, const START: u8, const LAST: bool>
    Part<'a, L, GRADIENT, START, LAST>
{
    #[inline(always)]
    fn new(
        plan: Cut<'a>,
        kicks: [Kick<L>; 2],
        drift: L::V,
        (from, to): ([&'a [Row]; 4], &'a mut Rows),
    ) -> Self {
        let rows = to[0].len();
        let shown = if GRADIENT { rows } else { 0 };
        let from = if START == FROM {
            [&from[0][..rows], &from[1][..rows], &from[2][..rows], &from[3][..shown]]
        } else {
            from
        };
        let [x, v, a, g] = to;
        let to: Rows = [&mut x[..rows], &mut v[..rows], &mut a[..rows], &mut g[..shown]];
        Self { plan, kicks, drift, from, to, bent: [L::splat(0.0); 2] }
    }

    /// Velocities in row `r` of what is `at` the start, after the first kick.
    #[inline(always)]
    fn opened(&self, at: [&[Row]; 4], r: usize) -> L::V {
        let gradient = if GRADIENT { L::load(&at[3][r]) } else { L::splat(0.0) };
        self.kicks[0].on::<GRADIENT>(L::load(&at[1][r]), [L::load(&at[2][r]), gradient])
    }

    /// Kicks row `r`, whose contacts' bends end above `next`.
    #[inline(always)]
    fn bend<Y: Layout>(&mut self, r: usize, next: L::V) {
        let [acceleration, bend] = self.bent;
        let gradient = pushed::<L, Y>(self.plan, r, [bend, next]);
        if LAST {
            L::store(gradient, &mut self.to[3][r]);
        }
        let velocity = &mut self.to[1][r];
        let kicked = self.kicks[1].on::<true>(L::load(velocity), [acceleration, gradient]);
        L::store(kicked, velocity);
    }

    /// Kicks the last row.
    #[inline(always)]
    fn end<Y: Layout>(&mut self) {
        let rows = self.to[0].len();
        if GRADIENT && rows > 0 {
            self.bend::<Y>(rows - 1, L::splat(0.0));
        }
    }
}

impl<L: Lanes, Y: Layout, const GRADIENT: bool, const START: u8, const LAST: bool> Visit<L, Y>
    for Part<'_, L, GRADIENT, START, LAST>
{
    #[inline(always)]
    fn enter(&mut self, r: usize) -> L::V {
        let (x, speed) = match START {
            FROM => (&self.from[0][r], self.opened(self.from, r)),
            HERE => {
                let [position, velocity, of, gradient] = &self.to;
                (&position[r], self.opened([position, velocity, of, gradient], r))
            }
            _ => (&self.to[0][r], L::load(&self.to[1][r])),
        };
        let here = L::mul_add(self.drift, speed, L::load(x));
        L::store(here, &mut self.to[0][r]);
        if START != ON {
            L::store(speed, &mut self.to[1][r]);
        }
        here
    }

    #[inline(always)]
    fn leave(&mut self, r: usize, acceleration: L::V, [_, tangent]: [L::V; 2]) {
        if LAST {
            L::store(acceleration, &mut self.to[2][r]);
        }
        if GRADIENT {
            let above = Y::above::<L>(self.bent[0], acceleration);
            let bend = L::mul(tangent, L::sub(above, acceleration));
            if r > 0 {
                self.bend::<Y>(r - 1, bend);
            }
            self.bent = [acceleration, bend];
        } else {
            let velocity = &mut self.to[1][r];
            let of = [acceleration, L::splat(0.0)];
            L::store(self.kicks[1].on::<false>(L::load(velocity), of), velocity);
        }
    }
}
