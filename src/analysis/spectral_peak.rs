//! The lines of a spectrum: local maxima, each the top of a parabola through the logarithms of three bins.
//!
//! With `a`, `b`, `c` the logarithms around the highest bin `k`: `f = (k + s) / (N dt)`, `s = (a - c) / (2 (a - 2 b + c))`, height
//! `exp(b - (a - c) s / 4)`. Source: J. O. Smith, X. Serra, Proc. Int. Computer Music Conf. (1987). Exact for lines
//! of Gaussian shape, and the closer for others the more the record is padded; valid for lines by themselves, more than a main
//! lobe apart.

use super::spectrum::Spectrum;
use super::window::Window;

/// Side lobes reach this much farther than the main lobe before they are low enough, in resolutions (1).
const SIDE_LOBES: f64 = 1.0;

/// A local maximum of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralPeak {
    /// Where it is, interpolated between bins (Hz).
    pub frequency: f64,
    /// Bound of its error for a line by itself: the bin width, and the resolution for the flat top window, whose lines have no
    /// point on top. Lines closer than the resolution pull each other (Hz).
    pub uncertainty: f64,
    /// How high it is, interpolated between bins (unit).
    pub amplitude: f64,
    /// The highest bin.
    pub bin: usize,
}

impl Spectrum {
    /// Local maxima higher than `share` of the highest, highest first. What stands within a main lobe and a side lobe of a higher
    /// one is taken for part of it; zero frequency and half the sampling frequency are no maxima.
    pub fn peaks(&self, share: f64) -> Vec<SpectralPeak> {
        let mut found: Vec<SpectralPeak> = (1..self.amplitude.len().saturating_sub(1))
            .filter_map(|bin| self.peak_at(bin))
            .collect();
        found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        let floor = found.first().map_or(0.0, |highest| share * highest.amplitude);
        let apart = (self.window.half_lobe() + SIDE_LOBES) * self.resolution;
        let mut kept: Vec<SpectralPeak> = Vec::new();
        for peak in found.into_iter().take_while(|peak| peak.amplitude >= floor) {
            if kept.iter().all(|higher| (higher.frequency - peak.frequency).abs() > apart) {
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

    /// The maximum at `bin`, if there is one: the top of the parabola through the logarithms of three bins.
    fn peak_at(&self, bin: usize) -> Option<SpectralPeak> {
        let below = *self.amplitude.get(bin.checked_sub(1)?)?;
        let here = *self.amplitude.get(bin)?;
        let above = *self.amplitude.get(bin + 1)?;
        if here <= below || here < above {
            return None;
        }
        // A zero among the three has no logarithm: the bin itself is the answer then.
        let (shift, amplitude) = if below.min(above) > 0.0 {
            let (a, b, c) = (below.ln(), here.ln(), above.ln());
            let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
            (shift, (b - 0.25 * (a - c) * shift).exp())
        } else {
            (0.0, here)
        };
        let frequency = self.frequency(bin) + shift * self.step;
        let uncertainty = match self.window {
            Window::Rectangular | Window::Hann => self.step,
            Window::FlatTop => self.resolution,
        };
        Some(SpectralPeak { frequency, uncertainty, amplitude, bin })
    }
}
