//! One step of a splitting on the chain in rows: kicks and drifts in turn, kicks also by the gradient of the accelerations along themselves.
//!
//! `v += b h a(x) + g h^3 (da/dx) a`, `x += a h v`; see [`mod@crate::integrate::splitting`].
#![allow(
    clippy::inline_always,
    reason = "the code has to be inlined into functions compiled for the instruction set"
)]

use super::rows::{ChainRows, Motion, rates, sweep};
use super::vector::{Kernel, Row, Simd, Vector};
use crate::integrate::splitting::Splitting;

/// Takes a step of `h` (s) from `now` to `next`.
pub struct Step<'a> {
    pub chain: &'a ChainRows,
    pub live: usize,
    pub method: &'a Splitting,
    pub now: &'a Motion,
    pub next: &'a mut Motion,
    /// Gradients of the accelerations along themselves at the last kick (m/s⁴).
    pub gradient: &'a mut [Row],
    /// Length of the step (s).
    pub h: f64,
}

impl Kernel for Step<'_> {
    /// Whether the new state is finite.
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { chain, live, method, now, next, gradient, h } = self;
        let Motion { position, velocity, acceleration, tangent, closed, .. } = next;
        let (position, velocity) = (&mut position[..live], &mut velocity[..live]);
        let (acceleration, tangent) = (&mut acceleration[..live], &mut tangent[..live]);
        let (closed, gradient) = (&mut closed[..live], &mut gradient[..live]);
        position.copy_from_slice(&now.position[..live]);
        velocity.copy_from_slice(&now.velocity[..live]);
        acceleration.copy_from_slice(&now.acceleration[..live]);
        let weights = |index: usize| {
            let gradient = method.gradients.get(index).copied().unwrap_or(0.0);
            (simd.splat(method.kicks[index] * h), gradient, simd.splat(gradient * h * h * h))
        };
        for (index, drift) in method.drifts.iter().enumerate() {
            let (kick, has_gradient, gradient_kick) = weights(index);
            if has_gradient != 0.0 && index == 0 {
                let known = (&now.tangent[..live], &now.acceleration[..live]);
                rates(simd, chain, live, known, |r, g| g.store(&mut gradient[r]));
            }
            let drift = simd.splat(drift * h);
            // A row's accelerations are overwritten after its positions have been asked for.
            let before: &[std::cell::Cell<Row>] =
                std::cell::Cell::from_mut(&mut *acceleration).as_slice_of_cells();
            let positions = |r: usize| {
                let mut v = simd.load(&before[r].get()).mul_add(kick, simd.load(&velocity[r]));
                if has_gradient != 0.0 {
                    v = simd.load(&gradient[r]).mul_add(gradient_kick, v);
                }
                v.store(&mut velocity[r]);
                let x = v.mul_add(drift, simd.load(&position[r]));
                x.store(&mut position[r]);
                x
            };
            let contacts = |r: usize, touch: super::rows::Touch<S::V>| {
                touch.tangent.store(&mut tangent[r]);
                closed[r] = touch.closed;
            };
            let bodies = |r: usize, a: S::V| {
                let mut row = Row::default();
                a.store(&mut row);
                before[r].set(row);
            };
            sweep(simd, chain, live, positions, contacts, bodies);
            if weights(index + 1).1 != 0.0 {
                let known = (&*tangent, &*acceleration);
                rates(simd, chain, live, known, |r, g| g.store(&mut gradient[r]));
            }
        }
        let (kick, has_gradient, gradient_kick) = weights(method.drifts.len());
        let (none, mut not_finite) = (simd.splat(0.0), simd.splat(0.0));
        for r in 0..live {
            let mut v = simd.load(&acceleration[r]).mul_add(kick, simd.load(&velocity[r]));
            if has_gradient != 0.0 {
                v = simd.load(&gradient[r]).mul_add(gradient_kick, v);
            }
            v.store(&mut velocity[r]);
            not_finite = (simd.load(&position[r]) + v).mul_add(none, not_finite);
        }
        let mut sum = Row::default();
        not_finite.store(&mut sum);
        sum.0.into_iter().sum::<f64>() == 0.0
    }
}
