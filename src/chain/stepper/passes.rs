//! The loops over a chain: one stage of a Runge-Kutta-Nystrom step is one pass, from positions over forces to accelerations,
//! and nothing but the accelerations is written.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::evaluate::Largest;
use super::few;
use super::flow;
use super::forces::{Cut, PLAIN};
use super::known::{Known, Position, PositionError, Stage, Sum, Velocity, VelocityError};
use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::plan::{Plan, Rest};
use super::strip::{At, Strip, StripMut};
use super::sweep::{Visit, sweep};
use super::workspace::{Between, Workspace};

/// Positions `x + c h v + h^2 sum` of stage `S`, and the accelerations there.
struct Pass<'a, L: Lanes, P, const N: usize, const S: usize> {
    sum: Sum<L, Stage<P, N, S>>,
    reach: L::V,
    /// Positions, velocities and accelerations where the step starts.
    from: [Strip<'a, Row>; 3],
    between: StripMut<'a, Between>,
}

impl<L: Lanes, P: Known<N>, const N: usize, const S: usize> Visit<L> for Pass<'_, L, P, N, S> {
    #[inline(always)]
    fn enter(&mut self, at: At) -> L::V {
        self.foresee(at)
    }

    #[inline(always)]
    fn foresee(&self, at: At) -> L::V {
        let [x, v, a] = self.from;
        let here = L::mul_add(self.reach, L::load(v.at(at)), L::load(x.at(at)));
        self.sum.plus((a.at(at), self.between.at(at)), S, here)
    }

    #[inline(always)]
    fn leave(&mut self, at: At, acceleration: L::V, _tangent: L::V) {
        L::store(acceleration, &mut self.between.at_mut(at)[S - 1]);
    }
}

/// Finds the accelerations of stage `S`, if there is one before the last.
#[inline(always)]
fn stage<L: Lanes, Y: Layout, P: Known<N>, const FORM: u8, const N: usize, const S: usize>(
    plan: &Plan,
    work: &mut Workspace,
    h: L::V,
) {
    if S + 1 >= N {
        return;
    }
    let rows = plan.rows();
    let Workspace { now, between, .. } = work;
    let mut pass = Pass::<L, P, N, S> {
        sum: Sum::new(L::mul(h, h)),
        reach: L::mul(h, L::splat(P::PAIR.nodes[S])),
        from: [now.position(), now.velocity(), now.acceleration()].map(|of| Strip::new(of, rows)),
        between: StripMut::new(between, rows),
    };
    sweep::<L, Y, FORM>(Cut::new(plan, rows), rows, &mut pass);
}

/// The new positions, with what rounding took from them, and the overlaps and accelerations there.
struct Arrive<'a, L: Lanes, P, const N: usize> {
    sum: Sum<L, Position<P, N>>,
    h: L::V,
    /// Positions, velocities, what rounding took from the positions, and accelerations, where the step starts.
    from: [Strip<'a, Row>; 4],
    between: Strip<'a, Between>,
    position: [StripMut<'a, Row>; 2],
    rest: Strip<'a, Rest>,
    overlap: StripMut<'a, Row>,
    out: StripMut<'a, Row>,
    closed: StripMut<'a, u8>,
    largest: Largest<L>,
}

impl<L: Lanes, P: Known<N>, const N: usize> Arrive<'_, L, P, N> {
    /// The positions of row `at`, and what rounding takes from them (m).
    #[inline(always)]
    fn arrived(&self, at: At) -> (L::V, L::V) {
        let [x, v, lost, a] = self.from;
        let drift = L::mul(self.h, L::load(v.at(at)));
        let rise = self.sum.plus((a.at(at), self.between.at(at)), N - 1, drift);
        add_compensated::<L>(L::load(x.at(at)), L::load(lost.at(at)), rise)
    }
}

impl<L: Lanes, P: Known<N>, const N: usize> Visit<L> for Arrive<'_, L, P, N> {
    #[inline(always)]
    fn enter(&mut self, at: At) -> L::V {
        let (position, rest) = self.arrived(at);
        L::store(position, self.position[0].at_mut(at));
        L::store(rest, self.position[1].at_mut(at));
        position
    }

    #[inline(always)]
    fn foresee(&self, at: At) -> L::V {
        self.arrived(at).0
    }

    #[inline(always)]
    fn see(&mut self, at: At, overlap: L::V, change: L::V) {
        *self.closed.at_mut(at) = L::positive(overlap);
        L::store(overlap, self.overlap.at_mut(at));
        self.largest.see(self.rest.at(at), change);
    }

    #[inline(always)]
    fn leave(&mut self, at: At, acceleration: L::V, _tangent: L::V) {
        L::store(acceleration, self.out.at_mut(at));
    }
}

/// Arrives where the step ends.
#[inline(always)]
fn arrive<L: Lanes, Y: Layout, P: Known<N>, const FORM: u8, const N: usize>(
    plan: &Plan,
    work: &mut Workspace,
    h: L::V,
) {
    let rows = plan.rows();
    let cut = Cut::new(plan, rows);
    let Workspace { now, next, between, overlap, .. } = work;
    let next = next.parts();
    let mut arrive = Arrive::<L, P, N> {
        sum: Sum::new(L::mul(h, h)),
        h,
        from: [now.position(), now.velocity(), now.lost_position(), now.acceleration()]
            .map(|of| Strip::new(of, rows)),
        between: Strip::new(between, rows),
        position: [next.position, next.lost_position].map(|of| StripMut::new(of, rows)),
        rest: Strip::new(cut.rest, rows),
        overlap: StripMut::new(overlap, rows),
        out: StripMut::new(next.acceleration, rows),
        closed: StripMut::new(next.closed, rows),
        largest: Largest::none(),
    };
    sweep::<L, Y, FORM>(cut, rows, &mut arrive);
    L::store(Y::largest::<L>(arrive.largest.change), &mut work.largest.overlap);
}

/// The new velocities, with what rounding took from them, and the estimated errors; their largest magnitudes; and what contacts have done.
#[inline(always)]
pub fn speed_up<L: Lanes, Y: Layout, P: Known<N>, const N: usize>(
    rows: usize,
    (h, worth): (L::V, [L::V; 2]),
    work: &mut Workspace,
) -> Sides {
    let Workspace {
        now,
        next,
        between,
        error_position,
        error_velocity,
        overlap,
        changed,
        doubtful,
        largest,
        finite,
        ..
    } = work;
    let next = next.parts();
    let velocity_sum = Sum::<L, Velocity<P, N>>::new(h);
    let position_error_sum = Sum::<L, PositionError<P, N>>::new(L::mul(h, h));
    let velocity_error_sum = Sum::<L, VelocityError<P, N>>::new(h);
    let (first, arrived) = (&now.acceleration()[..rows], &next.acceleration[..rows]);
    let between = &between[..rows];
    let (v, lost) = (&now.velocity()[..rows], &now.lost_velocity()[..rows]);
    let (new_v, new_lost) = (&mut next.velocity[..rows], &mut next.lost_velocity[..rows]);
    let (out_position, out_velocity) = (&mut error_position[..rows], &mut error_velocity[..rows]);
    let mut most = [L::splat(0.0); 3];
    let overlap = &overlap[..rows];
    let none = L::splat(0.0);
    let (mut total, mut above) = (none, none);
    let (changed, doubtful) = (&mut changed[..rows], &mut doubtful[..rows]);
    let mut sides = Sides::default();
    let (was_closed, closed) = (&now.closed[..rows], &next.closed[..rows]);
    for r in 0..rows {
        let (stages, end) = ((&first[r], &between[r]), L::load(&arrived[r]));
        let rise = velocity_sum.newest(N - 1, end, velocity_sum.plus(stages, N - 1, none));
        let sum = &position_error_sum;
        let position_error = sum.newest(N - 1, end, sum.plus(stages, N - 1, none));
        let sum = &velocity_error_sum;
        let velocity_error = sum.newest(N - 1, end, sum.plus(stages, N - 1, none));
        let (velocity, rest) = add_compensated::<L>(L::load(&v[r]), L::load(&lost[r]), rise);
        L::store(velocity, &mut new_v[r]);
        L::store(rest, &mut new_lost[r]);
        L::store(position_error, &mut out_position[r]);
        L::store(velocity_error, &mut out_velocity[r]);
        for (most, value) in most.iter_mut().zip([velocity, position_error, velocity_error]) {
            *most = L::max(L::abs(value), *most);
        }
        total = L::add(total, velocity);
        // `kinks::missed` asks for more; what it finds has come from beyond zero overlap, if its speed has been what it is now.
        let overlap = L::load(&overlap[r]);
        let travel = L::mul(h, L::sub(Y::above::<L>(above, velocity), velocity));
        changed[r] = closed[r] ^ was_closed[r];
        doubtful[r] = !changed[r] & L::positive(L::mul(overlap, L::sub(travel, overlap)));
        sides.changed |= changed[r];
        sides.doubtful |= doubtful[r];
        above = velocity;
    }
    let error = L::max(L::mul(most[1], worth[0]), L::mul(most[2], worth[1]));
    L::store(Y::largest::<L>(error), &mut largest.error);
    L::store(Y::largest::<L>(most[0]), &mut largest.speed);
    *finite = Y::all(L::finite(total));
    sides
}

/// `value + increment`, and what rounding took. Source: W. Kahan, Commun. ACM 8, 40 (1965).
#[inline(always)]
pub fn add_compensated<L: Lanes>(value: L::V, lost: L::V, increment: L::V) -> (L::V, L::V) {
    let increment = L::sub(increment, lost);
    let sum = L::add(value, increment);
    (sum, L::sub(L::sub(sum, value), increment))
}

/// What the contacts have done in a step, in any row.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sides {
    /// Lanes in which some are open that were closed, or the other way round.
    pub changed: u8,
    /// Lanes in which some may have been on the other side in between.
    pub doubtful: u8,
}

impl Sides {
    /// Whether any.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.changed | self.doubtful != 0
    }
}

/// Tries a step of `h` (s) from `work.now`: everything of `work` but that is written. An error of 1 m or 1 m/s is `worth` so many
/// tolerated ones.
#[inline(always)]
pub fn attempt<L: Lanes, Y: Layout, P: Known<N>, const FORM: u8, const N: usize>(
    plan: &Plan,
    work: &mut Workspace,
    (h, worth): (L::V, [L::V; 2]),
) -> Sides {
    if FORM == PLAIN && plan.in_few_rows::<Y>() {
        let attempt = if L::WAITS { few::attempt::<L, P, N> } else { flow::attempt::<L, P, N> };
        if let Some(sides) = attempt(plan, work, (h, worth)) {
            return sides;
        }
    }
    stage::<L, Y, P, FORM, N, 1>(plan, work, h);
    stage::<L, Y, P, FORM, N, 2>(plan, work, h);
    stage::<L, Y, P, FORM, N, 3>(plan, work, h);
    stage::<L, Y, P, FORM, N, 4>(plan, work, h);
    stage::<L, Y, P, FORM, N, 5>(plan, work, h);
    stage::<L, Y, P, FORM, N, 6>(plan, work, h);
    stage::<L, Y, P, FORM, N, 7>(plan, work, h);
    arrive::<L, Y, P, FORM, N>(plan, work, h);
    speed_up::<L, Y, P, N>(plan.rows(), (h, worth), work)
}
