//! The time constant from what a record shows behind the contact: no force, only the charge that is
//! left, leaking away.
//!
//! Without force `V[i] + (1 - a) sum over k < i of V[k] = 0`; least squares of these gives
//! `1 - a = 1 - exp(-dt/tau)`. On a quiet scope the signal behind the contact lingers between two
//! levels, and rounding moves it and the zero together: for each zero that the codes at rest allow,
//! what rounding adds on average to the signal found is taken off, and `1/tau` is the mean over
//! these zeros; how it goes with the zero counts with the baseline. Valid where the sensor feels
//! nothing behind the contact, as one that only the striker presses on.

use super::record::{PreparedRecord, RawRecord};
use crate::analysis::quiet_scope::{AtRest, MovingScatter, PossibleZero};
use crate::analysis::rounding::Rounding;

/// The end of the contact is not sharp: the fit begins this share of the contact later (1).
const TAIL_DELAY_SHARE: f64 = 0.3;
/// A leak this many standard uncertainties above zero is one (1).
const MIN_LEAK_DEVIATIONS: f64 = 3.0;
/// Fewer samples behind the contact than this tell nothing.
const MIN_TAIL_SAMPLES: usize = 100;

/// What rounding adds is taken off this many times, each time from the signal found before.
const ROUNDING_STEPS: usize = 2;

/// `1/tau` from one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tail {
    /// `1/tau` (1/s).
    pub inverse_tau: f64,
    /// Its standard uncertainty from the noise behind the contact (1/s).
    pub noise_u: f64,
    /// Its standard uncertainty from the noise during the contact (1/s).
    pub contact_u: f64,
    /// Its change with the integral of the voltage over the contact (1/V/s^2).
    pub per_integral: f64,
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
    /// Uncertainties go with one over what the contact leaves to leak away; their own estimates
    /// would favour records whose errors make the leak low.
    pub fn weight(&self) -> f64 {
        self.charge * self.charge
    }

    fn variance(&self) -> f64 {
        self.noise_u.powi(2)
            + self.contact_u.powi(2)
            + (self.per_baseline * self.baseline_u).powi(2)
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

/// Fits the end of `record`, whose samples scatter so about a smooth curve; none where there is too
/// little.
pub fn fit(record: &RawRecord, scatter: MovingScatter) -> Option<Tail> {
    let prepared = PreparedRecord::new(record, scatter).ok()?;
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
    let zeros = if let Some(rest) = &prepared.rest {
        without_rounding(values, first, rest)?
    } else {
        let u = prepared.baseline.uncertainty.max(f64::MIN_POSITIVE);
        let at = |off: f64| Some((0.5, off, discharged(values, first, off)?));
        vec![at(-u)?, at(u)?]
    };
    let mean = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
        zeros.iter().map(|(weight, off, leak)| weight * of(*off, inverse(*leak))).sum()
    };
    let inverse_tau = mean(&|_, inverse| inverse);
    let (square, joint) = (mean(&|off, _| off * off), mean(&|off, inverse| off * inverse));
    let per_baseline = joint / square;
    let left = mean(&|off, inverse| (inverse - inverse_tau - per_baseline * off).powi(2));
    let slope = 1.0 / (interval * (1.0 - leak));
    let [contact, behind, change] = errors(values, first, leak, prepared.baseline.rounding);
    let tail = Tail {
        inverse_tau,
        noise_u: (slope * behind).hypot(left.sqrt()),
        contact_u: slope * contact,
        per_integral: slope * change / interval,
        per_baseline,
        baseline_u: prepared.baseline.uncertainty,
        charge: values.get(..first)?.iter().sum::<f64>() / prepared.noise,
    };
    (tail.weight().is_finite() && tail.variance().is_finite()).then_some(tail)
}

/// `1 - a` for each zero that the codes at `rest` allow, with its probability and how far it is
/// above the one found: each time what rounding adds to the smooth signal behind the contact is
/// taken off, as far as it goes together.
fn without_rounding(values: &[f64], first: usize, rest: &AtRest) -> Option<Vec<(f64, f64, f64)>> {
    let zeros = rest.zeros();
    let one = |zero: &PossibleZero| {
        let mut shown = values.to_vec();
        for _ in 0..ROUNDING_STEPS {
            let leak = discharged(&shown, first, zero.off)?;
            let mut before = 0.0;
            for (index, (shown, value)) in shown.iter_mut().zip(values).enumerate() {
                if index >= first {
                    *shown = value - rest.shown_too_high(zero, -leak * before);
                }
                before += *shown - zero.off;
            }
        }
        Some((zero.weight, zero.off, discharged(&shown, first, zero.off)?))
    };
    zeros.iter().map(one).collect()
}

/// `tau` from several records; none where they show no leak above the noise (s).
///
/// All records count, however uncertain: without those whose leak comes out low by chance
/// the mean would be too high.
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

/// Standard uncertainties of `1 - a` from noise and rounding during the contact and behind it (1),
/// and its change with the sum of the voltage over the contact (1/V).
///
/// The change of `1 - a` with each sample times that sample's error. On a quiet scope what of the
/// rounding errors behind the contact goes together has been taken off; all else is white.
fn errors(values: &[f64], first: usize, leak: f64, rounding: Rounding) -> [f64; 3] {
    let mut before: Vec<f64> = Vec::with_capacity(values.len());
    let mut sum = 0.0;
    for value in values {
        before.push(sum);
        sum += value;
    }
    let denominator: f64 = before.iter().skip(first).map(|b| b * b).sum();
    let (mut later, mut behind) = (0.0, 0.0);
    for (value, before) in values.iter().zip(&before).skip(first).rev() {
        behind += (before + later).powi(2);
        later += value + 2.0 * leak * before;
    }
    let (change, sample) = (-later / denominator, rounding.sample());
    let white = (sample.powi(2) - rounding.common()).max(0.0);
    [change.abs() * sample * (first as f64).sqrt(), (behind * white).sqrt() / denominator, change]
}
