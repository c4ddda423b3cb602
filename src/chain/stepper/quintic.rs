//! One contact's overlap over a step, and what its force does there.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row};

/// Nodes of the Gauss-Jacobi quadrature for the weight `s^1.5` on 0 to 1, five of them; the rest weighs nothing (1).
const ROOT_NODES: Row = Row([
    0.124_061_505_637_331_54,
    0.336_472_509_340_995_9,
    0.587_491_435_263_399_5,
    0.815_071_707_804_017_6,
    0.962_989_798_475_994_5,
    1.0,
    1.0,
    1.0,
]);
/// Their weights (1).
const ROOT_WEIGHTS: Row = Row([
    0.007_609_028_036_605_25,
    0.047_184_038_143_998_46,
    0.112_429_350_380_216_15,
    0.144_130_795_395_627_18,
    0.088_646_788_043_552_97,
    0.0,
    0.0,
    0.0,
]);
/// One contact's overlap over a step, as a quintic in the fraction of the step.
pub struct Quintic {
    coefficients: [f64; 6],
    /// Where it changes sign (1).
    root: f64,
    /// Difference to the cubic at mid-step: what the ends do not know (m).
    pub uncertainty: f64,
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
        let square = 3.0 * (p1 - p0) - 2.0 * w0 - w1;
        let cube = 2.0 * (p0 - p1) + w0 + w1;
        let mut quintic = Self {
            coefficients: [
                p0,
                w0,
                0.5 * g0,
                10.0 * p - 4.0 * q + 0.5 * r,
                -15.0 * p + 7.0 * q - r,
                6.0 * p - 3.0 * q + 0.5 * r,
            ],
            root: 0.0,
            uncertainty: ((g0 - 2.0 * square) + (g1 - 2.0 * square - 6.0 * cube)).abs() / 64.0,
            closes: p1 > 0.0,
        };
        quintic.root = quintic.find_root(p0, p1);
        quintic
    }

    #[inline(always)]
    fn at(&self, t: f64) -> f64 {
        let c = &self.coefficients;
        c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))))
    }

    /// Newton's method, kept between the ends by bisection.
    #[inline(always)]
    fn find_root(&self, p0: f64, p1: f64) -> f64 {
        let c = &self.coefficients;
        let (mut low, mut high) = (0.0, 1.0);
        let mut t = p0 / (p0 - p1);
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

    /// Closed overlaps at eight times, to the power 1.5.
    #[inline(always)]
    pub fn power<L: Lanes>(&self, times: &Row) -> L::V {
        let closed = L::max(self.lanes::<L>(L::load(times)), L::splat(0.0));
        L::mul(closed, L::sqrt(closed))
    }

    /// `int overlap^1.5` and `int (1 - t) overlap^1.5` over the closed part (m^1.5).
    #[inline(always)]
    pub fn impulses<L: Lanes>(&self) -> (f64, f64) {
        let length = if self.closes { 1.0 - self.root } else { -self.root };
        let s = L::load(&ROOT_NODES);
        let t = L::mul_add(s, L::splat(length), L::splat(self.root));
        // The root is taken out, what remains is smooth.
        let rest = L::div(self.lanes::<L>(t), s);
        let closed = L::max(rest, L::splat(0.0));
        let value = L::mul(L::load(&ROOT_WEIGHTS), L::mul(closed, L::sqrt(closed)));
        let moment = L::mul(value, L::sub(L::splat(1.0), t));
        (L::total(value) * length.abs(), L::total(moment) * length.abs())
    }
}

/// The larger of both; what is not a number stays none (unit).
#[inline(always)]
pub fn raise(most: &mut f64, value: f64) {
    if value > *most || value.is_nan() {
        *most = value;
    }
}
