//! Finds records that the input's range cut off, where the file does not give the range.
//!
//! A cut shows as successive samples of exactly the largest (or smallest) value. A flat top is also
//! that of a smooth peak between two levels, of a square wave, or of a trace at rest. It is a cut
//! if
//!
//! - the record neither begins nor ends at this value, and the value is not zero: it is no level of
//!   rest, and no floor of a force or a rectifier;
//! - the samples before and behind it, each continued by a parabola, pass beyond it by more than
//!   four standard uncertainties and two levels: the slope does not go to zero towards the top;
//! - and a flank is curved, unlike a trapezoid's. Where the noise of a sample would have moved some
//!   of the samples of a held level, with a probability of all but one in a million, a trapezoid is
//!   excluded without that.
//!
//! If only the third is missing, the record may be cut, and a note says so. The uncertainties are
//! those of a straight least-squares fit; the noise is the median of third differences, which a
//! smooth signal leaves out. Of 4,900 whole records (pulses, sines, square waves, trapezoids and
//! filtered steps of 12 to 420 samples, 20 to 65,000 levels and noise up to two levels) none is
//! called cut. Of 1,200 cut pulses 637 are: all of 80 samples and 200 levels or more that lose a
//! fifth to three fifths, but for half sines of which straight flanks are left, which may be cut.

use crate::numeric::statistics::StraightLine;

/// Fewest successive samples of a flat top.
const MIN_RUN: usize = 4;
/// Samples of a flank that are continued by a parabola, at least and at most.
const SHOULDER: (usize, usize) = (4, 32);
/// Samples of a flank that are looked at.
const FLANK: usize = 4000;
/// Noise of a trace by its levels alone, at least (levels).
const QUANTISATION: f64 = 0.3;
/// Standard uncertainties and levels by which a continued flank passes a flat top.
const BEYOND: (f64, f64) = (4.0, 2.0);
/// Noise of a sample from which it shows through levels (levels).
const VISIBLE_NOISE: f64 = 0.6;
/// Logarithm of a million: a held level's samples are all equal by chance less often than that.
const MILLION: f64 = 13.8;

/// A flat top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FlatTop {
    /// Its value (unit).
    pub(super) value: f64,
    /// Samples with this value.
    pub(super) samples: usize,
    /// The most of them in a row.
    pub(super) run: usize,
    /// Whether it is the end of the input's range for certain.
    pub(super) is_cut: bool,
}

/// The flat tops at the largest and at the smallest value of `values` that are, or may be, cut;
/// `level` is the distance of neighbouring values.
pub(super) fn flat_tops(values: &[f64], level: f64) -> [Option<FlatTop>; 2] {
    [1.0, -1.0].map(|sign| flat_top(values, sign, level))
}

fn flat_top(values: &[f64], sign: f64, level: f64) -> Option<FlatTop> {
    let top = values.iter().map(|value| sign * value).fold(f64::NEG_INFINITY, f64::max);
    let bottom = values.iter().map(|value| sign * value).fold(f64::INFINITY, f64::min);
    let is_top = |index: usize| values.get(index).is_some_and(|value| sign * value >= top);
    if top == 0.0 || is_top(0) || is_top(values.len().saturating_sub(1)) {
        return None;
    }
    let (mut samples, mut longest, mut start) = (0, 0..0, 0);
    for index in 0..values.len() {
        if !is_top(index) {
            start = index + 1;
            continue;
        }
        samples += 1;
        if index + 1 - start > longest.len() {
            longest = start..index + 1;
        }
    }
    let run = longest.len();
    if run < MIN_RUN {
        return None;
    }
    let beside: Vec<f64> = values.iter().copied().filter(|value| sign * value < top).collect();
    let noise = noise(&beside);
    let sigma = noise.max(QUANTISATION * level);
    // Heights below the top, from it outwards.
    let below = |value: &f64| sign * value - top;
    let before: Vec<f64> =
        values.get(..longest.start)?.iter().rev().take(FLANK).map(below).collect();
    let behind: Vec<f64> = values.get(longest.end..)?.iter().take(FLANK).map(below).collect();
    let sides = [before, behind];
    let scales = Scales { sigma, level, height: top - bottom };
    let beyond: Vec<(f64, f64)> =
        sides.iter().filter_map(|side| continued(side, run, &scales)).collect();
    let passes = |(over, u): &(f64, f64)| *over > BEYOND.0 * u + BEYOND.1 * level;
    if beyond.len() < sides.len() || beyond.iter().any(|(over, _)| *over <= 0.0) {
        return None;
    }
    // Two neighbours of a held level are equal with at most this probability.
    let deviation = (noise * noise - level * level / 12.0).max(0.0).sqrt();
    let equal = (level / (deviation * std::f64::consts::TAU.sqrt())).min(1.0);
    let would_move = noise > VISIBLE_NOISE * level && -(run as f64) * equal.ln() > MILLION;
    let is_cornered = beyond.iter().all(passes);
    let is_curved = sides.iter().any(|side| !is_straight(side, &scales));
    let value = sign * top;
    (is_cornered || would_move).then_some(FlatTop {
        value,
        samples,
        run,
        is_cut: would_move || (is_cornered && is_curved),
    })
}

/// What differences are measured in (unit).
struct Scales {
    sigma: f64,
    level: f64,
    height: f64,
}

/// Standard deviation of the noise of one sample, from third differences, whose variance is 20
/// times the noise's (unit).
fn noise(values: &[f64]) -> f64 {
    const NORMAL_MEDIAN: f64 = 0.6745;
    let third = |window: &[f64]| match window {
        [a, b, c, d] => (d - 3.0 * c + 3.0 * b - a).abs(),
        _ => 0.0,
    };
    let mut differences: Vec<f64> = values.windows(4).map(third).collect();
    if differences.is_empty() {
        return 0.0;
    }
    let middle = differences.len() / 2;
    let (_, median, _) = differences.select_nth_unstable_by(middle, f64::total_cmp);
    *median / (20f64.sqrt() * NORMAL_MEDIAN)
}

/// How far the parabola through the samples beside a flat top of `run` samples passes beyond it in
/// its middle, and the standard uncertainty of that (unit); none if no parabola fits them.
/// `side` are heights below the top, from it outwards.
fn continued(side: &[f64], run: usize, scales: &Scales) -> Option<(f64, f64)> {
    let most = run.clamp(SHOULDER.0, SHOULDER.1).min(side.len());
    let allowed = (1.5 * scales.sigma).max(0.7 * scales.level).max(0.01 * scales.height);
    (SHOULDER.0..=most).rev().find_map(|count| {
        let heights = side.get(..count)?;
        let fit = Parabola::through(heights);
        let distance = (0.5 * (run as f64 - 1.0)).min(0.5 * count as f64);
        // Sample 0 stands beside the top, whose first sample is number -1.
        (fit.residual <= allowed).then(|| fit.at(-1.0 - distance, fit.residual.max(scales.sigma)))
    })
}

/// A parabola by least squares, over the distance `x` from the middle of the samples:
/// `y = a + b x + c x^2`.
struct Parabola {
    a: f64,
    b: f64,
    c: f64,
    middle: f64,
    /// Sums of `x^0`, `x^2` and `x^4`.
    sums: [f64; 3],
    /// Standard deviation of the residuals (unit).
    residual: f64,
}

impl Parabola {
    fn through(heights: &[f64]) -> Self {
        let count = heights.len() as f64;
        let middle = 0.5 * (count - 1.0);
        let points = || heights.iter().enumerate().map(|(index, y)| (index as f64 - middle, *y));
        let sum = |of: &dyn Fn(f64, f64) -> f64| points().map(|(x, y)| of(x, y)).sum::<f64>();
        let sums = [count, sum(&|x, _| x * x), sum(&|x, _| x.powi(4))];
        let (y0, y1, y2) = (sum(&|_, y| y), sum(&|x, y| x * y), sum(&|x, y| x * x * y));
        let determinant = sums[0] * sums[2] - sums[1] * sums[1];
        let a = (sums[2] * y0 - sums[1] * y2) / determinant;
        let (b, c) = (y1 / sums[1], (sums[0] * y2 - sums[1] * y0) / determinant);
        let squares = sum(&|x, y| (y - a - b * x - c * x * x).powi(2));
        let residual = (squares / (count - 3.0).max(1.0)).sqrt();
        Self { a, b, c, middle, sums, residual }
    }

    /// The parabola at sample `index`, and its standard uncertainty with noise `sigma` (unit).
    fn at(&self, index: f64, sigma: f64) -> (f64, f64) {
        let x = index - self.middle;
        let [count, two, four] = self.sums;
        let determinant = count * four - two * two;
        let squares = x * x;
        let variance =
            (four - 2.0 * squares * two + squares * squares * count) / determinant + squares / two;
        (self.a + self.b * x + self.c * squares, sigma * variance.sqrt())
    }
}

/// Whether the flank, from a tenth of its height up to the flat top, is a straight line, or has too
/// few samples to tell. The top's samples are left out: a trapezoid's corner may lie between two
/// samples.
fn is_straight(side: &[f64], scales: &Scales) -> bool {
    const FEWEST: usize = 7;
    let mut low = 0.0;
    let falls = side.iter().take_while(|height| {
        let goes_on = **height <= low + 4.0 * scales.sigma;
        low = low.min(**height);
        goes_on
    });
    let count = falls.count();
    let low = side.iter().take(count).copied().fold(0.0, f64::min);
    let flank = side.iter().take(count).take_while(|height| **height > 0.9 * low);
    let flank: Vec<f64> = flank.copied().collect();
    if flank.len() < FEWEST {
        return true;
    }
    let points: Vec<(f64, f64, f64)> =
        flank.iter().enumerate().map(|(index, height)| (index as f64, *height, 1.0)).collect();
    let Some(line) = StraightLine::through(&points) else {
        return true;
    };
    let off = points
        .iter()
        .map(|(x, y, _)| (y - line.mean.1 - line.slope * (x - line.mean.0)).abs())
        .fold(0.0, f64::max);
    off <= (3.0 * scales.sigma).max(scales.level).max(0.015 * low.abs())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use rand_distr::{Distribution, StandardNormal, Uniform};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    /// A signal over time for a length of a pulse or period (samples).
    type Signal = fn(f64, f64) -> f64;

    /// Signals between 0 and 1 that end where they begin, over 1000 samples, by name; `size` is the
    /// length of a pulse or period (samples).
    const SIGNALS: [(&str, Signal); 7] =
        [
            ("gaussian", |t, size| (-0.5 * (t / (0.2 * size)).powi(2)).exp()),
            ("half sine", |t, size| if t.abs() < 0.5 * size { (PI * t / size).cos() } else { 0.0 }),
            ("hertz pulse", |t, size| {
                if t.abs() < 0.5 * size { (PI * t / size).cos().powf(1.5) } else { 0.0 }
            }),
            ("sine", |t, size| 0.5 + 0.5 * (TAU * t / size).sin()),
            ("square wave", |t, size| if (t / size).rem_euclid(1.0) < 0.5 { 1.0 } else { 0.0 }),
            ("trapezoid", |t, size| ((0.5 * size - t.abs()) / (0.15 * size)).clamp(0.0, 1.0)),
            ("filtered step", |t, size| {
                let rise = |t: f64| if t > 0.0 { 1.0 - (-t / (0.08 * size)).exp() } else { 0.0 };
                rise(t + 0.5 * size) - rise(t - 0.5 * size)
            }),
        ];

    /// A record of `signal`, `height` levels high, in whole levels, with `noise` (levels).
    fn record(
        signal: Signal,
        (size, height, noise): (f64, f64, f64),
        random: &mut Pcg64Mcg,
    ) -> Vec<f64> {
        let phase = Uniform::new(0.0, 1.0).expect("a range").sample(random);
        let one = |index: u32| {
            let moved: f64 = StandardNormal.sample(random);
            let level = height * (signal(f64::from(index) - 500.0 + phase, size) - 0.03);
            (level + noise * moved).round()
        };
        (0..1000).map(one).collect()
    }

    /// Sizes of the signals (samples).
    const SIZES: [f64; 5] = [12.0, 30.0, 80.0, 200.0, 420.0];
    /// Their heights (levels).
    const HEIGHTS: [f64; 5] = [20.0, 60.0, 200.0, 4000.0, 65_000.0];
    /// Noise (levels).
    const NOISES: [f64; 4] = [0.0, 0.3, 1.0, 2.0];

    fn shapes() -> impl Iterator<Item = (f64, f64, f64)> {
        let of_size = |size| HEIGHTS.map(|height| NOISES.map(|noise| (size, height, noise)));
        SIZES.into_iter().flat_map(of_size).flatten()
    }

    #[test]
    fn whole_records_are_not_called_cut() {
        let mut random = Pcg64Mcg::new(60);
        for (name, signal) in SIGNALS {
            for shape in shapes().flat_map(|shape| [shape; 7]) {
                let values = record(signal, shape, &mut random);
                let cut = flat_tops(&values, 1.0).into_iter().flatten().find(|top| top.is_cut);
                assert_eq!(cut, None, "{name} {shape:?}");
            }
        }
    }

    /// Of pulses that lose more than a tenth of their height, all are found that are long and high
    /// enough, but for half sines of which straight flanks are left: those may be cut.
    #[test]
    fn cut_pulses_are_found() {
        let mut random = Pcg64Mcg::new(61);
        let (mut found, mut count) = (0, 0);
        for share in [0.95, 0.8, 0.6, 0.4] {
            for (name, signal) in &SIGNALS[..3] {
                for (size, height, noise) in shapes() {
                    let whole = record(*signal, (size, height, noise), &mut random);
                    let top = (share * height).round();
                    let cut: Vec<f64> = whole.iter().map(|value| value.min(top)).collect();
                    let [upper, _] = flat_tops(&cut, 1.0);
                    let is_found = upper.is_some_and(|top| top.is_cut);
                    count += 1;
                    found += usize::from(is_found);
                    let is_plain = share < 0.9 && size >= 80.0 && height >= 200.0;
                    let may_be = upper.is_some() && (*name, share) == ("half sine", 0.4);
                    let pulse = (share, size, height, noise);
                    assert!(!is_plain || is_found || may_be, "{name} {pulse:?}: {upper:?}");
                }
            }
        }
        assert_eq!((found, count), (637, 1200));
    }
}
