//! Which frequencies the pages of spectra show.

use super::{Page, ScreenState};
use crate::analysis::spectrum::Spectrum;
use crate::tui::axis::{DIVISIONS_ACROSS, Steps, TurnDirection};

/// Beyond the highest band edge so much more is shown (1).
const BAND_MARGIN: f64 = 1.4;
/// Without band edges this share of what was sampled (1).
const SHOWN_SHARE: f64 = 0.25;

impl ScreenState {
    /// The spectrum on screen, or the first one of the map.
    fn spectrum(&self) -> Option<&Spectrum> {
        match self.page {
            Page::Map => self.derived.map.as_ref()?.as_ref().ok()?.columns.first(),
            _ => self.derived.spectrum.as_ref()?.as_ref().ok(),
        }
    }

    /// Highest frequency that was sampled (Hz).
    fn highest(&self) -> Option<f64> {
        let spectrum = self.spectrum()?;
        Some(spectrum.step * spectrum.amplitude.len() as f64)
    }

    /// Lowest and highest frequency on screen, by default up to a little beyond the chain's highest
    /// band edge (Hz).
    pub fn band(&self) -> Option<(f64, f64)> {
        let sampled = self.highest()?;
        let chain = self.derived.chain.as_ref();
        let whole = chain
            .map_or(SHOWN_SHARE * sampled, |chain| (BAND_MARGIN * chain.cutoff()).min(sampled));
        // What was chosen for another trace may lie beyond this one's.
        let chosen = self.band.filter(|(_, high)| *high <= sampled * (1.0 + 1e-9));
        Some(chosen.unwrap_or((0.0, whole)))
    }

    /// Whether another band is shown than by default.
    pub fn is_band_zoomed(&self) -> bool {
        self.band.is_some()
    }

    /// The Hz/div knob; what stands `anchor` divisions right of the centre stays there.
    pub(super) fn zoom_band(&mut self, turn: TurnDirection, anchor: f64) {
        let (Some((low, high)), Some(spectrum), Some(sampled)) =
            (self.band(), self.spectrum(), self.highest())
        else {
            return;
        };
        let divisions = f64::from(DIVISIONS_ACROSS);
        let scale = (high - low) / divisions;
        let (finest, coarsest) = (spectrum.step, sampled / divisions);
        let next = Steps::OneTwoAndHalfFive.next(scale, turn).clamp(finest.min(coarsest), coarsest);
        let centre = f64::midpoint(low, high) + anchor * (scale - next);
        self.put_band(centre, next * divisions, sampled);
    }

    /// Moves the band by `divisions` to higher frequencies.
    pub(super) fn pan_band(&mut self, divisions: f64) {
        let (Some((low, high)), Some(sampled)) = (self.band(), self.highest()) else { return };
        let shift = divisions * (high - low) / f64::from(DIVISIONS_ACROSS);
        self.put_band(f64::midpoint(low, high) + shift, high - low, sampled);
    }

    /// Shows `width` around `centre`, inside of what was sampled.
    fn put_band(&mut self, centre: f64, width: f64, sampled: f64) {
        let low = (centre - width / 2.0).clamp(0.0, (sampled - width).max(0.0));
        self.band = Some((low, low + width));
    }

    /// Whether the page shows frequencies along its knob's axis.
    pub(super) fn shows_frequencies(&self) -> bool {
        matches!(self.page, Page::Spectrum | Page::Map)
    }
}
