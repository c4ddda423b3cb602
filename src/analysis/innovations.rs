//! A filter that turns white and 1/f noise into white noise.
//!
//! 1/f noise with the covariance `a^2 ln(L/d)` at distances `d` up to `L` is a sum of first-order
//! processes, `a^2 ln(q) exp(-d/tau)` each, whose time constants `tau` are apart by the factor `q`
//! (A. van der Ziel, Physica 16, 359, 1950): over all `tau` between two limits the sum is
//! `a^2 (E1(d/longest) - E1(d/shortest))`, which is `a^2 ln(L/d)` in between for
//! `longest = e^0.5772 L`; here `q` is about 2. Kalman's filter predicts each sample from those
//! before it, with these processes as its states (R. E. Kalman, J. Basic Eng. 82, 35, 1960). The
//! error of the prediction is the sample's innovation; innovations over their standard deviations
//! are white noise of variance one. Valid for normal noise.

use std::f64::consts::LN_2;

/// Exponential of Euler's constant (1).
const EXP_EULER: f64 = 1.781_072_417_990_198;
/// Variance of a sample beyond `a^2 ln(L)`, over `a^2`: a sample is a mean over its interval (1).
const WITHIN_A_SAMPLE: f64 = 1.5;

/// A filter for one record, fixed by its noise and by which samples count.
#[derive(Debug, Clone, PartialEq)]
pub struct Innovations {
    /// What each process keeps from one sample to the next (1).
    decays: Vec<f64>,
    /// How much each process follows an innovation, sample by sample (1).
    gains: Vec<f64>,
    /// Standard deviation of each innovation; infinite where a sample does not count (unit).
    deviations: Vec<f64>,
}

impl Innovations {
    /// The filter for noise of standard deviation `white` and 1/f noise of amplitude `pink` (unit),
    /// which is correlated over up to `longest` samples; `counts` says which samples are known.
    pub fn of((white, pink): (f64, f64), longest: f64, counts: &[bool]) -> Self {
        let (most, least) = (EXP_EULER * longest, EXP_EULER * (-WITHIN_A_SAMPLE).exp());
        let span = (most / least).ln().max(LN_2);
        let size = (span / LN_2).round() as usize;
        let step = span / size as f64;
        let decay = |place: usize| (-1.0 / (least * ((place as f64 + 0.5) * step).exp())).exp();
        let decays: Vec<f64> = (0..size).map(decay).collect();
        let variance = pink * pink * step;
        // Covariance of the processes, each at rest to begin with.
        let mut covariance = vec![vec![0.0; size]; size];
        (0..size).for_each(|i| covariance[i][i] = variance);
        let (mut gains, mut deviations) = (Vec::new(), Vec::new());
        for counts in counts {
            let along: Vec<f64> = covariance.iter().map(|row| row.iter().sum()).collect();
            let square = along.iter().sum::<f64>() + white * white;
            let share = if *counts { 1.0 / square } else { 0.0 };
            gains.extend(along.iter().map(|a| share * a));
            deviations.push(if *counts { square.sqrt() } else { f64::INFINITY });
            for (i, row) in covariance.iter_mut().enumerate() {
                for (j, entry) in row.iter_mut().enumerate() {
                    let known = *entry - share * along[i] * along[j];
                    let fresh = if i == j { variance * (1.0 - decays[i].powi(2)) } else { 0.0 };
                    *entry = decays[i] * decays[j] * known + fresh;
                }
            }
        }
        Self { decays, gains, deviations }
    }

    /// Variance of a sample of 1/f noise of amplitude 1 that is correlated over up to `longest`
    /// samples (1).
    pub fn variance(longest: f64) -> f64 {
        longest.ln() + WITHIN_A_SAMPLE
    }

    /// The factor on the filter's noise for which `values` are most likely, and before it the
    /// logarithm of that likelihood without its constant (1). Values are zero where samples do not
    /// count.
    pub fn likelihood(&self, values: &[f64]) -> (f64, f64) {
        let mut white = values.to_vec();
        self.whiten(&mut white);
        let counted = || self.deviations.iter().filter(|deviation| deviation.is_finite());
        let count = counted().count().max(1) as f64;
        let factor = (white.iter().map(|v| v * v).sum::<f64>() / count).sqrt();
        let logs: f64 = counted().map(|deviation| deviation.ln()).sum();
        (-count * factor.ln() - logs, factor)
    }

    /// Replaces `values`, zero where samples do not count, by their innovations over their standard
    /// deviations.
    pub fn whiten(&self, values: &mut [f64]) {
        let mut expected = vec![0.0; self.decays.len()];
        let gains = self.gains.chunks_exact(self.decays.len().max(1));
        for ((value, gains), deviation) in values.iter_mut().zip(gains).zip(&self.deviations) {
            let innovation = *value - expected.iter().sum::<f64>();
            *value = innovation / deviation;
            for ((state, gain), decay) in expected.iter_mut().zip(gains).zip(&self.decays) {
                *state = decay * (*state + gain * innovation);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::linear::Cholesky;

    /// White vectors of unit samples have products that are the inverse of the covariance: of
    /// `a^2 ln(L/d)` by Cholesky's factorisation, with a gap in the record.
    #[test]
    fn innovations_whiten_by_the_covariance() {
        let (white, pink, longest) = (0.7, 0.4, 40.0);
        let counts: Vec<bool> = (0..30).map(|index| !(12..15).contains(&index)).collect();
        let filter = Innovations::of((white, pink), longest, &counts);
        let known: Vec<usize> = (0..30).filter(|index| counts[*index]).collect();
        let covariance = |i: usize, j: usize| {
            let distance = known[i].abs_diff(known[j]) as f64;
            let of_pink = if i == j { longest.ln() + 1.5 } else { (longest / distance).ln() };
            pink * pink * of_pink + if i == j { white * white } else { 0.0 }
        };
        let matrix: Vec<Vec<f64>> = (0..known.len())
            .map(|i| (0..known.len()).map(|j| covariance(i, j)).collect())
            .collect();
        let inverse = Cholesky::of(&matrix).expect("positive").inverse();
        let columns: Vec<Vec<f64>> = known
            .iter()
            .map(|place| {
                let mut unit = vec![0.0; 30];
                unit[*place] = 1.0;
                filter.whiten(&mut unit);
                unit
            })
            .collect();
        for (i, a) in columns.iter().enumerate() {
            for (j, b) in columns.iter().enumerate() {
                let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                assert!(
                    (product - inverse[i][j]).abs() < 0.02,
                    "{i} {j}: {product} {}",
                    inverse[i][j]
                );
            }
        }
    }
}
