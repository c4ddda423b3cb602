//! What rounding to levels does to quantities that many samples make: on quiet scopes rounding
//! errors go together.
//!
//! A signal `x` with white normal noise `s` before the converter (levels) is shown as `x + e`; over
//! an unknown phase of `x` between levels,
//! `cov(e_i, e_j) = sum over k of a_k cos(2 pi k (x_i - x_j))`,
//! `a_k = exp(-4 pi^2 k^2 s^2)/(2 pi^2 k^2)`, beside a white rest. Without noise the sum is `1/12`,
//! from `s` = 0.35 on it is below 0.0004. Source: B. Widrow, I. Kollár, "Quantization Noise"
//! (Cambridge, 2008), chapters 4 and 5 (characteristic functions); Fourier series of the sawtooth.
//! Valid for signals that are known to a fraction of a level but for their zero.
//!
//! Zero `z` and noise of a signal at rest follow from how often each code `k` is shown
//! ([`AtRest`]): it has the probability `P_k = Phi((k + 1/2 - z)/s) - Phi((k - 1/2 - z)/s)`, and
//! Bayes' rule with even priors of `z` and `ln s` makes of the codes' likelihood a distribution of
//! both. A single code leaves the zero anywhere within it, but for the noise; two or more tell it
//! to a fraction of the noise. Where the signal crosses levels, its scatter about smooth curves
//! tells the noise beside ([`MovingScatter`]): `s^2`, and what the curves leave of the rounding
//! error's harmonics.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::numeric::intervals::normal_share;

/// Harmonics of the sawtooth that are followed; what they leave counts as white.
const HARMONICS: u32 = 24;
/// What the rounding error alone does to the variance of samples about a cubic, for one degree of
/// freedom: 8,000 simulated ones (levels^4).
const WAVE_SPREAD: f64 = 1.0 / 400.0;
/// Harmonics that are followed where the signal crosses levels (1).
const SCATTER_HARMONICS: usize = 6;
/// Harmonics weaker than this variance are left out (1).
const NEGLIGIBLE: f64 = 1e-7;
/// Noises that are tried: the lowest (levels), the ratio of neighbours (1) and their number, up to
/// where rounding errors are white.
const NOISES: (f64, f64, i32) = (0.0015, 1.23, 30);
/// Zeros that are tried on either side of the codes' mean, and their distance (levels).
const ZEROS: (i32, f64) = (120, 0.005);
/// Zeros closer together than this count as one (levels).
const ZERO_STEP: f64 = 0.04;
/// Least probability of a code: the normal distribution's own error (1).
const LEAST_PROBABILITY: f64 = 1e-7;

/// Probability that a signal `below` levels above a code's middle is shown as that code, for
/// `noise` (levels) (1).
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
    /// Sum of the squared differences from smooth curves (levels^2).
    squares: f64,
    /// Their degrees of freedom (1).
    freedom: f64,
    /// What the curves leave of waves of the rounding error's harmonics, of amplitude one (1).
    waves: [f64; SCATTER_HARMONICS],
}

impl MovingScatter {
    /// Of rounded `values` about a `curve` (levels); `leave` gives the sum of squares that curves
    /// of its kind leave of some values.
    pub fn of(values: &[f64], curve: &[f64], freedom: f64, leave: &dyn Fn(&[f64]) -> f64) -> Self {
        let wave = |index: usize| {
            let k = 2.0 * PI * (index + 1) as f64;
            let of = |f: fn(f64) -> f64| leave(&curve.iter().map(|x| f(k * x)).collect::<Vec<_>>());
            of(f64::sin) + of(f64::cos)
        };
        Self { squares: leave(values), freedom, waves: std::array::from_fn(wave) }
    }

    /// Together with another of the same noise.
    pub fn with(self, other: Self) -> Self {
        let wave = |index: usize| self.waves[index] + other.waves[index];
        Self {
            squares: self.squares + other.squares,
            freedom: self.freedom + other.freedom,
            waves: std::array::from_fn(wave),
        }
    }

    /// Logarithm of its likelihood for `noise` in levels. The rounding error's first harmonics
    /// follow the signal, what is left is white. A variance of normal noise scatters by `2 s^4`;
    /// between noise and rounding by `s^2/3`, times 12/8 since curves leave of the waves what they
    /// leave of no noise.
    fn likelihood(&self, noise: f64) -> f64 {
        if self.freedom <= 0.0 {
            return 0.0;
        }
        let square = noise * noise;
        let (mut white, mut waves) = (square + 1.0 / 12.0, 0.0);
        for (index, left) in self.waves.iter().enumerate() {
            let variance = harmonic((index + 1) as f64, noise);
            white -= variance;
            waves += variance * left;
        }
        let spread = (WAVE_SPREAD + 0.5 * square + 2.0 * square * square) / self.freedom;
        let off = (self.squares - waves) / self.freedom - white;
        -0.5 * (off * off / spread + spread.ln())
    }
}

/// Variance of the rounding error's harmonic `k` for `noise` (levels) (1).
fn harmonic(k: f64, noise: f64) -> f64 {
    (-(2.0 * PI * k * noise).powi(2)).exp() / (2.0 * PI * PI * k * k)
}

/// What the codes of a signal at rest tell of its zero and of the noise in front of the converter.
#[derive(Debug, Clone, PartialEq)]
pub struct AtRest {
    /// Distance of two levels (unit).
    level: f64,
    /// One of the codes (unit).
    origin: f64,
    /// Zeros above the origin and noises (levels), each pair with its probability (1).
    pairs: Vec<(f64, f64, f64)>,
    /// Mean of the zeros above the origin (levels).
    zero: f64,
    /// Whether nothing tells the noise: all samples have one code, and none move.
    is_noise_unknown: bool,
}

/// A zero that the codes allow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PossibleZero {
    /// How far it is above the one found (unit).
    pub off: f64,
    /// Its probability (1).
    pub weight: f64,
    /// The noise that goes with it (unit).
    noise: f64,
}

impl AtRest {
    /// From rounded `values` `level` apart (unit); elsewhere the signal's samples have the scatter
    /// `moving`.
    pub fn of(values: &[f64], level: f64, moving: MovingScatter) -> Self {
        let mut codes: BTreeMap<i64, f64> = BTreeMap::new();
        let origin = values.first().copied().unwrap_or(0.0);
        for value in values {
            *codes.entry(((value - origin) / level).round() as i64).or_default() += 1.0;
        }
        let count = values.len() as f64;
        let mean = codes.iter().map(|(code, times)| *code as f64 * times).sum::<f64>() / count;
        let likelihood = |zero: f64, noise: f64| -> f64 {
            codes.iter().map(|(code, n)| n * probability(zero - *code as f64, noise).ln()).sum()
        };
        let zeros = || (-ZEROS.0..=ZEROS.0).map(|number| mean + ZEROS.1 * f64::from(number));
        let mut pairs: Vec<(f64, f64, f64)> = noises()
            .map(|noise| (noise, moving.likelihood(noise)))
            .flat_map(|(noise, of_moving)| zeros().map(move |zero| (zero, noise, of_moving)))
            .map(|(zero, noise, of_moving)| (zero, noise, of_moving + likelihood(zero, noise)))
            .collect();
        let highest = pairs.iter().fold(f64::NEG_INFINITY, |high, (.., l)| high.max(*l));
        for (.., likelihood) in &mut pairs {
            *likelihood = (*likelihood - highest).exp();
        }
        pairs.retain(|(.., weight)| *weight > NEGLIGIBLE);
        let sum: f64 = pairs.iter().map(|(.., weight)| weight).sum();
        for (.., weight) in &mut pairs {
            *weight /= sum;
        }
        let is_noise_unknown = codes.len() == 1 && moving.freedom == 0.0;
        let mut rest = Self { level, origin, pairs, zero: 0.0, is_noise_unknown };
        rest.zero = rest.over(&|zero, _| zero);
        rest
    }

    /// Mean of something that depends on the zero and the noise (levels).
    fn over(&self, of: &dyn Fn(f64, f64) -> f64) -> f64 {
        self.pairs.iter().map(|(zero, noise, weight)| weight * of(*zero, *noise)).sum()
    }

    /// The zero (unit).
    pub fn zero(&self) -> f64 {
        self.origin + self.level * self.zero
    }

    /// How far the zero may be off: where nothing tells the noise, a single code says no more than
    /// that the zero lies somewhere in it.
    pub fn spread(&self) -> Spread {
        if self.is_noise_unknown {
            let variance = self.level.powi(2) / 12.0;
            return Spread { variance, fourth_cumulant: -1.2 * variance * variance };
        }
        let moment = |power: i32| self.over(&|zero, _| (zero - self.zero).powi(power));
        let square = moment(2);
        Spread {
            variance: self.level.powi(2) * (square + ZEROS.1 * ZEROS.1 / 12.0),
            fourth_cumulant: self.level.powi(4) * (moment(4) - 3.0 * square * square),
        }
    }

    /// The digitiser with its noise.
    pub fn rounding(&self) -> Rounding {
        Rounding { level: self.level, noise: self.level * self.over(&|_, noise| noise) }
    }

    /// The zeros that the codes allow, `ZERO_STEP` apart.
    pub fn zeros(&self) -> Vec<PossibleZero> {
        let mut bins: BTreeMap<i64, [f64; 3]> = BTreeMap::new();
        for (zero, noise, weight) in &self.pairs {
            let bin = ((zero - self.zero) / ZERO_STEP).round() as i64;
            let [sum, off, noises] = bins.entry(bin).or_default();
            *sum += weight;
            *off += weight * (zero - self.zero);
            *noises += weight * noise;
        }
        let one = |[weight, off, noise]: &[f64; 3]| PossibleZero {
            off: self.level * off / weight,
            weight: *weight,
            noise: self.level * noise / weight,
        };
        bins.values().map(one).collect()
    }

    /// By how much samples of `signal` above the zero (unit) are shown too high on average, where
    /// the zero is that one (unit).
    pub fn shown_too_high(&self, zero: &PossibleZero, signal: f64) -> f64 {
        let x = self.zero + (zero.off + signal) / self.level;
        let whole = x.floor();
        // Noise of a quiet scope reaches the nearest steps between levels and no others.
        let above = |step: f64| normal_share((x - whole - step) * self.level / zero.noise);
        self.level * (whole - 1.0 + above(-0.5) + above(0.5) + above(1.5) - x)
    }

    /// The same of a signal turned over.
    pub fn turned(mut self) -> Self {
        self.origin = -self.origin;
        self.zero = -self.zero;
        for (zero, ..) in &mut self.pairs {
            *zero = -*zero;
        }
        self
    }
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

    use crate::numeric::intervals::{even_half_width, expanded_95};

    use super::*;

    /// Zeros of signals at rest, anywhere between two levels: intervals of 95 % hold them, whatever
    /// the noise.
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
                let rest = AtRest::of(&codes, 1.0, MovingScatter::default());
                let (found, spread) = (rest.zero(), rest.spread());
                let u = spread.variance.sqrt();
                let half_width = even_half_width(u, spread.fourth_cumulant);
                inside += i32::from((found - zero).abs() <= expanded_95(u, half_width));
            }
            println!("noise {noise}: {inside}");
            assert!((900..=1000).contains(&inside), "noise {noise}: {inside}");
        }
    }

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
