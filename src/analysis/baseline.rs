//! Zero and noise of a trace, from its samples before the pulse.
//!
//! Noise of one sample: the baseline's root mean square about its mean, but no less than
//! `q/sqrt(12)`, what the rounding to levels `q` apart leaves (JCGM 100:2008, F.2.2.1). Where noise
//! is below a third of a level, rounding errors of neighbouring samples go together, and zero and
//! noise follow from how often each code is shown ([`super::quiet_scope`]). Elsewhere drift, mains
//! hum and 1/f noise move the zero, and [`super::disturbance`] predicts it at each sample.
//!
//! A pulse begins below the noise: its foot lies in the baseline if the record begins shortly
//! before it. A foot rises no more slowly than the exponential through an eighth and a quarter of
//! the largest value (a pulse in a precompressed chain begins so; a Hertz contact at once): its
//! mean over the baseline is a part of the zero's uncertainty, and the baseline ends where noise
//! and foot together are least.

use std::ops::Range;

use serde::Serialize;

use super::disturbance::{Disturbance, KnownParts, smooth_rms};
use super::droop::undo_droop_from;
use super::pulse_conditions::{Conditions, MIN_BASELINE_SAMPLES, PEAK_SHARE, PulseError};
use super::quiet_scope::{AtRest, MovingScatter};
use super::rounding::{Rounding, Spread};
use crate::numeric::statistics::Moments;
use crate::trace::Trace;

/// The baseline ends after this share of the samples before the pulse exceeds a quarter of the
/// largest value (1).
const BASELINE_SHARE: f64 = 2.0 / 3.0;
/// Shares of the samples before the quarter at which the baseline may end, the usual one first (1).
const SHORTER_SHARES: [f64; 5] = [1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0, 1.0 / 6.0, 1.0 / 8.0];
/// A foot below this share of the noise's part is none (1).
const MIN_FOOT_SHARE: f64 = 0.2;
/// A foot above this share of the largest value leaves no zero to be found (1).
const MAX_FOOT_SHARE: f64 = 0.02;
/// A baseline that varies this many times as much as neighbouring samples differ is no signal at
/// rest, if it is so by as many standard deviations and by this share of the largest value (1).
const MOTION_FACTOR: f64 = 2.0;
const MOTION_DEVIATIONS: f64 = 5.0;
const MOTION_SHARE: f64 = 0.01;
/// A record is a quiet scope's where its samples at rest scatter by less than this many levels,
/// more than which noise of half a level rarely shows, and their codes show noise below so many
/// levels: above, rounding errors of neighbouring samples are independent to
/// `exp(-2 pi^2 0.42^2) / pi`, 0.01 levels, and the scatter shows the noise to 7 % (1).
const QUIET_RMS: f64 = 0.65;
const QUIET_NOISE: f64 = 0.42;
/// A zero that moves across levels is followed where differences of neighbours show at least this
/// many levels of noise: noise of 0.3 levels and its rounding, `sqrt(0.3^2 + 1/12)` (1).
const DITHERED_RMS: f64 = 0.416;
/// Differences, or a slope, so many standard deviations from what white noise makes count as
/// movement within a level or two, which widens intervals, and across levels, which is refused (1).
const MOVING_DEVIATIONS: [f64; 2] = [3.5, 4.5];
/// Samples that are next to one of their own code, beyond what chance makes (1).
const MIN_TOGETHER: f64 = 5.0;
/// Blocks of a baseline, for its disturbance.
const BLOCKS: usize = 32;
/// Samples of a smooth curve about which samples scatter, and levels that it spans at least.
const CURVE_SAMPLES: usize = 12;
const CURVE_LEVELS: f64 = 3.0;

/// Zero and noise of a trace before the pulse.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Baseline {
    /// The signal at rest: the mean, or what the codes of a quiet scope show (unit).
    #[serde(rename = "baseline_v")]
    pub level: f64,
    /// Root mean square about the mean, or about the disturbance (unit).
    #[serde(skip)]
    pub rms: f64,
    /// Number of samples.
    #[serde(skip)]
    pub samples: usize,
    /// The first sample behind it.
    #[serde(skip)]
    pub end: usize,
    /// Mean of the pulse's foot in it (unit).
    #[serde(skip)]
    foot: f64,
    /// Its standard uncertainty (unit).
    #[serde(rename = "baseline_u_v")]
    pub uncertainty: f64,
    /// Standard uncertainty of its change from sample to sample on a quiet scope (unit).
    #[serde(skip)]
    pub slope_u: f64,
    /// True if a quiet scope shows that it moves.
    #[serde(skip)]
    pub is_moving: bool,
    /// How it is distributed: evenly, where all samples show one code.
    #[serde(skip)]
    pub spread: Spread,
    /// The noise in front of the converter, as far as the codes show it.
    #[serde(skip)]
    pub rounding: Rounding,
    /// Drift, hum and 1/f noise with the zero, of records that a scope dithers.
    #[serde(skip)]
    pub disturbance: Option<Disturbance>,
}

impl Baseline {
    /// The baseline of `trace`.
    pub(super) fn of(trace: &Trace, conditions: &Conditions) -> Result<Self, PulseError> {
        let scatter = || scatter(trace, conditions.level);
        let (mut baseline, rest) = Self::with_rest(trace, (conditions, true), Some(&scatter))?;
        if rest.is_none() {
            baseline.find_disturbance(trace);
        }
        Ok(baseline)
    }

    /// The same with what the codes of a quiet scope show, whose samples elsewhere have this
    /// `scatter`; nothing of these without it. Without `has_foot` the pulse is a single contact,
    /// which begins at once.
    ///
    /// # Errors
    /// [`PulseError`] if the record is too short before the pulse, or not at rest.
    pub fn with_rest(
        trace: &Trace,
        (conditions, has_foot): (&Conditions, bool),
        scatter: Option<&dyn Fn() -> MovingScatter>,
    ) -> Result<(Self, Option<AtRest>), PulseError> {
        let (range, foot) = match conditions.baseline {
            Some(gate) => (gate.range(trace), 0.0),
            None => Before::of(trace, conditions.level).baseline(trace, has_foot)?,
        };
        let values = trace.values.get(range.clone()).unwrap_or_default();
        if values.len() < MIN_BASELINE_SAMPLES {
            let samples = values.len();
            return Err(PulseError::NoBaseline { trace: trace.name.clone(), samples });
        }
        let count = values.len() as f64;
        let Moments { mean, deviation: rms, .. } = Moments::of(values);
        let step = conditions.level;
        // The zero of a quiet scope is followed by no more than the one level that it passes.
        let is_wide = span(values) > 1.5 * step;
        let moves = step > 0.0 && moves(values, rms, step, MOVING_DEVIATIONS[usize::from(is_wide)]);
        let is_lost = moves && difference_noise(values) < DITHERED_RMS * step;
        if is_lost && is_wide {
            return Err(PulseError::Unresolved { trace: trace.name.clone() });
        }
        let rest = (rms < QUIET_RMS * step && (is_lost || !moves))
            .then(|| Some(AtRest::of(values, step, scatter?())))
            .flatten()
            .filter(|rest| is_lost || rest.rounding().noise < QUIET_NOISE * step);
        let (samples, end) = (values.len(), range.end);
        let (level, spread, rounding) = if let Some(rest) = &rest {
            (rest.zero(), rest.spread(), rest.rounding())
        } else {
            let noise = (rms * rms - step * step / 12.0).max(0.0).sqrt();
            (mean, Spread::normal(rms / count.sqrt()), Rounding { level: step, noise })
        };
        let spread = spread.plus(Spread::normal(foot));
        let moved = match &rest {
            Some(_) if is_lost => 2.0 * step / 3f64.sqrt(),
            Some(_) => unseen_movement(values, rms, step),
            None => 0.0,
        };
        let slope_u = moved / count;
        let spread = if is_lost {
            Spread::normal(spread.variance.sqrt().hypot(step / 12f64.sqrt()))
        } else {
            spread
        };
        let uncertainty = spread.variance.sqrt();
        let disturbance = None;
        let baseline = Self {
            level,
            rms,
            samples,
            end,
            foot,
            uncertainty,
            slope_u,
            is_moving: is_lost,
            spread,
            rounding,
            disturbance,
        };
        Ok((baseline, rest))
    }

    /// Finds what disturbs `trace` beside white noise, in the baseline alone; of a trace that was
    /// never digitised nothing does.
    pub fn find_disturbance(&mut self, trace: &Trace) {
        let step = self.rounding.level;
        let range = self.end - self.samples..self.end;
        let Some(found) = (step > 0.0).then(|| disturbance(trace, range.clone(), step)).flatten()
        else {
            return;
        };
        *self = Self::disturbed(found.with_constant(self.foot), range, step);
    }

    /// The zero of a record with this `disturbance`, in the samples `range` on average.
    pub fn disturbed(disturbance: Disturbance, range: Range<usize>, step: f64) -> Self {
        let mean = |values: &[f64]| {
            let part = values.get(range.clone()).unwrap_or_default();
            part.iter().sum::<f64>() / part.len().max(1) as f64
        };
        let squares: f64 = disturbance.modes().iter().map(|mode| mean(mode).powi(2)).sum();
        let rms = disturbance.noise;
        let noise = (rms * rms - step * step / 12.0).max(0.0).sqrt();
        Self {
            level: mean(&disturbance.values()),
            rms,
            samples: range.len(),
            end: range.end,
            foot: 0.0,
            uncertainty: squares.sqrt(),
            slope_u: 0.0,
            is_moving: false,
            spread: Spread::normal(squares.sqrt()),
            rounding: Rounding { level: step, noise },
            disturbance: Some(disturbance),
        }
    }

    /// The zero at each of so many samples (unit).
    pub fn zeros(&self, length: usize) -> Vec<f64> {
        self.disturbance.as_ref().map_or_else(|| vec![self.level; length], Disturbance::values)
    }

    /// Error of the zero at each sample, as a sum of independent modes: each is one standard
    /// deviation (unit).
    pub fn modes(&self, length: usize) -> Vec<Vec<f64>> {
        if let Some(disturbance) = &self.disturbance {
            return disturbance.modes();
        }
        let middle = self.end as f64 - 0.5 * self.samples as f64;
        let ramp = || (0..length).map(|index| self.slope_u * (index as f64 - middle)).collect();
        let constant = vec![self.uncertainty; length];
        if self.slope_u > 0.0 { vec![constant, ramp()] } else { vec![constant] }
    }

    /// `trace` without its zero, and the modes of the zero's error, both with the droop of this
    /// time constant undone from the baseline's end on (s).
    pub fn take_from(&self, trace: &Trace, time_constant: Option<f64>) -> (Trace, Vec<Vec<f64>>) {
        let length = trace.values.len();
        let undone = |values: Vec<f64>| {
            let start = Trace { values, ..trace.clone() };
            time_constant
                .map_or_else(|| start.clone(), |tau| undo_droop_from(&start, self.end, tau))
        };
        let values = trace.values.iter().zip(self.zeros(length)).map(|(v, zero)| v - zero);
        let signal = undone(values.collect());
        let modes = self.modes(length).into_iter().map(|mode| undone(mode).values).collect();
        (signal, modes)
    }
}

/// What disturbs `trace`, whose samples `range` are at rest and whose levels are `step` (unit)
/// apart.
fn disturbance(trace: &Trace, range: Range<usize>, step: f64) -> Option<Disturbance> {
    let values = trace.values.get(range.clone())?;
    let mut parts = KnownParts::new(trace.values.len(), trace.interval, step, 0);
    parts.add(values, range.start, BLOCKS, &[]);
    Disturbance::of(&[parts])?.pop()
}

/// True if the zero moves: neighbours differ by less than samples scatter about their mean (J. von
/// Neumann, Ann. Math. Stat. 12, 367, 1941), or a line, parabola or cubic is in the samples, by
/// more than so many `deviations` of white noise (1).
fn moves(values: &[f64], rms: f64, step: f64, deviations: f64) -> bool {
    let count = values.len().max(1) as f64;
    let excess = 1.0 - (difference_noise(values) / rms).powi(2);
    // Two of a few samples with another code may be neighbours.
    let is_many = count * excess * rms * rms > MIN_TOGETHER * step * step;
    let together = is_many && excess > deviations / count.sqrt();
    let mean = values.iter().sum::<f64>() / count;
    let legendre: [fn(f64) -> f64; 3] = [|x| x, |x| 1.5 * x * x - 0.5, |x| x * (2.5 * x * x - 1.5)];
    let size = |(degree, shape): (usize, &fn(f64) -> f64)| {
        let at = |index: usize| shape((2.0 * index as f64 + 1.0) / count - 1.0);
        let sum: f64 = values.iter().enumerate().map(|(index, v)| (v - mean) * at(index)).sum();
        // The mean square of Legendre's polynomials is 1/(2 n + 1).
        sum.abs() * ((2 * degree + 3) as f64 / count).sqrt()
    };
    together || legendre.iter().enumerate().any(|one| size(one) > deviations * rms)
}

/// Standard uncertainty of the change of a quiet scope's zero over its samples at rest, `values`,
/// which show none (unit).
///
/// A single code leaves both ends anywhere in its level: `1/sqrt(6)`. Each sample with another code
/// tells of it; white noise leaves a slope's `rms sqrt(12/n)`.
fn unseen_movement(values: &[f64], rms: f64, step: f64) -> f64 {
    let usual = upper_median(values.to_vec());
    let others = values.iter().filter(|v| (*v - usual).abs() > 0.5 * step).count() as f64;
    let of_noise = 12.0 * rms * rms / values.len().max(1) as f64;
    (step * step / (6.0 * (1.0 + others)) + of_noise).sqrt()
}

/// The highest of `values` less the lowest (unit).
fn span(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    high - low
}

/// Noise of one sample by the differences of neighbours (unit).
fn difference_noise(values: &[f64]) -> f64 {
    let squares: f64 = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    (0.5 * squares / values.len().max(2) as f64).sqrt()
}

/// Standard uncertainty of one sample: the noise seen, but no less than rounding to levels leaves
/// (unit).
pub fn noise_of(rms: f64, level: f64) -> f64 {
    rms.max(level / 12f64.sqrt())
}

/// Scatter of the samples of `trace` about cubics over a few of them each, wherever these span
/// several levels `step` apart (unit).
pub fn scatter(trace: &Trace, step: f64) -> MovingScatter {
    let cubics = cubics();
    let shares = |values: &[f64]| -> Vec<f64> {
        cubics.iter().map(|basis| basis.iter().zip(values).map(|(b, v)| b * v).sum()).collect()
    };
    let square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
    let leave = |values: &[f64]| square(values) - square(&shares(values));
    let mut all = MovingScatter::default();
    for values in trace.values.chunks_exact(CURVE_SAMPLES) {
        let first = values.first().copied().unwrap_or(0.0);
        let values: Vec<f64> = values.iter().map(|v| (v - first) / step).collect();
        let (low, high) =
            values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
        if high - low >= CURVE_LEVELS {
            let shares = shares(&values);
            let at =
                |index: usize| shares.iter().zip(&cubics).map(|(s, basis)| s * basis[index]).sum();
            let curve: Vec<f64> = (0..CURVE_SAMPLES).map(at).collect();
            let freedom = (CURVE_SAMPLES - cubics.len()) as f64;
            all = all.with(MovingScatter::of(&values, &curve, freedom, &leave));
        }
    }
    all
}

/// Orthonormal cubics over [`CURVE_SAMPLES`] samples, by Gram and Schmidt.
fn cubics() -> Vec<[f64; CURVE_SAMPLES]> {
    let mut basis: Vec<[f64; CURVE_SAMPLES]> = Vec::new();
    for power in 0..4 {
        let place = |index: usize| 2.0 * index as f64 / (CURVE_SAMPLES - 1) as f64 - 1.0;
        let mut next: [f64; CURVE_SAMPLES] = std::array::from_fn(|index| place(index).powi(power));
        for one in &basis {
            let share: f64 = one.iter().zip(&next).map(|(a, b)| a * b).sum();
            next.iter_mut().zip(one).for_each(|(n, one)| *n -= share * one);
        }
        let size = next.iter().map(|n| n * n).sum::<f64>().sqrt();
        basis.push(next.map(|n| n / size));
    }
    basis
}

/// The samples before the pulse.
struct Before {
    /// Samples before the first that is a quarter of the largest deviation away from the start, as
    /// is one of the two behind it: a single one may be noise.
    samples: usize,
    /// Sample at which the pulse reaches that quarter but for noise, by how many samples are below.
    quarter: f64,
    /// Samples in which the pulse grows by a factor of e there.
    growth: f64,
    /// Largest deviation from the start (unit).
    top: f64,
    /// Noise of one sample, from the differences of neighbours (unit).
    noise: f64,
    /// Distance of two levels (unit).
    level: f64,
}

impl Before {
    fn of(trace: &Trace, level: f64) -> Self {
        let values = &trace.values;
        let first = values.iter().take(MIN_BASELINE_SAMPLES.max(values.len() / 50)).copied();
        let start = upper_median(first.collect());
        let farther = |far: f64, v: &f64| if v.abs() > far.abs() { *v } else { far };
        let away: Vec<f64> = values.iter().map(|v| v - start).collect();
        let far = away.iter().fold(0.0, farther);
        let top = far.abs();
        let reaches = |share: f64, from: usize| {
            let is_far = |v: &f64| v.abs() >= share * top;
            let is_pulse = |near: &[f64]| {
                let (first, behind) = near.split_at(1);
                first.iter().all(is_far) && behind.iter().any(is_far)
            };
            away.get(from..)?.windows(3).position(is_pulse).map(|place| from + place)
        };
        let samples = reaches(PEAK_SHARE, 0).unwrap_or(0);
        let quiet = values.get(..(BASELINE_SHARE * samples as f64) as usize).unwrap_or_default();
        let noise = difference_noise(quiet);
        // Noise takes single samples across a level either way: how many are on a side is right on
        // average. From the last sample on the pulse's other side on, and as far again before.
        let half = reaches(2.0 * PEAK_SHARE, samples).unwrap_or(samples);
        let rising = away.get(..half).unwrap_or_default();
        let low = rising.iter().rposition(|v| v * far <= 0.0).map_or(0, |place| place + 1);
        let from = (2 * low).saturating_sub(half);
        let below = |share: f64| {
            let part = rising.iter().skip(from);
            part.filter(|v| **v * far.signum() < share * top).count() as f64
        };
        let doubling = (below(PEAK_SHARE) - below(0.5 * PEAK_SHARE)).max(1.0);
        Self {
            samples,
            quarter: from as f64 + below(PEAK_SHARE),
            growth: doubling / std::f64::consts::LN_2,
            top,
            noise: noise_of(noise, level),
            level,
        }
    }

    /// Mean of the pulse's foot over the first `count` samples (unit).
    fn foot(&self, count: usize) -> f64 {
        let height =
            |sample: f64| PEAK_SHARE * self.top * ((sample - self.quarter) / self.growth).exp();
        (height(count as f64) - height(0.0)) * self.growth / count.max(1) as f64
    }

    /// Where the baseline lies, and the mean of the foot in it, if it counts (unit): the longest
    /// part at rest, or a shorter one with less of the foot.
    fn baseline(&self, trace: &Trace, has_foot: bool) -> Result<(Range<usize>, f64), PulseError> {
        let end = |share: f64| (share * self.samples as f64) as usize;
        let noise = |count: usize| self.noise / (count.max(1) as f64).sqrt();
        let error = |count: usize| noise(count).hypot(self.foot(count));
        let rms =
            |count: usize| Moments::of(trace.values.get(..count).unwrap_or_default()).deviation;
        let usual = end(BASELINE_SHARE);
        let shorter = SHORTER_SHARES.map(end).into_iter().filter(|n| *n >= MIN_BASELINE_SAMPLES);
        let ends = std::iter::once(usual).chain(shorter);
        // Drift and hum of a digitised record are no motion of the chain.
        let is_explained = self.level > 0.0 && {
            let values = trace.values.get(..usual).unwrap_or_default();
            let left = smooth_rms(values, trace.interval, self.top / self.noise);
            !self.is_moving(left, usual)
        };
        let resting: Vec<usize> =
            ends.filter(|n| is_explained || !self.is_moving(rms(*n), *n)).collect();
        let Some(longest) = resting.first().copied() else {
            let (trace, noise) = (trace.name.clone(), self.noise);
            return Err(PulseError::NotAtRest { trace, rms: rms(usual), noise });
        };
        if !has_foot || self.foot(longest) < MIN_FOOT_SHARE * noise(longest) {
            return Ok((0..longest, 0.0));
        }
        let best = resting.into_iter().min_by(|a, b| error(*a).total_cmp(&error(*b)));
        let best = best.unwrap_or(longest);
        let foot = self.foot(best);
        if foot > MAX_FOOT_SHARE * self.top && best >= MIN_BASELINE_SAMPLES {
            let (trace, share) = (trace.name.clone(), foot / self.top);
            return Err(PulseError::NoZero { trace, share });
        }
        Ok((0..best, foot))
    }

    /// True if a baseline of `count` samples with this root mean square varies by more than noise:
    /// of white noise, the mean squared difference of neighbours is twice the variance, with a
    /// relative standard deviation of `1/sqrt(n)` (J. von Neumann, Ann. Math. Stat. 12, 367, 1941).
    fn is_moving(&self, rms: f64, count: usize) -> bool {
        let ratio = (self.noise / rms).powi(2);
        rms > MOTION_FACTOR * self.noise
            && (1.0 - ratio) * (count as f64).sqrt() > MOTION_DEVIATIONS
            && rms > MOTION_SHARE * self.top
    }
}

/// The middle one of `values`, of two the larger; zero of none (unit).
fn upper_median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
