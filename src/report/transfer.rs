//! A transfer function with its coherence as a page of text and as a picture.

use serde::{Serialize, Serializer};

use super::plot::{Axis, Plot, Series, Sheet, terminal};
use super::spectrum::{band_edges, band_marks};
use super::table;
use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::transfer::{TransferBin, TransferFunction};
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
    /// The chain around the sensors, if the recording has a scene.
    pub chain: Option<DiatomicChain>,
    /// Notes for the reader.
    pub notes: Vec<String>,
}

/// The transfer function in one band of frequencies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BandRow {
    /// Name of the band.
    pub name: &'static str,
    /// Lower edge (Hz).
    pub from_hz: f64,
    /// Upper edge (Hz).
    pub to_hz: f64,
    /// Share of the input's power (1).
    pub input_share: f64,
    /// Gain `|H|` (1).
    pub gain: f64,
    /// The same in decibels; `None` for a gain of zero (dB).
    pub gain_db: Option<f64>,
    /// Coherence (1).
    pub coherence: f64,
}

impl Serialize for TransferPage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Fields<'a> {
            signals: &'a str,
            shots: usize,
            segments: usize,
            samples: usize,
            window: &'a str,
            step_hz: f64,
            chance_coherence: f64,
            bands: Vec<BandRow>,
            gain: Vec<f64>,
            gain_u: Vec<Option<f64>>,
            phase_rad: Vec<f64>,
            coherence: Vec<f64>,
            notes: &'a [String],
            #[serde(flatten, serialize_with = "band_edges")]
            chain: Option<DiatomicChain>,
        }
        let found = &self.found;
        let column = |of: fn(&TransferBin) -> f64| found.bins.iter().map(of).collect();
        // Without any coherence the gain is unknown.
        let gain_u = found.bins.iter().map(|bin| Some(bin.gain_u).filter(|u| *u < f64::INFINITY));
        Fields {
            signals: &self.title,
            shots: self.shots,
            segments: found.segments,
            samples: found.length,
            window: &self.window,
            step_hz: found.step,
            chance_coherence: found.chance_coherence(),
            bands: self.rows(),
            gain: column(|bin| bin.gain),
            gain_u: gain_u.collect(),
            phase_rad: column(|bin| bin.phase),
            coherence: column(|bin| bin.coherence),
            notes: &self.notes,
            chain: self.chain,
        }
        .serialize(serializer)
    }
}

/// Room below the lowest gain in the picture (dB).
const GAIN_MARGIN: f64 = 10.0;

/// `|H|` on a logarithmic scale (dB).
fn decibels(gain: f64) -> f64 {
    20.0 * gain.log10()
}

impl TransferPage {
    /// Bands of the chain with their names and edges (Hz); one, up to the highest that is drawn,
    /// where the chain is not known.
    fn bands(&self) -> Vec<(&'static str, [f64; 2])> {
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

    fn rows(&self) -> Vec<BandRow> {
        let row = |(name, [low, high]): (&'static str, [f64; 2])| {
            let band = self.found.between(low, high)?;
            Some(BandRow {
                name,
                from_hz: low,
                to_hz: high,
                input_share: band.input_share,
                gain: band.gain,
                gain_db: (band.gain != 0.0).then(|| decibels(band.gain)),
                coherence: band.coherence,
            })
        };
        self.bands().into_iter().filter_map(row).collect()
    }

    /// Points of the bins that are shown, by a function of the bin.
    fn points(&self, of: &dyn Fn(&TransferBin) -> f64) -> Vec<(f64, f64)> {
        let end = self.chain.map_or(SHOWN_FREQUENCY, |chain| BAND_MARGIN * chain.cutoff());
        // The mean of each segment is subtracted: the first bin is empty.
        let bins = self.found.bins.iter().skip(1).take_while(|bin| bin.frequency <= end);
        bins.map(|bin| (bin.frequency, of(bin))).collect()
    }

    /// The gain (dB), `deviations` expanded uncertainties above, within what is drawn.
    fn gain(&self, deviations: f64) -> Vec<(f64, f64)> {
        self.points(&|bin| {
            let gain = bin.gain + deviations * NORMAL_95 * bin.gain_u;
            decibels(gain.max(0.0)).clamp(LOWEST_GAIN, -LOWEST_GAIN)
        })
    }

    /// Gain with its expanded uncertainty, and coherence, over frequency, the gap's edges marked.
    fn plots(&self) -> [Plot; 2] {
        let coherence = self.points(&|bin| bin.coherence);
        let ends = coherence.first().zip(coherence.last());
        let limit = self.found.chance_coherence();
        let name = format!("5 % of unrelated signals are above {limit:.2}");
        let line = ends.map_or(Vec::new(), |(first, last)| vec![(first.0, limit), (last.0, limit)]);
        let around = Series::area("95 %", &self.gain(-1.0), &self.gain(1.0));
        [
            (["gain |H|", "dB"], around, self.gain(0.0)),
            (["coherence", ""], Series::behind(&name, line), coherence),
        ]
        .map(|(y, behind, points)| {
            let lowest = points.iter().map(|(_, value)| *value).fold(0.0, f64::min);
            let main = Series { name: "measured".to_owned(), ..Series::main(points) };
            let mut plot = Plot::fitted(["frequency", "Hz"], y, vec![behind, main])
                .with_marks(self.chain.iter().flat_map(band_marks).collect());
            plot.x = Axis::prefixed("frequency", "Hz", (0.0, plot.x.to));
            if lowest < 0.0 {
                // Where the interval has no lower end, the picture does not follow it down.
                plot.y = Axis::prefixed(y[0], y[1], (lowest - GAIN_MARGIN, plot.y.to));
            }
            plot
        })
    }

    /// The picture.
    pub fn picture(&self) -> Sheet {
        Sheet::stack(self.title.as_str(), self.plots().to_vec())
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
        rows.extend(self.rows().into_iter().map(|band| {
            vec![
                band.name.to_owned(),
                hertz(band.from_hz),
                hertz(band.to_hz),
                format!("{:.1} %", 100.0 * band.input_share),
                band.gain_db.map_or("-".to_owned(), |gain| format!("{gain:.1} dB")),
                format!("{:.3}", band.coherence),
            ]
        }));
        lines.extend(table::lines(&rows, &[0]));
        lines.push(String::new());
        let [gain, coherence] = self.plots();
        lines.extend(terminal(&gain));
        lines.push(String::new());
        lines.extend(terminal(&coherence));
        lines.extend(self.notes.iter().map(|note| format!("  note        {note}")));
        lines.join("\n")
    }

    fn segments(&self) -> f64 {
        self.found.segments as f64
    }
}
