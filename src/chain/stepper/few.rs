//! Steps of short chains under a pair, with the number of rows and the pair's coefficients known to the compiler: a whole step is one run of
//! instructions, and the newest accelerations stay in the registers.
//!
//! Rows of a short chain wait for each other's results most of the time, and every instruction between the end of a step and the start of
//! the next is waited for as well. The arithmetic is that of [`super::passes`].
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::evaluate::Largest;
use super::forces::{Cut, PLAIN, accelerations, begin, finish};
use super::known::{Known, Position, Stage, Sum};
use super::lanes::{Lanes, Row};
use super::passes::{Sides, add_compensated, speed_up};
use super::plan::{Along, FEW, Layout, Plan};
use super::workspace::{Between, Motion, Workspace};

/// The first `R` of `rows`.
#[inline(always)]
fn first<T, const R: usize>(rows: &[T]) -> &[T; R] {
    &rows.as_chunks::<R>().0[0]
}

/// The same to be written.
#[inline(always)]
fn first_mut<T, const R: usize>(rows: &mut [T]) -> &mut [T; R] {
    &mut rows.as_chunks_mut::<R>().0[0]
}

/// Contacts at some positions, and what they do to the bodies.
struct Contacts<L: Lanes, const R: usize> {
    /// Changes of the overlaps (m).
    change: [L::V; R],
    /// Overlaps (m).
    overlap: [L::V; R],
    /// Accelerations (m/s²).
    acceleration: [L::V; R],
}

impl<L: Lanes, const R: usize> Contacts<L, R> {
    /// At positions `x` (m).
    #[inline(always)]
    fn at(plan: Cut, x: &[L::V; R]) -> Self {
        let none = L::splat(0.0);
        let (mut change, mut overlap) = ([none; R], [none; R]);
        let (mut force, mut acceleration) = ([none; R], [none; R]);
        for r in 0..R {
            let above = if r > 0 { x[r - 1] } else { none };
            change[r] = L::sub(Along::above::<L>(above, x[r]), x[r]);
            let begun;
            (begun, overlap[r]) = begin::<L, PLAIN>(plan, r, change[r]);
            [force[r], _] = finish::<L, PLAIN>(plan, r, begun);
        }
        for r in 0..R {
            let next = if r + 1 < R { force[r + 1] } else { L::load(&plan.beyond) };
            acceleration[r] = accelerations::<L, Along>(plan, r, [force[r], next]);
        }
        Self { change, overlap, acceleration }
    }
}

/// Where a step starts, and how long it is.
#[derive(Clone, Copy)]
struct Start<'a, L: Lanes, const R: usize> {
    plan: Cut<'a>,
    now: &'a Motion,
    /// Accelerations (m/s²).
    acceleration: &'a [Row; R],
    /// Length of the step (s), and its square (s²).
    h: [L::V; 2],
}

impl<L: Lanes, const R: usize> Start<'_, L, R> {
    /// Finds the accelerations of stage `S` from those before, the last of which are `newest`.
    #[inline(always)]
    fn stage<P: Known<N>, const S: usize, const N: usize>(
        &self,
        between: &mut [Between; R],
        newest: [L::V; R],
    ) -> [L::V; R] {
        if S + 1 >= N {
            return newest;
        }
        let [h, square] = self.h;
        let (x, v) = (first::<Row, R>(&self.now.position), first::<Row, R>(&self.now.velocity));
        let sum = Sum::<L, Stage<P, N, S>>::new(square);
        let reach = L::mul(h, L::splat(P::PAIR.nodes[S]));
        let mut at = newest;
        for r in 0..R {
            let mut here = L::mul_add(reach, L::load(&v[r]), L::load(&x[r]));
            if S > 1 {
                here = sum.plus((&self.acceleration[r], &between[r]), S - 1, here);
            }
            at[r] = sum.newest(S - 1, newest[r], here);
        }
        let Contacts { acceleration, .. } = Contacts::<L, R>::at(self.plan, &at);
        for r in 0..R {
            L::store(acceleration[r], &mut between[r][S - 1]);
        }
        acceleration
    }
}

/// Tries a step as [`super::passes::attempt`] does, in plain form; none where the chain has more rows.
#[inline(always)]
pub fn attempt<L: Lanes, P: Known<N>, const N: usize>(
    plan: &Plan,
    work: &mut Workspace,
    step: (L::V, [L::V; 2]),
) -> Option<Sides> {
    match plan.rows() {
        1 => Some(whole::<L, P, 1, N>(plan, work, step)),
        2 => Some(whole::<L, P, 2, N>(plan, work, step)),
        3 => Some(whole::<L, P, 3, N>(plan, work, step)),
        4 => Some(whole::<L, P, 4, N>(plan, work, step)),
        FEW => Some(whole::<L, P, FEW, N>(plan, work, step)),
        _ => None,
    }
}

#[inline(always)]
fn whole<L: Lanes, P: Known<N>, const R: usize, const N: usize>(
    plan: &Plan,
    work: &mut Workspace,
    (h, worth): (L::V, [L::V; 2]),
) -> Sides {
    let Workspace { now, next, accelerations, between, overlap, .. } = work;
    let [first_of, last_of] = accelerations;
    let (acceleration, arrived) = (first::<Row, R>(first_of), first_mut::<Row, R>(last_of));
    let between = first_mut::<Between, R>(between);
    let square = L::mul(h, h);
    let start = Start::<L, R> { plan: Cut::new(plan, R), now, acceleration, h: [h, square] };
    let mut newest = [h; R];
    for r in 0..R {
        newest[r] = L::load(&acceleration[r]);
    }
    newest = start.stage::<P, 1, N>(between, newest);
    newest = start.stage::<P, 2, N>(between, newest);
    newest = start.stage::<P, 3, N>(between, newest);
    newest = start.stage::<P, 4, N>(between, newest);
    newest = start.stage::<P, 5, N>(between, newest);
    newest = start.stage::<P, 6, N>(between, newest);
    newest = start.stage::<P, 7, N>(between, newest);
    // As `passes::arrive` has it.
    let (x, v) = (first::<Row, R>(&now.position), first::<Row, R>(&now.velocity));
    let sum = Sum::<L, Position<P, N>>::new(square);
    let lost = first::<Row, R>(&now.lost_position);
    let to = first_mut::<Row, R>(&mut next.position);
    let to_lost = first_mut::<Row, R>(&mut next.lost_position);
    let mut at = [h; R];
    for r in 0..R {
        let drift = L::mul(h, L::load(&v[r]));
        let kept = sum.plus((&acceleration[r], &between[r]), N - 2, drift);
        let rise = sum.newest(N - 2, newest[r], kept);
        let rest;
        (at[r], rest) = add_compensated::<L>(L::load(&x[r]), L::load(&lost[r]), rise);
        L::store(at[r], &mut to[r]);
        L::store(rest, &mut to_lost[r]);
    }
    let there = Contacts::<L, R>::at(start.plan, &at);
    let mut largest = Largest::<L>::new(start.plan);
    let (was_closed, closed) = (&now.closed[..R], &mut next.closed[..R]);
    let overlap = first_mut::<Row, R>(overlap);
    let mut changed = 0;
    for r in 0..R {
        L::store(there.acceleration[r], &mut arrived[r]);
        closed[r] = L::positive(there.overlap[r]);
        changed |= closed[r] ^ was_closed[r];
        L::store(there.overlap[r], &mut overlap[r]);
        largest.see(r, there.change[r]);
    }
    L::store(Along::largest::<L>(largest.change), &mut work.largest.overlap);
    let doubtful = speed_up::<L, Along, P, N>(R, (h, worth), work);
    Sides { changed: changed != 0, doubtful }
}
