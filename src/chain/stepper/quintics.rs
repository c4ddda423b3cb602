//! Overlaps of eight contacts that change sides in a step, side by side, and what their forces do there.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row, WIDTH};
use super::quadrature::{Quadrature, Weights};
use super::quintic::Quintic;

/// Nodes of the Gauss-Jacobi quadrature for the weight `s^1.5` on 0 to 1, and their weights (1).
const ROOT_NODES: [(f64, f64); 5] = [
    (0.124_061_505_637_331_54, 0.007_609_028_036_605_25),
    (0.336_472_509_340_995_9, 0.047_184_038_143_998_46),
    (0.587_491_435_263_399_5, 0.112_429_350_380_216_15),
    (0.815_071_707_804_017_6, 0.144_130_795_395_627_18),
    (0.962_989_798_475_994_5, 0.088_646_788_043_552_97),
];
/// Steps of Newton's method from the secant's root.
const NEWTON_STEPS: usize = 3;
/// What may be left of an overlap at its root, as a share of those at both ends (1).
const ROOT_RESIDUE: f64 = 1e-10;

/// Overlap, closing speed and relative acceleration of eight contacts, times 1, `h` and `h^2` (m), at both ends of their steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ends(pub [[Row; 3]; 2]);

impl Default for Ends {
    /// Contacts that open half-way, so that lanes left over do no harm.
    #[inline(always)]
    fn default() -> Self {
        let mut ends = [[Row::default(); 3]; 2];
        (ends[0][0], ends[1][0]) = (Row([1.0; WIDTH]), Row([-1.0; WIDTH]));
        Self(ends)
    }
}

/// What the quadrature misses of `overlap^1.5`, contact by contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Missing {
    /// Of its integral over the step, in units of the step (m^1.5).
    pub impulse: Row,
    /// Of its first moment to the end of the step (m^1.5).
    pub moment: Row,
    /// What it contributes to the error estimates of velocity and position (m^1.5).
    pub errors: [Row; 2],
    /// Difference of quintic and cubic at mid-step: what the ends do not know (m).
    pub uncertainty: Row,
}

/// Eight quintics in the fraction of the step.
struct Quintics<L: Lanes> {
    coefficients: [L::V; 6],
    /// Where they change sign (1).
    root: L::V,
}

impl<L: Lanes> Quintics<L> {
    #[inline(always)]
    fn new(ends: &Ends) -> (Self, L::V) {
        let [[p0, w0, g0], [p1, w1, g1]] = ends.0;
        let [p0, w0, g0] = [L::load(&p0), L::load(&w0), L::load(&g0)];
        let [p1, w1, g1] = [L::load(&p1), L::load(&w1), L::load(&g1)];
        let times = |factor: f64, value: L::V| L::mul(L::splat(factor), value);
        let rise = L::sub(p1, p0);
        let p = L::sub(L::sub(rise, w0), times(0.5, g0));
        let q = L::sub(L::sub(w1, w0), g0);
        let r = L::sub(g1, g0);
        let square = L::sub(L::sub(times(3.0, rise), times(2.0, w0)), w1);
        let cube = L::sub(L::add(w0, w1), times(2.0, rise));
        let early = L::sub(g0, times(2.0, square));
        let late = L::sub(L::sub(g1, times(2.0, square)), times(6.0, cube));
        let uncertainty = times(1.0 / 64.0, L::abs(L::add(early, late)));
        let coefficients = [
            p0,
            w0,
            times(0.5, g0),
            L::add(L::sub(times(10.0, p), times(4.0, q)), times(0.5, r)),
            L::sub(L::sub(times(7.0, q), times(15.0, p)), r),
            L::add(L::sub(times(6.0, p), times(3.0, q)), times(0.5, r)),
        ];
        let mut quintics = Self { coefficients, root: L::div(p0, L::sub(p0, p1)) };
        quintics.find_roots(ends);
        (quintics, uncertainty)
    }

    #[inline(always)]
    fn at(&self, t: L::V) -> L::V {
        let c = &self.coefficients;
        let mut sum = c[5];
        for coefficient in [c[4], c[3], c[2], c[1], c[0]] {
            sum = L::mul_add(sum, t, coefficient);
        }
        sum
    }

    /// Newton's method; what it does not find is left to one contact's own search.
    #[inline(always)]
    fn find_roots(&mut self, ends: &Ends) {
        let c = self.coefficients;
        let times = |factor: f64, value: L::V| L::mul(L::splat(factor), value);
        let slopes = [times(4.0, c[4]), times(3.0, c[3]), times(2.0, c[2]), c[1]];
        let steepest = times(5.0, c[5]);
        let (none, one) = (L::splat(0.0), L::splat(1.0));
        for _ in 0..NEWTON_STEPS {
            let mut slope = steepest;
            for coefficient in slopes {
                slope = L::mul_add(slope, self.root, coefficient);
            }
            let next = L::sub(self.root, L::div(self.at(self.root), slope));
            // The smaller of both, as there is only a larger one.
            let capped = L::sub(none, L::max(L::sub(none, next), L::sub(none, one)));
            self.root = L::max(capped, none);
        }
        let (p0, p1) = (L::load(&ends.0[0][0]), L::load(&ends.0[1][0]));
        let allowed = times(ROOT_RESIDUE, L::add(L::abs(p0), L::abs(p1)));
        let found = L::positive(L::sub(allowed, L::abs(self.at(self.root))));
        if found != u8::MAX {
            let mut roots = Row::default();
            L::store(self.root, &mut roots);
            for lane in (0..WIDTH).filter(|lane| found & (1 << lane) == 0) {
                let end = |which: usize| ends.0[which].map(|row| row.0[lane]);
                roots.0[lane] = Quintic::new(end(0), end(1)).root();
            }
            self.root = L::load(&roots);
        }
    }

    /// `int overlap^1.5` and `int (1 - t) overlap^1.5` over the closed parts; `closing` is 1 where a contact closes, or 0 (m^1.5).
    #[inline(always)]
    fn impulses(&self, closing: L::V) -> (L::V, L::V) {
        let none = L::splat(0.0);
        let length = L::sub(closing, self.root);
        let (mut impulse, mut moment) = (none, none);
        for (node, weight) in ROOT_NODES {
            let t = L::mul_add(L::splat(node), length, self.root);
            // The root is taken out, what remains is smooth.
            let closed = L::max(L::mul(self.at(t), L::splat(1.0 / node)), none);
            let value = L::mul(L::splat(weight), L::mul(closed, L::sqrt(closed)));
            impulse = L::add(impulse, value);
            moment = L::mul_add(value, L::sub(L::splat(1.0), t), moment);
        }
        let length = L::abs(length);
        (L::mul(impulse, length), L::mul(moment, length))
    }
}

/// What `quadrature` misses of the contacts between `ends`.
#[inline(always)]
pub fn missing<L: Lanes>(quadrature: &Quadrature, ends: &Ends) -> Missing {
    let (quintics, uncertainty) = Quintics::<L>::new(ends);
    let mut closing = Row::default();
    for (closing, end) in closing.0.iter_mut().zip(ends.0[1][0].0) {
        *closing = f64::from(u8::from(end > 0.0));
    }
    let (mut impulse, mut moment) = quintics.impulses(L::load(&closing));
    let none = L::splat(0.0);
    let mut errors = [none; 2];
    let at = |weights: &Weights, stage: usize| L::splat(weights[stage / WIDTH].0[stage % WIDTH]);
    for stage in 0..quadrature.stages {
        let closed = L::max(quintics.at(at(&quadrature.nodes, stage)), none);
        let power = L::mul(closed, L::sqrt(closed));
        impulse = L::sub(impulse, L::mul(at(&quadrature.velocity, stage), power));
        moment = L::sub(moment, L::mul(at(&quadrature.position, stage), power));
        errors[0] = L::mul_add(at(&quadrature.velocity_error, stage), power, errors[0]);
        errors[1] = L::mul_add(at(&quadrature.position_error, stage), power, errors[1]);
    }
    let mut found = Missing::default();
    L::store(impulse, &mut found.impulse);
    L::store(moment, &mut found.moment);
    L::store(errors[0], &mut found.errors[0]);
    L::store(errors[1], &mut found.errors[1]);
    L::store(uncertainty, &mut found.uncertainty);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::stepper::lanes::Baseline;
    use crate::integrate::dormand_el_mikkawy_prince_64::DORMAND_EL_MIKKAWY_PRINCE_64;

    /// Parabolas through zero at eight places, opening or closing: their integrals against the midpoint rule in `s^2` from the root on,
    /// where they are smooth. The last two are so bent that Newton's method goes astray; five nodes follow them less closely, but a
    /// wrong root would leave nothing right.
    #[test]
    fn integrals_are_those_of_the_overlaps() {
        let overlaps = [
            (0.2, 1.0, 0.1),
            (0.5, -1.0, 0.3),
            (0.8, 2.0, -1.0),
            (0.01, -3.0, 1.0),
            (0.99, 1.0, 0.0),
            (0.4, -0.1, -0.05),
            (0.05, 0.06, 1.0),
            (0.95, -0.06, 1.0),
        ];
        // `b (t - root) + c (t - root)^2`, up to the other root, which lies outside.
        let mut ends = Ends::default();
        for (lane, (root, b, c)) in overlaps.into_iter().enumerate() {
            for (which, t) in [0.0 - root, 1.0 - root].into_iter().enumerate() {
                let values = [b * t + c * t * t, b + 2.0 * c * t, 2.0 * c];
                for (row, value) in ends.0[which].iter_mut().zip(values) {
                    row.0[lane] = value;
                }
            }
        }
        let mut nothing = Quadrature::of(&DORMAND_EL_MIKKAWY_PRINCE_64);
        nothing.stages = 0;
        let found = missing::<Baseline>(&nothing, &ends);
        for (lane, (root, b, c)) in overlaps.into_iter().enumerate() {
            let closes = ends.0[1][0].0[lane] > 0.0;
            let allowed = if lane < 6 { 1e-6 } else { 1e-2 };
            let length: f64 = if closes { 1.0 - root } else { -root };
            let (mut impulse, mut moment) = (0.0, 0.0);
            let count = 20_000;
            for i in 0..count {
                let s = (f64::from(i) + 0.5) / f64::from(count);
                let x = length * s * s;
                let part = 2.0 * s * length.abs() / f64::from(count)
                    * (b * x + c * x * x).max(0.0).powf(1.5);
                impulse += part;
                moment += part * (1.0 - root - x);
            }
            let off = (found.impulse.0[lane] / impulse - 1.0).abs();
            assert!(off < allowed, "{lane}: {} and {impulse}", found.impulse.0[lane]);
            let off = (found.moment.0[lane] - moment).abs() / impulse;
            assert!(off < allowed, "{lane}: {} and {moment}", found.moment.0[lane]);
        }
        // A parabola is a cubic.
        assert!(found.uncertainty.0.iter().all(|off| *off < 1e-15), "{:?}", found.uncertainty);
    }
}
