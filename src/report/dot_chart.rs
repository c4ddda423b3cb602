//! Rows with dots on one logarithmic axis, as an SVG picture: what is how large, at a glance.

use std::fmt::Write as _;

use super::escape;
use super::sheet::COLOURS;

/// Columns: frame, words behind it (pixels).
const WIDTHS: (f64, f64) = (440.0, 110.0);
/// Estimated width of a letter (pixels).
const LETTER: f64 = 7.0;
/// Decades that the axis has at most, down from its end.
const MOST_DECADES: i32 = 8;
/// Height of a row, of what is above the rows, and below (pixels).
const HEIGHTS: (f64, f64, f64) = (20.0, 74.0, 54.0);
/// Radius of a dot (pixels).
const RADIUS: f64 = 4.0;

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub struct DotRow {
    /// In front of it.
    pub name: String,
    /// A value for each series, where there is one (unit).
    pub values: Vec<Option<f64>>,
    /// Behind it.
    pub words: String,
}

/// The picture's content.
#[derive(Debug, Clone, PartialEq)]
pub struct DotChart {
    /// Above all.
    pub title: String,
    /// The axis with its unit.
    pub axis: String,
    /// Names of the series.
    pub series: Vec<&'static str>,
    /// A line across all rows, and its name (unit).
    pub mark: (f64, String),
    /// From top to bottom.
    pub rows: Vec<DotRow>,
}

impl DotChart {
    /// Exponents of the first and the last power of ten of the axis, around all values.
    fn decades(&self) -> (i32, i32) {
        let values = self.rows.iter().flat_map(|row| &row.values).flatten();
        let sizes =
            values.chain([&self.mark.0]).map(|value| value.abs()).filter(|size| *size > 0.0);
        let (low, high) = sizes
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let last = (high + 0.05).ceil() as i32;
        ((low.floor() as i32).clamp(last - MOST_DECADES, last - 1), last)
    }

    /// Room for the names (pixels).
    fn left(&self) -> f64 {
        let longest = self.rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0);
        24.0 + LETTER * f64::from(u32::try_from(longest).unwrap_or(0))
    }

    /// Place on the axis; what is below it stands at its beginning (pixels).
    fn x(&self, value: f64) -> f64 {
        let (from, to) = self.decades();
        let (from, to) = (f64::from(from), f64::from(to));
        let place = value.abs().max(f64::MIN_POSITIVE).log10().clamp(from, to);
        self.left() + WIDTHS.0 * (place - from) / (to - from)
    }

    /// The picture.
    pub fn svg(&self) -> String {
        let (left, (frame, right)) = (self.left(), WIDTHS);
        let (row_height, above, below) = HEIGHTS;
        let down = row_height * self.rows.len() as f64;
        let (width, height) = (left + frame + right, above + down + below);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n<text x=\"14\" y=\"24\" font-size=\"15\">{}</text>\n",
            escape(&self.title)
        );
        self.legend(&mut svg);
        self.axis(&mut svg, above + down);
        let mut y = above + 0.5 * row_height;
        for row in &self.rows {
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\n<text x=\"{:.1}\" y=\"{:.1}\">{}</text>\n\
                 <path d=\"M{left} {y}h{frame}\" stroke=\"#e8e8e8\"/>",
                left - 10.0,
                y + 4.0,
                escape(&row.name),
                left + frame + 10.0,
                y + 4.0,
                escape(&row.words)
            );
            for (value, colour) in row.values.iter().zip(COLOURS) {
                let Some(value) = *value else { continue };
                let x = self.x(value);
                let _ = writeln!(
                    svg,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{RADIUS}\" fill=\"{colour}\" fill-opacity=\"0.85\"/>"
                );
            }
            y += row_height;
        }
        svg.push_str("</svg>\n");
        svg
    }

    fn legend(&self, svg: &mut String) {
        let mut x = self.left();
        for (name, colour) in self.series.iter().zip(COLOURS) {
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"46\" r=\"{RADIUS}\" fill=\"{colour}\"/>\n<text x=\"{:.1}\" y=\"50\">{name}</text>",
                x + 9.0
            );
            x += 110.0;
        }
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.1} 38v14\" stroke=\"#303030\" stroke-dasharray=\"4 3\"/>\n<text x=\"{:.1}\" y=\"50\">{}</text>",
            x + 7.0,
            escape(&self.mark.1)
        );
    }

    fn axis(&self, svg: &mut String, bottom: f64) {
        let (left, frame) = (self.left(), WIDTHS.0);
        let top = HEIGHTS.1;
        let (first, last) = self.decades();
        for decade in first..=last {
            let x = self.x(10f64.powi(decade));
            let _ = writeln!(
                svg,
                "<path d=\"M{x:.1} {top}V{bottom:.1}\" stroke=\"#dddddd\"/>\n<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                bottom + 17.0,
                power(decade)
            );
        }
        let x = self.x(self.mark.0);
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.1} {top}V{bottom:.1}\" stroke=\"#303030\" stroke-dasharray=\"4 3\"/>\n\
             <rect x=\"{left}\" y=\"{top}\" width=\"{frame}\" height=\"{:.1}\" fill=\"none\" stroke=\"#303030\"/>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            bottom - top,
            left + 0.5 * frame,
            bottom + 38.0,
            escape(&self.axis)
        );
    }
}

/// A power of ten as one reads it.
fn power(decade: i32) -> String {
    match decade {
        -2 => "0.01".to_owned(),
        -1 => "0.1".to_owned(),
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        2 => "100".to_owned(),
        other => format!("1e{other}"),
    }
}
