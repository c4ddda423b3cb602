//! Curves in a terminal: Braille characters, two dots across and four down in each.

use super::sheet::Axis;
use crate::quantity::engineering;

/// Characters across and down.
const PLOT_SIZE: (usize, usize) = (72, 14);
/// Dots in a character.
const DOTS_PER_CELL: (usize, usize) = (2, 4);
/// Bit of each dot in a Braille character, by column and row.
const BRAILLE_BITS: [[u32; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];
/// The Braille character without a dot.
const EMPTY_BRAILLE: u32 = 0x2800;
/// A vertical line at a mark has one dot in this many.
const MARK_SPACING: usize = 3;

/// A curve `y(x)` with places to mark on its abscissa.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Points in order of `x` (unit).
    pub points: Vec<(f64, f64)>,
    /// Places to mark, each with its name.
    pub marks: Vec<(f64, String)>,
    /// The abscissa.
    pub x: Label,
    /// The ordinate.
    pub y: Label,
}

/// What an axis shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// The quantity.
    pub name: String,
    /// Its unit; empty for a plain number.
    pub unit: String,
}

impl Label {
    /// `name` in `unit`.
    pub fn new(name: &str, unit: &str) -> Self {
        Self { name: name.to_owned(), unit: unit.to_owned() }
    }
}

impl Curve {
    /// Smallest and largest `x` and `y`; zero belongs to `y`.
    pub(super) fn bounds(&self) -> ((f64, f64), (f64, f64)) {
        let widen = |(low, high): (f64, f64), v: f64| (low.min(v), high.max(v));
        let empty = (f64::INFINITY, f64::NEG_INFINITY);
        let x = self.points.iter().fold(empty, |bounds, (x, _)| widen(bounds, *x));
        let y = self.points.iter().fold((0.0, 0.0), |bounds, (_, y)| widen(bounds, *y));
        (spread(x), spread(y))
    }
}

/// Bounds that are apart.
fn spread((low, high): (f64, f64)) -> (f64, f64) {
    if high > low { (low, high) } else { (low.min(0.0), low.max(0.0) + 1.0) }
}

/// The curve as lines of text.
pub fn braille(curve: &Curve) -> Vec<String> {
    let ((left, right), (bottom, top)) = curve.bounds();
    let mut canvas = Canvas::new();
    let place = |x: f64| share(x, left, right, PLOT_SIZE.0 * DOTS_PER_CELL.0);
    let height = |y: f64| {
        PLOT_SIZE.1 * DOTS_PER_CELL.1 - 1 - share(y, bottom, top, PLOT_SIZE.1 * DOTS_PER_CELL.1)
    };
    for (x, _) in curve.marks.iter().filter(|(x, _)| (left..=right).contains(x)) {
        (0..PLOT_SIZE.1 * DOTS_PER_CELL.1)
            .step_by(MARK_SPACING)
            .for_each(|row| canvas.set(place(*x), row));
    }
    for pair in curve.points.windows(2) {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]].map(|(x, y)| (place(x), height(y)));
        canvas.line((x0, y0), (x1, y1));
    }
    let axis = |label: &Label, range| Axis::prefixed(&label.name, &label.unit, range);
    let (x, y) = (axis(&curve.x, (left, right)), axis(&curve.y, (bottom, top)));
    let mut lines = framed(&canvas.rows(), &x, &y);
    let marks = curve.marks.iter();
    lines.extend(
        marks.map(|(x, name)| format!("  ┊ {name}: {}", engineering(*x, &curve.x.unit, 4))),
    );
    lines
}

/// Rows of characters, from above, with both axes and their round numbers.
pub(super) fn framed(rows: &[String], x: &Axis, y: &Axis) -> Vec<String> {
    let across = rows.first().map_or(0, |row| row.chars().count());
    let cell = |axis: &Axis, value: f64, cells: usize| {
        let cell = (axis.share(value) * cells as f64) as usize;
        cell.min(cells.saturating_sub(1))
    };
    let names = y.ticks.iter().map(|(value, name)| (cell(y, *value, rows.len()), name));
    let names: Vec<(usize, &String)> = names.collect();
    let margin = names.iter().map(|(_, name)| name.chars().count()).max().unwrap_or(0);
    let mut lines = vec![format!("  {}", y.label)];
    for (index, row) in rows.iter().enumerate() {
        let named = names.iter().find(|(from_below, _)| from_below + index + 1 == rows.len());
        let (name, edge) = named.map_or(("", '│'), |(_, name)| (name.as_str(), '┤'));
        lines.push(format!("  {name:>margin$} {edge}{row}").trim_end().to_owned());
    }
    let (mut edge, mut below) = (vec!['─'; across], String::new());
    for (value, name) in &x.ticks {
        let at = cell(x, *value, across);
        let start = at.saturating_sub(name.chars().count() / 2);
        let end = below.chars().count();
        if end == 0 || start > end {
            edge[at] = '┬';
            below.push_str(&" ".repeat(start - end));
            below.push_str(name);
        }
    }
    let edge: String = edge.into_iter().collect();
    lines.push(format!("  {:margin$} └{edge}", ""));
    lines.push(format!("  {:margin$}  {below}", "").trim_end().to_owned());
    lines.push(format!("  {:margin$}  {:^across$}", "", x.label).trim_end().to_owned());
    lines
}

fn share(value: f64, low: f64, high: f64, dots: usize) -> usize {
    let place = (value - low) / (high - low) * (dots - 1) as f64;
    (place.round().max(0.0) as usize).min(dots - 1)
}

/// Points that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct PointSet<'a> {
    /// The points (unit).
    pub points: Vec<(f64, f64)>,
    /// Their label.
    pub name: &'a str,
    /// Their colour, as SVG writes it.
    pub colour: &'static str,
}

/// Curves with points on them as lines of text, from zero in both directions; each point is a cross
/// of five dots.
pub fn scatter(
    curves: &[Vec<(f64, f64)>],
    clouds: &[PointSet<'_>],
    labels: &[Label; 2],
) -> Vec<String> {
    let points = curves.iter().chain(clouds.iter().map(|cloud| &cloud.points)).flatten();
    let (right, top) = points.fold((0.0, 0.0), |(x, y): (f64, f64), p| (x.max(p.0), y.max(p.1)));
    let mut canvas = Canvas::new();
    let place = |(x, y): (f64, f64)| {
        let down = share(y, 0.0, top, PLOT_SIZE.1 * DOTS_PER_CELL.1);
        (
            share(x, 0.0, right, PLOT_SIZE.0 * DOTS_PER_CELL.0),
            PLOT_SIZE.1 * DOTS_PER_CELL.1 - 1 - down,
        )
    };
    for curve in curves {
        for pair in curve.windows(2) {
            canvas.line(place(pair[0]), place(pair[1]));
        }
    }
    for point in clouds.iter().flat_map(|cloud| &cloud.points) {
        let (x, y) = place(*point);
        canvas.line((x.saturating_sub(1), y), (x + 1, y));
        canvas.line((x, y.saturating_sub(1)), (x, y + 1));
    }
    let [x, y] = [(&labels[0], right), (&labels[1], top)]
        .map(|(label, end)| Axis::prefixed(&label.name, &label.unit, (0.0, end)));
    framed(&canvas.rows(), &x, &y)
}

struct Canvas(Vec<Vec<u32>>);

impl Canvas {
    fn new() -> Self {
        Self(vec![vec![0; PLOT_SIZE.0]; PLOT_SIZE.1])
    }

    fn set(&mut self, x: usize, y: usize) {
        let cell =
            self.0.get_mut(y / DOTS_PER_CELL.1).and_then(|row| row.get_mut(x / DOTS_PER_CELL.0));
        if let Some(cell) = cell {
            *cell |= BRAILLE_BITS[x % DOTS_PER_CELL.0][y % DOTS_PER_CELL.1];
        }
    }

    /// Bresenham's line.
    fn line(&mut self, from: (usize, usize), to: (usize, usize)) {
        let (across, down) = (to.0.abs_diff(from.0), to.1.abs_diff(from.1));
        let steps = across.max(down);
        let between = |a: usize, b: usize, step: usize| {
            if b >= a {
                a + ((b - a) * step + steps / 2) / steps.max(1)
            } else {
                a - ((a - b) * step + steps / 2) / steps.max(1)
            }
        };
        for step in 0..=steps {
            self.set(between(from.0, to.0, step), between(from.1, to.1, step));
        }
    }

    fn rows(&self) -> Vec<String> {
        let character = |dots: &u32| char::from_u32(EMPTY_BRAILLE + dots).unwrap_or(' ');
        self.0.iter().map(|row| row.iter().map(character).collect()).collect()
    }
}
