//! One step of a splitting on the chain in rows: kicks and drifts in turn, kicks also by the
//! gradient of the accelerations along themselves.
//!
//! `v += b h a(x) + g h^3 (da/dx) a`, `x += a h v`; see [`mod@crate::motion::splitting`].
#![allow(
    clippy::inline_always,
    reason = "the code has to be inlined into functions compiled for the instruction set"
)]

use super::rows::{ChainRows, Motion, Touch, Visit, rates, sweep};
use super::vector::{Kernel, Row, Simd, Vector};
use crate::motion::splitting::Splitting;

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

/// Kicks and drifts of all rows, then forces where they lead.
struct KickAndDrift<'a, V> {
    kick: V,
    /// Weight of the gradients; none where the kick does not go by them.
    gradient_kick: Option<V>,
    drift: V,
    gradient: &'a [Row],
    position: &'a mut [Row],
    velocity: &'a mut [Row],
    acceleration: &'a mut [Row],
    tangent: &'a mut [Row],
    closed: &'a mut [u8],
}

impl<S: Simd> Visit<S> for KickAndDrift<'_, S::V> {
    #[inline(always)]
    fn positions(&mut self, simd: S, r: usize) -> S::V {
        // A row's accelerations are overwritten after its positions have been asked for.
        let mut v =
            simd.load(&self.acceleration[r]).mul_add(self.kick, simd.load(&self.velocity[r]));
        if let Some(kick) = self.gradient_kick {
            v = simd.load(&self.gradient[r]).mul_add(kick, v);
        }
        v.store(&mut self.velocity[r]);
        let x = v.mul_add(self.drift, simd.load(&self.position[r]));
        x.store(&mut self.position[r]);
        x
    }

    #[inline(always)]
    fn contacts(&mut self, _simd: S, r: usize, touch: &Touch<S::V>) {
        touch.tangent.store(&mut self.tangent[r]);
        self.closed[r] = touch.closed;
    }

    #[inline(always)]
    fn bodies(&mut self, r: usize, acceleration: S::V) {
        acceleration.store(&mut self.acceleration[r]);
    }
}

impl Step<'_> {
    /// Weights of kick `index`: of accelerations and of gradients.
    #[inline(always)]
    fn kick<S: Simd>(&self, simd: S, index: usize) -> (S::V, Option<S::V>) {
        let (h, weight) = (self.h, self.gradient_weight(index));
        let gradient = if weight == 0.0 { None } else { Some(simd.splat(weight * h * h * h)) };
        (simd.splat(self.method.kicks[index] * h), gradient)
    }

    /// Weight of the gradients in kick `index`, in units of the step cubed (1).
    fn gradient_weight(&self, index: usize) -> f64 {
        self.method.gradients.get(index).copied().unwrap_or(0.0)
    }
}

impl Kernel for Step<'_> {
    /// Whether the new state is finite.
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let (chain, live, now) = (self.chain, self.live, self.now);
        self.next.position[..live].copy_from_slice(&now.position[..live]);
        self.next.velocity[..live].copy_from_slice(&now.velocity[..live]);
        self.next.acceleration[..live].copy_from_slice(&now.acceleration[..live]);
        if self.gradient_weight(0) != 0.0 {
            let known = (&now.tangent[..live], &now.acceleration[..live]);
            rates(simd, chain, live, known, self.gradient);
        }
        for index in 0..self.method.drifts.len() {
            let (kick, gradient_kick) = self.kick(simd, index);
            let Motion { position, velocity, acceleration, tangent, closed, .. } = &mut *self.next;
            let mut sweep_rows = KickAndDrift {
                kick,
                gradient_kick,
                drift: simd.splat(self.method.drifts[index] * self.h),
                gradient: &self.gradient[..live],
                position: &mut position[..live],
                velocity: &mut velocity[..live],
                acceleration: &mut acceleration[..live],
                tangent: &mut tangent[..live],
                closed: &mut closed[..live],
            };
            sweep(simd, chain, live, &mut sweep_rows);
            if self.gradient_weight(index + 1) != 0.0 {
                let known = (&self.next.tangent[..live], &self.next.acceleration[..live]);
                rates(simd, chain, live, known, self.gradient);
            }
        }
        let (kick, gradient_kick) = self.kick(simd, self.method.drifts.len());
        let (none, mut not_finite) = (simd.splat(0.0), simd.splat(0.0));
        for r in 0..live {
            let acceleration = simd.load(&self.next.acceleration[r]);
            let mut v = acceleration.mul_add(kick, simd.load(&self.next.velocity[r]));
            if let Some(kick) = gradient_kick {
                v = simd.load(&self.gradient[r]).mul_add(kick, v);
            }
            v.store(&mut self.next.velocity[r]);
            not_finite = (simd.load(&self.next.position[r]) + v).mul_add(none, not_finite);
        }
        let mut sum = Row::default();
        not_finite.store(&mut sum);
        sum.0.into_iter().sum::<f64>() == 0.0
    }
}
