//! A time-frequency map as characters and as a picture: time to the right, frequency upward, 60 dB
//! from the highest to nothing.

use serde::{Serialize, Serializer};

use super::plot::{Axis, Plot, Series, ShadedMap, Sheet, terminal};
use super::spectrum::band_edges;
use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::spectrum::{Convention, Window};
use crate::analysis::time_frequency::{Pieces, Spectrogram};
use crate::quantity::engineering;

/// Range of the shades below the highest amplitude (dB).
const DYNAMIC_RANGE: f64 = 60.0;
/// Most cells of the map across and down.
const MAX_CELLS: (usize, usize) = (200, 120);
/// A map with what is known about the chain it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrogramPage {
    /// The name of the transformed signal.
    pub title: String,
    /// The map.
    pub map: Spectrogram,
    /// The chain around the sensor, if the recording has a scene.
    pub chain: Option<DiatomicChain>,
    /// Highest frequency that is shown (Hz).
    pub highest: f64,
    /// How the record was cut.
    pub pieces: Pieces,
    /// Notes for the reader.
    pub notes: Vec<String>,
}

impl Serialize for SpectrogramPage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Fields<'a> {
            signal: &'a str,
            unit: Option<&'a str>,
            convention: Option<Convention>,
            window: Option<Window>,
            segment_samples: usize,
            hop_samples: usize,
            step_hz: Option<f64>,
            resolution_hz: Option<f64>,
            #[serde(flatten, serialize_with = "band_edges")]
            chain: Option<DiatomicChain>,
            notes: &'a [String],
            times_s: &'a [f64],
            ridge_hz: Vec<Option<f64>>,
            amplitude: Vec<&'a [f64]>,
        }
        let map = &self.map;
        let first = map.columns.first();
        Fields {
            signal: &self.title,
            unit: first.map(|column| column.unit.as_str()),
            convention: first.map(|column| column.convention),
            window: first.map(|column| column.window),
            segment_samples: self.pieces.segment,
            hop_samples: self.pieces.hop,
            step_hz: first.map(|column| column.step),
            resolution_hz: first.map(|column| column.resolution),
            chain: self.chain,
            notes: &self.notes,
            times_s: &map.times,
            ridge_hz: map.ridge(0.0, f64::INFINITY),
            amplitude: map.columns.iter().map(|column| column.amplitude.as_slice()).collect(),
        }
        .serialize(serializer)
    }
}

impl SpectrogramPage {
    /// Amplitudes in decibels below the highest, the highest of each cell: columns over time, each
    /// from the lowest frequency; and the highest (unit).
    fn cells(&self) -> (Vec<Vec<f64>>, f64) {
        let count = self.map.columns.len();
        let (across, down) = (count.clamp(1, MAX_CELLS.0), MAX_CELLS.1);
        let mut cells = vec![vec![0.0_f64; down]; across];
        for (index, column) in self.map.columns.iter().enumerate() {
            let Some(cells) = cells.get_mut(index * across / count) else { continue };
            for (bin, amplitude) in column.amplitude.iter().enumerate() {
                let Some(row) = self.row(column.frequency(bin), down) else { break };
                let above = self.row(column.frequency(bin + 1), down).unwrap_or(down);
                let Some(cells) = cells.get_mut(row..above.max(row + 1)) else { continue };
                for cell in cells {
                    *cell = cell.max(*amplitude);
                }
            }
        }
        let top = cells.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max);
        for cell in cells.iter_mut().flatten() {
            *cell = (20.0 * (*cell / top).log10()).max(-DYNAMIC_RANGE);
        }
        (cells, top)
    }

    fn row(&self, frequency: f64, down: usize) -> Option<usize> {
        let row = (frequency / self.highest * down as f64) as usize;
        (row < down).then_some(row)
    }

    fn plot(&self) -> Plot {
        let end = |time: Option<&f64>| time.copied().unwrap_or(0.0);
        let span = (end(self.map.times.first()), end(self.map.times.last()));
        let x = Axis::prefixed("time after the trigger", "s", span);
        let y = Axis::prefixed("frequency", "Hz", (0.0, self.highest));
        let mut plot = Plot::new("", x, y);
        for (name, frequency) in self.chain.iter().flat_map(DiatomicChain::edges) {
            plot.lines.push(Series::level(&plot.x, frequency));
            plot.beside.push((frequency, format!("{name} {}", engineering(frequency, "Hz", 4))));
        }
        let (cells, top) = self.cells();
        let mut map = ShadedMap::decibels(&cells, DYNAMIC_RANGE);
        if let Some(column) = self.map.columns.first() {
            map.shades[1] = format!("0 dB: {}", engineering(top, &column.unit, 3));
        }
        plot.map = Some(map);
        plot
    }

    /// The picture.
    pub fn picture(&self) -> Sheet {
        Sheet::stack(self.title.as_str(), vec![self.plot()])
    }

    /// The page that `spectrogram` prints.
    pub fn text(&self) -> String {
        let mut lines = vec![self.title.clone()];
        if let Some(column) = self.map.columns.first() {
            lines.push(format!(
                "  {} pieces of {}, {} window; resolution {}",
                self.map.columns.len(),
                engineering(1.0 / column.resolution, "s", 3),
                column.window,
                engineering(column.resolution, "Hz", 4)
            ));
        }
        lines.extend(terminal(&self.plot()));
        lines.push(format!("  from dark to nothing {DYNAMIC_RANGE:.0} dB below the highest"));
        lines.extend(self.notes.iter().map(|note| format!("  note  {note}")));
        lines.join("\n")
    }
}
