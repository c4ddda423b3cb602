//! A sheet of plots as an SVG picture: panels in rows, axes with units, lines, shaded bands, maps.

mod draw;

pub use draw::sheet_svg;

use crate::quantity::engineering;

/// Units that take no prefix.
const WITHOUT_PREFIX: [&str; 3] = ["", "dB", "rad"];
/// Target number of intervals on an axis.
const TARGET_INTERVALS: f64 = 6.0;

/// Lines in colours that the colour-blind tell apart. Source: M. Okabe, K. Ito (2008), "Color
/// Universal Design".
pub const COLOURS: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Label with unit.
    pub label: String,
    /// First value (unit).
    pub from: f64,
    /// Last value (unit).
    pub to: f64,
    /// Whether equal ratios are equally long.
    pub logarithmic: bool,
    /// Places with their names; an empty name is a line of the grid without one.
    pub ticks: Vec<(f64, String)>,
}

impl Axis {
    /// From `from` to `to` (unit), round numbers named.
    pub fn linear(label: &str, from: f64, to: f64) -> Self {
        let places = ticks(from, to);
        let step = places.get(1).zip(places.first()).map_or(1.0, |(b, a)| b - a);
        let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        // What is a rounding error away from zero is zero.
        let name = |v: f64| format!("{:.decimals$}", if v.abs() < 1e-9 * step { 0.0 } else { v });
        let ticks = places.into_iter().map(|value| (value, name(value))).collect();
        Self { label: label.to_owned(), from, to, logarithmic: false, ticks }
    }

    /// From `from` to `to` (unit) with the quantity `name`, round numbers in one unit, whose prefix
    /// fits the larger end.
    pub(super) fn prefixed(name: &str, unit: &str, (from, to): (f64, f64)) -> Self {
        let (scale, unit) = prefixed(from.abs().max(to.abs()), unit);
        let label = if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") };
        let shown = Self::linear(&label, from / scale, to / scale);
        let ticks = shown.ticks.into_iter().map(|(place, name)| (place * scale, name)).collect();
        Self { from, to, ticks, ..shown }
    }

    /// From `from` to `to` (unit), both above zero; 1, 2 and 5 of each decade named.
    pub fn logarithmic(label: &str, from: f64, to: f64) -> Self {
        let decades = (from.log10().floor() as i32)..=(to.log10().ceil() as i32);
        let places = decades.flat_map(|d| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(d)));
        let inside = places.filter(|value| (from * 0.999..=to * 1.001).contains(value));
        let name = |value: f64| format!("{}", format!("{value:.3e}").parse().unwrap_or(value));
        let ticks = inside.map(|value| (value, name(value))).collect();
        Self { label: label.to_owned(), from, to, logarithmic: true, ticks }
    }

    /// Where `value` stands between both ends (1).
    pub(super) fn share(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.from).ln() / (self.to / self.from).ln()
        } else {
            (value - self.from) / (self.to - self.from)
        }
    }
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// Through all points.
    Solid,
    /// The same in dashes.
    Dashed,
    /// The points alone.
    Dots,
    /// The area within: the lower edge, and the upper one back.
    Filled,
}

/// Points that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    /// Its name in the legend; none for an empty one.
    pub name: String,
    /// Points in order (unit).
    pub points: Vec<(f64, f64)>,
    /// Colour.
    pub colour: &'static str,
    /// How it is drawn.
    pub stroke: Stroke,
}

/// Values on a grid, as shades: columns from left to right, each from below.
#[derive(Debug, Clone, PartialEq)]
pub struct ShadedMap {
    /// Columns of shares from 0 (white) to 1 (dark) (1).
    pub columns: Vec<Vec<f64>>,
    /// Values of white and of dark.
    pub shades: [String; 2],
}

/// One plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// `(a) what it shows`.
    pub title: String,
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// Lines in the order in which they are drawn.
    pub lines: Vec<Polyline>,
    /// Parts of the abscissa that are shaded, each with its name (unit).
    pub bands: Vec<(f64, f64, String)>,
    /// Words at places in the plot (unit).
    pub words: Vec<(f64, f64, String)>,
    /// Shades below the lines.
    pub map: Option<ShadedMap>,
}

impl Plot {
    /// An empty one.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        let (lines, bands, words) = (Vec::new(), Vec::new(), Vec::new());
        Self { title: title.to_owned(), x, y, lines, bands, words, map: None }
    }
}

/// Panels in rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Above all.
    pub title: String,
    /// Panels in a row.
    pub columns: usize,
    /// Width and height of a panel's frame (pixels).
    pub size: (f64, f64),
    /// Row by row.
    pub panels: Vec<Plot>,
    /// Lines that mean the same in all panels: their names are below them.
    pub legend: Vec<Polyline>,
    /// Below all.
    pub note: String,
}

/// The unit with an SI prefix, such that `size` has one to three digits before the point, and what
/// it stands for (unit).
fn prefixed(size: f64, unit: &str) -> (f64, String) {
    let group = 3 * (size.log10() / 3.0).floor().clamp(-4.0, 4.0) as i32;
    if WITHOUT_PREFIX.contains(&unit) || size == 0.0 {
        return (1.0, unit.to_owned());
    }
    let scale = 10f64.powi(group);
    let one = engineering(scale, unit, 1);
    (scale, one.trim_start_matches("1 ").to_owned())
}

/// Round numbers from `low` to `high`: steps of 1, 2 or 5 of a power of ten.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / TARGET_INTERVALS;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= rough);
    let step = step.unwrap_or(rough);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last).map(|n| n as f64 * step).collect()
}

/// Every whole number from `low` to `high`, without a name.
pub(super) fn whole_numbers(low: f64, high: f64) -> Vec<(f64, String)> {
    ((low.ceil() as i64)..=(high.floor() as i64)).map(|n| (n as f64, String::new())).collect()
}
