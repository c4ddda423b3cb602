//! Pairs whose coefficients the compiler knows: sums of stages without a weight that is zero.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;

use crate::chain::stepper::lanes::{Lanes, Row};
use crate::integrate::dormand_el_mikkawy_prince_64 as pair_64;
use crate::integrate::dormand_el_mikkawy_prince_86 as pair_86;
use crate::integrate::nystrom::{NystromPair, Row as Terms};

/// Most stages of a pair.
const MOST: usize = 9;

/// A pair of `N` stages that the compiler knows.
pub trait Known<const N: usize> {
    const PAIR: NystromPair;
    /// The first `R` rows of each stage: taken apart by hand, for the compiler makes a loop of anything else.
    fn stages<const R: usize>(stages: &mut [Vec<Row>]) -> Option<[&mut [Row; R]; N]>;
}

pub struct Pair64;
pub struct Pair86;

impl Known<6> for Pair64 {
    const PAIR: NystromPair = pair_64::PAIR;

    #[inline(always)]
    #[allow(clippy::many_single_char_names, reason = "stages in a row")]
    fn stages<const R: usize>(stages: &mut [Vec<Row>]) -> Option<[&mut [Row; R]; 6]> {
        let [a, b, c, d, e, f] = stages else { return None };
        let (a, b, c) = (first_mut(a), first_mut(b), first_mut(c));
        Some([a, b, c, first_mut(d), first_mut(e), first_mut(f)])
    }
}

impl Known<9> for Pair86 {
    const PAIR: NystromPair = pair_86::PAIR;

    #[inline(always)]
    #[allow(clippy::many_single_char_names, reason = "stages in a row")]
    fn stages<const R: usize>(stages: &mut [Vec<Row>]) -> Option<[&mut [Row; R]; 9]> {
        let [a, b, c, d, e, f, g, h, i] = stages else { return None };
        let (a, b, c) = (first_mut(a), first_mut(b), first_mut(c));
        let (d, e, f) = (first_mut(d), first_mut(e), first_mut(f));
        Some([a, b, c, d, e, f, first_mut(g), first_mut(h), first_mut(i)])
    }
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

/// A weighted sum of stages.
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

    /// `sum` plus what the first `count` of `stages` weigh in row `r`.
    #[inline(always)]
    pub fn kept<const R: usize, const N: usize>(
        &self,
        (stages, count): (&[&mut [Row; R]; N], usize),
        (mut sum, r): (L::V, usize),
    ) -> L::V {
        for (m, stage) in stages.iter().enumerate().take(count) {
            if W::OF[m] != 0.0 {
                sum = L::mul_add(self.weights[m], L::load(&stage[r]), sum);
            }
        }
        sum
    }

    /// What all stages weigh in row `r`, the last two of which are `newest`.
    #[inline(always)]
    pub fn all<const R: usize, const N: usize>(
        &self,
        stages: &[&mut [Row; R]; N],
        newest: (L::V, L::V),
        r: usize,
    ) -> L::V {
        let kept = self.kept((stages, N - 2), (L::splat(0.0), r));
        let before = self.newest(N - 2, newest.0, kept);
        self.newest(N - 1, newest.1, before)
    }

    /// `sum` plus what `acceleration` weighs, that of stage `m`.
    #[inline(always)]
    pub fn newest(&self, m: usize, acceleration: L::V, sum: L::V) -> L::V {
        if W::OF[m] == 0.0 { sum } else { L::mul_add(self.weights[m], acceleration, sum) }
    }
}

/// The first `R` rows.
#[inline(always)]
pub fn first<const R: usize>(rows: &[Row]) -> &[Row; R] {
    &rows.as_chunks::<R>().0[0]
}

/// The same to be written.
#[inline(always)]
pub fn first_mut<const R: usize>(rows: &mut [Row]) -> &mut [Row; R] {
    &mut rows.as_chunks_mut::<R>().0[0]
}
