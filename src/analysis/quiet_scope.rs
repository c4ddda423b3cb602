//! Zero and noise of a quiet scope, from how often each code is shown.
//!
//! A signal at rest at `z` with noise `s` (levels) shows code `k` with the probability `P_k =
//! Phi((k + 1/2 - z)/s) - Phi((k - 1/2 - z)/s)`, and Bayes' rule with even priors of `z` and `ln s`
//! gives the distribution of both ([`AtRest`]). A single code leaves the zero anywhere within it,
//! but for the noise; two or more determine it to a fraction of the noise. Where the signal crosses
//! levels, its scatter about smooth curves shows the noise, too ([`MovingScatter`]): `s^2`, and
//! what the curves leave of the rounding error's harmonics ([`super::rounding`]).

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::rounding::{NEGLIGIBLE, Rounding, Spread, harmonic};
use crate::numeric::intervals::normal_share;

/// What the rounding error alone does to the variance of samples about a cubic, for one degree of
/// freedom: 8,000 simulated ones (levels^4).
const WAVE_SPREAD: f64 = 1.0 / 400.0;
/// Harmonics that are followed where the signal crosses levels (1).
const SCATTER_HARMONICS: usize = 6;
/// Noises that are tried: the lowest (levels), the ratio of neighbours (1) and their number, up to
/// where rounding errors are white.
const NOISES: (f64, f64, i32) = (0.0015, 1.23, 30);
/// Zeros that are tried on either side of the codes' mean, and their distance (levels).
const ZEROS: (i32, f64) = (120, 0.005);
/// Zeros closer together than this count as one (levels).
const ZERO_STEP: f64 = 0.04;
/// Least probability of a code: below it another cause is likelier than noise (1).
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

/// Zero of a signal at rest and noise in front of the converter, as its codes show them.
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
    /// True if all samples have the same code and none move, so that the noise is unknown.
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

    /// Distribution of the zero's error: even within the code if the noise is unknown.
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
}
