//! How a signal's spectrum changes with time: short pieces of it, one after the other.
//!
//! Piece `p` holds `segment` samples from sample `p hop` on; its time is that of its middle. A
//! piece of `segment dt` seconds separates frequencies `1/(segment dt)` apart and times `segment
//! dt` apart, and no choice of it gives both: their product is 1. Source: J. B. Allen, L. R.
//! Rabiner, Proc. IEEE 65, 1558 (1977). Valid while the signal changes little within a piece.

use super::gate::Gate;
use super::spectrum::{Analyser, LARGEST_TRANSFORM, Spectrum, SpectrumError, SpectrumSettings};
use crate::trace::Trace;

/// How a signal is cut into pieces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pieces {
    /// Samples of a piece.
    pub segment: usize,
    /// Samples from the start of one to the start of the next.
    pub hop: usize,
}

/// Pieces are at least this part of the record, and at most half of it.
const PIECES_PER_RECORD: usize = 16;
/// They move on by this part of themselves.
const HOPS_PER_PIECE: usize = 32;
/// Width of the Hann window's main lobe, in `1/(segment dt)`. Source: F. J. Harris, Proc. IEEE 66,
/// 51 (1978), Table 1.
const HANN_LOBE_WIDTH: f64 = 4.0;

impl Pieces {
    /// Pieces of a record of `samples` at `interval` (s): a sixteenth of it, or as long as it takes
    /// for a line to be no wider than `gap` (Hz), a chain's band gap, where there is one.
    pub fn of_record(samples: usize, interval: f64, gap: Option<f64>) -> Self {
        let for_gap = gap
            .filter(|gap| *gap > 0.0)
            .map_or(0, |gap| (HANN_LOBE_WIDTH / (gap * interval)) as usize);
        let segment = for_gap.max(samples / PIECES_PER_RECORD).min(samples / 2).max(2);
        Self::moving_on(segment)
    }

    /// Pieces of `segment` samples that move on by a thirty-second part of themselves.
    pub fn moving_on(segment: usize) -> Self {
        Self { segment, hop: (segment / HOPS_PER_PIECE).max(1) }
    }
}

/// Why there is no spectrogram.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpectrogramError {
    /// No piece fits.
    #[error(
        "segments of {segment} samples do not fit the {samples} samples between --from and --to: at least 2, and no longer than these"
    )]
    Segment {
        /// Samples of a piece.
        segment: usize,
        /// Samples inside the gate.
        samples: usize,
    },
    /// Pieces that do not move on.
    #[error("found a hop of 0 samples, expected at least 1")]
    Hop,
    /// A piece cannot be transformed.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
}

/// Spectra of the pieces of a signal, in order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrogram {
    /// Time of the middle of each piece (s).
    pub times: Vec<f64>,
    /// The spectrum of each piece.
    pub columns: Vec<Spectrum>,
}

impl Spectrogram {
    /// Cuts the gated part of `trace` into `pieces` and transforms each.
    ///
    /// # Errors
    /// [`SpectrogramError`] for pieces that do not fit or do not move on, and as
    /// [`Analyser::spectrum`].
    pub fn of(
        analyser: &mut Analyser,
        trace: &Trace,
        settings: &SpectrumSettings,
        pieces: Pieces,
    ) -> Result<Self, SpectrogramError> {
        let Pieces { segment, hop } = pieces;
        let range = settings.gate.range(trace);
        if segment < 2 || segment > range.len() {
            return Err(SpectrogramError::Segment { segment, samples: range.len() });
        }
        if hop == 0 {
            return Err(SpectrogramError::Hop);
        }
        let columns = (range.len() - segment) / hop + 1;
        let cells = columns.saturating_mul(segment.saturating_mul(settings.padding));
        if cells > LARGEST_TRANSFORM {
            let trace = trace.name.clone();
            return Err(SpectrumError::TooLong { trace, padded: cells }.into());
        }
        let whole = SpectrumSettings { gate: Gate::ALL, ..*settings };
        let mut spectrogram = Self { times: Vec::new(), columns: Vec::new() };
        for start in (range.start..=range.end - segment).step_by(hop) {
            let piece = Trace {
                name: trace.name.clone(),
                unit: trace.unit.clone(),
                start: trace.time(start),
                interval: trace.interval,
                values: trace.values.get(start..start + segment).unwrap_or_default().to_vec(),
            };
            spectrogram.times.push(0.5 * (piece.start + piece.time(segment - 1)));
            spectrogram.columns.push(analyser.spectrum(&piece, &whole)?);
        }
        Ok(spectrogram)
    }

    /// Where each column is highest between two frequencies (Hz), interpolated between bins; none
    /// where no maximum lies there (Hz).
    pub fn ridge(&self, low: f64, high: f64) -> Vec<Option<f64>> {
        let top = |column: &Spectrum| {
            let peaks = column.peaks(0.0).into_iter();
            peaks.map(|peak| peak.frequency).find(|f| (low..=high).contains(f))
        };
        self.columns.iter().map(top).collect()
    }
}
