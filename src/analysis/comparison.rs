//! One trace held against another: residuals, gain, correlation, and how far their spectra are
//! apart.
//!
//! Both traces on one time axis, `m` measured and `s` simulated, `n` samples, means `<m>`, `<s>`:
//!
//! - residual `d = m - s`; root mean square `sqrt(sum d^2 / n)`, and the largest `|d|`;
//! - gain and offset: the straight line `m = g s + o` with noise on both sides, of variances in the
//!   ratio `l` (Deming): with the sums `M`, `S` and `C` of the squares and products about the
//!   means, `g = [M - l S + sqrt((M - l S)^2 + 4 l C^2)]/(2 C)`, so that measured over simulated
//!   and simulated over measured are each other's inverse; `u(g)^2 = g^2 (1/r^2 - 1) F/(n - 2)`,
//!   `F = sum over k of p(k) q(k)` of the autocorrelations of the line's residuals and of the
//!   signal, 1 for white residuals. Both are reported, neither is taken out of the residual;
//! - correlation: Pearson's coefficient;
//! - spectrum distance: `sqrt(sum (|M[k]| - |S[k]|)^2 / sum |S[k]|^2)` over the amplitudes of both
//!   Fourier transforms without their zero-frequency bins: 0 for a trace shifted in time, `|g - 1|`
//!   for one of another gain, and never larger than the residual's root mean square over the
//!   simulated trace's (Parseval).
//!
//! Sources: W. A. Fuller, "Measurement Error Models" (1987), 1.3, for the straight line; M. S.
//! Bartlett, J. R. Stat. Soc. 98, 536 (1935), for `F`; A. H. Gray, J. D. Markel, IEEE Trans. ASSP
//! 24, 380 (1976), for distances between spectra as norms of the difference of their amplitudes.
//! Valid for traces that overlap in time.

use super::gate::Gate;
use super::least_squares::squares;
use super::spectrum::Window;
use super::spectrum::{Analyser, SpectrumSettings};
use crate::numeric::roots::vertex;
use crate::quantity::Uncertain;
use crate::trace::Trace;

/// Fewest samples that both traces must have in common.
pub const MIN_COMMON_SAMPLES: usize = 16;

/// Two traces on one time axis, that of the measured one.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The measured trace, where both have something to say.
    pub measured: Trace,
    /// The simulated trace at the same times.
    pub simulated: Trace,
}

/// How far two traces are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Root mean square of the residual (unit).
    pub rms: f64,
    /// Largest residual (unit).
    pub largest: f64,
    /// Slope of the measured over the simulated trace (1).
    pub gain: Uncertain,
    /// Its zero: what the measured trace reads where the simulated one is zero (unit).
    pub offset: f64,
    /// Pearson's coefficient; none where a trace is flat (1).
    pub correlation: Option<f64>,
    /// Distance between the amplitude spectra; none where the simulated trace is flat (1).
    pub spectrum: Option<f64>,
}

impl Pair {
    /// Puts the simulated trace, `shift` (s) later, on the measured one's axis; none where they
    /// have fewer than [`MIN_COMMON_SAMPLES`] samples in common.
    pub fn new(measured: &Trace, simulated: &Trace, shift: f64) -> Option<Self> {
        let ratio = measured.interval / simulated.interval;
        let at =
            |index: usize| (measured.time(index) - shift - simulated.start) / simulated.interval;
        if !(ratio > 0.0 && ratio.is_finite()) {
            return None;
        }
        let mut first = None;
        let (mut kept, mut placed) = (Vec::new(), Vec::new());
        for (index, value) in measured.values.iter().enumerate() {
            let Some(other) = between(&simulated.values, at(index)) else { continue };
            first.get_or_insert(index);
            kept.push(*value);
            placed.push(other);
        }
        let start = measured.time(first?);
        if kept.len() < MIN_COMMON_SAMPLES {
            return None;
        }
        Some(Self {
            simulated: Trace { values: placed, start, ..simulated.clone() }.at(measured.interval),
            measured: Trace { values: kept, start, ..measured.clone() },
        })
    }

    /// Measured minus simulated.
    pub fn residual(&self) -> Trace {
        let values = self.measured.values.iter().zip(&self.simulated.values);
        let values = values.map(|(m, s)| m - s).collect();
        Trace { name: "measured minus simulated".to_owned(), values, ..self.measured.clone() }
    }

    /// How far the two are apart; the measured trace's noise has `noise_ratio` (1) times the
    /// variance of the simulated one's.
    pub fn distance(&self, noise_ratio: f64) -> Distance {
        let (m, s) = (&self.measured.values, &self.simulated.values);
        let count = m.len() as f64;
        let residual = self.residual().values;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
        let (of_m, of_s) = (mean(m), mean(s));
        let off = |values: &[f64], mean: f64| values.iter().map(|v| v - mean).collect::<Vec<_>>();
        let (m, s) = (off(m, of_m), off(s, of_s));
        let (mm, ss) = (squares(&m), squares(&s));
        let ms: f64 = m.iter().zip(&s).map(|(m, s)| m * s).sum();
        let gain = deming(mm, noise_ratio * ss, ms, noise_ratio);
        let left: Vec<f64> = m.iter().zip(&s).map(|(m, s)| m - gain * s).collect();
        let both: Vec<f64> = m.iter().zip(&s).map(|(m, s)| m + gain * s).collect();
        let alike = variance_factor(&left, &both);
        let scatter = (mm * ss / (ms * ms) - 1.0).max(0.0) * alike / (count - 2.0);
        let told = ss > 0.0 && mm > 0.0;
        Distance {
            rms: (squares(&residual) / count).sqrt(),
            largest: residual.iter().fold(0.0, |most: f64, d| most.max(d.abs())),
            gain: Uncertain::normal(gain, gain.abs() * scatter.sqrt()),
            offset: of_m - gain * of_s,
            correlation: told.then(|| (ms / (mm * ss).sqrt()).clamp(-1.0, 1.0)),
            spectrum: if ss > 0.0 { self.spectrum_distance() } else { None },
        }
    }

    fn spectrum_distance(&self) -> Option<f64> {
        let settings = SpectrumSettings {
            window: Window::Rectangular,
            padding: 1,
            gate: Gate::ALL,
            ..SpectrumSettings::default()
        };
        let mut analyser = Analyser::new();
        let mut moduli = |trace: &Trace| analyser.spectrum(trace, &settings).ok();
        let (m, s) = (moduli(&self.measured)?, moduli(&self.simulated)?);
        // The bin at half the sampling frequency stands for itself alone, all others for two.
        let weight = |bin: usize| if 2 * bin == m.padded { 1.0 } else { 2.0 };
        let (mut apart, mut whole) = (0.0, 0.0);
        let bins = m.amplitude.iter().zip(&s.amplitude).enumerate().skip(1);
        for (bin, (m, s)) in bins {
            apart += weight(bin) * (m - s).powi(2);
            whole += weight(bin) * s * s;
        }
        let distance = (apart / whole).sqrt();
        distance.is_finite().then_some(distance)
    }
}

/// Slope of the line through points with noise in both coordinates: sums of squares `mm` and `lss`,
/// the latter by the ratio of variances `ratio` (1), and of products `ms` (unit).
fn deming(mm: f64, lss: f64, ms: f64, ratio: f64) -> f64 {
    let apart = mm - lss;
    let root = (apart * apart + 4.0 * ratio * ms * ms).sqrt();
    // Of the two forms of one root, the one that subtracts nothing.
    if apart > 0.0 { (apart + root) / (2.0 * ms) } else { 2.0 * ratio * ms / (root - apart) }
}

/// Sum of the products of two traces' autocorrelations, up to where the first one's ends: how many
/// times a slope's variance is what white residuals would make it (1).
fn variance_factor(residual: &[f64], signal: &[f64]) -> f64 {
    let at = |values: &[f64], lag: usize| -> f64 {
        values.iter().zip(values.get(lag..).unwrap_or(&[])).map(|(a, b)| a * b).sum()
    };
    let (whole, all) = (at(residual, 0), at(signal, 0));
    let mut sum = 1.0;
    for lag in 1..residual.len() {
        let follows = at(residual, lag) / whole;
        // Not a number where nothing is left.
        if follows.is_nan() || follows <= 0.0 {
            break;
        }
        sum += 2.0 * follows * at(signal, lag) / all;
    }
    sum.max(1.0)
}

impl Trace {
    /// The same samples at another interval (s).
    fn at(self, interval: f64) -> Self {
        Self { interval, ..self }
    }
}

/// The value at `place`, in samples: a sample itself, or the cubic through the four around it; none
/// outside.
fn between(values: &[f64], place: f64) -> Option<f64> {
    /// Places as near as this to a sample are that sample: what is left of the same time axis after
    /// rounding (1).
    const TIME_TOLERANCE: f64 = 1e-6;
    let last = values.len().checked_sub(1)? as f64;
    if !(-TIME_TOLERANCE..=last + TIME_TOLERANCE).contains(&place) {
        return None;
    }
    let nearest = place.round();
    if (place - nearest).abs() < TIME_TOLERANCE {
        return values.get(nearest as usize).copied();
    }
    let base = place.floor() as usize;
    let at = |index: usize| values.get(index).copied();
    let (here, there, x) = (at(base)?, at(base + 1)?, place - place.floor());
    let before = base.checked_sub(1).and_then(at).unwrap_or(2.0 * here - there);
    let after = at(base + 2).unwrap_or(2.0 * there - here);
    // Lagrange's polynomial through -1, 0, 1, 2.
    Some(
        -before * x * (x - 1.0) * (x - 2.0) / 6.0 + here * (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0
            - there * (x + 1.0) * x * (x - 2.0) / 2.0
            + after * (x + 1.0) * x * (x - 1.0) / 6.0,
    )
}

/// The shift (s) by which `simulated` traces are to be later so that the sum of all weighted
/// squared residuals, each pair with its own weight, is least; none where no shift between the
/// traces' ends leaves enough in common (s).
///
/// Searched over every shift by whole samples that leaves half of the shorter record in common,
/// then refined to the bottom of the parabola through the three lowest.
pub fn least_squares_shift(pairs: &[(&Trace, &Trace, f64)]) -> Option<f64> {
    let (first, other, _) = pairs.first()?;
    let step = first.interval;
    let samples =
        (other.values.len() as f64 * other.interval / step).min(first.values.len() as f64);
    let reach = first.values.len() as f64 + other.values.len() as f64 * other.interval / step;
    let cost = |shift: f64| {
        let (mut sum, mut common) = (0.0, 0.0_f64);
        for (measured, simulated, weight) in pairs {
            let pair = Pair::new(measured, simulated, shift)?;
            let count = pair.measured.values.len() as f64;
            common = common.max(count);
            sum += weight * squares(&pair.residual().values) / count;
        }
        (common >= 0.5 * samples).then_some(sum)
    };
    // A coarse look at every eighth sample first: pulses are dozens of them long.
    let middle = first.start - other.start;
    let coarse = scan(&cost, middle, 8.0 * step, (reach / 16.0).ceil())?;
    let fine = scan(&cost, coarse, step, 10.0)?;
    let (low, here, high) = (cost(fine - step)?, cost(fine)?, cost(fine + step)?);
    let off = vertex([low, here, high].map(|cost| -cost)).map_or(0.0, |(off, _)| off);
    // Traces that agree to the last bit are where they are.
    Some(if here == 0.0 { fine } else { fine + off * step })
}

/// The lowest of `cost` among `count` steps on either side of `middle`.
fn scan(cost: &dyn Fn(f64) -> Option<f64>, middle: f64, step: f64, count: f64) -> Option<f64> {
    let count = count as i64;
    let costs = (-count..=count).filter_map(|k| {
        let shift = middle + k as f64 * step;
        cost(shift).map(|cost| (shift, cost))
    });
    costs.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(shift, _)| shift)
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "small counts, exact values")]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A packet on 512 samples that is zero at its ends.
    fn packet(gain: f64, later: usize) -> Trace {
        let value = |i: usize| {
            let x = (i as f64 - 200.0 - later as f64) / 30.0;
            gain * (-x * x).exp() * (TAU * x).cos()
        };
        Trace {
            name: "packet".to_owned(),
            unit: "V".to_owned(),
            start: -1e-4,
            interval: 1e-6,
            values: (0..512).map(value).collect(),
        }
    }

    /// Closed forms of the module's text: a gain changes the spectrum by itself, a shift does not,
    /// and neither exceeds the residual.
    #[test]
    fn the_spectrum_distance_has_its_closed_forms() {
        let base = packet(1.0, 0);
        for (gain, later, expected) in
            [(1.0, 0, 0.0), (1.25, 0, 0.25), (0.8, 60, 0.2), (1.0, 60, 0.0)]
        {
            let pair = Pair::new(&packet(gain, later), &base, 0.0).expect("common samples");
            let distance = pair.distance(1.0);
            let found = distance.spectrum.expect("a spectrum");
            assert!((found - expected).abs() < 1e-9, "{gain} {later}: {found}");
            let whole = (squares(&base.values) / 512.0).sqrt();
            assert!(found <= distance.rms / whole + 1e-9);
        }
        let pair = Pair::new(&packet(1.25, 0), &base, 0.0).expect("common samples");
        let distance = pair.distance(1.0);
        assert!((distance.gain.value - 1.25).abs() < 1e-12 && distance.offset.abs() < 1e-12);
        assert!((distance.correlation.expect("a number") - 1.0).abs() < 1e-12);
    }

    /// Two traces that differ by 0.5 and -0.5 in turn have a root mean square residual of 0.5.
    #[test]
    fn the_rms_residual_is_that_of_one_sample() {
        let base = packet(1.0, 0);
        let mut other = base.clone();
        let signs = [0.5, -0.5].into_iter().cycle();
        other.values.iter_mut().zip(signs).for_each(|(value, off)| *value += off);
        let distance = Pair::new(&other, &base, 0.0).expect("common samples").distance(1.0);
        assert!((distance.rms - 0.5).abs() < 1e-12, "{}", distance.rms);
    }

    /// What is measured alone, 0.7 and -0.7 in turn, adds 0.49 to the mean square at every shift. A
    /// sum over the common samples would be least where fewest are common: half of 512 samples with
    /// 0.49 are 125 less, and the packets side by side add 38, twice their energy.
    #[test]
    fn a_shift_is_not_rewarded_for_fewer_common_samples() {
        let base = packet(1.0, 0);
        let mut measured = base.clone();
        let signs = [0.7, -0.7].into_iter().cycle();
        measured.values.iter_mut().zip(signs).for_each(|(value, off)| *value += off);
        let shift = least_squares_shift(&[(&measured, &base, 1.0)]).expect("a shift");
        assert!(shift.abs() < 0.02e-6, "{shift:e}");
    }

    /// A shift that is not a whole number of samples comes back, and a trace is at no distance from
    /// itself.
    #[test]
    fn shifts_come_back() {
        let base = packet(1.0, 0);
        let shift = least_squares_shift(&[(&base, &base, 1.0)]).expect("a shift");
        assert_eq!(shift.to_bits(), 0.0_f64.to_bits());
        let pair = Pair::new(&base, &base, 0.0).expect("common samples");
        assert_eq!((pair.distance(1.0).rms, pair.distance(1.0).largest), (0.0, 0.0));
        let mut late = packet(1.0, 40);
        late.start += 0.3e-6;
        let shift = least_squares_shift(&[(&late, &base, 1.0)]).expect("a shift");
        assert!((shift - 40.3e-6).abs() < 0.02e-6, "{shift:e}");
        assert!(least_squares_shift(&[]).is_none());
    }

    /// Noise on both sides, white and such that samples follow each other: 95 % of the intervals
    /// hold the gain, and either way round it is the same.
    #[test]
    fn gains_are_covered_and_each_others_inverse() {
        let mut state = 9_u64;
        let mut even = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        let mut normal = || (-2.0 * even().ln()).sqrt() * (TAU * even()).cos();
        for (noises, follows) in [([0.02, 0.02], 0.0), ([0.06, 0.02], 0.0), ([0.02, 0.02], 0.8)] {
            let mut inside = 0;
            for _ in 0..600 {
                let mut noisy = |mut trace: Trace, noise: f64| {
                    let mut last = normal();
                    for value in &mut trace.values {
                        last = follows * last + f64::sqrt(1.0 - follows * follows) * normal();
                        *value += noise * last;
                    }
                    trace
                };
                let (m, s) = (noisy(packet(1.25, 0), noises[0]), noisy(packet(1.0, 0), noises[1]));
                let ratio = (noises[0] / noises[1]).powi(2);
                let there = Pair::new(&m, &s, 0.0).expect("a pair").distance(ratio).gain;
                let back = Pair::new(&s, &m, 0.0).expect("a pair").distance(1.0 / ratio).gain;
                assert!((there.value * back.value - 1.0).abs() < 1e-12, "{there:?} {back:?}");
                let shares = [there, back].map(|gain| gain.u / gain.value);
                assert!((shares[0] / shares[1] - 1.0).abs() < 1e-6, "{shares:?}");
                inside += i32::from((there.value - 1.25).abs() <= there.expanded());
            }
            // Binomial scatter of 600 trials: 0.9 %.
            let share = f64::from(inside) / 600.0;
            assert!((0.93..=0.97).contains(&share), "{noises:?} {follows}: {share}");
        }
    }

    /// Interpolation is exact for cubics, and nothing is invented beyond the ends.
    #[test]
    fn cubics_are_interpolated_exactly() {
        let cubic = |x: f64| 1.0 + x * (2.0 - x * (0.5 - 0.1 * x));
        let values: Vec<f64> = (0..10).map(|i| cubic(f64::from(i))).collect();
        for place in [1.25, 4.5, 7.9] {
            assert!((between(&values, place).expect("inside") - cubic(place)).abs() < 1e-12);
        }
        assert_eq!((between(&values, -0.1), between(&values, 9.1)), (None, None));
    }
}
