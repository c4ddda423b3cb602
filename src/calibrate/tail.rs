//! The time constant from what a record shows behind the contact: no force, only the charge that is
//! left, leaking away.
//!
//! Without force `V[i] + (1 - a) sum over k < i of V[k] = 0`: behind a contact whose samples sum up
//! to `B` is `V[i] = -(1 - a) a^i B`; least squares of these gives `1 - a = 1 - exp(-dt/tau)`. On a
//! quiet scope the signal behind the contact lingers between two levels, and rounding moves it and
//! the zero together: for each zero that the codes at rest allow, what rounding adds on average to
//! the signal found is taken off, and `1/tau` is the mean over these zeros; its change with the
//! zero is part of the baseline's uncertainty. Valid if no force acts on the sensor after the
//! contact, as on one that only the striker presses on.

use super::record::{PreparedRecord, RawRecord, Surroundings};
use crate::analysis::quiet_scope::{AtRest, PossibleZero};
use crate::analysis::rounding::Rounding;
use crate::numeric::intervals::chi_squared_beyond;

/// A leak this many standard uncertainties above zero is one (1).
const MIN_LEAK_DEVIATIONS: f64 = 3.0;
/// Fewer samples behind the contact than this tell nothing.
pub(super) const MIN_TAIL_SAMPLES: usize = 100;

/// Steps of Gauss and Newton from a start that is right to a few per cent: each squares the error.
const STEPS: usize = 5;

/// Scatter that is less probable is no chance (1).
const CHANCE: f64 = 0.05;
/// What rounding adds is taken off this many times, each time from the signal found before.
const ROUNDING_STEPS: usize = 2;

/// `1/tau` from one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tail {
    /// `1/tau` (1/s).
    pub inverse_tau: f64,
    /// Its standard uncertainty from the noise behind the contact (1/s).
    pub noise_u: f64,
    /// Its standard uncertainty from the zero, as far as it does not go with it in a straight line
    /// (1/s).
    pub zero_u: f64,
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
            + self.zero_u.powi(2)
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

/// Fits the end of `record` with what is known from all of its range; none where there is too
/// little.
pub fn fit(record: &RawRecord, known: &Surroundings) -> Option<Tail> {
    let prepared = PreparedRecord::new(record, known).ok()?;
    let signal = &prepared.signal;
    let contact = prepared.contact()?;
    let (start, first) = (contact.start, contact.len());
    let values = signal.values.get(start..)?;
    if values.len() < first + MIN_TAIL_SAMPLES {
        return None;
    }
    let leak = discharged(values, first)?;
    let interval = signal.interval;
    let inverse = |leak: f64| -(-leak).ln_1p() / interval;
    let slope = 1.0 / (interval * (1.0 - leak));
    let found = Discharge::of(values, first, leak);
    let by_zero = if let Some(rest) = &prepared.rest {
        ByZero::of_codes(&without_rounding(values, first, rest)?, &inverse)
    } else {
        let of = |mode: &Vec<f64>| change(mode.get(start..).unwrap_or_default(), &found);
        let changes: Vec<f64> = prepared.modes.iter().map(|mode| -slope * of(mode)).collect();
        ByZero::of_modes(inverse(leak), &prepared.contact_modes(), &changes)
    };
    let [contact, behind] = errors(&found, prepared.baseline.rounding);
    let tail = Tail {
        inverse_tau: by_zero.inverse_tau,
        noise_u: slope * behind,
        zero_u: by_zero.left,
        contact_u: slope * contact,
        per_integral: slope * found.per_charge / interval,
        per_baseline: by_zero.per_baseline,
        baseline_u: by_zero.baseline_u,
        charge: values.get(..first)?.iter().sum::<f64>() / prepared.noise,
    };
    (tail.weight().is_finite() && tail.variance().is_finite()).then_some(tail)
}

/// How `1/tau` goes with the baseline.
struct ByZero {
    /// Mean over all baselines that may be (1/s).
    inverse_tau: f64,
    /// Its change with the baseline during the contact (1/s/V).
    per_baseline: f64,
    /// Standard uncertainty of that baseline (V).
    baseline_u: f64,
    /// Standard uncertainty of `1/tau` for a given baseline during the contact (1/s).
    left: f64,
}

impl ByZero {
    /// From the zeros that codes at rest allow, each with its probability, how far it is above the
    /// one found, and `1 - a`.
    fn of_codes(zeros: &[(f64, f64, f64)], inverse: &dyn Fn(f64) -> f64) -> Self {
        let mean = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            zeros.iter().map(|(weight, off, leak)| weight * of(*off, inverse(*leak))).sum()
        };
        let inverse_tau = mean(&|_, inverse| inverse);
        let (square, joint) = (mean(&|off, _| off * off), mean(&|off, inverse| off * inverse));
        let per_baseline = joint / square;
        let left = mean(&|off, inverse| (inverse - inverse_tau - per_baseline * off).powi(2));
        Self { inverse_tau, per_baseline, baseline_u: square.sqrt(), left: left.sqrt() }
    }

    /// From the modes of the baseline's error: their means over the contact and the changes of
    /// `1/tau` with them.
    fn of_modes(inverse_tau: f64, contact: &[f64], changes: &[f64]) -> Self {
        let square: f64 = contact.iter().map(|own| own * own).sum();
        let joint: f64 = contact.iter().zip(changes).map(|(own, change)| own * change).sum();
        let whole: f64 = changes.iter().map(|change| change * change).sum();
        let per_baseline = if square > 0.0 { joint / square } else { 0.0 };
        let left = (whole - per_baseline * joint).max(0.0).sqrt();
        Self { inverse_tau, per_baseline, baseline_u: square.sqrt(), left }
    }
}

/// `1 - a` for each zero that the codes at `rest` allow, with its probability and how far it is
/// above the one found: each time what rounding adds to the smooth signal behind the contact is
/// taken off, as far as it goes together.
fn without_rounding(values: &[f64], first: usize, rest: &AtRest) -> Option<Vec<(f64, f64, f64)>> {
    let zeros = rest.zeros();
    let one = |zero: &PossibleZero| {
        let own: Vec<f64> = values.iter().map(|v| v - zero.off).collect();
        let mut shown = own.clone();
        for _ in 0..ROUNDING_STEPS {
            let leak = discharged(&shown, first)?;
            let mut behind = -leak * shown.get(..first)?.iter().sum::<f64>();
            for (shown, value) in shown.iter_mut().zip(&own).skip(first) {
                *shown = value - rest.shown_too_high(zero, behind);
                behind *= 1.0 - leak;
            }
        }
        Some((zero.weight, zero.off, discharged(&shown, first)?))
    };
    zeros.iter().map(one).collect()
}

/// `tails` with their uncertainties enlarged by the ratio of what they scatter to what these
/// explain (R. T. Birge, Phys. Rev. 40, 207, 1932), where that is beyond chance: a zero that moves
/// unseen makes each record's time constant another one.
pub fn with_scatter(mut tails: Vec<Option<Tail>>) -> Vec<Option<Tail>> {
    let Some((mean, _)) = mean(tails.iter().flatten()) else { return tails };
    let square = |tail: &Tail| (tail.inverse_tau - mean).powi(2) / tail.variance();
    let chi_squared: f64 = tails.iter().flatten().map(square).sum();
    let freedom = tails.iter().flatten().count() as f64 - 1.0;
    if freedom > 0.0 && chi_squared_beyond(chi_squared, freedom) < CHANCE {
        for tail in tails.iter_mut().flatten() {
            tail.noise_u =
                tail.noise_u.hypot((tail.variance() * (chi_squared / freedom - 1.0)).sqrt());
        }
    }
    tails
}

/// `tau` from several records; none where they show no leak above the noise (s).
///
/// All records count, however uncertain: without those whose leak comes out low by chance
/// the mean would be too high.
pub fn weighted_mean(tails: &[Option<Tail>]) -> Option<f64> {
    let (inverse, u) = mean(tails.iter().flatten())?;
    (inverse > MIN_LEAK_DEVIATIONS * u).then(|| 1.0 / inverse)
}

/// `1 - a` of `values`, behind the contact from sample `first` on.
pub(super) fn discharged(values: &[f64], first: usize) -> Option<f64> {
    // To begin with as if the sums were exact.
    let (mut before, mut numerator, mut denominator) = (0.0, 0.0, 0.0);
    for (index, value) in values.iter().enumerate() {
        if index >= first {
            numerator -= value * before;
            denominator += before * before;
        }
        before += value;
    }
    let mut leak = numerator / denominator;
    let charge: f64 = values.get(..first)?.iter().sum();
    for _ in 0..STEPS {
        let (mut joint, mut square) = (0.0, 0.0);
        for (value, [left, change]) in values.iter().skip(first).zip(discharge(charge, leak)) {
            joint += change * (value - left);
            square += change * change;
        }
        leak += joint / square;
        if !(leak > -0.5 && leak < 1.0) {
            return None;
        }
    }
    leak.is_finite().then_some(leak)
}

/// What a `charge` (V) leaves behind the contact, and its change with `1 - a`, sample by sample
/// (V).
pub(super) fn discharge(charge: f64, leak: f64) -> impl Iterator<Item = [f64; 2]> {
    let mut kept = 1.0;
    let mut number = 0.0;
    std::iter::repeat_with(move || {
        let left = -leak * kept * charge;
        let change = -charge * kept * (1.0 - number * leak / (1.0 - leak));
        kept *= 1.0 - leak;
        number += 1.0;
        [left, change]
    })
}

/// How `1 - a` goes with the samples.
struct Discharge {
    /// Samples of the contact.
    first: usize,
    /// Change of what is behind the contact with `1 - a`, sample by sample (V).
    changes: Vec<f64>,
    /// Sum of their squares (V^2).
    square: f64,
    /// Change of `1 - a` with the sum of the voltage over the contact (1/V).
    per_charge: f64,
}

impl Discharge {
    fn of(values: &[f64], first: usize, leak: f64) -> Self {
        let charge: f64 = values.get(..first).unwrap_or_default().iter().sum();
        let behind = values.len().saturating_sub(first);
        let (mut changes, mut joint) = (Vec::with_capacity(behind), 0.0);
        for [left, change] in discharge(charge, leak).take(behind) {
            joint += change * left / charge;
            changes.push(change);
        }
        let square: f64 = changes.iter().map(|change| change * change).sum();
        Self { first, changes, square, per_charge: -joint / square }
    }
}

/// Change of `1 - a` with the samples by `mode` (1).
fn change(mode: &[f64], found: &Discharge) -> f64 {
    let (contact, behind) = mode.split_at(found.first.min(mode.len()));
    let joint: f64 = found.changes.iter().zip(behind).map(|(change, m)| change * m).sum();
    joint / found.square + found.per_charge * contact.iter().sum::<f64>()
}

/// Standard uncertainties of `1 - a` from noise and rounding during the contact and behind it (1).
///
/// The change of `1 - a` with each sample times that sample's error. On a quiet scope what of the
/// rounding errors behind the contact goes together has been taken off; all else is white.
fn errors(found: &Discharge, rounding: Rounding) -> [f64; 2] {
    let sample = rounding.sample();
    let white = (sample.powi(2) - rounding.common()).max(0.0);
    let contact = found.per_charge.abs() * sample * (found.first as f64).sqrt();
    [contact, (white / found.square).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One sample behind a contact that sums up to `B` is `-(1 - a) B`: a larger sum with the same
    /// sample is a smaller leak, by `-(1 - a)/B` for each volt.
    #[test]
    fn a_larger_charge_with_the_same_rest_leaks_less() {
        let values = [1.0, 2.0, 1.0, -0.2];
        let leak = discharged(&values, 3).expect("a leak");
        assert!((leak - 0.05).abs() < 1e-12, "{leak}");
        let found = Discharge::of(&values, 3, leak);
        assert!((found.per_charge + 0.05 / 4.0).abs() < 1e-12, "{}", found.per_charge);
        // The same by a contact that is a volt higher in one sample, and to first order.
        let step = 1e-6;
        let higher = discharged(&[1.0, 2.0 + step, 1.0, -0.2], 3).expect("a leak");
        assert!(((higher - leak) / step - found.per_charge).abs() < 1e-7);
        let mode = [0.0, 1.0, 0.0, 0.0];
        assert!((change(&mode, &found) - found.per_charge).abs() < 1e-12);
    }
}
