//! Steps of short chains under a pair, with the number of rows and the pair's coefficients known to the compiler: a whole step is one run of
//! instructions, and the newest accelerations stay in the registers.
//!
//! Rows of a short chain wait for each other's results most of the time, and every instruction between the end of a step and the start of
//! the next is waited for as well. The arithmetic is that of [`super::passes`].
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

mod known;

use super::evaluate::Largest;
use super::forces::{Cut, PLAIN, accelerations, begin, finish};
use super::lanes::{Lanes, Row};
use super::passes::{Sides, add_compensated};
use super::plan::{Along, Layout, Plan};
use super::workspace::{Motion, Workspace};
use crate::integrate::dormand_el_mikkawy_prince_64::DORMAND_EL_MIKKAWY_PRINCE_64;
use crate::integrate::dormand_el_mikkawy_prince_86::DORMAND_EL_MIKKAWY_PRINCE_86;
use crate::integrate::nystrom::NystromPair;
use known::{
    Known, Pair64, Pair86, Position, PositionError, Stage, Sum, Velocity, VelocityError, first,
    first_mut,
};

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
    /// Length of the step (s), and its square (s²).
    h: [L::V; 2],
}

impl<L: Lanes, const R: usize> Start<'_, L, R> {
    /// Finds the accelerations of stage `S` from those before, the last of which are `newest`.
    #[inline(always)]
    fn stage<P: Known<N>, const S: usize, const N: usize>(
        &self,
        stages: &mut [&mut [Row; R]; N],
        newest: [L::V; R],
    ) -> [L::V; R] {
        if S >= N - 1 {
            return newest;
        }
        let [h, square] = self.h;
        let (x, v) = (first::<R>(&self.now.position), first::<R>(&self.now.velocity));
        let sum = Sum::<L, Stage<P, N, S>>::new(square);
        let reach = L::mul(h, L::splat(P::PAIR.nodes[S]));
        let mut at = newest;
        for r in 0..R {
            let drifted = L::mul_add(reach, L::load(&v[r]), L::load(&x[r]));
            let kept = sum.kept((stages, S - 1), (drifted, r));
            at[r] = sum.newest(S - 1, newest[r], kept);
        }
        let Contacts { acceleration, .. } = Contacts::<L, R>::at(self.plan, &at);
        for r in 0..R {
            L::store(acceleration[r], &mut stages[S][r]);
        }
        acceleration
    }
}

/// Tries a step as [`super::passes::attempt`] does, in plain form; none where the chain has more rows, or the compiler does not know the
/// pair.
#[inline(always)]
pub fn attempt<L: Lanes>(
    plan: &Plan,
    pair: &NystromPair,
    work: &mut Workspace,
    step: (L::V, [L::V; 2]),
) -> Option<Sides> {
    if std::ptr::eq(pair, &raw const DORMAND_EL_MIKKAWY_PRINCE_64) {
        return by_rows::<L, Pair64, 6>(plan, work, step);
    }
    if std::ptr::eq(pair, &raw const DORMAND_EL_MIKKAWY_PRINCE_86) {
        return by_rows::<L, Pair86, 9>(plan, work, step);
    }
    None
}

#[inline(always)]
fn by_rows<L: Lanes, P: Known<N>, const N: usize>(
    plan: &Plan,
    work: &mut Workspace,
    step: (L::V, [L::V; 2]),
) -> Option<Sides> {
    match plan.rows() {
        1 => whole::<L, P, 1, N>(plan, work, step),
        2 => whole::<L, P, 2, N>(plan, work, step),
        3 => whole::<L, P, 3, N>(plan, work, step),
        4 => whole::<L, P, 4, N>(plan, work, step),
        5 => whole::<L, P, 5, N>(plan, work, step),
        _ => None,
    }
}

#[inline(always)]
fn whole<L: Lanes, P: Known<N>, const R: usize, const N: usize>(
    plan: &Plan,
    work: &mut Workspace,
    (h, worth): (L::V, [L::V; 2]),
) -> Option<Sides> {
    let Workspace { now, next, stages, error_position, error_velocity, overlap, .. } = work;
    let mut stages = P::stages::<R>(stages)?;
    let square = L::mul(h, h);
    let start = Start::<L, R> { plan: Cut::new(plan, R), now, h: [h, square] };
    let mut newest = [h; R];
    for r in 0..R {
        newest[r] = L::load(&stages[0][r]);
    }
    newest = start.stage::<P, 1, N>(&mut stages, newest);
    newest = start.stage::<P, 2, N>(&mut stages, newest);
    newest = start.stage::<P, 3, N>(&mut stages, newest);
    newest = start.stage::<P, 4, N>(&mut stages, newest);
    newest = start.stage::<P, 5, N>(&mut stages, newest);
    newest = start.stage::<P, 6, N>(&mut stages, newest);
    newest = start.stage::<P, 7, N>(&mut stages, newest);
    let (x, v) = (first::<R>(&now.position), first::<R>(&now.velocity));
    let sum = Sum::<L, Position<P, N>>::new(square);
    let lost = first::<R>(&now.lost_position);
    let to = first_mut::<R>(&mut next.position);
    let to_lost = first_mut::<R>(&mut next.lost_position);
    let mut at = [h; R];
    for r in 0..R {
        let kept = sum.kept((&stages, N - 2), (L::mul(h, L::load(&v[r])), r));
        let rise = sum.newest(N - 2, newest[r], kept);
        let rest;
        (at[r], rest) = add_compensated::<L>(L::load(&x[r]), L::load(&lost[r]), rise);
        L::store(at[r], &mut to[r]);
        L::store(rest, &mut to_lost[r]);
    }
    let there = Contacts::<L, R>::at(start.plan, &at);
    let mut largest = Largest::<L>::new(start.plan);
    let (was_closed, closed) = (&now.closed[..R], &mut next.closed[..R]);
    let overlap = first_mut::<R>(overlap);
    let mut changed = 0;
    for r in 0..R {
        L::store(there.acceleration[r], &mut stages[N - 1][r]);
        closed[r] = L::positive(there.overlap[r]);
        changed |= closed[r] ^ was_closed[r];
        L::store(there.overlap[r], &mut overlap[r]);
        largest.see(r, there.change[r]);
    }
    // As `passes::speed_up` has it.
    let velocity_sum = Sum::<L, Velocity<P, N>>::new(h);
    let error_sums =
        (Sum::<L, PositionError<P, N>>::new(square), Sum::<L, VelocityError<P, N>>::new(h));
    let lost = first::<R>(&now.lost_velocity);
    let to = first_mut::<R>(&mut next.velocity);
    let to_lost = first_mut::<R>(&mut next.lost_velocity);
    let errors = (first_mut::<R>(error_position), first_mut::<R>(error_velocity));
    let none = L::splat(0.0);
    let mut most = [none; 3];
    let (mut total, mut above, mut doubtful) = (none, none, none);
    for r in 0..R {
        let rest;
        let rise = velocity_sum.all(&stages, (newest[r], there.acceleration[r]), r);
        let position_error = error_sums.0.all(&stages, (newest[r], there.acceleration[r]), r);
        let velocity_error = error_sums.1.all(&stages, (newest[r], there.acceleration[r]), r);
        let velocity;
        (velocity, rest) = add_compensated::<L>(L::load(&v[r]), L::load(&lost[r]), rise);
        L::store(velocity, &mut to[r]);
        L::store(rest, &mut to_lost[r]);
        L::store(position_error, &mut errors.0[r]);
        L::store(velocity_error, &mut errors.1[r]);
        for (most, value) in most.iter_mut().zip([velocity, position_error, velocity_error]) {
            *most = L::max(L::abs(value), *most);
        }
        total = L::add(total, velocity);
        let travel = L::mul(h, L::sub(Along::above::<L>(above, velocity), velocity));
        doubtful = L::max(L::mul(there.overlap[r], L::sub(travel, there.overlap[r])), doubtful);
        above = velocity;
    }
    let error = L::max(L::mul(most[1], worth[0]), L::mul(most[2], worth[1]));
    L::store(Along::largest::<L>(error), &mut work.largest.error);
    L::store(Along::largest::<L>(most[0]), &mut work.largest.speed);
    L::store(Along::largest::<L>(largest.change), &mut work.largest.overlap);
    work.finite = Along::all(L::finite(total));
    Some(Sides { changed: changed != 0, doubtful: L::positive(doubtful) != 0 })
}
