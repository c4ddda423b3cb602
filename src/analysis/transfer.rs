//! How one signal follows another: transfer function and coherence, averaged over segments and
//! shots.
//!
//! With the spectra `X`, `Y` of each segment, its mean taken out and windowed, and means over all
//! `n` segments: `P_xx = <|X|^2>`, `P_yy = <|Y|^2>`, `P_xy = <X* Y>`; transfer function
//! `H = P_xy/P_xx`, coherence `g2 = |P_xy|^2/(P_xx P_yy)`, the share of the power of `y` that
//! follows `x` linearly. Standard uncertainty of `|H|`: `|H| sqrt((1 - g2)/(2 n g2))`; without any
//! relation `g2` is `1/n` on average, and above `1 - 0.05^(1/(n - 1))` in 5 % of all cases.
//! Segments do not overlap, so that they are independent. Sources: P. D. Welch, IEEE Trans. Audio
//! Electroacoust. 15, 70 (1967); J. S. Bendat, A. G. Piersol, "Random Data", 4th ed. (2010),
//! sections 9.2 and 11.5. Valid for segments longer than the delay from `x` to `y`.

use std::f64::consts::FRAC_1_SQRT_2;

use realfft::num_complex::Complex;

use super::fourier::Fourier;
use super::gate::Gate;
use super::spectrum::Window;
use crate::trace::Trace;

/// Fewest samples of a segment.
const MIN_SEGMENT: usize = 16;
/// Intervals and starts that differ by less than this, in samples, are the same (1).
const AXIS_TOLERANCE: f64 = 1e-6;

/// How a transfer function is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferSettings {
    /// Segments of each record.
    pub segments: usize,
    /// Window of each segment.
    pub window: Window,
    /// The part of the records that is looked at.
    pub gate: Gate,
}

/// Why there is no transfer function.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TransferError {
    /// Coherence needs an average.
    #[error(
        "found a single segment, whose coherence is 1 whatever the signals: give more shots, or --segments 2 or more"
    )]
    Single,
    /// Segments too short for a spectrum.
    #[error(
        "found {samples} samples a segment, expected at least {MIN_SEGMENT}: use fewer --segments, or a longer part of the records"
    )]
    TooShort {
        /// Samples of a segment.
        samples: usize,
    },
    /// Two time axes.
    #[error("found {first} and {second} on different time axes, expected records of one shot")]
    Axes {
        /// One signal.
        first: String,
        /// The other.
        second: String,
    },
    /// Records of different shots.
    #[error(
        "found {found} samples of {interval:e} s in one shot and {expected} of {expected_interval:e} s in the first, expected shots of one setting"
    )]
    Shots {
        /// Samples of the shot.
        found: usize,
        /// Interval of the shot (s).
        interval: f64,
        /// Samples of the first shot.
        expected: usize,
        /// Interval of the first shot (s).
        expected_interval: f64,
    },
    /// A value is not a number.
    #[error("found a value that is not finite in {trace}, expected numbers only")]
    NotFinite {
        /// The signal.
        trace: String,
    },
}

/// Averages of one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferBin {
    /// Frequency (Hz).
    pub frequency: f64,
    /// Mean power of the first signal (unit).
    pub input_power: f64,
    /// Mean power of the second signal (unit).
    pub output_power: f64,
    /// `|H|` (1).
    pub gain: f64,
    /// Its standard uncertainty; infinite where nothing is coherent (1).
    pub gain_u: f64,
    /// Phase of `H`, negative where the second signal is later (rad).
    pub phase: f64,
    /// Coherence (1).
    pub coherence: f64,
}

/// A transfer function.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    /// The bins from zero.
    pub bins: Vec<TransferBin>,
    /// Segments that were averaged.
    pub segments: usize,
    /// Samples of a segment.
    pub length: usize,
    /// From one bin to the next (Hz).
    pub step: f64,
}

/// What is in a band of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandTransfer {
    /// Root of the coherent output power over the input power (1).
    pub gain: f64,
    /// Coherence weighted with the output power (1).
    pub coherence: f64,
    /// Share of the input's whole power (1).
    pub input_share: f64,
}

/// The transfer function from the first signal of each pair to the second; each pair is one shot.
///
/// # Errors
/// [`TransferError`] for records that do not share their times, and where a single segment is left.
pub fn transfer(
    pairs: &[(Trace, Trace)],
    settings: TransferSettings,
) -> Result<TransferFunction, TransferError> {
    let count = pairs.len() * settings.segments;
    if count < 2 {
        return Err(TransferError::Single);
    }
    let mut fourier = Fourier::default();
    let mut sums: Vec<(f64, f64, Complex<f64>)> = Vec::new();
    let mut axis: Option<(usize, f64)> = None;
    for (x, y) in pairs {
        let range = settings.gate.range(x);
        check(x, y)?;
        let (expected, expected_interval) = *axis.get_or_insert((range.len(), x.interval));
        let is_same = (x.interval / expected_interval - 1.0).abs() < AXIS_TOLERANCE;
        if !is_same || range.len() != expected {
            let (found, interval) = (range.len(), x.interval);
            return Err(TransferError::Shots { found, interval, expected, expected_interval });
        }
        let length = range.len() / settings.segments;
        if length < MIN_SEGMENT {
            return Err(TransferError::TooShort { samples: length });
        }
        let weights: Vec<f64> = (0..length).map(|i| settings.window.weight(i, length)).collect();
        let mut spectrum = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / length as f64;
            let mut input: Vec<f64> =
                values.iter().zip(&weights).map(|(v, w)| (v - mean) * w).collect();
            fourier.forward(&mut input)
        };
        for segment in 0..settings.segments {
            let part = range.start + segment * length..range.start + (segment + 1) * length;
            let mut of =
                |trace: &Trace| spectrum(trace.values.get(part.clone()).unwrap_or_default());
            let (x, y) = (of(x), of(y));
            sums.resize(x.len(), (0.0, 0.0, Complex::default()));
            for (sum, (x, y)) in sums.iter_mut().zip(x.iter().zip(&y)) {
                *sum = (sum.0 + x.norm_sqr(), sum.1 + y.norm_sqr(), sum.2 + x.conj() * y);
            }
        }
    }
    let (samples, interval) = axis.unwrap_or((0, 1.0));
    let length = samples / settings.segments;
    let (n, step) = (count as f64, 1.0 / (length as f64 * interval));
    let bin = |(index, (xx, yy, xy)): (usize, &(f64, f64, Complex<f64>))| {
        let h = xy / xx;
        let coherence = if *yy > 0.0 && *xx > 0.0 { xy.norm_sqr() / (xx * yy) } else { 0.0 };
        TransferBin {
            frequency: index as f64 * step,
            input_power: xx / n,
            output_power: yy / n,
            gain: h.norm(),
            gain_u: h.norm()
                * FRAC_1_SQRT_2
                * ((1.0 - coherence).max(0.0) / (n * coherence)).sqrt(),
            phase: h.arg(),
            coherence,
        }
    };
    let bins = sums.iter().enumerate().map(bin).collect();
    Ok(TransferFunction { bins, segments: count, length, step })
}

fn check(x: &Trace, y: &Trace) -> Result<(), TransferError> {
    let apart = (x.start - y.start).abs() > AXIS_TOLERANCE * x.interval
        || (x.interval / y.interval - 1.0).abs() > AXIS_TOLERANCE;
    if apart || x.values.len() != y.values.len() {
        return Err(TransferError::Axes { first: x.name.clone(), second: y.name.clone() });
    }
    match [x, y].into_iter().find(|trace| trace.values.iter().any(|v| !v.is_finite())) {
        Some(trace) => Err(TransferError::NotFinite { trace: trace.name.clone() }),
        None => Ok(()),
    }
}

impl TransferFunction {
    /// Coherence that signals without any relation exceed in 5 % of all bins (1).
    pub fn chance_coherence(&self) -> f64 {
        1.0 - 0.05f64.powf(1.0 / (self.segments as f64 - 1.0))
    }

    /// What passes between two frequencies (Hz); none where no bin lies between.
    pub fn between(&self, low: f64, high: f64) -> Option<BandTransfer> {
        let sum = |of: &dyn Fn(&TransferBin) -> f64, low: f64, high: f64| -> f64 {
            let inside = |bin: &&TransferBin| (low..high).contains(&bin.frequency);
            self.bins.iter().skip(1).filter(inside).map(of).sum()
        };
        let input = sum(&|bin| bin.input_power, low, high);
        let output = sum(&|bin| bin.output_power, low, high);
        let coherent = sum(&|bin| bin.coherence * bin.output_power, low, high);
        (input > 0.0 && output > 0.0).then(|| BandTransfer {
            gain: (coherent / input).sqrt(),
            coherence: coherent / output,
            input_share: input / sum(&|bin| bin.input_power, 0.0, f64::INFINITY),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use super::*;

    fn trace(values: Vec<f64>) -> Trace {
        let (name, unit) = ("noise".to_owned(), "V".to_owned());
        Trace { name, unit, start: 0.0, interval: 1e-6, values }
    }

    fn noise(numbers: &mut Pcg64, count: usize) -> Vec<f64> {
        (0..count).map(|_| StandardNormal.sample(numbers)).collect()
    }

    const SETTINGS: TransferSettings =
        TransferSettings { segments: 10, window: Window::Hann, gate: Gate::ALL };

    /// White noise through `y[i] = a y[i - 1] + (1 - a) x[i]`, with noise of its own behind it:
    /// `H = (1 - a)/(1 - a exp(-i w))`, and the coherence is the share of the filtered noise's
    /// power.
    #[test]
    fn a_filter_comes_out_and_so_does_its_coherence() {
        let mut numbers = Pcg64::new(7, 1);
        let (a, s) = (0.7, 0.2);
        let pairs: Vec<(Trace, Trace)> = (0..40)
            .map(|_| {
                let x = noise(&mut numbers, 2560);
                let own = noise(&mut numbers, 2560);
                let mut y = 0.0;
                let through = x.iter().zip(&own).map(|(x, own)| {
                    y = a * y + (1.0 - a) * x;
                    y + s * own
                });
                let through = through.collect();
                (trace(x), trace(through))
            })
            .collect();
        let found = transfer(&pairs, SETTINGS).expect("a transfer function");
        assert_eq!((found.segments, found.length), (400, 256));
        let (mut off, mut count) = (0.0, 0.0);
        for bin in &found.bins[4..120] {
            let w = TAU * bin.frequency * 1e-6;
            let h = Complex::new(1.0 - a, 0.0) / (1.0 - a * Complex::new(0.0, -w).exp());
            let coherence = h.norm_sqr() / (h.norm_sqr() + s * s);
            off += ((bin.gain - h.norm()) / bin.gain_u).powi(2);
            count += 1.0;
            assert!((bin.coherence - coherence).abs() < 0.12, "{bin:?} {coherence}");
            assert!((bin.phase - h.arg()).abs() < 0.25, "{bin:?} {}", h.arg());
        }
        // Squares of normal numbers: 1 within a fifth for 116 bins, neighbours of which go
        // together.
        let variance: f64 = off / count;
        assert!((0.7..1.4).contains(&variance), "{variance}");
    }

    /// Noise that has nothing to do with noise: `1/n` on average, and 5 % of the bins above the
    /// limit of chance.
    #[test]
    fn independent_noise_has_a_coherence_of_one_over_n() {
        let mut numbers = Pcg64::new(7, 2);
        let pairs: Vec<(Trace, Trace)> = (0..2)
            .map(|_| (trace(noise(&mut numbers, 20_480)), trace(noise(&mut numbers, 20_480))))
            .collect();
        let settings = TransferSettings { window: Window::Rectangular, ..SETTINGS };
        let found = transfer(&pairs, settings).expect("a transfer function");
        let bins = &found.bins[1..found.bins.len() - 1];
        let mean = bins.iter().map(|bin| bin.coherence).sum::<f64>() / bins.len() as f64;
        // 1023 bins that scatter by 1/n each.
        assert!((mean * 20.0 - 1.0).abs() < 0.1, "{mean}");
        let above = bins.iter().filter(|bin| bin.coherence > found.chance_coherence()).count();
        assert!((30..=75).contains(&above), "{above} of {}", bins.len());
    }

    #[test]
    fn a_single_segment_and_two_axes_are_refused() {
        let one = (trace(vec![0.0; 64]), trace(vec![0.0; 64]));
        let single = TransferSettings { segments: 1, ..SETTINGS };
        assert_eq!(transfer(std::slice::from_ref(&one), single), Err(TransferError::Single));
        let later = (one.0.clone(), Trace { start: 1e-3, ..one.1.clone() });
        let two = TransferSettings { segments: 2, ..SETTINGS };
        assert!(matches!(transfer(&[later], two), Err(TransferError::Axes { .. })));
        let short = TransferSettings { segments: 8, ..SETTINGS };
        assert!(matches!(transfer(&[one], short), Err(TransferError::TooShort { .. })));
    }
}
