//! Quantisation error of averages. Below 0.5 levels of noise, errors of neighbouring samples are
//! correlated.
//!
//! A signal `x` with white normal noise `s` before the converter (levels) is shown as `x + e`; over
//! an unknown phase of `x` between levels,
//! `cov(e_i, e_j) = sum over k of a_k cos(2 pi k (x_i - x_j))`,
//! `a_k = exp(-4 pi^2 k^2 s^2)/(2 pi^2 k^2)`, beside a white rest. Without noise the sum is `1/12`,
//! from `s` = 0.35 on it is below 0.0004. Source: B. Widrow, I. Kollár, "Quantization Noise"
//! (Cambridge, 2008), chapters 4 and 5 (characteristic functions); Fourier series of the sawtooth.
//! Valid for signals that are known to a fraction of a level but for their zero.

use std::f64::consts::PI;

/// Harmonics of the sawtooth that are followed; what they leave counts as white.
const HARMONICS: u32 = 24;
/// Harmonics weaker than this variance are left out (1).
pub(super) const NEGLIGIBLE: f64 = 1e-7;
/// Variance of the rounding error's harmonic `k` for `noise` (levels) (1).
pub(super) fn harmonic(k: f64, noise: f64) -> f64 {
    (-(2.0 * PI * k * noise).powi(2)).exp() / (2.0 * PI * PI * k * k)
}

/// How an error is distributed: independent ones add up in both.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// Its variance (V^2).
    pub variance: f64,
    /// Its fourth cumulant, zero for a normal one (V^4).
    pub fourth_cumulant: f64,
}

impl Spread {
    /// A normal error of so many standard deviations (unit).
    pub fn normal(deviation: f64) -> Self {
        Self { variance: deviation * deviation, fourth_cumulant: 0.0 }
    }

    /// This error `factor` times.
    pub fn times(self, factor: f64) -> Self {
        let Self { variance, fourth_cumulant } = self;
        Self {
            variance: factor.powi(2) * variance,
            fourth_cumulant: factor.powi(4) * fourth_cumulant,
        }
    }

    /// This error and another, independent of it.
    pub fn plus(self, other: Self) -> Self {
        Self {
            variance: self.variance + other.variance,
            fourth_cumulant: self.fourth_cumulant + other.fourth_cumulant,
        }
    }
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
        let of = move |k: u32| (f64::from(k), harmonic(f64::from(k), ratio));
        let counts = move |(_, variance): &(f64, f64)| level > 0.0 && *variance > NEGLIGIBLE;
        (1..=HARMONICS).map(of).filter(counts).map(move |(k, v)| (k, v * level * level))
    }

    /// Variance of the rounding error that all samples of a signal at rest have in common (V^2).
    pub fn common(&self) -> f64 {
        self.harmonics().map(|(_, variance)| variance).sum()
    }

    /// Distribution of `sum of weights x errors` over samples of `signal`, each with its weight;
    /// harmonic by harmonic, each a sine of an unknown phase, and the rest white (V^2).
    pub fn spread(&self, samples: &[(f64, f64)]) -> Spread {
        let squares: f64 = samples.iter().map(|(weight, _)| weight * weight).sum();
        let white = (self.sample().powi(2) - self.common()).max(0.0);
        let together = |(k, variance): (f64, f64)| {
            let (mut cosines, mut sines) = (0.0, 0.0);
            for (weight, signal) in samples {
                let (sine, cosine) = (2.0 * PI * k * signal / self.level).sin_cos();
                cosines += weight * cosine;
                sines += weight * sine;
            }
            let variance = variance * (cosines * cosines + sines * sines);
            Spread { variance, fourth_cumulant: -1.5 * variance * variance }
        };
        let rest = Spread { variance: white * squares, fourth_cumulant: 0.0 };
        self.harmonics().map(together).fold(rest, Spread::plus)
    }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal, StandardUniform};
    use rand_pcg::Pcg64;

    use super::*;

    /// Means and slopes of rounded samples scatter as said: 4000 draws of the phase for a signal at
    /// rest and for a slow ramp.
    #[test]
    fn sums_of_rounded_samples_scatter_as_said() {
        let mut numbers = Pcg64::new(3, 5);
        for noise in [0.0, 0.1, 0.2, 0.35, 1.0] {
            for slope in [0.0, 0.004, 0.05] {
                let count: u32 = 200;
                let signal = |i: u32| slope * f64::from(i);
                let weight = |i: u32| (f64::from(i) - 70.0) / 200.0;
                let samples: Vec<(f64, f64)> = (0..count).map(|i| (weight(i), signal(i))).collect();
                let said = Rounding { level: 1.0, noise }.spread(&samples).variance;
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
                // Variances from 4000 draws are good to 2.2 %; distributions with flat tops to
                // less.
                let ratio = squares / 4000.0 / said;
                assert!((ratio - 1.0).abs() < 0.1, "noise {noise} slope {slope}: {ratio}");
            }
        }
    }
}
