//! Pairs whose coefficients the compiler knows: sums of stages without a weight that is zero, each from a place beside the last one's.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;

use super::lanes::{Lanes, Row};
use super::workspace::{BETWEEN, Between};
use crate::integrate::dormand_el_mikkawy_prince_64::DORMAND_EL_MIKKAWY_PRINCE_64;
use crate::integrate::dormand_el_mikkawy_prince_86::DORMAND_EL_MIKKAWY_PRINCE_86;
use crate::integrate::nystrom::NystromPair;
use crate::integrate::stages::Row as Terms;

/// Most stages of a pair.
const MOST: usize = BETWEEN + 2;

/// A pair of `N` stages.
pub trait Known<const N: usize> {
    const PAIR: NystromPair;
}

pub struct Pair64;
pub struct Pair86;

impl Known<6> for Pair64 {
    const PAIR: NystromPair = DORMAND_EL_MIKKAWY_PRINCE_64;
}

impl Known<9> for Pair86 {
    const PAIR: NystromPair = DORMAND_EL_MIKKAWY_PRINCE_86;
}

/// What each stage weighs in a sum (1).
pub trait Weights {
    const OF: [f64; MOST];
}

/// In the position of stage `S`.
pub struct Stage<P, const N: usize, const S: usize>(P);
pub struct Position<P, const N: usize>(P);
pub struct Velocity<P, const N: usize>(P);
pub struct PositionError<P, const N: usize>(P);
pub struct VelocityError<P, const N: usize>(P);

impl<P: Known<N>, const N: usize, const S: usize> Weights for Stage<P, N, S> {
    const OF: [f64; MOST] = if S < N { spread(P::PAIR.stages[S]) } else { [0.0; MOST] };
}

impl<P: Known<N>, const N: usize> Weights for Position<P, N> {
    const OF: [f64; MOST] = spread(P::PAIR.position);
}

impl<P: Known<N>, const N: usize> Weights for Velocity<P, N> {
    const OF: [f64; MOST] = spread(P::PAIR.velocity);
}

impl<P: Known<N>, const N: usize> Weights for PositionError<P, N> {
    const OF: [f64; MOST] = spread(P::PAIR.position_error);
}

impl<P: Known<N>, const N: usize> Weights for VelocityError<P, N> {
    const OF: [f64; MOST] = spread(P::PAIR.velocity_error);
}

const fn spread(terms: Terms) -> [f64; MOST] {
    let mut weights = [0.0; MOST];
    let mut i = 0;
    while i < terms.len() {
        weights[terms[i].0] = terms[i].1;
        i += 1;
    }
    weights
}

/// A weighted sum of a pair's stages.
#[derive(Clone, Copy)]
pub struct Sum<L: Lanes, W> {
    weights: [L::V; MOST],
    of: PhantomData<W>,
}

impl<L: Lanes, W: Weights> Sum<L, W> {
    /// Each weight times `scale`.
    #[inline(always)]
    pub fn new(scale: L::V) -> Self {
        let mut weights = [scale; MOST];
        for (weight, of) in weights.iter_mut().zip(W::OF) {
            if of != 0.0 {
                *weight = L::mul(scale, L::splat(of));
            }
        }
        Self { weights, of: PhantomData }
    }

    /// `sum` plus what the first `count` stages weigh in a row, the newest last: all others can be summed while it is still being computed.
    #[inline(always)]
    pub fn plus(&self, (first, between): (&Row, &Between), count: usize, sum: L::V) -> L::V {
        let mut sum = self.newest(0, L::load(first), sum);
        for (m, stage) in (1..count).zip(between) {
            sum = self.newest(m, L::load(stage), sum);
        }
        sum
    }

    /// `sum` plus what `acceleration` weighs, that of stage `m`.
    #[inline(always)]
    pub fn newest(&self, m: usize, acceleration: L::V, sum: L::V) -> L::V {
        if W::OF[m] == 0.0 { sum } else { L::mul_add(self.weights[m], acceleration, sum) }
    }
}
