//! The first pulse in a sampled trace: where it stands out of the noise, how high and wide it is.
//!
//! Behind the scope and before [`super::arrival`]: takes the baseline away, undoes the droop where
//! the time constant is known, turns negative pulses over, and finds the first peak: the first
//! local maximum above a quarter of the largest value, as a run's summary defines it for the force
//! itself. A maximum counts when the signal falls off behind it by six standard deviations of the
//! smoothed noise and by 0.5 % of the largest value; shallower ones may be noise.

use super::pulse_conditions::MIN_PROMINENCE;
pub use super::pulse_conditions::{Conditions, PEAK_SHARE, PulseError};

use super::baseline::Baseline;
use super::disturbance::DisturbanceKind;
use super::local_fit::LocalFit;
use super::rounding::Spread;
use crate::trace::Trace;
/// A zero whose standard uncertainty at the peak is more than this share of the height leaves
/// neither height nor arrival (1).
const MAX_ZERO_SHARE: f64 = 0.125;
/// As long as nothing is smoothed, there are more samples to be wrong: then by this many (1).
const MIN_RAW_PROMINENCE: f64 = 8.0;
/// And by this share of the largest value (1).
const MIN_DEPTH_SHARE: f64 = 0.005;
/// Half-width of the smoothing in units of the rise from a quarter of the largest value to the peak
/// (1).
const SMOOTHING: f64 = 1.0 / 6.0;

/// A trace with a pulse, ready to be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Pulse {
    /// The signal with baseline and droop taken away, turned so that the pulse is positive.
    pub signal: Trace,
    /// The baseline that was taken away.
    pub baseline: Baseline,
    /// Whether the pulse was negative.
    pub inverted: bool,
    /// Standard uncertainty of one sample (unit).
    pub noise: f64,
    pub(super) conditions: Conditions,
    /// Modes of the zero's error in the signal, each with a standard deviation of one (unit).
    pub(super) modes: Vec<Vec<f64>>,
    pub(super) smoothed: Vec<f64>,
    /// Standard uncertainty of a smoothed sample.
    pub(super) smoothed_noise: f64,
    /// Sample of the first peak, and the first at half of it.
    pub(super) peak: usize,
    pub(super) half: usize,
}

impl Pulse {
    /// Finds the first pulse of `trace`.
    ///
    /// # Errors
    /// [`PulseError`] without a baseline, without a pulse, and for values that are no numbers.
    pub fn find(trace: &Trace, conditions: Conditions) -> Result<Self, PulseError> {
        let name = || trace.name.clone();
        let sound = trace.interval > 0.0 && trace.interval.is_finite();
        if !sound || trace.values.iter().any(|v| !v.is_finite()) {
            return Err(PulseError::NotFinite { trace: name() });
        }
        let baseline = Baseline::of(trace, &conditions)?;
        let noise = baseline.rounding.sample();
        let (mut signal, modes) = baseline.take_from(trace, conditions.time_constant);
        let (_, inverted) = largest(&signal.values);
        if inverted {
            for value in &mut signal.values {
                *value = -*value;
            }
        }
        let (top, _) = largest(&signal.values);
        if top <= MIN_PROMINENCE * noise {
            return Err(PulseError::NoPulse { trace: name(), largest: top, noise });
        }
        let drop = |noise: f64| noise.max(MIN_DEPTH_SHARE * top);
        // A quarter of the largest value may be within the noise: of many samples one passes it by
        // chance.
        let significant = chance_limit(signal.values.len());
        let threshold = |noise: f64| (PEAK_SHARE * top).max(significant * noise);
        let rough =
            first_maximum(&signal.values, threshold(noise), drop(MIN_RAW_PROMINENCE * noise));
        let reach = smoothing_reach(rough.1 - rough.0);
        let (smoothed, weights) = smooth(&signal.values, reach);
        let gain = weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
        let fast = baseline.disturbance.as_ref().map_or(0.0, |found| found.fast_noise(&weights));
        let smoothed_noise = (noise * gain).hypot(fast);
        let (_, peak, has_fallen) = first_maximum(
            &smoothed,
            threshold(smoothed_noise),
            drop(MIN_PROMINENCE * smoothed_noise),
        );
        if !has_fallen {
            return Err(PulseError::Cut { trace: name(), end: signal.time(signal.values.len()) });
        }
        let height = smoothed.get(peak).copied().unwrap_or(top);
        let half = smoothed.iter().position(|v| *v >= 0.5 * height).unwrap_or(peak);
        let found = Self {
            signal,
            baseline,
            inverted,
            noise,
            conditions,
            modes,
            smoothed,
            smoothed_noise,
            peak,
            half,
        };
        let share = found.zero_variance(found.signal.time(peak)).sqrt() / height;
        match &found.baseline.disturbance {
            Some(disturbance) if share > MAX_ZERO_SHARE => {
                let kinds = match disturbance.words() {
                    words if words.is_empty() => "noise".to_owned(),
                    words => words,
                };
                Err(PulseError::Disturbed { trace: name(), kinds, share })
            }
            _ => Ok(found),
        }
    }

    /// Samples from half of the first peak to the peak: the pulse's own measure of time.
    pub(super) fn rise(&self) -> usize {
        (self.peak - self.half).max(1)
    }

    /// A polynomial through the samples up to `reach` on either side of sample `at`.
    pub(super) fn fit(&self, at: usize, reach: usize, degree: usize) -> Option<LocalFit> {
        let reach = reach.max(2);
        let range = at.saturating_sub(reach)..(at + reach + 1).min(self.signal.values.len());
        LocalFit::of(&self.signal, range, degree)
    }

    /// Variance that noise and rounding give the sum of the coefficients of `fit` with the weights
    /// `gradient`.
    pub(super) fn variance(&self, fit: &LocalFit, gradient: &[f64]) -> f64 {
        self.spread(fit, gradient).variance
    }

    /// How noise and rounding distribute the sum of the coefficients of `fit` with the weights
    /// `gradient`.
    pub(super) fn spread(&self, fit: &LocalFit, gradient: &[f64]) -> Spread {
        let [white, coloured] = self.spreads(fit, gradient);
        white.plus(coloured)
    }

    /// True if 1/f noise is there beyond doubt and moves that sum more than white noise does.
    pub(super) fn is_coloured(&self, fit: &LocalFit, gradient: &[f64]) -> bool {
        let [white, coloured] = self.spreads(fit, gradient);
        let disturbance = self.baseline.disturbance.as_ref();
        let is_found = disturbance.is_some_and(|d| d.found.contains(&DisturbanceKind::Pink));
        is_found && coloured.variance > white.variance
    }

    /// The parts of white noise with rounding, and of 1/f noise.
    fn spreads(&self, fit: &LocalFit, gradient: &[f64]) -> [Spread; 2] {
        let weights: Vec<(f64, f64)> = fit.weights(gradient).collect();
        let white = self.baseline.rounding.spread(&weights);
        let weights: Vec<f64> = weights.iter().map(|(weight, _)| *weight).collect();
        let fast =
            self.baseline.disturbance.as_ref().map_or(0.0, |found| found.fast_noise(&weights));
        [white, Spread::normal(fast)]
    }

    /// Variance of the signal's zero at `time` (s).
    pub(super) fn zero_variance(&self, time: f64) -> f64 {
        self.zero_spread(time).variance
    }

    /// How the signal's zero at `time` (s) is distributed: the modes of its error, grown by undoing
    /// the droop, and what the noise adds by that.
    pub(super) fn zero_spread(&self, time: f64) -> Spread {
        let square = |mode: &Vec<f64>| self.at(mode, time).powi(2);
        let (all, constant) =
            (self.modes.iter().map(square).sum(), self.modes.first().map_or(0.0, square));
        let spread = self.baseline.spread;
        let growth = if spread.variance > 0.0 { constant / spread.variance } else { 0.0 };
        let constant =
            Spread { variance: all, fourth_cumulant: growth * growth * spread.fourth_cumulant };
        let Some(tau) = self.conditions.time_constant else { return constant };
        let after = (time - self.signal.time(self.baseline.end)).max(0.0);
        let walk = self.noise * (after * self.signal.interval).sqrt() / tau;
        constant.plus(Spread::normal(walk))
    }

    /// Variance of the difference of the zeros at two times (s), the second `share` times.
    pub(super) fn zero_difference(&self, first: f64, second: f64, share: f64) -> f64 {
        let off = |mode: &Vec<f64>| self.at(mode, first) - share * self.at(mode, second);
        self.modes.iter().map(|mode| off(mode).powi(2)).sum()
    }

    /// Variance of the zero's change around `time` (s) over `reach` (s).
    pub(super) fn tilt_variance(&self, time: f64, reach: f64) -> f64 {
        0.25 * self.zero_difference(time + reach, time - reach, 1.0)
    }

    /// Value of a `mode` at `time` (s).
    fn at(&self, mode: &[f64], time: f64) -> f64 {
        let place = ((time - self.signal.start) / self.signal.interval).max(0.0);
        let index = (place as usize).min(mode.len().saturating_sub(2));
        let (a, b) = (mode.get(index).copied(), mode.get(index + 1).copied());
        let a = a.unwrap_or(0.0);
        a + (b.unwrap_or(a) - a) * (place - index as f64).clamp(0.0, 1.0)
    }

    /// Number of maxima that stand out of what is around them by six standard deviations and by
    /// `share` of the largest (1).
    pub fn count(&self, share: f64) -> usize {
        let (top, _) = largest(&self.smoothed);
        let drop = (MIN_PROMINENCE * self.smoothed_noise).max(share * top);
        let (mut high, mut low) = (0.0_f64, 0.0_f64);
        let (mut rising, mut count) = (false, 0);
        for value in &self.smoothed {
            high = high.max(*value);
            low = low.min(*value);
            if rising && *value < high - drop {
                count += 1;
                (rising, low) = (false, *value);
            } else if !rising && *value > low + drop {
                (rising, high) = (true, *value);
            }
        }
        count
    }
}

/// What normal noise exceeds in one of `samples` samples with a probability of 0.1 %, in standard
/// deviations: `Q(z) = 0.001/samples`, from the bound `Q(z) < exp(-z^2/2)/2` (1).
fn chance_limit(samples: usize) -> f64 {
    (2.0 * (500.0 * samples.max(1) as f64).ln()).sqrt()
}

/// The value farthest from zero, as its distance, and whether it is negative.
fn largest(values: &[f64]) -> (f64, bool) {
    let farther = |far: f64, v: &f64| if v.abs() > far.abs() { *v } else { far };
    let far = values.iter().fold(0.0, farther);
    (far.abs(), far < 0.0)
}

/// First sample at `threshold`, and that of the highest value from there until the values have
/// fallen by `drop`; and whether they have before the end.
fn first_maximum(values: &[f64], threshold: f64, drop: f64) -> (usize, usize, bool) {
    let start = values.iter().position(|v| *v >= threshold).unwrap_or(0);
    let (mut at, mut high) = (start, f64::NEG_INFINITY);
    for (index, value) in values.iter().enumerate().skip(start) {
        if *value > high {
            (at, high) = (index, *value);
        } else if *value < high - drop {
            return (start, at, true);
        }
    }
    (start, at, false)
}

fn smoothing_reach(rise: usize) -> usize {
    (SMOOTHING * rise as f64).round() as usize
}

/// Savitzky and Golay's quadratic smoothing over `reach` samples on either side, and the weights of
/// the samples. Source: A. Savitzky, M. J. E. Golay, Anal. Chem. 36, 1627 (1964). Beyond the
/// ends the outermost samples stand.
fn smooth(values: &[f64], reach: usize) -> (Vec<f64>, Vec<f64>) {
    if reach < 2 {
        return (values.to_vec(), vec![1.0]);
    }
    let m = reach as f64;
    let scale = 3.0 / ((2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0));
    let weight = |j: i64| scale * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * (j * j) as f64);
    let (reach, last) = (reach as i64, values.len() as i64 - 1);
    let weights: Vec<(i64, f64)> = (-reach..=reach).map(|j| (j, weight(j))).collect();
    let at = |index: i64| values.get(index.clamp(0, last) as usize).copied().unwrap_or(0.0);
    let smoothed = (0..=last).map(|i| weights.iter().map(|(j, w)| w * at(i + j)).sum()).collect();
    (smoothed, weights.into_iter().map(|(_, weight)| weight).collect())
}

#[cfg(test)]
mod tests {
    use super::first_maximum;

    /// A top of several equal samples, as of a saturated record, begins with its first.
    #[test]
    fn the_first_of_equal_maxima_is_the_peak() {
        assert_eq!(first_maximum(&[0.0, 1.0, 3.0, 3.0, 3.0, 1.0], 1.0, 1.5), (1, 2, true));
    }
}
