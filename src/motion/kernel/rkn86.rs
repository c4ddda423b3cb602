//! One trial step of the Runge-Kutta-Nystrom pair 8(6) of Dormand, El-Mikkawy and Prince on the
//! chain in rows.
//!
//! `x_s = x + c_s h v + h^2 sum a_sj k_j`, `k_s = a(x_s)`; the new position is the last stage's, so
//! a step costs eight evaluations. Sums of positions and velocities are compensated. Source and
//! coefficients: [`mod@crate::motion::dormand_el_mikkawy_prince_86`].
#![allow(
    clippy::inline_always,
    reason = "the code has to be inlined into functions compiled for the instruction set"
)]

use super::rows::{ChainRows, Motion, Touch, Visit, sweep};
use super::vector::{Kernel, Row, Simd, Vector};
use crate::motion::dormand_el_mikkawy_prince_86::DORMAND_EL_MIKKAWY_PRINCE_86 as PAIR;
use crate::motion::runge_kutta::Row as Terms;

/// Stages of the pair.
pub const STAGES: usize = 9;
/// Stages between the first, which is the start, and the last, which is the end.
const INNER: usize = STAGES - 2;
/// Force evaluations of a step.
pub const EVALUATIONS: u64 = 8;

/// What each stage contributes to a sum (1).
pub type Weights = [f64; STAGES];

const fn dense(terms: Terms) -> Weights {
    let (mut weights, mut i) = ([0.0; STAGES], 0);
    while i < terms.len() {
        weights[terms[i].0] = terms[i].1;
        i += 1;
    }
    weights
}

const ARGUMENTS: [Weights; STAGES] = {
    let (mut all, mut i) = ([[0.0; STAGES]; STAGES], 0);
    while i < STAGES {
        all[i] = dense(PAIR.stages[i]);
        i += 1;
    }
    all
};
/// Times of the stages, in steps (1).
pub const NODES: &[f64] = PAIR.nodes;
/// Weights of the new position, over the square of the step (1).
pub const POSITION: Weights = dense(PAIR.position);
/// Weights of the new velocity, over the step (1).
pub const VELOCITY: Weights = dense(PAIR.velocity);
/// Weights of the position's error estimate (1).
pub const POSITION_ERROR: Weights = dense(PAIR.position_error);
/// Weights of the velocity's error estimate (1).
pub const VELOCITY_ERROR: Weights = dense(PAIR.velocity_error);

/// Room for the stages and error estimates of a trial.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Accelerations of the inner stages (m/s²).
    stages: [Vec<Row>; INNER],
    /// Error estimates of positions (m) and velocities (m/s).
    pub errors: [Vec<Row>; 2],
    /// Bits of the contacts that were open at one end and closed at the other.
    pub changed: Vec<u8>,
    /// Bits of the contacts that may have changed sides twice.
    pub doubtful: Vec<u8>,
}

impl Trial {
    /// For a chain of so many rows.
    pub fn new(rows: usize) -> Self {
        let empty = || vec![Row::default(); rows];
        Self {
            stages: std::array::from_fn(|_| empty()),
            errors: [empty(), empty()],
            changed: vec![0; rows],
            doubtful: vec![0; rows],
        }
    }
}

/// The magnitudes that decide on a trial.
#[derive(Debug, Clone, Copy)]
pub struct Judged {
    /// Largest change of an overlap at the end (m).
    pub overlap: f64,
    /// Largest speed at the end (m/s).
    pub speed: f64,
    /// Largest error estimates of positions and velocities, not a number where the state is none
    /// (m, m/s).
    pub errors: [f64; 2],
    /// Whether any contact has changed sides, or may have.
    pub is_changed: bool,
}

/// Attempts a step of `h` (s) from `now` to `next`.
pub struct TrialStep<'a> {
    pub chain: &'a ChainRows,
    pub live: usize,
    pub now: &'a Motion,
    pub next: &'a mut Motion,
    pub trial: &'a mut Trial,
    /// Length of the step (s).
    pub h: f64,
}

/// Acceleration of every stage, as far as they are known, for rows below `live`.
#[derive(Clone, Copy)]
struct Stages<'a>([&'a [Row]; STAGES - 1]);

impl<'a> Stages<'a> {
    #[inline(always)]
    fn new(now: &'a Motion, inner: &'a [Vec<Row>], live: usize) -> Self {
        let mut stages = Self([&now.acceleration[..live]; STAGES - 1]);
        for (stage, known) in stages.0[1..].iter_mut().zip(inner) {
            *stage = &known[..live];
        }
        stages
    }

    /// `start + scale * sum of weight * stage` in row `r`, of the first `N` stages.
    #[inline(always)]
    fn sum<S: Simd, const N: usize>(
        &self,
        simd: S,
        (weights, scale): (&Weights, f64),
        r: usize,
        start: S::V,
    ) -> S::V {
        let mut sum = start;
        for (weight, stage) in weights.iter().zip(&self.0).take(N) {
            if *weight != 0.0 {
                sum = simd.load(&stage[r]).mul_add(simd.splat(scale * weight), sum);
            }
        }
        sum
    }
}

/// Stage `N`: `x + c h v + h^2 sum a k`, and the accelerations there.
struct Stage<'a, const N: usize> {
    stages: Stages<'a>,
    h: f64,
    /// Positions (m) and velocities (m/s) at the start.
    start: [&'a [Row]; 2],
    out: &'a mut [Row],
}

impl<S: Simd, const N: usize> Visit<S> for Stage<'_, N> {
    #[inline(always)]
    fn positions(&mut self, simd: S, r: usize) -> S::V {
        let [x, v] = self.start;
        let start = simd.load(&v[r]).mul_add(simd.splat(NODES[N] * self.h), simd.load(&x[r]));
        self.stages.sum::<S, N>(simd, (&ARGUMENTS[N], self.h * self.h), r, start)
    }

    #[inline(always)]
    fn bodies(&mut self, r: usize, acceleration: S::V) {
        acceleration.store(&mut self.out[r]);
    }
}

/// The end of a step, or any state: its contacts and accelerations.
struct Arrival<'a, V> {
    /// The step that leads there, from where: positions, velocities and what rounding took (m, m/s,
    /// m); none where positions are known.
    step: Option<(Stages<'a>, f64, [&'a [Row]; 3])>,
    exists: &'a [Row],
    position: &'a mut [Row],
    lost: &'a mut [Row],
    acceleration: &'a mut [Row],
    tangent: &'a mut [Row],
    closed: &'a mut [u8],
    /// Largest change of an overlap (m).
    largest: V,
}

impl<'a, V> Arrival<'a, V> {
    #[inline(always)]
    fn new(
        chain: &'a ChainRows,
        motion: &'a mut Motion,
        live: usize,
        step: Option<(Stages<'a>, f64, [&'a [Row]; 3])>,
        largest: V,
    ) -> Self {
        let Motion { position, acceleration, tangent, closed, lost: [lost, _], .. } = motion;
        Self {
            step,
            exists: &chain.exists[..live],
            position: &mut position[..live],
            lost: &mut lost[..live],
            acceleration: &mut acceleration[..live],
            tangent: &mut tangent[..live],
            closed: &mut closed[..live],
            largest,
        }
    }
}

impl<S: Simd> Visit<S> for Arrival<'_, S::V> {
    #[inline(always)]
    fn positions(&mut self, simd: S, r: usize) -> S::V {
        let Some((stages, h, [x, v, lost])) = self.step else {
            return simd.load(&self.position[r]);
        };
        let drift = simd.load(&v[r]) * simd.splat(h);
        let increment = stages.sum::<S, { STAGES - 1 }>(simd, (&POSITION, h * h), r, drift);
        let (sum, rest) = add_compensated(simd.load(&x[r]), simd.load(&lost[r]), increment);
        sum.store(&mut self.position[r]);
        rest.store(&mut self.lost[r]);
        sum
    }

    #[inline(always)]
    fn contacts(&mut self, simd: S, r: usize, touch: &Touch<S::V>) {
        touch.tangent.store(&mut self.tangent[r]);
        self.closed[r] = touch.closed;
        self.largest = (touch.change.abs() * simd.load(&self.exists[r])).max(self.largest);
    }

    #[inline(always)]
    fn bodies(&mut self, r: usize, acceleration: S::V) {
        acceleration.store(&mut self.acceleration[r]);
    }
}

impl TrialStep<'_> {
    /// Accelerations of stage `N`.
    #[inline(always)]
    fn stage<S: Simd, const N: usize>(&mut self, simd: S) {
        let (live, h, now) = (self.live, self.h, self.now);
        let (before, rest) = self.trial.stages.split_at_mut(N - 1);
        let stages = Stages::new(now, before, live);
        let start = [&now.position[..live], &now.velocity[..live]];
        let mut stage = Stage::<N> { stages, h, start, out: &mut rest[0][..live] };
        sweep(simd, self.chain, live, &mut stage);
    }

    /// The new positions, contacts and accelerations; the largest change of an overlap (m).
    #[inline(always)]
    fn arrive<S: Simd>(&mut self, simd: S) -> f64 {
        let (live, now) = (self.live, self.now);
        let from = [&now.position, &now.velocity, &now.lost[0]];
        let from = [&from[0][..live], &from[1][..live], &from[2][..live]];
        let step = Some((Stages::new(now, &self.trial.stages, live), self.h, from));
        let mut arrival = Arrival::new(self.chain, self.next, live, step, simd.splat(0.0));
        sweep(simd, self.chain, live, &mut arrival);
        arrival.largest.largest()
    }

    /// The new velocities, the error estimates, and what contacts may have changed sides.
    #[inline(always)]
    fn finish<S: Simd>(&mut self, simd: S, overlap: f64) -> Judged {
        let Self { chain, live, now, next, trial, h } = self;
        let (live, h) = (*live, *h);
        let Trial { stages, errors: [position_error, velocity_error], changed, doubtful } =
            &mut **trial;
        let stages = Stages::new(now, stages, live);
        let Motion { position, velocity, acceleration, closed, lost: [_, new_lost], .. } =
            &mut **next;
        let (v, lost, was_closed) =
            (&now.velocity[..live], &now.lost[1][..live], &now.closed[..live]);
        let (position, velocity, end) =
            (&position[..live], &mut velocity[..live], &acceleration[..live]);
        let (new_lost, closed) = (&mut new_lost[..live], &closed[..live]);
        let (position_error, velocity_error) =
            (&mut position_error[..live], &mut velocity_error[..live]);
        let (changed, doubtful) = (&mut changed[..live], &mut doubtful[..live]);
        let none = simd.splat(0.0);
        let [mut speed, mut largest_x, mut largest_v, mut not_finite] = [none; 4];
        let (mut x_above, mut v_above, mut is_changed) = (none, none, 0);
        for r in 0..live {
            let last = simd.load(&end[r]);
            let increment = all_stages(simd, &stages, (&VELOCITY, h), r, last);
            let (v_new, rest) = add_compensated(simd.load(&v[r]), simd.load(&lost[r]), increment);
            v_new.store(&mut velocity[r]);
            rest.store(&mut new_lost[r]);
            let error_x = all_stages(simd, &stages, (&POSITION_ERROR, h * h), r, last);
            let error_v = all_stages(simd, &stages, (&VELOCITY_ERROR, h), r, last);
            error_x.store(&mut position_error[r]);
            error_v.store(&mut velocity_error[r]);
            largest_x = error_x.abs().max(largest_x);
            largest_v = error_v.abs().max(largest_v);
            speed = v_new.abs().max(speed);
            let x_new = simd.load(&position[r]);
            not_finite = (x_new + v_new).mul_add(none, not_finite);
            // A contact that had its present closing speed all the time comes from beyond zero
            // overlap.
            let overlap = simd.load(&chain.static_overlap[r]) + (x_new.shift_up(x_above) - x_new);
            let travel = (v_new.shift_up(v_above) - v_new) * simd.splat(h);
            let comes_from_beyond = overlap * simd.load(&chain.exists[r]) * (travel - overlap);
            changed[r] = closed[r] ^ was_closed[r];
            doubtful[r] = !changed[r] & comes_from_beyond.positive();
            is_changed |= changed[r] | doubtful[r];
            (x_above, v_above) = (x_new, v_new);
        }
        // `max` hides what is not a number, the sum does not.
        let mut sum = Row::default();
        not_finite.store(&mut sum);
        let unless_lost = sum.0.into_iter().sum::<f64>();
        Judged {
            overlap,
            speed: speed.largest(),
            errors: [largest_x.largest() + unless_lost, largest_v.largest() + unless_lost],
            is_changed: is_changed != 0,
        }
    }
}

impl Kernel for TrialStep<'_> {
    type Output = Judged;

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) -> Judged {
        self.stage::<S, 1>(simd);
        self.stage::<S, 2>(simd);
        self.stage::<S, 3>(simd);
        self.stage::<S, 4>(simd);
        self.stage::<S, 5>(simd);
        self.stage::<S, 6>(simd);
        self.stage::<S, 7>(simd);
        let overlap = self.arrive(simd);
        self.finish(simd, overlap)
    }
}

/// `scale * sum of weight * stage` in row `r`, the `last` stage's accelerations included.
#[inline(always)]
fn all_stages<S: Simd>(
    simd: S,
    stages: &Stages,
    (weights, scale): (&Weights, f64),
    r: usize,
    last: S::V,
) -> S::V {
    let start = last * simd.splat(scale * weights[STAGES - 1]);
    stages.sum::<S, { STAGES - 1 }>(simd, (weights, scale), r, start)
}

/// `value + increment`, and what rounding took. Source: W. Kahan, Commun. ACM 8, 40 (1965).
#[inline(always)]
fn add_compensated<V: Vector>(value: V, lost: V, increment: V) -> (V, V) {
    let increment = increment - lost;
    let sum = value + increment;
    (sum, (sum - value) - increment)
}

/// Computes contacts and accelerations where the chain is; the largest change of an overlap (m).
pub struct Evaluate<'a> {
    pub chain: &'a ChainRows,
    pub live: usize,
    pub motion: &'a mut Motion,
}

impl Kernel for Evaluate<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> f64 {
        let Self { chain, live, motion } = self;
        let mut arrival = Arrival::new(chain, motion, live, None, simd.splat(0.0));
        sweep(simd, chain, live, &mut arrival);
        arrival.largest.largest()
    }
}
