//! The loops over a chain: one stage of a Runge-Kutta-Nystrom step is one pass, from positions over forces to accelerations,
//! and nothing but the accelerations is written.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::evaluate::Largest;
use super::forces::{Cut, PLAIN};
use super::lanes::{Lanes, Row};
use super::plan::{Layout, Plan};
use super::quadrature::Quadrature;
use super::sweep::{Visit, sweep};
use super::workspace::{Motion, Workspace};
use crate::integrate::nystrom::{NystromPair, Row as Terms};

/// A weighted sum of `M` stages.
#[derive(Clone, Copy)]
struct Sum<'a, L: Lanes, const M: usize> {
    stages: [&'a [Row]; M],
    weights: [L::V; M],
}

impl<'a, L: Lanes, const M: usize> Sum<'a, L, M> {
    /// The first `M` terms, each weight times `scale`; every stage cut to `rows` rows.
    #[inline(always)]
    fn new(terms: Terms, stages: &'a [Vec<Row>], scale: L::V, rows: usize) -> Self {
        let mut stages_of = [&stages[0][..rows]; M];
        let mut weights = [scale; M];
        for m in 0..M {
            stages_of[m] = &stages[terms[m].0][..rows];
            weights[m] = L::mul(scale, L::splat(terms[m].1));
        }
        Self { stages: stages_of, weights }
    }

    /// `start` plus the sum in row `r`.
    #[inline(always)]
    fn plus(&self, start: L::V, r: usize) -> L::V {
        // The newest stage comes last: all others can be summed while it is still being computed.
        let mut sum = start;
        for m in 0..M {
            sum = L::mul_add(self.weights[m], L::load(&self.stages[m][r]), sum);
        }
        sum
    }
}

/// Calls a function for the number of terms there are: the loops over terms are unrolled.
macro_rules! for_terms {
    ($terms:expr, $call:ident::<$($generic:ident),*>($($argument:expr),*)) => {
        match $terms.len() {
            0 => $call::<$($generic,)* 0>($($argument),*),
            1 => $call::<$($generic,)* 1>($($argument),*),
            2 => $call::<$($generic,)* 2>($($argument),*),
            3 => $call::<$($generic,)* 3>($($argument),*),
            4 => $call::<$($generic,)* 4>($($argument),*),
            5 => $call::<$($generic,)* 5>($($argument),*),
            6 => $call::<$($generic,)* 6>($($argument),*),
            7 => $call::<$($generic,)* 7>($($argument),*),
            _ => $call::<$($generic,)* 8>($($argument),*),
        }
    };
}

/// Positions `x + c h v + h^2 sum` of a stage, and the accelerations there.
struct Stage<'a, L: Lanes, const M: usize> {
    sum: Sum<'a, L, M>,
    reach: L::V,
    from: [&'a [Row]; 2],
    out: &'a mut [Row],
}

impl<L: Lanes, Y: Layout, const M: usize> Visit<L, Y> for Stage<'_, L, M> {
    #[inline(always)]
    fn enter(&mut self, r: usize) -> L::V {
        let [x, v] = self.from;
        self.sum.plus(L::mul_add(self.reach, L::load(&v[r]), L::load(&x[r])), r)
    }

    #[inline(always)]
    fn leave(&mut self, r: usize, acceleration: L::V, _tangent: L::V) {
        L::store(acceleration, &mut self.out[r]);
    }
}

#[inline(always)]
fn stage<L: Lanes, Y: Layout, const FORM: u8, const M: usize>(
    plan: &Plan,
    now: &Motion,
    (terms, node, h): (Terms, f64, L::V),
    before: &[Vec<Row>],
    out: &mut [Row],
) {
    let rows = plan.rows();
    let mut stage = Stage {
        sum: Sum::<L, M>::new(terms, before, L::mul(h, h), rows),
        reach: L::mul(h, L::splat(node)),
        from: [&now.position[..rows], &now.velocity[..rows]],
        out: &mut out[..rows],
    };
    sweep::<L, Y, _, FORM>(Cut::new(plan, rows), rows, &mut stage);
}

/// The new positions, with what rounding took from them, and the overlaps and accelerations there.
struct Arrive<'a, L: Lanes, const M: usize> {
    sum: Sum<'a, L, M>,
    h: L::V,
    /// Positions, velocities, and what rounding took from the positions, where the step starts.
    from: [&'a [Row]; 3],
    was_closed: &'a [u8],
    position: [&'a mut [Row]; 2],
    overlap: &'a mut [Row],
    out: &'a mut [Row],
    closed: &'a mut [u8],
    /// Contacts that have changed sides, a bit for each lane.
    changed: u8,
    largest: Largest<'a, L>,
}

impl<L: Lanes, Y: Layout, const M: usize> Visit<L, Y> for Arrive<'_, L, M> {
    #[inline(always)]
    fn enter(&mut self, r: usize) -> L::V {
        let [x, v, lost] = self.from;
        let rise = self.sum.plus(L::mul(self.h, L::load(&v[r])), r);
        let (position, rest) = add_compensated::<L>(L::load(&x[r]), L::load(&lost[r]), rise);
        L::store(position, &mut self.position[0][r]);
        L::store(rest, &mut self.position[1][r]);
        position
    }

    #[inline(always)]
    fn see(&mut self, r: usize, overlap: L::V, change: L::V) {
        self.closed[r] = L::positive(overlap);
        self.changed |= self.closed[r] ^ self.was_closed[r];
        L::store(overlap, &mut self.overlap[r]);
        self.largest.see(r, change);
    }

    #[inline(always)]
    fn leave(&mut self, r: usize, acceleration: L::V, _tangent: L::V) {
        L::store(acceleration, &mut self.out[r]);
    }
}

/// Arrives where the step ends; how far the overlaps have changed, and whether any contact has changed sides.
#[inline(always)]
fn arrive<L: Lanes, Y: Layout, const FORM: u8, const M: usize>(
    plan: &Plan,
    now: &Motion,
    (terms, h): (Terms, L::V),
    (before, out): (&[Vec<Row>], &mut [Row]),
    (next, overlaps): (&mut Motion, &mut [Row]),
) -> (L::V, bool) {
    let rows = plan.rows();
    let cut = Cut::new(plan, rows);
    let mut arrive = Arrive {
        sum: Sum::<L, M>::new(terms, before, L::mul(h, h), rows),
        h,
        from: [&now.position[..rows], &now.velocity[..rows], &now.lost_position[..rows]],
        was_closed: &now.closed[..rows],
        position: [&mut next.position[..rows], &mut next.lost_position[..rows]],
        overlap: &mut overlaps[..rows],
        out: &mut out[..rows],
        closed: &mut next.closed[..rows],
        changed: 0,
        largest: Largest::new(cut),
    };
    sweep::<L, Y, _, FORM>(cut, rows, &mut arrive);
    (arrive.largest.change, arrive.changed != 0)
}

/// The new velocities, with what rounding took from them, and the estimated errors, by the weights `ends` of each stage; their largest
/// magnitudes. Tells whether a contact may have opened or closed and gone back within the step.
#[inline(always)]
fn speed_up<L: Lanes, Y: Layout, const M: usize>(
    rows: usize,
    ends: &[[f64; 3]],
    (h, worth): (L::V, [L::V; 2]),
    work: &mut Workspace,
) -> bool {
    let Workspace {
        now,
        next,
        stages,
        error_position,
        error_velocity,
        overlap,
        largest,
        finite,
        ..
    } = work;
    let square = L::mul(h, h);
    let mut stages_of = [&stages[0][..rows]; M];
    let mut weights = [[h; 3]; M];
    for m in 0..M {
        stages_of[m] = &stages[m][..rows];
        let [velocity, position_error, velocity_error] = ends[m];
        weights[m] = [
            L::mul(h, L::splat(velocity)),
            L::mul(square, L::splat(position_error)),
            L::mul(h, L::splat(velocity_error)),
        ];
    }
    let (v, lost) = (&now.velocity[..rows], &now.lost_velocity[..rows]);
    let (new_v, new_lost) = (&mut next.velocity[..rows], &mut next.lost_velocity[..rows]);
    let (out_position, out_velocity) = (&mut error_position[..rows], &mut error_velocity[..rows]);
    let mut most = [L::splat(0.0); 3];
    let overlap = &overlap[..rows];
    let none = L::splat(0.0);
    let (mut total, mut above, mut doubtful) = (none, none, none);
    for r in 0..rows {
        let mut sums = [L::splat(0.0); 3];
        for m in 0..M {
            let stage = L::load(&stages_of[m][r]);
            for kind in 0..3 {
                sums[kind] = L::mul_add(weights[m][kind], stage, sums[kind]);
            }
        }
        let (velocity, rest) = add_compensated::<L>(L::load(&v[r]), L::load(&lost[r]), sums[0]);
        L::store(velocity, &mut new_v[r]);
        L::store(rest, &mut new_lost[r]);
        L::store(sums[1], &mut out_position[r]);
        L::store(sums[2], &mut out_velocity[r]);
        for (most, value) in most.iter_mut().zip([velocity, sums[1], sums[2]]) {
            *most = L::max(L::abs(value), *most);
        }
        total = L::add(total, velocity);
        // `kinks::missed` asks for more; what it finds has come from beyond zero overlap, if its speed has been what it is now.
        let overlap = L::load(&overlap[r]);
        let travel = L::mul(h, L::sub(Y::above::<L>(above, velocity), velocity));
        doubtful = L::max(L::mul(overlap, L::sub(travel, overlap)), doubtful);
        above = velocity;
    }
    let error = L::max(L::mul(most[1], worth[0]), L::mul(most[2], worth[1]));
    L::store(Y::largest::<L>(error), &mut largest.error);
    L::store(Y::largest::<L>(most[0]), &mut largest.speed);
    *finite = Y::all(L::finite(total));
    L::positive(doubtful) != 0
}

/// `value + increment`, and what rounding took. Source: W. Kahan, Commun. ACM 8, 40 (1965).
#[inline(always)]
pub fn add_compensated<L: Lanes>(value: L::V, lost: L::V, increment: L::V) -> (L::V, L::V) {
    let increment = L::sub(increment, lost);
    let sum = L::add(value, increment);
    (sum, L::sub(L::sub(sum, value), increment))
}

/// What the contacts have done in a step.
#[derive(Debug, Clone, Copy)]
pub struct Sides {
    /// Some are open that were closed, or the other way round.
    pub changed: bool,
    /// Some may have been on the other side in between.
    pub doubtful: bool,
}

/// Tries a step of `h` (s) from `work.now`: everything of `work` but that is written. An error of 1 m or 1 m/s is `worth` so many
/// tolerated ones.
#[inline(always)]
pub fn attempt<L: Lanes, Y: Layout, const FORM: u8>(
    plan: &Plan,
    (pair, quadrature): (&NystromPair, &Quadrature),
    work: &mut Workspace,
    (h, worth): (L::V, [L::V; 2]),
) -> Sides {
    if FORM == PLAIN
        && let Some(sides) = Y::in_few_rows::<L>(plan, pair, work, (h, worth))
    {
        return sides;
    }
    let last = pair.nodes.len() - 1;
    for stage_number in 1..last {
        let (before, rest) = work.stages.split_at_mut(stage_number);
        let terms = pair.stages[stage_number];
        let setting = (terms, pair.nodes[stage_number], h);
        for_terms!(terms, stage::<L, Y, FORM>(plan, &work.now, setting, before, &mut rest[0]));
    }
    let (before, rest) = work.stages.split_at_mut(last);
    let (now, next) = (&*work.now, (&mut *work.next, work.overlap.as_mut_slice()));
    let (overlap, changed) = for_terms!(
        pair.position,
        arrive::<L, Y, FORM>(plan, now, (pair.position, h), (before, &mut rest[0]), next)
    );
    L::store(Y::largest::<L>(overlap), &mut work.largest.overlap);
    let doubtful = match pair.nodes.len() {
        6 => speed_up::<L, Y, 6>(plan.rows(), &quadrature.ends[..6], (h, worth), work),
        _ => speed_up::<L, Y, 9>(plan.rows(), &quadrature.ends[..9], (h, worth), work),
    };
    Sides { changed, doubtful }
}
