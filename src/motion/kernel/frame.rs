//! The whole chain at one time within a step: displacements and contact forces.
#![allow(
    clippy::inline_always,
    reason = "the code has to be inlined into functions compiled for the instruction set"
)]

use super::rows::{ChainRows, Motion, Touch, Visit, place, rates, sweep};
use super::vector::{Kernel, Row, Simd, Vector};
use crate::motion::hermite::septic_weights;

/// Interpolates at the fraction `theta` of the step of `h` (s) from `from` to `to` by septics.
pub struct Frame<'a> {
    pub chain: &'a ChainRows,
    pub live: usize,
    pub ends: [&'a Motion; 2],
    /// Fraction of the step (1).
    pub theta: f64,
    /// Length of the step (s).
    pub h: f64,
    /// Room for jerks at both ends (m/s³).
    pub jerks: &'a mut [Vec<Row>; 2],
    /// Displacements (m) and force changes (N); rows that nothing has reached are left alone.
    pub out: &'a mut [Vec<Row>; 2],
}

impl Kernel for Frame<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { chain, live, ends, theta, h, jerks, out: [positions, forces] } = self;
        for (motion, jerk) in ends.iter().zip(jerks.iter_mut()) {
            let known = (&motion.tangent[..live], &motion.velocity[..live]);
            rates(simd, chain, live, known, jerk);
            if let Some((body, by_pull)) = chain.jerk_by_pull(motion) {
                let (row, lane) = place(body);
                jerk[row].0[lane] += by_pull;
            }
        }
        let weights = septic_weights(theta, h);
        sweep(simd, chain, live, &mut Interpolated { ends, jerks, weights, positions, forces });
    }
}

/// Positions from both ends of the step.
struct Interpolated<'a> {
    ends: [&'a Motion; 2],
    jerks: &'a [Vec<Row>; 2],
    weights: [[f64; 4]; 2],
    positions: &'a mut [Row],
    forces: &'a mut [Row],
}

impl<S: Simd> Visit<S> for Interpolated<'_> {
    #[inline(always)]
    fn positions(&mut self, simd: S, r: usize) -> S::V {
        let mut sum = simd.splat(0.0);
        for end in 0..2 {
            let (motion, weights) = (self.ends[end], &self.weights[end]);
            let rows = [&motion.position, &motion.velocity, &motion.acceleration, &self.jerks[end]];
            for which in 0..4 {
                sum = simd.load(&rows[which][r]).mul_add(simd.splat(weights[which]), sum);
            }
        }
        sum.store(&mut self.positions[r]);
        sum
    }

    #[inline(always)]
    fn contacts(&mut self, _simd: S, r: usize, touch: &Touch<S::V>) {
        touch.force.store(&mut self.forces[r]);
    }

    #[inline(always)]
    fn bodies(&mut self, _r: usize, _acceleration: S::V) {}
}
