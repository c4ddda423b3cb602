//! Steps of short chains under a pair, with the number of rows and the pair's coefficients known to the compiler: a whole step is one run of
//! instructions.
//!
//! Rows of a short chain wait for each other's results most of the time, so what counts is how many operations stand between a stage's
//! forces and those of the next. Here stages go from overlap to overlap, and bodies move only where the step ends. With `d` the overlaps at
//! its start, `w` their rates, `k` those' rates, `F` the forces, and `D` what forces do to overlaps by way of the bodies' masses `m`,
//!
//! `d_s = d + c_s h w + c_s^2/2 h^2 k + h^2 D sum_(0<i<s) a_si (F_i - F_0)`,
//! `(D F)_j = F_(j-1)/m_(j-1) - F_j (1/m_(j-1) + 1/m_j) + F_(j+1)/m_j`,
//!
//! which is [`super::passes`]' stage, for `sum_i a_si = c_s^2/2`; in the same way the weights of the position sum to 1/2, those of the velocity
//! to 1, and those of the errors to 0. `F_i - F_0` is exactly zero where nothing has moved.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::evaluate::Largest;
use super::forces::{Begun, Cut, PLAIN, accelerations, begin_plain, finish};
use super::known::{Known, Position, PositionError, Stage, Velocity, VelocityError, Weights};
use super::lanes::Lanes;
use super::layout::{Along, Layout};
use super::passes::{Sides, add_compensated};
use super::plan::{FEW, Plan};
use super::rows::{Mobility, Rows, differences, largest_of, load, nets, scaled, store};
use super::workspace::{BETWEEN, Motion, Parts, Workspace};

/// `sum` plus what stage `m` weighs.
#[inline(always)]
fn plus<L: Lanes, W: Weights>(m: usize, value: L::V, sum: L::V) -> L::V {
    if W::OF[m] == 0.0 { sum } else { L::mul_add(L::splat(W::OF[m]), value, sum) }
}

/// The overlaps that have changed by `change` (m).
#[inline(always)]
fn overlaps<L: Lanes, const R: usize>(plan: Cut, mut change: Rows<L, R>) -> Rows<L, R> {
    for (change, row) in change.iter_mut().zip(plan.static_overlap) {
        *change = L::add(*change, L::load(row));
    }
    change
}

/// Where a step starts and what it has come by; its length is in overlaps and mobilities.
struct Step<'a, L: Lanes, const R: usize> {
    plan: Cut<'a>,
    now: &'a Motion,
    /// (s)
    h: L::V,
    /// Overlaps, their rates and those' rates (m).
    start: [Rows<L, R>; 3],
    /// Forces there (N).
    force: Rows<L, R>,
    /// (m/N)
    mobility: Mobility<L, R>,
    /// What the forces have changed by at the stages between (N).
    between: [Rows<L, R>; BETWEEN],
}

impl<'a, L: Lanes, const R: usize> Step<'a, L, R> {
    /// Of `h` (s) from `now`.
    #[inline(always)]
    fn new(plan: Cut<'a>, now: &'a Motion, h: L::V) -> Self {
        let square = L::mul(h, h);
        let force = load::<L, R>(now.force());
        let change = differences::<L, Along, R>(&load::<L, R>(now.position()));
        let overlap = overlaps::<L, R>(plan, change);
        let rate = differences::<L, Along, R>(&load::<L, R>(now.velocity()));
        let second = differences::<L, Along, R>(&load::<L, R>(now.acceleration()));
        Self {
            plan,
            now,
            h,
            start: [overlap, scaled::<L, R>(h, rate), scaled::<L, R>(square, second)],
            force,
            mobility: Mobility::new(scaled::<L, R>(square, load::<L, R>(plan.inverse_mass))),
            between: [force; BETWEEN],
        }
    }

    /// What the stages between weigh before stage `end`: one after the other, for the compiler may leave a loop as it is.
    #[inline(always)]
    fn sum<W: Weights>(&self, end: usize) -> Rows<L, R> {
        let sum = self.term::<W, 1>(end, None);
        let sum = self.term::<W, 2>(end, sum);
        let sum = self.term::<W, 3>(end, sum);
        let sum = self.term::<W, 4>(end, sum);
        let sum = self.term::<W, 5>(end, sum);
        let sum = self.term::<W, 6>(end, sum);
        let sum = self.term::<W, BETWEEN>(end, sum);
        sum.unwrap_or([L::splat(0.0); R])
    }

    #[inline(always)]
    fn term<W: Weights, const M: usize>(
        &self,
        end: usize,
        sum: Option<Rows<L, R>>,
    ) -> Option<Rows<L, R>> {
        if M >= end || W::OF[M] == 0.0 {
            return sum;
        }
        let change = &self.between[M - 1];
        let Some(mut sum) = sum else {
            return Some(scaled::<L, R>(L::splat(W::OF[M]), *change));
        };
        for r in 0..R {
            sum[r] = plus::<L, W>(M, change[r], sum[r]);
        }
        Some(sum)
    }

    /// Overlaps at stage `S` (m).
    #[inline(always)]
    #[allow(
        clippy::needless_range_loop,
        reason = "the compiler makes less of iterators side by side"
    )]
    fn overlaps<P: Known<N>, const S: usize, const N: usize>(&self) -> Rows<L, R> {
        let ([overlap, rate, second], node) = (&self.start, P::PAIR.nodes[S]);
        let (node, half_square) = (L::splat(node), L::splat(0.5 * node * node));
        let mut at = *overlap;
        for r in 0..R {
            at[r] = L::mul_add(half_square, second[r], L::mul_add(node, rate[r], at[r]));
        }
        if S == 1 {
            return at;
        }
        self.mobility.moved(at, &self.sum::<Stage<P, N, S>>(S))
    }

    /// Finds what the forces have changed by at stage `S`, if there is one before the last.
    #[inline(always)]
    fn stage<P: Known<N>, const S: usize, const N: usize>(&mut self) {
        if S + 1 >= N {
            return;
        }
        let at = self.overlaps::<P, S, N>();
        for (r, at) in at.iter().enumerate() {
            let [force, _] =
                finish::<L, PLAIN>(self.plan.contacts(r), r, begin_plain::<L, PLAIN>(r, *at));
            self.between[S - 1][r] = L::sub(force, self.force[r]);
        }
    }

    /// The new positions; how overlaps have changed there, and what they are (m).
    #[inline(always)]
    fn arrive<P: Known<N>, const N: usize>(&self, next: &mut Parts) -> [Rows<L, R>; 2] {
        let push = nets::<L, Along, R>(&self.sum::<Position<P, N>>(N - 1), L::splat(0.0));
        let (mut at, mut rest) = (push, push);
        let half = L::mul(L::splat(0.5), L::mul(self.h, self.h));
        let now = self.now;
        let (acceleration, velocity) = (&now.acceleration()[..R], &now.velocity()[..R]);
        let (position, lost) = (&now.position()[..R], &now.lost_position()[..R]);
        for r in 0..R {
            let fall = L::mul(half, L::load(&acceleration[r]));
            let fall = L::mul_add(self.h, L::load(&velocity[r]), fall);
            let rise = L::mul_add(self.mobility.below[r], push[r], fall);
            let (from, lost) = (L::load(&position[r]), L::load(&lost[r]));
            (at[r], rest[r]) = add_compensated::<L>(from, lost, rise);
        }
        store::<L, R>(&at, next.position);
        store::<L, R>(&rest, next.lost_position);
        let change = differences::<L, Along, R>(&at);
        [change, overlaps::<L, R>(self.plan, change)]
    }

    /// The new velocities (m/s), from what the stages weigh in them.
    #[inline(always)]
    fn speed_up(&self, sum: &Rows<L, R>, next: &mut Parts) -> Rows<L, R> {
        let push = nets::<L, Along, R>(sum, L::splat(0.0));
        let (mut speed, mut rest) = (push, push);
        let (now, inverse_mass) = (self.now, &self.plan.inverse_mass[..R]);
        let acceleration = &now.acceleration()[..R];
        let (velocity, lost) = (&now.velocity()[..R], &now.lost_velocity()[..R]);
        for r in 0..R {
            let rise = L::mul_add(L::load(&inverse_mass[r]), push[r], L::load(&acceleration[r]));
            let (from, lost) = (L::load(&velocity[r]), L::load(&lost[r]));
            (speed[r], rest[r]) = add_compensated::<L>(from, lost, L::mul(self.h, rise));
        }
        store::<L, R>(&speed, next.velocity);
        store::<L, R>(&rest, next.lost_velocity);
        speed
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
    let (now, mut next) = (&*work.now, work.next.parts());
    let (plan, none) = (Cut::new(plan, R), L::splat(0.0));
    let mut step = Step::<L, R>::new(plan, now, h);
    step.stage::<P, 1, N>();
    step.stage::<P, 2, N>();
    step.stage::<P, 3, N>();
    step.stage::<P, 4, N>();
    step.stage::<P, 5, N>();
    step.stage::<P, 6, N>();
    step.stage::<P, 7, N>();

    // What the next step waits for comes first.
    let [moved, overlap] = step.arrive::<P, N>(&mut next);
    let mut begun = [Begun::none(); R];
    for r in 0..R {
        begun[r] = begin_plain::<L, PLAIN>(r, overlap[r]);
    }
    // While roots are on their way.
    let mut off = step.sum::<PositionError<P, N>>(N - 1);
    let mut off_speed = step.sum::<VelocityError<P, N>>(N - 1);
    let mut speed = step.sum::<Velocity<P, N>>(N - 1);
    let mut force = step.force;
    for r in 0..R {
        [force[r], _] = finish::<L, PLAIN>(plan.contacts(r), r, begun[r]);
        let newest = L::sub(force[r], step.force[r]);
        off[r] = plus::<L, PositionError<P, N>>(N - 1, newest, off[r]);
        off_speed[r] = plus::<L, VelocityError<P, N>>(N - 1, newest, off_speed[r]);
        speed[r] = plus::<L, Velocity<P, N>>(N - 1, newest, speed[r]);
    }
    store::<L, R>(&force, next.force);
    let mut off = nets::<L, Along, R>(&off, none);
    let mut off_speed = nets::<L, Along, R>(&off_speed, none);
    for r in 0..R {
        off[r] = L::mul(step.mobility.below[r], off[r]);
        off_speed[r] = L::mul(L::load(&plan.inverse_mass[r]), off_speed[r]);
    }
    let (most, most_speed) = (largest_of::<L, R>(off), largest_of::<L, R>(off_speed));
    let error = L::max(L::mul(most, worth[0]), L::mul(most_speed, L::mul(h, worth[1])));
    L::store(Along::largest::<L>(error), &mut work.largest.error);
    store::<L, R>(&off, &mut work.error_position);
    store::<L, R>(&scaled::<L, R>(h, off_speed), &mut work.error_velocity);

    let speed = step.speed_up(&speed, &mut next);
    let travel = scaled::<L, R>(h, differences::<L, Along, R>(&speed));
    // As `passes::speed_up` has it.
    let beyond = |r: usize| L::mul(overlap[r], L::sub(travel[r], overlap[r]));
    let (was_closed, closed) = (&now.closed[..R], &mut next.closed[..R]);
    let (mut seen, mut total) = (Largest::<L>::none(), none);
    let (mut any_changed, mut most_doubtful) = (0, none);
    let held = nets::<L, Along, R>(&force, L::load(&plan.beyond));
    for r in 0..R {
        let acceleration = accelerations::<L>(plan.bodies(r), held[r]);
        L::store(acceleration, &mut next.acceleration[r]);
        total = L::add(total, speed[r]);
        closed[r] = L::positive(overlap[r]);
        any_changed |= closed[r] ^ was_closed[r];
        seen.see(&plan.rest[r], moved[r]);
        most_doubtful = L::max(beyond(r), most_doubtful);
    }
    L::store(Along::largest::<L>(largest_of::<L, R>(speed)), &mut work.largest.speed);
    L::store(Along::largest::<L>(seen.change), &mut work.largest.overlap);
    work.finite = Along::all(L::finite(total));
    let sides = Sides { changed: any_changed, doubtful: L::positive(most_doubtful) };
    if sides.any() {
        for r in 0..R {
            work.changed[r] = closed[r] ^ was_closed[r];
            work.doubtful[r] = !work.changed[r] & L::positive(beyond(r));
        }
    }
    sides
}
