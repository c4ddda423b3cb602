//! A time-frequency map as characters and as a picture: time to the right, frequency upward, 60 dB
//! from the highest to nothing.

use serde::{Serialize, Serializer};

use super::chart;
use super::plot;
use super::sheet::{Axis, Plot, ShadedMap};
use super::spectrum::band_edges;
use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::spectrum::{Convention, Window};
use crate::analysis::time_frequency::{Pieces, Spectrogram};
use crate::quantity::engineering;

/// Range of the shades below the highest amplitude (dB).
const DYNAMIC_RANGE: f64 = 60.0;
/// Characters across and down.
const MAP_SIZE: (usize, usize) = (72, 20);
/// Shades from nothing to the highest.
const SHADES: [char; 5] = [' ', '░', '▒', '▓', '█'];
/// Most cells of the picture across and down.
const MAX_CELLS: (usize, usize) = (200, 120);
/// Distance of an edge's name above its line, as a share of the map's height (1).
const NAME_DISTANCE: f64 = 4.0 / chart::SIZE.1;

/// A map with what is known about the chain it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrogramPage {
    /// The name of the transformed signal.
    pub title: String,
    /// The map.
    pub map: Spectrogram,
    /// The chain around the sensor, where the recording tells.
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
    /// Amplitudes in decibels below the highest, the highest of each of `across` times `down`
    /// cells; frequency from below.
    fn cells(&self, across: usize, down: usize) -> Vec<Vec<f64>> {
        let mut cells = vec![vec![0.0_f64; across]; down];
        let count = self.map.columns.len();
        for (index, column) in self.map.columns.iter().enumerate() {
            // Fewer pieces than cells: each fills several.
            let places = (index * across / count)..((index + 1) * across).div_ceil(count);
            for (bin, amplitude) in column.amplitude.iter().enumerate() {
                let Some(row) = self.row(column.frequency(bin), down) else { break };
                let above = self.row(column.frequency(bin + 1), down).unwrap_or(down);
                let Some(rows) = cells.get_mut(row..above.max(row + 1)) else { continue };
                for cell in rows.iter_mut().filter_map(|row| row.get_mut(places.clone())).flatten()
                {
                    *cell = cell.max(*amplitude);
                }
            }
        }
        let top = cells.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max);
        for cell in cells.iter_mut().flatten() {
            *cell = (20.0 * (*cell / top).log10()).max(-DYNAMIC_RANGE);
        }
        cells
    }

    fn row(&self, frequency: f64, down: usize) -> Option<usize> {
        let row = (frequency / self.highest * down as f64) as usize;
        (row < down).then_some(row)
    }

    fn edges(&self) -> Vec<(f64, &'static str)> {
        let edges = self.chain.iter().flat_map(DiatomicChain::edges);
        edges.map(|(name, frequency)| (frequency, name)).collect()
    }

    fn axes(&self) -> [Axis; 2] {
        let end = |time: Option<&f64>| time.copied().unwrap_or(0.0);
        let span = (end(self.map.times.first()), end(self.map.times.last()));
        let time = Axis::prefixed("time", "s", span);
        [time, Axis::prefixed("frequency", "Hz", (0.0, self.highest))]
    }
}

/// The page that `spectrogram` prints.
pub fn text(page: &SpectrogramPage) -> String {
    let hertz = |f: f64| engineering(f, "Hz", 4);
    let mut lines = vec![page.title.clone()];
    if let Some(column) = page.map.columns.first() {
        lines.push(format!(
            "  {} pieces of {}, {} window; resolution {}",
            page.map.columns.len(),
            engineering(1.0 / column.resolution, "s", 3),
            column.window,
            hertz(column.resolution)
        ));
    }
    let cells = page.cells(MAP_SIZE.0, MAP_SIZE.1);
    let edge_rows: Vec<(usize, String)> = page
        .edges()
        .iter()
        .filter_map(|(f, name)| Some((page.row(*f, MAP_SIZE.1)?, format!("{name} {}", hertz(*f)))))
        .collect();
    let shade = |db: &f64| {
        let share = 1.0 + db / DYNAMIC_RANGE;
        SHADES[((share * SHADES.len() as f64) as usize).min(SHADES.len() - 1)]
    };
    let rows: Vec<String> =
        cells.iter().rev().map(|amplitudes| amplitudes.iter().map(shade).collect()).collect();
    let [x, y] = page.axes();
    let framed = plot::framed(&rows, &x, &y);
    // An edge's name stands beside its row; the frame's first line is the ordinate's label.
    lines.extend(framed.into_iter().enumerate().map(|(index, line)| {
        let here = edge_rows.iter().filter(|(row, _)| row + index == MAP_SIZE.1);
        let names: Vec<&str> = here.map(|(_, name)| name.as_str()).collect();
        format!("{line}  {}", names.join(", ")).trim_end().to_owned()
    }));
    lines.push(format!(
        "  each shade {:.0} dB, nothing is {DYNAMIC_RANGE:.0} dB below the highest",
        DYNAMIC_RANGE / SHADES.len() as f64
    ));
    lines.extend(page.notes.iter().map(|note| format!("  note  {note}")));
    lines.join("\n")
}

/// The map as a picture.
pub fn svg(page: &SpectrogramPage) -> String {
    let across = page.map.columns.len().clamp(1, MAX_CELLS.0);
    let rows = page.cells(across, MAX_CELLS.1);
    let share = |db: f64| (1.0 + db / DYNAMIC_RANGE).max(0.0);
    let column = |index: usize| rows.iter().map(|row| share(row[index])).collect();
    let [x, y] = page.axes();
    let from = x.from;
    let mut plot = Plot::new("", x, y);
    for (frequency, name) in page.edges() {
        plot.lines.push(chart::level(&plot.x, frequency));
        let above = frequency + NAME_DISTANCE * page.highest;
        plot.words.push((from, above, format!("{name} {}", engineering(frequency, "Hz", 4))));
    }
    plot.map = Some(ShadedMap {
        columns: (0..across).map(column).collect(),
        shades: [format!("-{DYNAMIC_RANGE:.0} dB"), "0 dB".to_owned()],
    });
    chart::picture(&page.title, plot)
}
