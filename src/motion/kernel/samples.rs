//! Forces of two contacts at even times within a step, eight times at once.
#![allow(
    clippy::inline_always,
    reason = "the code has to be inlined into functions compiled for the instruction set"
)]

use super::rows::force_change;
use super::vector::{Kernel, Row, Simd, Vector, WIDTH};

/// The force of one contact over a step.
#[derive(Debug, Clone, Copy)]
pub struct ContactStep<'a> {
    /// Overlap change as a polynomial in the fraction of the step: coefficients of its powers (m).
    pub overlap: &'a [f64; 8],
    /// `A` (N/m^1.5).
    pub stiffness: f64,
    /// Square root of the static overlap (m^0.5).
    pub static_root: f64,
    /// Weight in the sum (1).
    pub weight: f64,
}

/// Writes the weighted sum of the force changes (N) at the fractions `first + i * interval` of a
/// step.
pub struct SampleForces<'a> {
    /// The two contacts.
    pub contacts: [ContactStep<'a>; 2],
    /// Fraction of the step at the first sample (1).
    pub first: f64,
    /// From one sample to the next, as a fraction of the step (1).
    pub interval: f64,
    /// Where the sums go (N).
    pub out: &'a mut [f64],
}

impl Kernel for SampleForces<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { contacts, first, interval, out } = self;
        let lanes = simd.load(&Row([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]));
        let mut start = 0.0;
        for chunk in out.chunks_mut(WIDTH) {
            let index = lanes + simd.splat(start);
            let theta = index.mul_add(simd.splat(interval), simd.splat(first));
            let mut sum = simd.splat(0.0);
            for contact in &contacts {
                let mut change = simd.splat(contact.overlap[7]);
                for power in (0..7).rev() {
                    change = change.mul_add(theta, simd.splat(contact.overlap[power]));
                }
                let root = contact.static_root;
                let found = force_change(
                    simd,
                    simd.splat(contact.stiffness),
                    (simd.splat(root * root), simd.splat(root)),
                    change,
                );
                sum = found.force.mul_add(simd.splat(contact.weight), sum);
            }
            let mut row = Row::default();
            sum.store(&mut row);
            chunk.copy_from_slice(&row.0[..chunk.len()]);
            start += 8.0;
        }
    }
}
