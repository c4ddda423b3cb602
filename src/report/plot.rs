//! Curves in a terminal: Braille characters, two dots across and four down in each.

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

/// The curve as lines of text; `label` puts a value of `x` and of `y` into words.
pub fn braille(
    curve: &Curve,
    label_x: &dyn Fn(f64) -> String,
    label_y: &dyn Fn(f64) -> String,
) -> Vec<String> {
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
    let labels = [label_y(top), label_y(bottom)];
    let margin = labels.iter().map(|l| l.chars().count()).max().unwrap_or(0);
    let rows = canvas.rows();
    let last = rows.len().saturating_sub(1);
    let mut lines = vec![format!("  {}", curve.y.name)];
    for (index, row) in rows.into_iter().enumerate() {
        let label = match index {
            0 => labels[0].as_str(),
            _ if index == last => labels[1].as_str(),
            _ => "",
        };
        lines.push(format!("  {label:>margin$} │{row}").trim_end().to_owned());
    }
    lines.push(format!("  {:margin$} └{}", "", "─".repeat(PLOT_SIZE.0)));
    let (start, end) = (label_x(left), format!("{} {}", label_x(right), curve.x.name));
    let gap = PLOT_SIZE.0.saturating_sub(start.chars().count() + end.chars().count());
    lines.push(format!("  {:margin$}  {start}{}{end}", "", " ".repeat(gap.max(1))));
    lines.extend(curve.marks.iter().map(|(x, name)| format!("  ┊ {name}: {}", label_x(*x))));
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

/// Curves with points on them as lines of text, from zero in both directions; each point is a cross of five dots.
pub fn scatter(
    curves: &[Vec<(f64, f64)>],
    clouds: &[PointSet<'_>],
    label: &str,
    label_y: &dyn Fn(f64) -> String,
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
    let labels = [label_y(top), label_y(0.0)];
    let margin = labels.iter().map(|l| l.chars().count()).max().unwrap_or(0);
    let rows = canvas.rows();
    let last = rows.len().saturating_sub(1);
    let mut lines = vec![format!("  {label}")];
    for (index, row) in rows.into_iter().enumerate() {
        let label = if index == 0 {
            labels[0].as_str()
        } else if index == last {
            labels[1].as_str()
        } else {
            ""
        };
        lines.push(format!("  {label:>margin$} │{row}").trim_end().to_owned());
    }
    lines.push(format!("  {:margin$} └{}", "", "─".repeat(PLOT_SIZE.0)));
    lines
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
