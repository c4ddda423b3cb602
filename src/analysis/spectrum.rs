//! Amplitude spectra.
//!
//! Stands behind `recording` and `experiment`: a [`Trace`] in, amplitudes over frequency out. Two
//! conventions:
//!
//! - The paper's: `C[k] = |X[k]| / M`,
//!   `X[k] = sum over j from 0 to N - 1 of x[j] exp(-2 pi i j k/N)`, at `f[k] = k/(N dt)`. `M` is
//!   the number of samples of the record inside the gate, spaced `dt`; `N = padding M` its length
//!   after zeros were put behind it, 5 times as long in the paper. Only the coefficients of
//!   positive frequencies are kept, and not doubled: `C[0]` is the mean over the record, and a
//!   lasting sine of amplitude `A` makes a line `A/2` high. A pulse's coefficients fall as the
//!   record gets longer, since `M` counts the silence behind it too: only records of one length may
//!   be compared. With a window `w` other than the rectangular one, `M` becomes `sum of w`, so that
//!   lines keep their height. Source: Herbold et al. (2009), Eq. (11) and the text below it; in
//!   that equation indices count from 1.
//! - The density: `S[k] = sqrt(c dt / sum of w^2) |X[k]|`, `c = 2` except at zero and at half the
//!   sampling frequency, where it is 1: the root of the one-sided power spectral density.
//!   `sum of S[k]^2 / (N dt)` is the mean square of the windowed record (Parseval). Noise keeps its
//!   height whatever the record's length; lines grow with its root. Source: G. Heinzel, A.
//!   Ruediger, R. Schilling, MPI report (2002), Eqs (23) and (24).
//!
//! Valid below half the sampling frequency; what the signal holds above that is folded down and
//! cannot be separated.
//!
//! Windows: what a record is multiplied with before it is transformed.
//!
//! A record cut out of a longer signal has ends that do not meet; a window takes them to zero, and
//! pays with wider lines. All windows here are periodic cosine sums,
//! `w[i] = sum over j of (-1)^j a[j] cos(2 pi j i/M)`, `i` from 0 to `M - 1`. Source: F. J. Harris,
//! Proc. IEEE 66, 51 (1978); flat top: G. Heinzel, A. Ruediger, R. Schilling, MPI report (2002),
//! the five-term window that Matlab and `SciPy` call `flattop`. Valid for any record of at least
//! two samples.
//!
//! The lines of a spectrum: local maxima, each the top of a parabola through the logarithms of
//! three bins.
//!
//! With `a`, `b`, `c` the logarithms around the highest bin `k`: `f = (k + s) / (N dt)`,
//! `s = (a - c) / (2 (a - 2 b + c))`, height `exp(b - (a - c) s / 4)`. Source: J. O. Smith, X.
//! Serra, Proc. Int. Computer Music Conf. (1987). Exact for lines of Gaussian shape, and the closer
//! for others the more the record is padded; valid for lines by themselves, more than a main lobe
//! apart.

use std::f64::consts::TAU;
use std::fmt;

use serde::{Serialize, Serializer};

use super::fourier::Fourier;
use super::gate::Gate;
use crate::numeric::roots::vertex;
use crate::quantity::Uncertain;
use crate::trace::Trace;

/// Ratio `N/M` of the paper.
pub const PAPER_PADDING: usize = 5;

/// Convention of a spectrum's ordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Convention {
    /// `|X[k]|/M`, as in the paper.
    #[default]
    Paper,
    /// Root of the one-sided power spectral density.
    Density,
}

impl fmt::Display for Convention {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Paper => "|X|/M, Herbold et al. (2009), Eq. (11)",
            Self::Density => "one-sided amplitude spectral density",
        })
    }
}

/// How a spectrum is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrumSettings {
    /// Convention of the ordinate.
    pub convention: Convention,
    /// The window function.
    pub window: Window,
    /// `N/M`: how many times as long the record is made with zeros.
    pub padding: usize,
    /// The part of the record that is looked at.
    pub gate: Gate,
    /// Subtracted from every sample first, such as the static force (unit).
    pub offset: f64,
}

impl Default for SpectrumSettings {
    /// As in the paper: no window, five times as long, everything.
    fn default() -> Self {
        Self {
            convention: Convention::Paper,
            window: Window::Rectangular,
            padding: PAPER_PADDING,
            gate: Gate::ALL,
            offset: 0.0,
        }
    }
}

/// Most samples of a transform, padding included: it needs forty bytes for each.
pub const LARGEST_TRANSFORM: usize = 1 << 24;

/// Why there is no spectrum.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpectrumError {
    /// Nothing to transform.
    #[error("found {samples} samples of {trace} inside the gate, expected at least 2")]
    TooShort {
        /// The trace's name.
        trace: String,
        /// Samples inside the gate.
        samples: usize,
    },
    /// More than is transformed at once.
    #[error(
        "found {padded} samples of {trace} with padding, expected at most {LARGEST_TRANSFORM}: take a part of it (--from, --to), or less padding"
    )]
    TooLong {
        /// The trace's name.
        trace: String,
        /// Samples with padding.
        padded: usize,
    },
    /// A value is not a number.
    #[error("found a value that is not finite in {trace} at {time:e} s, expected numbers only")]
    NotFinite {
        /// The trace's name.
        trace: String,
        /// Where it stands (s).
        time: f64,
    },
    /// A time axis that does not go on.
    #[error("found a sample interval of {interval:e} s in {trace}, expected one above zero")]
    Interval {
        /// The trace's name.
        trace: String,
        /// The interval (s).
        interval: f64,
    },
    /// The padding is below one.
    #[error("found a padding of {padding}, expected 1 (none) or more")]
    Padding {
        /// `N/M`.
        padding: usize,
    },
}

/// Amplitudes at evenly spaced frequencies from zero.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spectrum {
    /// Unit of the amplitudes, `N` or `N/sqrt(Hz)`.
    pub unit: String,
    /// Convention of the amplitudes.
    pub convention: Convention,
    /// Window of the record.
    pub window: Window,
    /// From one bin to the next, `1/(N dt)` (Hz).
    #[serde(rename = "step_hz")]
    pub step: f64,
    /// Resolution, the least distance of two separate lines, `1/(M dt)` (Hz).
    #[serde(rename = "resolution_hz")]
    pub resolution: f64,
    /// Samples of the record, `M`.
    pub samples: usize,
    /// Length after padding, `N`.
    pub padded: usize,
    /// Amplitude of each bin (unit).
    pub amplitude: Vec<f64>,
}

/// Makes spectra; keeps what it has worked out for a record's length, so one of them serves for
/// many records.
#[derive(Default)]
pub struct Analyser {
    fourier: Fourier,
}

impl Analyser {
    /// One that has worked out nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The spectrum of `trace`.
    ///
    /// # Errors
    /// [`SpectrumError`] for fewer than two samples in the gate, samples that are no numbers, a
    /// padding of zero.
    pub fn spectrum(
        &mut self,
        trace: &Trace,
        settings: &SpectrumSettings,
    ) -> Result<Spectrum, SpectrumError> {
        let range = settings.gate.range(trace);
        let record = trace.values.get(range.clone()).unwrap_or_default();
        check(trace, settings, range.start, record)?;
        let samples = record.len();
        let padded = samples * settings.padding;
        let weights: Vec<f64> = (0..samples).map(|i| settings.window.weight(i, samples)).collect();
        let mut input: Vec<f64> =
            record.iter().zip(&weights).map(|(x, w)| (x - settings.offset) * w).collect();
        input.resize(padded, 0.0);
        let modulus = self.fourier.forward(&mut input).iter().map(|x| x.re.hypot(x.im)).collect();
        let (m, n) = (samples as f64, padded as f64);
        let amplitude = scaled(modulus, settings.convention, &weights, trace.interval, padded);
        Ok(Spectrum {
            unit: match settings.convention {
                Convention::Paper => trace.unit.clone(),
                Convention::Density => format!("{}/sqrt(Hz)", trace.unit),
            },
            convention: settings.convention,
            window: settings.window,
            step: 1.0 / (n * trace.interval),
            resolution: 1.0 / (m * trace.interval),
            samples,
            padded,
            amplitude,
        })
    }
}

fn check(
    trace: &Trace,
    settings: &SpectrumSettings,
    start: usize,
    record: &[f64],
) -> Result<(), SpectrumError> {
    let name = || trace.name.clone();
    if !(trace.interval > 0.0 && trace.interval.is_finite()) {
        return Err(SpectrumError::Interval { trace: name(), interval: trace.interval });
    }
    if settings.padding == 0 {
        return Err(SpectrumError::Padding { padding: settings.padding });
    }
    if record.len() < 2 {
        return Err(SpectrumError::TooShort { trace: name(), samples: record.len() });
    }
    // The product cannot overflow where it is below the limit.
    let padded = record.len().saturating_mul(settings.padding);
    if padded > LARGEST_TRANSFORM {
        return Err(SpectrumError::TooLong { trace: name(), padded });
    }
    if let Some(at) = record.iter().position(|x| !x.is_finite()) {
        return Err(SpectrumError::NotFinite { trace: name(), time: trace.time(start + at) });
    }
    Ok(())
}

fn scaled(
    modulus: Vec<f64>,
    convention: Convention,
    weights: &[f64],
    interval: f64,
    padded: usize,
) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    let squares: f64 = weights.iter().map(|w| w * w).sum();
    let factor = |bin: usize| match convention {
        Convention::Paper => 1.0 / sum,
        Convention::Density => {
            let sides = if bin == 0 || 2 * bin == padded { 1.0 } else { 2.0 };
            (sides * interval / squares).sqrt()
        }
    };
    modulus.into_iter().enumerate().map(|(bin, x)| x * factor(bin)).collect()
}

impl Spectrum {
    /// Frequency of bin `bin` (Hz).
    pub fn frequency(&self, bin: usize) -> f64 {
        bin as f64 * self.step
    }
}

/// A window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Window {
    /// None: the samples as they are, as the paper takes them. Right for pulses that end before the
    /// record does.
    #[default]
    Rectangular,
    /// Raised cosine: for lines close to each other in a signal that goes on.
    Hann,
    /// Flat top: reads a line's height to 0.05 %, wherever it falls between bins, and blurs it over
    /// ten of them.
    FlatTop,
}

const RECTANGULAR: [f64; 1] = [1.0];
const HANN: [f64; 2] = [0.5, 0.5];
const FLAT_TOP: [f64; 5] =
    [0.215_578_95, 0.416_631_58, 0.277_263_158, 0.083_578_947, 0.006_947_368];

impl Window {
    /// All windows.
    pub const ALL: [Self; 3] = [Self::Rectangular, Self::Hann, Self::FlatTop];

    /// Amplitudes of the cosines.
    fn terms(self) -> &'static [f64] {
        match self {
            Self::Rectangular => &RECTANGULAR,
            Self::Hann => &HANN,
            Self::FlatTop => &FLAT_TOP,
        }
    }

    /// The weight of sample `index` of `length` (1).
    pub fn weight(self, index: usize, length: usize) -> f64 {
        let angle = TAU * index as f64 / length.max(1) as f64;
        let mut sum = 0.0;
        let (mut order, mut sign) = (0.0, 1.0);
        for term in self.terms() {
            sum += sign * term * (order * angle).cos();
            order += 1.0;
            sign = -sign;
        }
        sum
    }

    /// Half the width of a line's main lobe, in units of the resolution `1/(M dt)` (1).
    pub fn half_lobe(self) -> f64 {
        match self {
            Self::Rectangular => 1.0,
            Self::Hann => 2.0,
            Self::FlatTop => 5.0,
        }
    }
}

impl Serialize for Convention {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl Serialize for Window {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rectangular => "rectangular",
            Self::Hann => "Hann",
            Self::FlatTop => "flat top",
        })
    }
}

/// The first side lobe of a rectangular window has 0.217 of its line's amplitude, those of the
/// others less (1).
const MAX_SIDE_LOBE: f64 = 0.25;
/// Side lobes reach this much farther than the main lobe before they are low enough, in resolutions
/// (1).
const SIDE_LOBES: f64 = 1.0;

/// A local maximum of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralPeak {
    /// Where it is, interpolated between bins (Hz).
    pub frequency: f64,
    /// Bound of its error for a line by itself, anywhere within which the line may be: the bin
    /// width, and the resolution for the flat top window, whose lines have no point on top. Lines
    /// closer than the resolution pull each other (Hz).
    pub bound: f64,
    /// How high it is, interpolated between bins (unit).
    pub amplitude: f64,
    /// The highest bin.
    pub bin: usize,
}

impl SpectralPeak {
    /// The frequency with its uncertainty (Hz).
    pub fn uncertain(&self) -> Uncertain {
        Uncertain { value: self.frequency, u: self.bound / 3f64.sqrt(), half_width: self.bound }
    }
}

impl Spectrum {
    /// Local maxima higher than `share` of the highest, highest first. What stands within the main
    /// lobe of a higher one, or is as small as a side lobe beside it, is taken for part of it; zero
    /// frequency and half the sampling frequency are no maxima.
    pub fn peaks(&self, share: f64) -> Vec<SpectralPeak> {
        let mut found: Vec<SpectralPeak> = (1..self.amplitude.len().saturating_sub(1))
            .filter_map(|bin| self.peak_at(bin))
            .collect();
        found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        let floor = found.first().map_or(0.0, |highest| share * highest.amplitude);
        let half_lobe = self.window.half_lobe() * self.resolution;
        let apart = half_lobe + SIDE_LOBES * self.resolution;
        let mut kept: Vec<SpectralPeak> = Vec::new();
        for peak in found.into_iter().take_while(|peak| peak.amplitude >= floor) {
            let is_apart = |higher: &SpectralPeak| {
                let distance = (higher.frequency - peak.frequency).abs();
                let is_side_lobe = peak.amplitude < MAX_SIDE_LOBE * higher.amplitude;
                distance > if is_side_lobe { apart } else { half_lobe }
            };
            if kept.iter().all(is_apart) {
                kept.push(peak);
            }
        }
        kept
    }

    /// The highest bin between two frequencies (Hz), both included, and its amplitude.
    pub fn highest_between(&self, low: f64, high: f64) -> Option<(usize, f64)> {
        let inside = |bin: &usize| (low..=high).contains(&self.frequency(*bin));
        let bins = (0..self.amplitude.len()).filter(inside);
        let heights = bins.filter_map(|bin| Some((bin, *self.amplitude.get(bin)?)));
        heights.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The maximum at `bin`, if there is one: the top of the parabola through the logarithms of
    /// three bins.
    fn peak_at(&self, bin: usize) -> Option<SpectralPeak> {
        let below = *self.amplitude.get(bin.checked_sub(1)?)?;
        let here = *self.amplitude.get(bin)?;
        let above = *self.amplitude.get(bin + 1)?;
        if here <= below || here < above {
            return None;
        }
        // A zero among the three has no logarithm: the bin itself is the answer then.
        let logarithms = [below, here, above].map(f64::ln);
        let top = vertex(logarithms).filter(|_| below.min(above) > 0.0);
        let (shift, amplitude) = top.map_or((0.0, here), |(shift, top)| (shift, top.exp()));
        let frequency = self.frequency(bin) + shift * self.step;
        let bound = match self.window {
            Window::Rectangular | Window::Hann => self.step,
            Window::FlatTop => self.resolution,
        };
        Some(SpectralPeak { frequency, bound, amplitude, bin })
    }
}
