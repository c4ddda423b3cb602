//! Zero and noise of a trace, from its samples before the pulse.
//!
//! Noise of one sample: the baseline's root mean square about its mean, but no less than `q/sqrt(12)`, what the rounding to
//! levels `q` apart leaves (JCGM 100:2008, F.2.2.1). Where noise is below half a level, rounding errors of neighbouring samples go
//! together, and zero and noise follow from how often each code is shown ([`super::rounding`]).

use std::ops::Range;

use super::local_fit::LocalFit;
use super::pulse_conditions::{Conditions, MIN_BASELINE_SAMPLES, PEAK_SHARE, PulseError};
use super::rounding::{MovingScatter, Rounding, at_rest};
use crate::trace::Trace;

/// The baseline ends after this share of the samples before the pulse exceeds a quarter of the largest value (1).
const BASELINE_SHARE: f64 = 2.0 / 3.0;
/// Scatter below this many levels leaves rounding errors that go together (1).
const DITHERED_RMS: f64 = 0.6;
/// Samples of a smooth curve that tells the scatter, and levels that it spans at least.
const CURVE_SAMPLES: usize = 12;
const CURVE_LEVELS: f64 = 3.0;

/// Zero and noise of a trace before the pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Baseline {
    /// The signal at rest: the mean, or what the codes of a quiet scope tell (unit).
    pub level: f64,
    /// Root mean square about the mean (unit).
    pub rms: f64,
    /// Number of samples.
    pub samples: usize,
    /// Time of its middle (s).
    pub middle: f64,
    /// Its standard uncertainty (unit).
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
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let rms = (squares / (count - 1.0)).sqrt();
        let step = conditions.level;
        let (level, uncertainty, rounding) = if rms < DITHERED_RMS * step {
            at_rest(values, step, scatter(trace, step))
        } else {
            let noise = (rms * rms - step * step / 12.0).sqrt();
            (mean, rms / count.sqrt(), Rounding { level: step, noise })
        };
        Ok(Self {
            level,
            rms,
            samples: values.len(),
            middle: 0.5 * (trace.time(range.start) + trace.time(range.end - 1)),
            uncertainty,
            rounding,
        })
    }
}

/// Standard uncertainty of one sample: the noise seen, but no less than rounding to levels leaves.
pub(super) fn noise_of(rms: f64, level: f64) -> f64 {
    rms.max(level / 12f64.sqrt())
}

/// Scatter of the samples of `trace` about cubics over a few of them each, wherever these span several levels `step` apart (unit).
fn scatter(trace: &Trace, step: f64) -> MovingScatter {
    let (mut squares, mut freedom) = (0.0, 0.0);
    for start in (0..trace.values.len()).step_by(CURVE_SAMPLES) {
        let range = start..(start + CURVE_SAMPLES).min(trace.values.len());
        let values = trace.values.get(range.clone()).unwrap_or_default();
        let (low, high) =
            values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
        if values.len() == CURVE_SAMPLES
            && high - low >= CURVE_LEVELS * step
            && let Some(fit) = LocalFit::of(trace, range, 3)
        {
            squares += fit.residual_variance() * fit.freedom();
            freedom += fit.freedom();
        }
    }
    MovingScatter { variance: squares / f64::max(freedom, 1.0), freedom }
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
