//! The loops over a chain: one stage of a Runge-Kutta-Nystrom step is one pass, from positions over forces to accelerations,
//! and nothing but the accelerations is written.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::evaluate::Largest;
use super::few;
use super::forces::{Cut, PLAIN};
use super::known::{Known, Position, PositionError, Stage, Sum, Velocity, VelocityError};
use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::plan::Plan;
use super::sweep::{Visit, sweep};
use super::workspace::{Between, Workspace};

/// Positions `x + c h v + h^2 sum` of stage `S`, and the accelerations there.
struct Pass<'a, L: Lanes, P, const N: usize, const S: usize> {
    sum: Sum<L, Stage<P, N, S>>,
    reach: L::V,
    /// Positions, velocities and accelerations where the step starts.
    from: [&'a [Row]; 3],
    between: &'a mut [Between],
}

impl<L: Lanes, Y: Layout, P: Known<N>, const N: usize, const S: usize> Visit<L, Y>
    for Pass<'_, L, P, N, S>
{
    #[inline(always)]
    fn enter(&mut self, r: usize) -> L::V {
        let [x, v, a] = self.from;
        let here = L::mul_add(self.reach, L::load(&v[r]), L::load(&x[r]));
        self.sum.plus((&a[r], &self.between[r]), S, here)
    }

    #[inline(always)]
    fn leave(&mut self, r: usize, acceleration: L::V, _pressed: [L::V; 2]) {
        L::store(acceleration, &mut self.between[r][S - 1]);
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
        from: [&now.position()[..rows], &now.velocity()[..rows], &now.acceleration()[..rows]],
        between: &mut between[..rows],
    };
    sweep::<L, Y, FORM>(Cut::new(plan, rows), rows, &mut pass);
}

/// The new positions, with what rounding took from them, and the overlaps and accelerations there.
struct Arrive<'a, L: Lanes, P, const N: usize> {
    sum: Sum<L, Position<P, N>>,
    h: L::V,
    /// Positions, velocities, what rounding took from the positions, and accelerations, where the step starts.
    from: [&'a [Row]; 4],
    between: &'a [Between],
    position: [&'a mut [Row]; 2],
    overlap: &'a mut [Row],
    out: &'a mut [Row],
    closed: &'a mut [u8],
    largest: Largest<'a, L>,
}

impl<L: Lanes, Y: Layout, P: Known<N>, const N: usize> Visit<L, Y> for Arrive<'_, L, P, N> {
    #[inline(always)]
    fn enter(&mut self, r: usize) -> L::V {
        let [x, v, lost, a] = self.from;
        let drift = L::mul(self.h, L::load(&v[r]));
        let rise = self.sum.plus((&a[r], &self.between[r]), N - 1, drift);
        let (position, rest) = add_compensated::<L>(L::load(&x[r]), L::load(&lost[r]), rise);
        L::store(position, &mut self.position[0][r]);
        L::store(rest, &mut self.position[1][r]);
        position
    }

    #[inline(always)]
    fn see(&mut self, r: usize, overlap: L::V, change: L::V) {
        self.closed[r] = L::positive(overlap);
        L::store(overlap, &mut self.overlap[r]);
        self.largest.see(r, change);
    }

    #[inline(always)]
    fn leave(&mut self, r: usize, acceleration: L::V, _pressed: [L::V; 2]) {
        L::store(acceleration, &mut self.out[r]);
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
        from: [
            &now.position()[..rows],
            &now.velocity()[..rows],
            &now.lost_position()[..rows],
            &now.acceleration()[..rows],
        ],
        between: &between[..rows],
        position: [&mut next.position[..rows], &mut next.lost_position[..rows]],
        overlap: &mut overlap[..rows],
        out: &mut next.acceleration[..rows],
        closed: &mut next.closed[..rows],
        largest: Largest::new(cut),
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
    let few = L::WAITS && FORM == PLAIN && plan.in_few_rows::<Y>();
    if few && let Some(sides) = few::attempt::<L, P, N>(plan, work, (h, worth)) {
        return sides;
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
