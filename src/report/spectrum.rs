//! A spectrum as a page of text and as a curve.

use serde::{Serialize, Serializer};

use super::plot::{Plot, Series, Sheet, terminal};
use super::table;
use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::spectrum::{Convention, SpectralPeak, Spectrum};
use crate::quantity::engineering;

/// Without band edges the plot ends a little behind the last amplitude higher than this share of
/// the highest (1).
const SHOWN_SHARE: f64 = 0.01;
/// It ends at this multiple of that amplitude's frequency (1).
const SIGNAL_MARGIN: f64 = 1.1;
/// With band edges it ends at this multiple of the highest (1).
const BAND_MARGIN: f64 = 1.5;

/// A spectrum with what is known about the chain it comes from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpectrumPage {
    /// The name of the transformed signal.
    #[serde(rename = "signal")]
    pub title: String,
    /// Its spectrum.
    #[serde(flatten)]
    pub spectrum: Spectrum,
    /// The maxima to list.
    pub peaks: Vec<ListedPeak>,
    /// The chain around the sensor, if the recording has a scene.
    #[serde(flatten, serialize_with = "band_edges")]
    pub chain: Option<DiatomicChain>,
    /// The offset subtracted from every sample (unit).
    pub offset: f64,
    /// Notes for the reader.
    pub notes: Vec<String>,
}

/// A maximum of a spectrum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ListedPeak {
    /// Frequency (Hz).
    pub frequency_hz: f64,
    /// Its standard uncertainty (Hz).
    pub u_hz: f64,
    /// Its expanded uncertainty for 95 % (Hz).
    #[serde(rename = "U95_hz")]
    pub expanded_hz: f64,
    /// Amplitude (unit).
    pub amplitude: f64,
    /// The chain's band that it lies in.
    pub band: Option<&'static str>,
}

impl ListedPeak {
    /// `peak` with its band in `chain`.
    pub fn new(peak: &SpectralPeak, chain: Option<&DiatomicChain>) -> Self {
        let frequency = peak.uncertain();
        Self {
            frequency_hz: peak.frequency,
            u_hz: frequency.u,
            expanded_hz: frequency.expanded(),
            amplitude: peak.amplitude,
            band: chain.map(|chain| band(chain, peak.frequency)),
        }
    }
}

/// The chain's band edges (Hz) as fields `f1_hz` to `f3_hz`, null without a chain.
#[allow(clippy::ref_option, reason = "the signature that serde calls")]
pub(super) fn band_edges<S: Serializer>(
    chain: &Option<DiatomicChain>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    type Edge = fn(&DiatomicChain) -> f64;
    let edges: [(_, Edge); 3] = [
        ("f1_hz", DiatomicChain::gap_bottom),
        ("f2_hz", DiatomicChain::gap_top),
        ("f3_hz", DiatomicChain::cutoff),
    ];
    serializer.collect_map(edges.map(|(name, edge)| (name, chain.as_ref().map(edge))))
}

/// Which band of `chain` a frequency (Hz) lies in.
fn band(chain: &DiatomicChain, frequency: f64) -> &'static str {
    if !chain.has_gap() {
        if frequency <= chain.cutoff() { "pass band" } else { "above the cut-off" }
    } else if frequency <= chain.gap_bottom() {
        "acoustic branch"
    } else if frequency < chain.gap_top() {
        "gap"
    } else if frequency <= chain.cutoff() {
        "optical branch"
    } else {
        "above the optical branch"
    }
}

/// The band edges of `chain` as marks of a plot over frequency.
pub(super) fn band_marks(chain: &DiatomicChain) -> Vec<(f64, String)> {
    let named = |(name, frequency): (&str, f64)| {
        let what = match name {
            "f1" => "f1, the gap's lower edge",
            "f2" => "f2, the gap's upper edge",
            _ if chain.has_gap() => "f3, top of the optical branch",
            _ => "f3, the cut-off",
        };
        (frequency, format!("{what}: {}", engineering(frequency, "Hz", 4)))
    };
    chain.edges().into_iter().map(named).collect()
}

/// Highest frequency that pictures of `spectra` show: a little more than the chain's highest band
/// edge, or than the last amplitude that reaches a hundredth of the highest (Hz).
pub fn shown_end(spectra: &[Spectrum], chain: Option<&DiatomicChain>) -> f64 {
    let step = spectra.first().map_or(0.0, |spectrum| spectrum.step);
    let end = if let Some(chain) = chain {
        BAND_MARGIN * chain.cutoff()
    } else {
        let values = spectra.iter().flat_map(|spectrum| &spectrum.amplitude);
        let top = values.copied().fold(0.0, f64::max);
        let last = |spectrum: &Spectrum| {
            let is_shown = |a: &f64| *a >= SHOWN_SHARE * top;
            spectrum.frequency(spectrum.amplitude.iter().rposition(is_shown).unwrap_or(0))
        };
        SIGNAL_MARGIN * spectra.iter().map(last).fold(0.0, f64::max)
    };
    end.max(2.0 * step)
}

impl SpectrumPage {
    /// The spectrum from zero to where little is left, with the band edges marked.
    pub fn plot(&self) -> Plot {
        let spectrum = &self.spectrum;
        let end = shown_end(std::slice::from_ref(spectrum), self.chain.as_ref());
        let points = spectrum.amplitude.iter().enumerate();
        let points = points.map(|(bin, a)| (spectrum.frequency(bin), *a));
        let points = points.take_while(|(f, _)| *f <= end).collect();
        let y = match spectrum.convention {
            Convention::Paper => "amplitude, |X|/M",
            Convention::Density => "amplitude density",
        };
        Plot::fitted(["frequency", "Hz"], [y, &spectrum.unit], vec![Series::main(points)])
            .with_marks(self.chain.iter().flat_map(band_marks).collect())
    }

    /// The picture.
    pub fn picture(&self) -> Sheet {
        Sheet::stack(self.title.as_str(), vec![self.plot()])
    }

    /// The page that `spectrum` prints.
    pub fn text(&self) -> String {
        let spectrum = &self.spectrum;
        let hertz = |f: f64| engineering(f, "Hz", 4);
        let mut lines = vec![
            self.title.clone(),
            format!("  amplitude   {}, in {}", spectrum.convention, spectrum.unit),
            format!(
                "  record      M = {} samples, {} window, padded with zeros to N = {}",
                spectrum.samples, spectrum.window, spectrum.padded
            ),
            format!(
                "  frequency   bins {} apart, resolution {}",
                hertz(spectrum.step),
                hertz(spectrum.resolution)
            ),
        ];
        if self.offset != 0.0 {
            let offset = engineering(self.offset, &spectrum.unit, 4);
            lines.push(format!("  offset      {offset} subtracted from every sample"));
        }
        lines.push("  peaks       largest first; ± is the expanded uncertainty (95 %)".to_owned());
        lines.push(String::new());
        lines.extend(self.peak_lines());
        lines.push(String::new());
        lines.extend(terminal(&self.plot()));
        lines.extend(self.notes.iter().map(|note| format!("  note        {note}")));
        lines.join("\n")
    }

    fn peak_lines(&self) -> Vec<String> {
        let unit = &self.spectrum.unit;
        let mut heading = vec!["peak".to_owned(), "±".to_owned(), "amplitude".to_owned()];
        heading.extend(self.chain.map(|_| "where".to_owned()));
        let mut rows = vec![heading];
        rows.extend(self.peaks.iter().map(|peak| {
            let mut row = vec![
                engineering(peak.frequency_hz, "Hz", 4),
                engineering(peak.expanded_hz, "Hz", 2),
                engineering(peak.amplitude, unit, 3),
            ];
            row.extend(peak.band.map(str::to_owned));
            row
        }));
        table::lines(&rows, &[3])
    }
}
