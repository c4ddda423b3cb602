//! Overlaps of eight contacts over a step, side by side, and what their forces do where they change sides.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::{BESIDE, PLAIN, begin_plain};
use super::known::{Known, Position, PositionError, Velocity, VelocityError, Weights};
use super::lanes::Lanes;

/// Nodes of the Gauss-Jacobi quadrature for the weight `s^1.5` on 0 to 1, and their weights (1).
pub const ROOT_NODES: [(f64, f64); 5] = [
    (0.124_061_505_637_331_54, 0.007_609_028_036_605_25),
    (0.336_472_509_340_995_9, 0.047_184_038_143_998_46),
    (0.587_491_435_263_399_5, 0.112_429_350_380_216_15),
    (0.815_071_707_804_017_6, 0.144_130_795_395_627_18),
    (0.962_989_798_475_994_5, 0.088_646_788_043_552_97),
];
/// What may be left of an overlap at its root, as a share of those at both ends: the impulse from there on is off by less than that share of
/// itself (1).
pub const ROOT_RESIDUE: f64 = 1e-7;
/// Most steps of the search for a root that the first one has not found.
pub const SEARCH_STEPS: usize = 30;
/// Where an overlap is looked at that may have gone to the other side and back, fractions of the step (1).
const LOOKS: [f64; 8] = [0.12, 0.23, 0.34, 0.45, 0.55, 0.66, 0.77, 0.88];

/// Overlap, closing speed and relative acceleration of eight contacts, times 1, `h` and `h^2` (m), at both ends of their steps.
pub type Ends<L> = [[<L as Lanes>::V; 3]; 2];

/// What the quadrature misses of `overlap^1.5`, contact by contact.
#[derive(Clone, Copy)]
pub struct Missing<L: Lanes> {
    /// Of its integral over the step, in units of the step (m^1.5).
    pub impulse: L::V,
    /// Of its first moment to the end of the step (m^1.5).
    pub moment: L::V,
    /// What it contributes to the error estimates of velocity and position (m^1.5).
    pub errors: [L::V; 2],
    /// What the integral is off if the overlap is off by [`doubt`] (m^1.5).
    pub uncertainty: L::V,
}

#[inline(always)]
fn times<L: Lanes>(factor: f64, value: L::V) -> L::V {
    L::mul(L::splat(factor), value)
}

/// `max(overlap, 0)^1.5`; every other `number` leaves the square-root unit alone.
#[inline(always)]
pub fn power<L: Lanes>(number: usize, overlap: L::V) -> L::V {
    begin_plain::<L, PLAIN>(number, overlap).power(number)
}

/// Eight quintics in the fraction of the step.
pub struct Quintics<L: Lanes> {
    coefficients: [L::V; 6],
}

impl<L: Lanes> Quintics<L> {
    /// Through `ends`.
    #[inline(always)]
    pub fn new([[p0, w0, g0], [p1, w1, g1]]: Ends<L>) -> Self {
        let (rise, square) = (L::sub(p1, p0), times::<L>(0.5, g0));
        let p = L::sub(L::sub(rise, w0), square);
        let q = L::sub(L::sub(w1, w0), g0);
        let r = times::<L>(0.5, L::sub(g1, g0));
        let coefficients = [
            p0,
            w0,
            square,
            L::add(L::sub(times::<L>(10.0, p), times::<L>(4.0, q)), r),
            L::sub(L::sub(times::<L>(7.0, q), times::<L>(15.0, p)), L::add(r, r)),
            L::add(L::sub(times::<L>(6.0, p), times::<L>(3.0, q)), r),
        ];
        Self { coefficients }
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

    /// A step of Halley's method from `t`: `t - f f' / (f'^2 - f f''/2)`.
    #[inline(always)]
    fn nearer(&self, t: L::V) -> L::V {
        let c = &self.coefficients;
        let mut slope = times::<L>(5.0, c[5]);
        let mut half_bend = times::<L>(10.0, c[5]);
        for (n, k) in [(4.0, 4), (3.0, 3), (2.0, 2), (1.0, 1)] {
            slope = L::mul_add(slope, t, times::<L>(n, c[k]));
        }
        for (n, k) in [(6.0, 4), (3.0, 3), (1.0, 2)] {
            half_bend = L::mul_add(half_bend, t, times::<L>(n, c[k]));
        }
        let value = self.at(t);
        let divisor = L::sub(L::mul(slope, slope), L::mul(value, half_bend));
        L::sub(t, L::div(L::mul(value, slope), divisor))
    }

    /// Where they change sign between `ends`, for the contacts of `wanted`: each as if it were alone (1).
    #[inline(always)]
    fn roots(&self, [[start, early, _], [end, late, _]]: Ends<L>, wanted: u8) -> L::V {
        let (none, one) = (L::splat(0.0), L::splat(1.0));
        // Where time, as a cubic in the overlap with the slopes at both ends, says that there is none left.
        let rise = L::sub(end, start);
        let (done, left) = (L::div(L::sub(none, start), rise), L::div(end, rise));
        let (early, late) = (L::sub(L::div(rise, early), one), L::sub(one, L::div(rise, late)));
        let bend = L::mul_add(early, left, L::mul(late, done));
        let guess = L::mul_add(L::mul(done, left), bend, done);
        let mut root = L::max(L::min(self.nearer(guess), one), none);

        let allowed = times::<L>(ROOT_RESIDUE, L::add(L::abs(start), L::abs(end)));
        let closing = L::positive(end);
        let (mut low, mut high) = (none, one);
        for _ in 0..SEARCH_STEPS {
            let value = self.at(root);
            let searched = wanted & !L::positive(L::sub(allowed, L::abs(value)));
            if searched == 0 {
                break;
            }
            // Kept between the ends by bisection.
            let beyond = !(L::positive(value) ^ closing);
            high = L::select(beyond, root, high);
            low = L::select(beyond, low, root);
            let next = self.nearer(root);
            let inside = L::positive(L::sub(next, low)) & L::positive(L::sub(high, next));
            let next = L::select(inside, next, times::<L>(0.5, L::add(low, high)));
            root = L::select(searched, next, root);
        }
        root
    }

    /// `int overlap^1.5` and `int (1 - t) overlap^1.5` over the closed parts, which reach from `root` (1) to where `end` says: to the end of
    /// the step where contacts are closed there, or to its start (m^1.5).
    #[inline(always)]
    fn impulses(&self, root: L::V, end: L::V) -> [L::V; 2] {
        let (none, one) = (L::splat(0.0), L::splat(1.0));
        let length = L::sub(L::select(L::positive(end), one, none), root);
        let (mut impulse, mut moment) = (none, none);
        for (number, (node, weight)) in ROOT_NODES.into_iter().enumerate() {
            let t = L::mul_add(L::splat(node), length, root);
            // The root is taken out, what remains is smooth.
            let value = power::<L>(number, times::<L>(1.0 / node, self.at(t)));
            let value = times::<L>(weight, value);
            impulse = L::add(impulse, value);
            moment = L::mul_add(value, L::sub(one, t), moment);
        }
        let length = L::abs(length);
        [L::mul(impulse, length), L::mul(moment, length)]
    }

    /// How far overlaps that are `end` (m) at last have been on the other side of zero (m).
    #[inline(always)]
    pub fn beyond(&self, end: L::V) -> L::V {
        let none = L::splat(0.0);
        let (mut above, mut below) = (none, none);
        for time in LOOKS {
            let overlap = self.at(L::splat(time));
            above = L::max(overlap, above);
            below = L::max(L::sub(none, overlap), below);
        }
        L::select(L::positive(end), below, above)
    }
}

/// Difference of quintic and cubic at mid-step: what the ends do not know (m).
#[inline(always)]
fn doubt<L: Lanes>([[p0, w0, g0], [p1, w1, g1]]: Ends<L>) -> L::V {
    let rise = L::sub(p1, p0);
    let square = L::sub(L::sub(times::<L>(3.0, rise), times::<L>(2.0, w0)), w1);
    let cube = L::sub(L::add(w0, w1), times::<L>(2.0, rise));
    let early = L::sub(g0, times::<L>(2.0, square));
    let late = L::sub(L::sub(g1, times::<L>(2.0, square)), times::<L>(6.0, cube));
    times::<L>(1.0 / 64.0, L::abs(L::add(early, late)))
}

/// What the pair's quadrature misses of contacts that change sides between `ends`; nothing of those that are not `wanted`.
#[inline(always)]
pub fn missing<L: Lanes, P: Known<N>, const N: usize>(ends: Ends<L>, wanted: u8) -> Missing<L> {
    let quintics = Quintics::<L>::new(ends);
    let ([start, end], none) = ([ends[0][0], ends[1][0]], L::splat(0.0));
    // The quadrature first: it does not wait for the roots.
    let [mut impulse, mut moment, mut velocity, mut position] = [none; 4];
    for stage in 0..N {
        // The square-root unit is left to the roots that wait for it.
        let power = power::<L>(BESIDE, quintics.at(L::splat(P::PAIR.nodes[stage])));
        let weigh = |weight: f64, sum: L::V| L::mul_add(L::splat(weight), power, sum);
        impulse = weigh(Velocity::<P, N>::OF[stage], impulse);
        moment = weigh(Position::<P, N>::OF[stage], moment);
        velocity = weigh(VelocityError::<P, N>::OF[stage], velocity);
        position = weigh(PositionError::<P, N>::OF[stage], position);
    }
    let root = quintics.roots(ends, wanted);
    let [whole_impulse, whole_moment] = quintics.impulses(root, end);
    let depth = L::sqrt(L::max(L::max(start, end), none));
    let uncertainty = times::<L>(1.5, L::mul(depth, doubt::<L>(ends)));
    Missing {
        impulse: L::select(wanted, L::sub(whole_impulse, impulse), none),
        moment: L::select(wanted, L::sub(whole_moment, moment), none),
        errors: [L::select(wanted, velocity, none), L::select(wanted, position, none)],
        uncertainty: L::select(wanted, uncertainty, none),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::stepper::lanes::Baseline;

    /// Parabolas through zero at eight places, opening or closing: their integrals against the midpoint rule in `s^2` from the root on,
    /// where they are smooth. The last two are so bent that five nodes follow them less closely.
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
        let mut ends = [[[0.0; 8]; 3]; 2];
        for (lane, (root, b, c)) in overlaps.into_iter().enumerate() {
            for (which, t) in [0.0 - root, 1.0 - root].into_iter().enumerate() {
                let values = [b * t + c * t * t, b + 2.0 * c * t, 2.0 * c];
                for (row, value) in ends[which].iter_mut().zip(values) {
                    row[lane] = value;
                }
            }
        }
        let quintics = Quintics::<Baseline>::new(ends);
        let at = quintics.roots(ends, u8::MAX);
        let [impulses, moments] = quintics.impulses(at, ends[1][0]);
        for (lane, (root, b, c)) in overlaps.into_iter().enumerate() {
            let closes = ends[1][0][lane] > 0.0;
            assert!((at[lane] - root).abs() < 1e-6, "{lane}: {} and {root}", at[lane]);
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
            let off = (impulses[lane] / impulse - 1.0).abs();
            assert!(off < allowed, "{lane}: {} and {impulse}", impulses[lane]);
            let off = (moments[lane] - moment).abs() / impulse;
            assert!(off < allowed, "{lane}: {} and {moment}", moments[lane]);
        }
        // A parabola is a cubic.
        let off = doubt::<Baseline>(ends);
        assert!(off.iter().all(|off| *off < 1e-15), "{off:?}");
    }
}
