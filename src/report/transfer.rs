//! A transfer function with its coherence as a page of text and as a picture.

use super::chart::{Under, charts_over};
use super::plot::{Curve, Label, braille};
use super::spectrum::band_marks;
use super::table;
use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::transfer::TransferFunction;
use crate::numeric::intervals::NORMAL_95;
use crate::quantity::engineering;

/// With band edges pictures end at this multiple of the highest (1).
const BAND_MARGIN: f64 = 1.5;
/// Without them they end at this frequency, the paper's audible range (Hz).
const SHOWN_FREQUENCY: f64 = 20e3;
/// Lowest gain that is drawn (dB).
const LOWEST_GAIN: f64 = -80.0;

/// A transfer function with what is known about the chain.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferPage {
    /// The signals and where they are from.
    pub title: String,
    /// The transfer function.
    pub found: TransferFunction,
    /// Shots that it is from.
    pub shots: usize,
    /// The window of its segments, in words.
    pub window: String,
    /// The chain around the sensors, where the recording tells.
    pub chain: Option<DiatomicChain>,
    /// Notes for the reader.
    pub notes: Vec<String>,
}

/// `|H|` on a logarithmic scale (dB).
pub fn decibels(gain: f64) -> f64 {
    20.0 * gain.log10()
}

impl TransferPage {
    /// Bands of the chain with their names and edges (Hz); one, up to the highest that is drawn,
    /// where the chain is not known.
    pub fn bands(&self) -> Vec<(&'static str, [f64; 2])> {
        match &self.chain {
            Some(chain) => {
                let (f1, f2, f3) = (chain.gap_bottom(), chain.gap_top(), chain.cutoff());
                if !chain.has_gap() {
                    return vec![("pass band", [0.0, f3])];
                }
                vec![
                    ("acoustic branch", [0.0, f1]),
                    ("gap", [f1, f2]),
                    ("optical branch", [f2, f3]),
                ]
            }
            None => vec![("up to 20 kHz", [0.0, SHOWN_FREQUENCY])],
        }
    }

    fn curve(&self, y: Label, of: &dyn Fn(usize) -> f64) -> Curve {
        let end = self.chain.map_or(SHOWN_FREQUENCY, |chain| BAND_MARGIN * chain.cutoff());
        // The mean of each segment is taken out.
        let bins = self.found.bins.iter().enumerate().skip(1);
        let bins = bins.take_while(|(_, bin)| bin.frequency <= end);
        Curve {
            points: bins.map(|(index, bin)| (bin.frequency, of(index))).collect(),
            marks: self.chain.iter().flat_map(band_marks).collect(),
            x: Label::new("frequency", "Hz"),
            y,
        }
    }

    fn gain_curve(&self, deviations: f64) -> Curve {
        let gain = |index: usize| {
            let bin = &self.found.bins[index];
            decibels((bin.gain + deviations * NORMAL_95 * bin.gain_u).max(0.0)).max(LOWEST_GAIN)
        };
        self.curve(Label::new("gain |H|", "dB"), &|index| gain(index).min(-LOWEST_GAIN))
    }

    fn coherence_curve(&self) -> Curve {
        self.curve(Label::new("coherence", ""), &|index| self.found.bins[index].coherence)
    }

    /// Gain with its expanded uncertainty and coherence over frequency, the gap's edges marked.
    pub fn picture(&self) -> String {
        let around = [-1.0, 1.0].map(|sign| self.gain_curve(sign).points).to_vec();
        let coherence = self.coherence_curve();
        let ends = coherence.points.first().zip(coherence.points.last());
        let limit = self.found.chance_coherence();
        let name = format!("5 % of unrelated signals are above {limit:.2}");
        let line = ends.map_or(Vec::new(), |(first, last)| vec![(first.0, limit), (last.0, limit)]);
        let around = vec![Under::new("95 %", around)];
        let limit = vec![Under::new(&name, vec![line])];
        charts_over(&[(self.gain_curve(0.0), around), (coherence, limit)], &self.title)
    }

    /// The page that `transfer` prints.
    pub fn text(&self) -> String {
        let found = &self.found;
        let hertz = |f: f64| engineering(f, "Hz", 4);
        let mut lines = vec![
            self.title.clone(),
            format!(
                "  averaged    {} segments of {} samples from {} shots, {} window, bins {} apart",
                found.segments,
                found.length,
                self.shots,
                self.window,
                hertz(found.step)
            ),
            format!(
                "  by chance   coherence of unrelated signals: {:.3} on average, above {:.3} in 5 % of the bins",
                1.0 / self.segments(),
                found.chance_coherence()
            ),
            String::new(),
        ];
        let mut rows =
            vec![["", "from", "to", "input power", "|H|", "coherence"].map(str::to_owned).to_vec()];
        for (name, [low, high]) in self.bands() {
            let Some(band) = found.between(low, high) else { continue };
            rows.push(vec![
                name.to_owned(),
                hertz(low),
                hertz(high),
                format!("{:.1} %", 100.0 * band.input_share),
                format!("{:.1} dB", decibels(band.gain)),
                format!("{:.3}", band.coherence),
            ]);
        }
        lines.extend(table::lines(&rows, &[0]));
        lines.push(String::new());
        lines.extend(braille(&self.gain_curve(0.0)));
        lines.push(String::new());
        lines.extend(braille(&self.coherence_curve()));
        lines.extend(self.notes.iter().map(|note| format!("  note        {note}")));
        lines.join("\n")
    }

    fn segments(&self) -> f64 {
        self.found.segments as f64
    }
}
