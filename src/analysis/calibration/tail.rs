//! The time constant from what a record shows behind the contact: no force, only the charge that is left, leaking away.
//!
//! Without force `V[i] + (1 - a) sum over k < i of V[k] = 0`; least squares of these gives `1 - a = 1 - exp(-dt/tau)`.
//! Valid where the sensor feels nothing behind the contact, as one that only the striker presses on.

use super::prepared::PreparedRecord;
use super::record::RawRecord;
use crate::analysis::rounding::Rounding;

/// The end of the contact is not sharp: the fit begins this share of the contact later (1).
const TAIL_DELAY_SHARE: f64 = 0.3;
/// A leak this many standard uncertainties above zero is one (1).
const MIN_LEAK_DEVIATIONS: f64 = 3.0;
/// Fewer samples behind the contact than this tell nothing.
const MIN_TAIL_SAMPLES: usize = 100;

/// `1/tau` from one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tail {
    /// `1/tau` (1/s).
    pub inverse_tau: f64,
    /// Its standard uncertainty from the noise (1/s).
    pub noise_u: f64,
    /// Its change with the baseline (1/s/V).
    pub per_baseline: f64,
    /// Standard uncertainty of the baseline (V).
    pub baseline_u: f64,
    /// Sum of the voltage over the contact over the noise of one sample (1).
    pub charge: f64,
}

impl Tail {
    /// Weight among several (1).
    ///
    /// Uncertainties go with one over what the contact leaves to leak away; their own estimates would favour records whose errors make the leak low.
    pub fn weight(&self) -> f64 {
        self.charge * self.charge
    }

    fn variance(&self) -> f64 {
        self.noise_u.powi(2) + (self.per_baseline * self.baseline_u).powi(2)
    }
}

/// Weighted mean of `1/tau` and its standard uncertainty (1/s).
pub fn mean<'a>(tails: impl Iterator<Item = &'a Tail>) -> Option<(f64, f64)> {
    let (mut sum, mut weights, mut variance) = (0.0, 0.0, 0.0);
    for tail in tails {
        sum += tail.weight() * tail.inverse_tau;
        variance += tail.weight().powi(2) * tail.variance();
        weights += tail.weight();
    }
    (weights > 0.0).then(|| (sum / weights, variance.sqrt() / weights))
}

/// Fits the end of `record`; none where there is too little.
pub fn fit(record: &RawRecord) -> Option<Tail> {
    let prepared = PreparedRecord::new(record).ok()?;
    let signal = &prepared.signal;
    let start = prepared.start()?;
    // The voltage passes zero a little before the contact ends.
    let zero = prepared.fall(&signal.values, 0.0)?;
    let first = zero + (TAIL_DELAY_SHARE * (zero - start) as f64) as usize - start;
    let values = signal.values.get(start..)?;
    if values.len() < first + MIN_TAIL_SAMPLES {
        return None;
    }
    let leak = discharged(values, first, 0.0)?;
    let interval = signal.interval;
    let inverse = |leak: f64| -(-leak).ln_1p() / interval;
    let steps = prepared.baseline.uncertainty.max(f64::MIN_POSITIVE);
    let (higher, lower) = (discharged(values, first, steps)?, discharged(values, first, -steps)?);
    let slope = 1.0 / (interval * (1.0 - leak));
    let tail = Tail {
        inverse_tau: inverse(leak),
        noise_u: slope * noise_u(values, first, leak, prepared.baseline.rounding, prepared.noise),
        per_baseline: (inverse(higher) - inverse(lower)) / (2.0 * steps),
        baseline_u: prepared.baseline.uncertainty,
        charge: values.get(..first)?.iter().sum::<f64>() / prepared.noise,
    };
    (tail.weight().is_finite() && tail.variance().is_finite()).then_some(tail)
}

/// `tau` from several records; none where they show no leak above the noise (s).
///
/// All records count, however little each tells: without those whose leak comes out low by chance the mean would be too high.
pub fn weighted_mean(tails: &[Option<Tail>]) -> Option<f64> {
    let (inverse, u) = mean(tails.iter().flatten())?;
    (inverse > MIN_LEAK_DEVIATIONS * u).then(|| 1.0 / inverse)
}

/// `1 - a` for a baseline that is `off` higher.
fn discharged(values: &[f64], first: usize, off: f64) -> Option<f64> {
    let (mut before, mut numerator, mut denominator) = (0.0, 0.0, 0.0);
    for (index, value) in values.iter().enumerate() {
        let value = value - off;
        if index >= first {
            numerator -= value * before;
            denominator += before * before;
        }
        before += value;
    }
    let leak = numerator / denominator;
    (leak.is_finite() && leak < 1.0).then_some(leak)
}

/// Standard uncertainty of `1 - a` from noise and rounding (1).
///
/// The change of `1 - a` with each sample times that sample's error. Behind the contact the signal is smooth, `-(1 - a)` times the sum before it,
/// and rounding errors go together as far as it crosses levels; during the contact they are white.
fn noise_u(values: &[f64], first: usize, leak: f64, rounding: Rounding, sample: f64) -> f64 {
    let mut before: Vec<f64> = Vec::with_capacity(values.len());
    let mut sum = 0.0;
    for value in values {
        before.push(sum);
        sum += value;
    }
    let denominator: f64 = before.iter().skip(first).map(|b| b * b).sum();
    let (mut later, mut early) = (0.0, 0.0);
    let mut behind: Vec<(f64, f64)> = Vec::with_capacity(values.len());
    for (index, (value, before)) in values.iter().zip(&before).enumerate().rev() {
        if index < first {
            early += later * later;
            continue;
        }
        behind.push(((before + later) / denominator, -leak * before));
        later += value + 2.0 * leak * before;
    }
    let early = early * (sample / denominator).powi(2);
    // The noise that the codes show may be more than what is told apart of them.
    let unseen = (sample * sample - rounding.sample().powi(2)).max(0.0);
    let squares: f64 = behind.iter().map(|(weight, _)| weight * weight).sum();
    (early + unseen * squares + rounding.variance(&behind)).sqrt()
}
