//! What rounding to levels does to quantities that many samples make: on quiet scopes rounding errors go together.
//!
//! A signal `x` with white normal noise `s` before the converter (levels) is shown as `x + e`; over an unknown phase of `x` between levels,
//! `cov(e_i, e_j) = sum over k of a_k cos(2 pi k (x_i - x_j))`, `a_k = exp(-4 pi^2 k^2 s^2)/(2 pi^2 k^2)`, beside a white rest. Without noise the
//! sum is `1/12`, from `s` = 0.35 on it is below 0.0004.
//! Source: B. Widrow, I. Kollár, "Quantization Noise" (Cambridge, 2008), chapters 4 and 5 (characteristic functions); Fourier series of the
//! sawtooth. Valid for signals that are known to a fraction of a level but for their zero.
//!
//! Zero `z` and noise of a signal at rest follow from how often each code `k` is shown ([`at_rest`]): it has the probability
//! `P_k = Phi((k + 1/2 - z)/s) - Phi((k - 1/2 - z)/s)`, and Bayes' rule with even priors of `z` and `ln s` makes of the codes' likelihood a distribution of both. A single
//! code leaves the zero anywhere within it, but for the noise; two or more tell it to a fraction of the noise. Where the signal crosses levels fast, its scatter about a smooth
//! curve has the variance `s^2 + 1/12`, which tells the noise beside.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::quantity::coverage::normal_share;

/// Harmonics of the sawtooth that are followed; what they leave counts as white.
const HARMONICS: u32 = 24;
/// Harmonics weaker than this variance are left out (1).
const NEGLIGIBLE: f64 = 1e-7;
/// Noises that are tried: the lowest (levels), the ratio of neighbours (1) and their number, up to where rounding errors are white.
const NOISES: (f64, f64, i32) = (0.0015, 1.23, 30);
/// Zeros that are tried on either side of the codes' mean, and their distance (levels).
const ZEROS: (i32, f64) = (120, 0.005);
/// Least probability of a code: the normal distribution's own error (1).
const LEAST_PROBABILITY: f64 = 1e-7;

/// Probability that a signal `below` levels above a code's middle is shown as that code, for `noise` (levels) (1).
fn probability(below: f64, noise: f64) -> f64 {
    let share = normal_share((0.5 - below) / noise) - normal_share((-0.5 - below) / noise);
    share.max(LEAST_PROBABILITY)
}

fn noises() -> impl Iterator<Item = f64> {
    (0..NOISES.2).map(|number| NOISES.0 * NOISES.1.powi(number))
}

/// Scatter of samples where the signal crosses levels.
#[derive(Debug, Clone, Copy, Default)]
pub struct MovingScatter {
    /// Mean of the squared differences from a smooth curve (V^2).
    pub variance: f64,
    /// Their degrees of freedom (1).
    pub freedom: f64,
}

impl MovingScatter {
    /// Logarithm of its likelihood for `noise` in levels of `level` (unit): a variance's own scatters by the fourth moments of a normal and an even distribution.
    fn likelihood(&self, level: f64, noise: f64) -> f64 {
        if self.freedom <= 0.0 {
            return 0.0;
        }
        let square = noise * noise;
        let spread = (1.0 / 180.0 + square / 3.0 + 2.0 * square * square) / self.freedom;
        let off = self.variance / (level * level) - square - 1.0 / 12.0;
        -0.5 * (off * off / spread + spread.ln())
    }
}

/// Zero of a signal at rest, its standard uncertainty, and the noise in front of the converter, from rounded `values` `level` apart (unit); elsewhere the signal's
/// samples have this scatter.
pub fn at_rest(values: &[f64], level: f64, moving: MovingScatter) -> (f64, f64, Rounding) {
    let mut codes: BTreeMap<i64, f64> = BTreeMap::new();
    let first = values.first().copied().unwrap_or(0.0);
    for value in values {
        *codes.entry(((value - first) / level).round() as i64).or_default() += 1.0;
    }
    let count = values.len() as f64;
    let mean = codes.iter().map(|(code, times)| *code as f64 * times).sum::<f64>() / count;
    let likelihood = |zero: f64, noise: f64| -> f64 {
        codes.iter().map(|(code, n)| n * probability(zero - *code as f64, noise).ln()).sum()
    };
    let zeros = || (-ZEROS.0..=ZEROS.0).map(|number| mean + ZEROS.1 * f64::from(number));
    let all: Vec<(f64, f64, f64)> = noises()
        .map(|noise| (noise, moving.likelihood(level, noise)))
        .flat_map(|(noise, of_moving)| zeros().map(move |zero| (zero, noise, of_moving)))
        .map(|(zero, noise, of_moving)| (zero, noise, of_moving + likelihood(zero, noise)))
        .collect();
    let highest = all.iter().fold(f64::NEG_INFINITY, |high, (.., l)| high.max(*l));
    let over = |of: &dyn Fn(f64, f64) -> f64| {
        let weighed = all.iter().map(|(zero, noise, l)| (of(*zero, *noise), (l - highest).exp()));
        let (sum, weights) =
            weighed.fold((0.0, 0.0), |(s, w), (of, weight)| (s + weight * of, w + weight));
        sum / weights
    };
    let zero = over(&|zero, _| zero);
    let variance = over(&|other, _| (other - zero).powi(2)) + ZEROS.1 * ZEROS.1 / 12.0;
    let noise = over(&|_, noise| noise);
    (first + level * zero, level * variance.sqrt(), Rounding { level, noise: level * noise })
}

/// A digitiser's level and the noise in front of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    /// Distance of two levels; 0 for a trace that was never digitised (unit).
    pub level: f64,
    /// Standard deviation of the white noise before rounding (unit).
    pub noise: f64,
}

impl Rounding {
    /// Standard uncertainty of one sample, noise and rounding (unit).
    pub fn sample(&self) -> f64 {
        self.noise.hypot(self.level / 12f64.sqrt())
    }

    /// Number and variance of each harmonic that counts (unit^2).
    pub fn harmonics(&self) -> impl Iterator<Item = (f64, f64)> {
        let (level, ratio) = (self.level, self.noise / self.level);
        let of = move |k: u32| {
            let k = f64::from(k);
            (k, (-(2.0 * PI * k * ratio).powi(2)).exp() / (2.0 * PI * PI * k * k))
        };
        let counts = move |(_, variance): &(f64, f64)| level > 0.0 && *variance > NEGLIGIBLE;
        (1..=HARMONICS).map(of).filter(counts).map(move |(k, v)| (k, v * level * level))
    }

    /// Variance of the rounding error that all samples of a signal at rest have in common (V^2).
    pub fn common(&self) -> f64 {
        self.harmonics().map(|(_, variance)| variance).sum()
    }

    /// Variance of `sum of weights x errors` over samples of `signal`, each with its weight; harmonic by harmonic, and the rest white (V^2).
    pub fn variance(&self, samples: &[(f64, f64)]) -> f64 {
        let squares: f64 = samples.iter().map(|(weight, _)| weight * weight).sum();
        let white = (self.sample().powi(2) - self.common()).max(0.0);
        let together = |(k, variance): (f64, f64)| {
            let (mut cosines, mut sines) = (0.0, 0.0);
            for (weight, signal) in samples {
                let (sine, cosine) = (2.0 * PI * k * signal / self.level).sin_cos();
                cosines += weight * cosine;
                sines += weight * sine;
            }
            variance * (cosines * cosines + sines * sines)
        };
        white * squares + self.harmonics().map(together).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal, StandardUniform};
    use rand_pcg::Pcg64;

    use super::*;

    /// Zeros of signals at rest, anywhere between two levels: intervals of 1.96 standard uncertainties hold them, whatever the noise. Without noise the zero is evenly distributed
    /// within a code, of which they hold less or all.
    #[test]
    fn zeros_of_signals_at_rest_are_as_certain_as_said() {
        let mut numbers = Pcg64::new(3, 9);
        for noise in [0.001, 0.05, 0.1, 0.2, 0.35] {
            let mut inside = 0;
            for _ in 0..1000 {
                let zero: f64 = StandardUniform.sample(&mut numbers);
                let mut sample = || {
                    let deviate: f64 = StandardNormal.sample(&mut numbers);
                    (zero + noise * deviate).round()
                };
                let codes: Vec<f64> = (0..300).map(|_| sample()).collect();
                let (found, u, _) = at_rest(&codes, 1.0, MovingScatter::default());
                inside += i32::from((found - zero).abs() <= 1.96 * u);
            }
            println!("noise {noise}: {inside}");
            assert!((900..=1000).contains(&inside), "noise {noise}: {inside}");
        }
    }

    /// Means and slopes of rounded samples scatter as said: 4000 draws of the phase for a signal at rest and for a slow ramp.
    #[test]
    fn sums_of_rounded_samples_scatter_as_said() {
        let mut numbers = Pcg64::new(3, 5);
        for noise in [0.0, 0.1, 0.2, 0.35, 1.0] {
            for slope in [0.0, 0.004, 0.05] {
                let count: u32 = 200;
                let signal = |i: u32| slope * f64::from(i);
                let weight = |i: u32| (f64::from(i) - 70.0) / 200.0;
                let samples: Vec<(f64, f64)> = (0..count).map(|i| (weight(i), signal(i))).collect();
                let said = Rounding { level: 1.0, noise }.variance(&samples);
                let mut squares = 0.0;
                for _ in 0..4000 {
                    let phase: f64 = StandardUniform.sample(&mut numbers);
                    let error = |i: u32| {
                        let deviate: f64 = StandardNormal.sample(&mut numbers);
                        let x = signal(i) + phase;
                        weight(i) * ((x + noise * deviate).round() - x)
                    };
                    squares += (0..count).map(error).sum::<f64>().powi(2);
                }
                // Variances from 4000 draws are good to 2.2 %; distributions with flat tops to less.
                let ratio = squares / 4000.0 / said;
                assert!((ratio - 1.0).abs() < 0.1, "noise {noise} slope {slope}: {ratio}");
            }
        }
    }
}
