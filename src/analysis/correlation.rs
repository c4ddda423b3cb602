//! By how much one pulse is later than another, from their whole shapes: cross-correlation.
//!
//! The lag `T` that makes `C(T) = sum of a(t) b(t + T)` largest, the top of a cubic through those
//! near it. Both signals end softly behind their first pulse, at the same distance from their
//! half-rise, so that later pulses and reflections have no say. Noise of variances `s_a^2`, `s_b^2`
//! per sample moves the top by `u^2 = (s_a^2 sum b'^2 + s_b^2 sum a'^2) / (sum a' b')^2`; noise
//! that meets noise adds `n s_a^2 s_b^2` to the variance of every `C`. Source: C. H. Knapp, G. C.
//! Carter, IEEE Trans. ASSP 24, 320 (1976); the uncertainty, to which comes by how much the lag
//! moves with the place where the signals are cut, follows from `C' = 0` by JCGM 100:2008, Eq.
//! (10). Valid for pulses of like shape; for pulses that change their shape on the way it is an
//! estimator of its own, with no time of arrival behind it.

use crate::quantity::Uncertain;
use std::f64::consts::PI;

use super::arrival::Estimator;
use super::fourier::Fourier;
use super::local_fit::{LocalFit, nearest_fall};
use super::pulse::Pulse;
use crate::trace::Trace;

/// Lags on either side of the largest correlation that its place is read from, in rises from half
/// to peak (1).
const FIT_LAGS: f64 = 0.35;
/// Length of what is cut out of a signal, in such rises (1).
const EXCERPT_LENGTH: f64 = 8.0;
/// Intervals that differ by less than this are the same (1).
const INTERVAL_TOLERANCE: f64 = 1e-9;

/// How much later `second` is than `first` (s); none where sample intervals differ or no lag stands
/// out.
pub fn delay(first: &Pulse, second: &Pulse) -> Option<Uncertain> {
    let interval = first.signal.interval;
    if (second.signal.interval / interval - 1.0).abs() > INTERVAL_TOLERANCE {
        return None;
    }
    let rise = first.rise().max(second.rise()) as f64;
    let (half_a, half_b) =
        (first.arrival(Estimator::HalfRise)?, second.arrival(Estimator::HalfRise)?);
    let (a, b) = (first.excerpt(half_a.value, rise), second.excerpt(half_b.value, rise));
    let reach = (FIT_LAGS * rise).ceil().max(2.0) as usize;
    let CorrelationMaximum { lag, bend, gain } = top(&correlate(&a, &b), reach)?;
    // The cut-out moves with the half-rise: how far the lag goes with it, once for each of the two.
    let moved = second.excerpt(half_b.value + half_b.u, rise);
    let cut_b = (top(&correlate(&a, &moved), reach)?.lag - lag).abs();
    let cut_a = cut_b * half_a.u / half_b.u;
    // The curvature of C at its top is the sum of a' b' with its sign turned: with pulses of like
    // shape, those of a'^2 and b'^2 by the ratio of the heights. Summed up from the samples they
    // would count the noise's own slopes.
    let ratio = second.height()?.value / first.height()?.value;
    let (noise_a, noise_b) =
        (first.noise * (ratio / -bend).sqrt(), second.noise / (ratio * -bend).sqrt());
    // The noise that moves the half-rise is the noise that moves the lag: both shares go together.
    let shares = (noise_a + cut_a).powi(2) + (noise_b + cut_b).powi(2);
    let both = (first.noise * second.noise).powi(2) * EXCERPT_LENGTH * rise * gain;
    let standard_uncertainty = (shares + both).sqrt() * interval;
    let value = second.signal.start - first.signal.start + lag * interval;
    standard_uncertainty.is_finite().then_some(Uncertain::normal(value, standard_uncertainty))
}

/// A maximum of the correlation.
struct CorrelationMaximum {
    /// Lag (samples).
    lag: f64,
    /// Second difference from lag to lag.
    bend: f64,
    /// Variance of the lag from noise of unit variance in each correlation.
    gain: f64,
}

/// The maximum of a cubic through the largest correlation and `reach` on either side.
fn top(lags: &[f64], reach: usize) -> Option<CorrelationMaximum> {
    let best = (0..lags.len()).max_by(|i, j| lags[*i].total_cmp(&lags[*j]))?;
    let around = (0..=2 * reach).map(|shift| (best + lags.len() + shift - reach) % lags.len());
    let values = around.filter_map(|index| lags.get(index).copied()).collect();
    let whole = if best <= lags.len() / 2 { best as f64 } else { best as f64 - lags.len() as f64 };
    let start = whole - reach as f64;
    let (name, unit) = (String::new(), String::new());
    let curve = Trace { name, unit, start, interval: 1.0, values };
    let fit = LocalFit::of(&curve, 0..2 * reach + 1, 3)?;
    let x = nearest_fall(&|x| fit.slope(x))?;
    let bend = fit.curvature(x) / fit.scale().powi(2);
    let gain = fit.variance(&fit.gradient(1, x)) / (bend * fit.scale()).powi(2);
    Some(CorrelationMaximum { lag: fit.time(x), bend, gain })
}

impl Pulse {
    /// The signal around its first pulse, in units of `rise` (samples) from `arrival` (s), its
    /// half-rise: nothing before -3, fading out as a cosine from 1 to 5.
    fn excerpt(&self, arrival: f64, rise: f64) -> Vec<f64> {
        let half = (arrival - self.signal.start) / self.signal.interval;
        let weight = |index: usize| {
            let place = (index as f64 - half) / rise;
            match place {
                ..-3.0 => 0.0,
                -3.0..1.0 => 1.0,
                1.0..5.0 => 0.5 + 0.5 * (0.25 * PI * (place - 1.0)).cos(),
                _ => 0.0,
            }
        };
        let values = self.signal.values.iter().enumerate();
        values.map(|(i, v)| v * weight(i)).collect()
    }
}

/// `sum of a[i] b[i + k]` for every `k`, negative ones at the end (unit).
pub fn correlate(a: &[f64], b: &[f64]) -> Vec<f64> {
    let length = (a.len() + b.len()).next_power_of_two();
    let mut fourier = Fourier::default();
    let [first, second] = [a, b].map(|values| {
        let mut padded = values.to_vec();
        padded.resize(length, 0.0);
        fourier.forward(&mut padded)
    });
    let mut product: Vec<_> = first.iter().zip(&second).map(|(x, y)| x.conj() * y).collect();
    fourier.inverse(&mut product, length)
}
