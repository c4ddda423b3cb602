//! A time-frequency map as characters and as a picture: time to the right, frequency upward, 60 dB from the highest to nothing.

use std::fmt::Write as _;

use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::time_frequency::Spectrogram;
use crate::quantity::engineering;

/// Range of the shades below the highest amplitude (dB).
const DYNAMIC_RANGE: f64 = 60.0;
/// Characters across and down.
const MAP_SIZE: (usize, usize) = (72, 20);
/// Shades from nothing to the highest.
const SHADES: [char; 5] = [' ', '░', '▒', '▓', '█'];
/// Most cells of the picture across and down.
const MAX_CELLS: (usize, usize) = (200, 120);
/// Size of the map in the picture (pixels).
const PICTURE_SIZE: (f64, f64) = (760.0, 360.0);

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
}

impl SpectrogramPage {
    /// Amplitudes in decibels below the highest, the highest of each of `across` times `down` cells; frequency from below.
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

    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place among a few dozen"
    )]
    fn row(&self, frequency: f64, down: usize) -> Option<usize> {
        let row = (frequency / self.highest * down as f64) as usize;
        (row < down).then_some(row)
    }

    fn edges(&self) -> Vec<(f64, &'static str)> {
        let edges = self.chain.iter().flat_map(|chain| {
            [(chain.gap_bottom(), "f1"), (chain.gap_top(), "f2"), (chain.cutoff(), "f3")]
        });
        edges.collect()
    }

    fn span(&self) -> [f64; 2] {
        [self.map.times.first(), self.map.times.last()].map(|time| time.copied().unwrap_or(0.0))
    }
}

/// The page that `spectrogram` prints.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "one of a handful of shades"
)]
pub fn text(page: &SpectrogramPage) -> String {
    let hertz = |f: f64| engineering(f, "Hz", 4);
    let mut lines = vec![page.title.clone()];
    if let Some(column) = page.map.columns.first() {
        lines.push(format!(
            "  {} pieces of {}, {} window; lines told apart at {}",
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
    for (row, amplitudes) in cells.iter().enumerate().rev() {
        let shade = |db: &f64| {
            let share = 1.0 + db / DYNAMIC_RANGE;
            SHADES[((share * SHADES.len() as f64) as usize).min(SHADES.len() - 1)]
        };
        let line: String = amplitudes.iter().map(shade).collect();
        let names: Vec<&str> =
            edge_rows.iter().filter(|(r, _)| *r == row).map(|(_, name)| name.as_str()).collect();
        let label = match row {
            _ if row + 1 == MAP_SIZE.1 => hertz(page.highest),
            0 => "0".to_owned(),
            _ => String::new(),
        };
        lines.push(format!("  {label:>9} │{line}│ {}", names.join(", ")).trim_end().to_owned());
    }
    let [from, to] = page.span().map(|time| engineering(time, "s", 4));
    let gap = MAP_SIZE.0.saturating_sub(from.chars().count() + to.chars().count());
    lines.push(format!("  {:9} └{}┘", "", "─".repeat(MAP_SIZE.0)));
    lines.push(format!("  {:9}  {from}{}{to}", "", " ".repeat(gap)));
    lines.push(format!(
        "  {:9}  each shade {:.0} dB, nothing is {DYNAMIC_RANGE:.0} dB below the highest",
        "",
        DYNAMIC_RANGE / SHADES.len() as f64
    ));
    lines.join("\n")
}

/// The map as a picture.
#[allow(clippy::cast_precision_loss, reason = "a few hundred cells")]
pub fn svg(page: &SpectrogramPage) -> String {
    let (across, down) = (page.map.columns.len().clamp(1, MAX_CELLS.0), MAX_CELLS.1);
    let (width, height) = PICTURE_SIZE;
    let (w, h) = (width / across as f64, height / down as f64);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 880 460\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"880\" height=\"460\" fill=\"#ffffff\"/>\n<text x=\"80\" y=\"26\" font-size=\"15\">{}</text>\n\
         <g transform=\"translate(80 44)\" shape-rendering=\"crispEdges\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n",
        super::escape(&page.title)
    );
    for (row, amplitudes) in page.cells(across, down).iter().enumerate() {
        for (column, db) in amplitudes.iter().enumerate().filter(|(_, db)| **db > -DYNAMIC_RANGE) {
            let share = 1.0 + db / DYNAMIC_RANGE;
            // From white over blue to black: printed in grey it keeps its order.
            let [red, green, blue] = [1.0, 0.85, 0.45].map(|part| 255.0 * (1.0 - share * part));
            let (x, y) = (column as f64 * w, height - (row + 1) as f64 * h);
            let _ = writeln!(
                svg,
                "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"rgb({red:.0},{green:.0},{blue:.0})\"/>",
                w + 0.05,
                h + 0.05
            );
        }
    }
    for (frequency, name) in page.edges() {
        let y = height * (1.0 - frequency / page.highest);
        let text = format!("{name} {}", engineering(frequency, "Hz", 4));
        let _ = writeln!(
            svg,
            "<path d=\"M0 {y:.1}H{width}\" stroke=\"#c04020\" stroke-dasharray=\"5 4\"/>\n\
             <text x=\"4\" y=\"{:.1}\" fill=\"#c04020\">{text}</text>",
            y - 4.0
        );
    }
    let [from, to] = page.span().map(|time| engineering(time, "s", 4));
    let _ = writeln!(
        svg,
        "<rect width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"#404040\"/>\n\
         <text x=\"0\" y=\"{0}\">{from}</text>\n<text x=\"{width}\" y=\"{0}\" text-anchor=\"end\">{to}</text>\n\
         <text x=\"-8\" y=\"12\" text-anchor=\"end\">{1}</text>\n<text x=\"-8\" y=\"{height}\" text-anchor=\"end\">0</text>",
        height + 20.0,
        engineering(page.highest, "Hz", 3)
    );
    svg.push_str("</g>\n</svg>\n");
    svg
}
