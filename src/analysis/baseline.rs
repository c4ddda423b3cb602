//! Zero and noise of a trace, from its samples before the pulse.
//!
//! Noise of one sample: the baseline's root mean square about its mean, but no less than `q/sqrt(12)`, what the rounding to
//! levels `q` apart leaves (JCGM 100:2008, F.2.2.1). Where noise is below 0.35 levels, rounding errors of neighbouring samples go
//! together ([`super::rounding`]): the mean of a signal at rest has them in common, and a local fit over samples that span `c` levels
//! counts as one over `c` samples.

use std::ops::Range;

use super::pulse_conditions::{Conditions, MIN_BASELINE_SAMPLES, PEAK_SHARE, PulseError};
use super::rounding::Rounding;
use crate::trace::Trace;

/// The baseline ends after this share of the samples before the pulse exceeds a quarter of the largest value (1).
const BASELINE_SHARE: f64 = 2.0 / 3.0;
/// Noise below this many levels leaves rounding errors that go together (1).
const DITHER_NOISE: f64 = 0.35;

/// Zero and noise of a trace before the pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Baseline {
    /// Mean (unit).
    pub level: f64,
    /// Root mean square about the mean (unit).
    pub rms: f64,
    /// Number of samples.
    pub samples: usize,
    /// Time of its middle (s).
    pub middle: f64,
    /// Standard uncertainty of the mean (unit).
    pub uncertainty: f64,
    /// The noise in front of the converter, as far as the codes tell it.
    pub rounding: Rounding,
}

impl Baseline {
    /// The baseline of `trace`.
    pub(super) fn of(trace: &Trace, conditions: &Conditions) -> Result<Self, PulseError> {
        let range = conditions.baseline.map_or_else(|| before_pulse(trace), |g| g.range(trace));
        let values = trace.values.get(range.clone()).unwrap_or_default();
        if values.len() < MIN_BASELINE_SAMPLES {
            let samples = values.len();
            return Err(PulseError::NoBaseline { trace: trace.name.clone(), samples });
        }
        let count = values.len() as f64;
        let level = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - level).powi(2)).sum();
        let rms = (squares / (count - 1.0)).sqrt();
        let noise = noise_of(rms, conditions.level);
        let rounding = Rounding::of(values, rms, conditions.level);
        Ok(Self {
            level,
            rms,
            samples: values.len(),
            middle: 0.5 * (trace.time(range.start) + trace.time(range.end - 1)),
            uncertainty: (noise * noise / count + rounding.common()).sqrt(),
            rounding,
        })
    }
}

/// Standard uncertainty of one sample: the noise seen, but no less than rounding to levels leaves.
pub(super) fn noise_of(rms: f64, level: f64) -> f64 {
    rms.max(level / 12f64.sqrt())
}

/// Samples over independent samples: 1 with noise enough, else their number over that of the levels they span.
pub(super) fn together(values: &[f64], rms: f64, level: f64) -> f64 {
    if rms >= DITHER_NOISE * level {
        return 1.0;
    }
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    (values.len() as f64 / ((high - low) / level + 1.0)).max(1.0)
}

/// The first two thirds of the samples before the first that is a quarter of the largest deviation away from the start, as is one of the two behind it: a single one
/// may be noise.
fn before_pulse(trace: &Trace) -> Range<usize> {
    let mut first: Vec<f64> = trace
        .values
        .iter()
        .take(MIN_BASELINE_SAMPLES.max(trace.values.len() / 50))
        .copied()
        .collect();
    first.sort_by(f64::total_cmp);
    let start = first.get(first.len() / 2).copied().unwrap_or(0.0);
    let away = |v: &f64| (v - start).abs();
    let top = trace.values.iter().map(away).fold(0.0, f64::max);
    let is_far = |v: &f64| away(v) >= PEAK_SHARE * top;
    let is_pulse = |near: &[f64]| {
        let (first, behind) = near.split_at(1);
        first.iter().all(is_far) && behind.iter().any(is_far)
    };
    let quarter = trace.values.windows(3).position(is_pulse).unwrap_or(0);
    0..(BASELINE_SHARE * quarter as f64) as usize
}
