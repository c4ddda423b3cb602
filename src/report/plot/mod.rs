//! The plot model: axes with units; lines, points, areas and bars; shaded bands, marks and maps.
//!
//! A [`Plot`] is drawn as SVG ([`svg()`]), light or dark, of which PNG is made, and in a terminal
//! ([`terminal()`]). A [`Sheet`] is a picture of several plots.

mod svg;
mod terminal;

pub use svg::{Style, Theme, svg, svg_in_style, with_minus_signs};
pub use terminal::terminal;

use crate::quantity::{Quantity, engineering};
use crate::trace::Trace;

/// Units that take no prefix.
const WITHOUT_PREFIX: [&str; 4] = ["", "dB", "rad", "g"];
/// Target number of intervals on an axis.
const TARGET_INTERVALS: f64 = 6.0;

/// Size of a plot's frame (pixels).
const SIZE: (f64, f64) = (780.0, 356.0);
/// Height of a named row (pixels).
const ROW_HEIGHT: f64 = 20.0;
/// Room above and below the points, as a share of their height (1).
const PADDING: f64 = 0.04;
/// Colour of a plot's main line.
const CURVE_COLOUR: &str = "#1060b0";
/// Colour behind it.
const BACKGROUND_COLOUR: &str = "#909090";
/// Colour of marks.
const MARK_COLOUR: &str = "#c04020";

/// Colours that are distinct for the colour-blind. Source: M. Okabe, K. Ito (2008), "Color
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

    /// Powers of ten around all of `sizes` (unit), at most `decades` of them; smaller sizes are at
    /// its first end.
    pub fn powers(label: &str, sizes: impl Iterator<Item = f64>, decades: i32) -> Self {
        let (low, high) = sizes
            .filter(|size| *size > 0.0)
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let last = (high + 0.05).ceil() as i32;
        let first = (low.floor() as i32).clamp(last - decades, last - 1);
        let name = |decade: i32| match decade {
            -2..=2 => 10f64.powi(decade).to_string(),
            other => format!("1e{other}"),
        };
        let ticks = (first..=last).map(|decade| (10f64.powi(decade), name(decade))).collect();
        let [from, to] = [first, last].map(|decade| 10f64.powi(decade));
        Self { label: label.to_owned(), from, to, logarithmic: true, ticks }
    }

    /// The same from `from` to `to` (unit), its numbers in a unit that fits them.
    fn within(&self, (from, to): (f64, f64)) -> Self {
        if self.logarithmic {
            return Self::logarithmic(&self.label, from, to);
        }
        let parts = self.label.strip_suffix(')').and_then(|label| label.rsplit_once(" ("));
        let Some((name, unit)) = parts else { return Self::linear(&self.label, from, to) };
        // `µs` without its prefix.
        let is_one = |unit: &str| {
            let scale = format!("1 {unit}").parse::<Quantity>().map(|one| one.value);
            scale.is_ok_and(|scale| (scale - 1.0).abs() < 1e-12)
        };
        let bare: String = unit.chars().skip(1).collect();
        let has_prefix = !is_one(unit) && is_one(&bare);
        Self::prefixed(name, if has_prefix { &bare } else { unit }, (from, to))
    }

    /// Position of `value` between both ends (1).
    pub(super) fn share(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.from).ln() / (self.to / self.from).ln()
        } else {
            (value - self.from) / (self.to - self.from)
        }
    }
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// A line through all points.
    Solid,
    /// The same in dashes.
    Dashed,
    /// The points alone.
    Dots,
    /// The area within: the lower edge, and the upper one back.
    Filled,
    /// Horizontal bars, each from a point to the next one at the same height.
    Bars,
}

/// Points that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name in the legend; none for an empty one.
    pub name: String,
    /// Points in order (unit).
    pub points: Vec<(f64, f64)>,
    /// Colour on white, `#rrggbb`.
    pub colour: &'static str,
    /// How it is drawn.
    pub stroke: Stroke,
}

impl Series {
    /// A series of `points` (unit).
    pub fn new(
        name: impl Into<String>,
        points: Vec<(f64, f64)>,
        colour: &'static str,
        stroke: Stroke,
    ) -> Self {
        Self { name: name.into(), points, colour, stroke }
    }

    /// The main line of a plot, without a name.
    pub fn main(points: Vec<(f64, f64)>) -> Self {
        Self::new("", points, CURVE_COLOUR, Stroke::Solid)
    }

    /// A grey line behind the main one.
    pub fn behind(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, points, BACKGROUND_COLOUR, Stroke::Solid)
    }

    /// The grey area between two lines.
    pub fn area(name: &str, low: &[(f64, f64)], high: &[(f64, f64)]) -> Self {
        let points = low.iter().chain(high.iter().rev()).copied().collect();
        Self::new(name, points, BACKGROUND_COLOUR, Stroke::Filled)
    }

    /// A dashed line at `height` (unit) across `x`.
    pub fn level(x: &Axis, height: f64) -> Self {
        Self::new("", vec![(x.from, height), (x.to, height)], MARK_COLOUR, Stroke::Dashed)
    }
}

/// Points of a trace: time (s) and value (unit).
pub fn trace_points(trace: &Trace) -> Vec<(f64, f64)> {
    trace.values.iter().enumerate().map(|(i, value)| (trace.time(i), *value)).collect()
}

/// Values on a grid, as shades: columns from left to right, each from below.
#[derive(Debug, Clone, PartialEq)]
pub struct ShadedMap {
    /// Columns of shares from 0 (white) to 1 (dark) (1).
    pub columns: Vec<Vec<f64>>,
    /// Values of white and of dark.
    pub shades: [String; 2],
}

impl ShadedMap {
    /// A map of decibels below the highest, from -`range` (dB) to 0.
    pub fn decibels(columns: &[Vec<f64>], range: f64) -> Self {
        let share = |db: &f64| (1.0 + db / range).clamp(0.0, 1.0);
        let columns = columns.iter().map(|column| column.iter().map(share).collect()).collect();
        Self { columns, shades: [format!("-{range:.0} dB"), "0 dB".to_owned()] }
    }
}

/// One plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Title above the frame.
    pub title: String,
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// Series in the order in which they are drawn.
    pub lines: Vec<Series>,
    /// Parts of the abscissa that are shaded, each with its name (unit).
    pub bands: Vec<(f64, f64, String)>,
    /// Places on the abscissa with a dashed line and a name (unit).
    pub marks: Vec<(f64, String)>,
    /// Words at places in the plot (unit).
    pub words: Vec<(f64, f64, String)>,
    /// Words beside the frame, at heights (unit).
    pub beside: Vec<(f64, String)>,
    /// Shades below the lines.
    pub map: Option<ShadedMap>,
}

impl Plot {
    /// An empty plot.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self {
            title: title.to_owned(),
            x,
            y,
            lines: Vec::new(),
            bands: Vec::new(),
            marks: Vec::new(),
            words: Vec::new(),
            beside: Vec::new(),
            map: None,
        }
    }

    /// A plot whose axes, each a quantity and its unit, fit all points; zero is on the ordinate.
    pub fn fitted(x: [&str; 2], y: [&str; 2], lines: Vec<Series>) -> Self {
        let points = || lines.iter().flat_map(|line| &line.points).copied();
        let range = |values: &mut dyn Iterator<Item = f64>, empty: (f64, f64)| {
            let (low, high) = values.fold(empty, |(low, high), v| (low.min(v), high.max(v)));
            match high > low {
                true => (low, high),
                false if low.is_finite() => (low.min(0.0), low.max(0.0) + 1.0),
                false => (0.0, 1.0),
            }
        };
        let across = range(&mut points().map(|(x, _)| x), (f64::INFINITY, f64::NEG_INFINITY));
        let (low, high) = range(&mut points().map(|(_, y)| y), (0.0, 0.0));
        let padding = PADDING * (high - low);
        let up = (if low < 0.0 { low - padding } else { low }, high + padding);
        let plot =
            Self::new("", Axis::prefixed(x[0], x[1], across), Axis::prefixed(y[0], y[1], up));
        Self { lines, ..plot }
    }

    /// A line over the time after the trigger, behind it what it is compared with.
    pub fn over_time(y: [&str; 2], line: Vec<(f64, f64)>, behind: Vec<Series>) -> Self {
        let lines = behind.into_iter().chain([Series::main(line)]).collect();
        Self::fitted(["time after the trigger", "s"], y, lines)
    }

    /// A plot with a row for each name, from above: the ordinate counts rows from 0.
    pub fn of_rows(x: Axis, names: impl IntoIterator<Item = String>) -> Self {
        let ticks: Vec<(f64, String)> =
            names.into_iter().enumerate().map(|(row, name)| (row as f64, name)).collect();
        let to = ticks.len() as f64 - 0.5;
        let y = Axis { label: String::new(), from: to, to: -0.5, logarithmic: false, ticks };
        Self::new("", x, y)
    }

    /// The same with marks.
    pub fn with_marks(self, marks: Vec<(f64, String)>) -> Self {
        Self { marks, ..self }
    }
}

/// Panels in rows: what a picture holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Title above all panels.
    pub title: String,
    /// Panels in a row.
    pub columns: usize,
    /// Width and height of a panel's frame (pixels).
    pub size: (f64, f64),
    /// Row by row.
    pub panels: Vec<Plot>,
    /// Series that mean the same in all panels: their names are below them.
    pub legend: Vec<Series>,
    /// Below all.
    pub note: String,
}

impl Sheet {
    /// Panels of the usual size below each other.
    pub fn stack(title: impl Into<String>, panels: Vec<Plot>) -> Self {
        Self {
            title: title.into(),
            columns: 1,
            size: SIZE,
            panels,
            legend: Vec::new(),
            note: String::new(),
        }
    }

    /// Gives all panels the abscissa that fits them all, if they show the same quantity.
    pub fn share_abscissa(&mut self) {
        let axes = || self.panels.iter().map(|panel| &panel.x);
        let name = |axis: &Axis| axis.label.split(" (").next().unwrap_or_default().to_owned();
        let Some(first) = axes().next() else { return };
        if axes().all(|axis| name(axis) == name(first) && axis.logarithmic == first.logarithmic) {
            let from = axes().map(|axis| axis.from).fold(f64::INFINITY, f64::min);
            let to = axes().map(|axis| axis.to).fold(f64::NEG_INFINITY, f64::max);
            let shared = first.within((from, to));
            self.panels.iter_mut().for_each(|panel| panel.x = shared.clone());
        }
    }

    /// Shows parts of the axes of all panels (unit); false for rows, maps, and a logarithmic axis
    /// from zero or less.
    pub fn show(&mut self, x: Option<(f64, f64)>, y: Option<(f64, f64)>) -> bool {
        let fits = |axis: &Axis, range: Option<(f64, f64)>| {
            range
                .is_none_or(|(from, _)| !axis.label.is_empty() && (from > 0.0 || !axis.logarithmic))
        };
        let can = |panel: &Plot| panel.map.is_none() && fits(&panel.x, x) && fits(&panel.y, y);
        if !self.panels.iter().all(can) {
            return false;
        }
        for panel in &mut self.panels {
            for (axis, range) in [(&mut panel.x, x), (&mut panel.y, y)] {
                if let Some(range) = range {
                    *axis = axis.within(range);
                }
            }
            let is_shown = |axis: &Axis, at: f64| (0.0..=1.0).contains(&axis.share(at));
            let Plot { x, y, words, beside, .. } = panel;
            beside.retain(|(at, _)| is_shown(y, *at));
            words.retain(|(at, height, _)| is_shown(x, *at) && is_shown(y, *height));
        }
        true
    }

    /// One plot with a height that its rows need.
    pub fn rows(title: impl Into<String>, plot: Plot) -> Self {
        let height = ROW_HEIGHT * plot.y.ticks.len() as f64;
        Self { size: (440.0, height), ..Self::stack(title, vec![plot]) }
    }
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
