//! The whole chain at one time within a step: displacements and contact forces.
#![allow(
    clippy::inline_always,
    reason = "the code has to be inlined into functions compiled for the instruction set"
)]

use super::rows::{ChainRows, Motion, rates, sweep};
use super::vector::{Kernel, Row, Simd, Vector};
use crate::integrate::hermite::septic_weights;

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
            rates(simd, chain, live, known, |r, j| j.store(&mut jerk[r]));
        }
        let weights = septic_weights(theta, h);
        let at = |r: usize| {
            let mut sum = simd.splat(0.0);
            for ((motion, jerk), weights) in ends.iter().zip(jerks.iter()).zip(weights) {
                let rows = [&motion.position, &motion.velocity, &motion.acceleration, jerk];
                for (rows, weight) in rows.into_iter().zip(weights) {
                    sum = simd.load(&rows[r]).mul_add(simd.splat(weight), sum);
                }
            }
            sum.store(&mut positions[r]);
            sum
        };
        sweep(simd, chain, live, at, |r, touch| touch.force.store(&mut forces[r]), |_, _| ());
    }
}
