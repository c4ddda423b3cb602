//! One contact's overlap over a step, and what its force does there.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row};

/// One contact's overlap over a step, as a quintic in the fraction of the step.
pub struct Quintic {
    coefficients: [f64; 6],
    /// Where the secant changes sign (1).
    start: f64,
    /// Whether it is positive at the end.
    closes: bool,
}

impl Quintic {
    /// From overlap (m), closing speed and relative acceleration, times `h` and `h^2` (m), at both ends.
    #[inline(always)]
    pub fn new(from: [f64; 3], to: [f64; 3]) -> Self {
        let [p0, w0, g0] = from;
        let [p1, w1, g1] = to;
        let (p, q, r) = (p1 - p0 - w0 - 0.5 * g0, w1 - w0 - g0, g1 - g0);
        Self {
            coefficients: [
                p0,
                w0,
                0.5 * g0,
                10.0 * p - 4.0 * q + 0.5 * r,
                -15.0 * p + 7.0 * q - r,
                6.0 * p - 3.0 * q + 0.5 * r,
            ],
            closes: p1 > 0.0,
            start: p0 / (p0 - p1),
        }
    }

    #[inline(always)]
    fn at(&self, t: f64) -> f64 {
        let c = &self.coefficients;
        c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))))
    }

    /// Where it changes sign: Newton's method, kept between the ends by bisection (1).
    #[inline(always)]
    pub fn root(&self) -> f64 {
        let c = &self.coefficients;
        let (mut low, mut high) = (0.0, 1.0);
        let mut t = self.start;
        for _ in 0..12 {
            let value = self.at(t);
            if (value > 0.0) == self.closes {
                high = t;
            } else {
                low = t;
            }
            let slope =
                c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * 5.0 * c[5])));
            let newton = t - value / slope;
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let moved = (next - t).abs();
            t = next;
            if moved < 1e-6 {
                break;
            }
        }
        t
    }

    /// How far the overlap goes to the other side of zero between its ends, which are on one side (m).
    #[inline(always)]
    pub fn beyond<L: Lanes>(&self) -> f64 {
        let sign = if self.closes { -1.0 } else { 1.0 };
        let times = Row([0.12, 0.23, 0.34, 0.45, 0.55, 0.66, 0.77, 0.88]);
        let values = L::mul(L::splat(sign), self.lanes::<L>(L::load(&times)));
        L::largest(L::max(values, L::splat(0.0)))
    }

    /// The overlap at eight times.
    #[inline(always)]
    pub fn lanes<L: Lanes>(&self, t: L::V) -> L::V {
        let mut sum = L::splat(0.0);
        for coefficient in self.coefficients.iter().rev() {
            sum = L::mul_add(sum, t, L::splat(*coefficient));
        }
        sum
    }
}

/// The larger of both; what is not a number stays none (unit).
#[inline(always)]
pub fn raise(most: &mut f64, value: f64) {
    if value > *most || value.is_nan() {
        *most = value;
    }
}
