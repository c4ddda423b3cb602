//! A diagram with two labelled axes, drawn in dots: what spectra, comparisons and studies stand on.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::widgets::canvas::{Canvas, Painter, Shape};

use super::axes::put;
use super::readout::{digits_for, spelled};
use crate::tui::axis::Steps;

/// Columns for the labels of the ordinate.
const LABEL_COLUMNS: u16 = 9;
/// Columns from one label of the abscissa to the next, at least.
const MIN_LABEL_SPACING: u16 = 11;
/// Rows from one label of the ordinate to the next, at least.
const MIN_LABEL_ROWS: u16 = 2;
/// Most divisions between two labels' marks (1).
const MAX_MARKS: usize = 64;

/// One axis: from where to where, and in what.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::tui) struct DiagramAxis {
    /// Value at the left or at the bottom (unit).
    pub(in crate::tui) low: f64,
    /// Value at the right or at the top (unit).
    pub(in crate::tui) high: f64,
    /// Unit of both.
    pub(in crate::tui) unit: String,
    /// Whether equal distances are equal ratios.
    pub(in crate::tui) logarithmic: bool,
}

impl DiagramAxis {
    pub(in crate::tui) fn linear(low: f64, high: f64, unit: &str) -> Self {
        let (low, high) = if high > low { (low, high) } else { (low - 0.5, low + 0.5) };
        Self { low, high, unit: unit.to_owned(), logarithmic: false }
    }

    pub(in crate::tui) fn logarithmic(low: f64, high: f64, unit: &str) -> Self {
        let high = if high > low { high } else { 10.0 * low };
        Self { low, high, unit: unit.to_owned(), logarithmic: true }
    }

    /// Place of `value` along the axis, 0 to 1 (1).
    fn share(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// Values to label, at most `count`, round ones.
    fn marks(&self, count: u16) -> Vec<f64> {
        if self.logarithmic {
            let (first, last) = (self.low.log10().ceil(), self.high.log10().floor());
            let decades = (last - first).max(0.0);
            let step = (decades / f64::from(count.max(1))).ceil().max(1.0);
            let marks = (0..).map(|i: u32| first + step * f64::from(i));
            return marks.take_while(|m| *m <= last + 1e-9).map(|m| 10f64.powf(m)).collect();
        }
        let step = Steps::OneTwoFive.at_least((self.high - self.low) / f64::from(count.max(1)));
        let first = (self.low / step - 1e-9).ceil();
        let marks = (0..).map(|i: u32| (first + f64::from(i)) * step).take(MAX_MARKS);
        marks.take_while(|mark| *mark <= self.high + 1e-9 * step).collect()
    }

    fn label(&self, value: f64) -> String {
        if self.logarithmic && self.unit.is_empty() {
            return format!("{value:.0e}");
        }
        let span = if self.logarithmic { value } else { (self.high - self.low) / 10.0 };
        if value.abs() < 1e-9 * span {
            format!("0 {}", self.unit).trim_end().to_owned()
        } else {
            spelled(value, &self.unit, digits_for(value, span))
        }
    }
}

/// A dot with its colour.
type Dot = (usize, usize, Color);

/// The diagram, filled dot by dot and drawn at the end.
#[derive(Debug)]
pub(in crate::tui) struct Diagram {
    area: Rect,
    inner: Rect,
    x: DiagramAxis,
    y: DiagramAxis,
    grid: Vec<Dot>,
    dots: Vec<Dot>,
    grid_colour: Color,
}

impl Diagram {
    /// An empty diagram in `area`, with a grid of `grid_colour`.
    pub(in crate::tui) fn new(
        area: Rect,
        x: DiagramAxis,
        y: DiagramAxis,
        grid_colour: Color,
    ) -> Self {
        let inner = Rect {
            x: area.x + LABEL_COLUMNS,
            width: area.width.saturating_sub(LABEL_COLUMNS),
            height: area.height.saturating_sub(1),
            ..area
        };
        let mut sheet = Self { area, inner, x, y, grid: Vec::new(), dots: Vec::new(), grid_colour };
        for value in sheet.x_marks() {
            sheet.grid_line(sheet.place(value, sheet.y.low).map(|(x, _)| x), true);
        }
        for value in sheet.y_marks() {
            sheet.grid_line(sheet.place(sheet.x.low, value).map(|(_, y)| y), false);
        }
        sheet
    }

    /// Where the dots are.
    pub(in crate::tui) fn inner(&self) -> Rect {
        self.inner
    }

    fn x_marks(&self) -> Vec<f64> {
        self.x.marks(self.inner.width / MIN_LABEL_SPACING)
    }

    fn y_marks(&self) -> Vec<f64> {
        self.y.marks(self.inner.height / MIN_LABEL_ROWS)
    }

    fn size(&self) -> (usize, usize) {
        (usize::from(self.inner.width) * 2, usize::from(self.inner.height) * 4)
    }

    fn grid_line(&mut self, at: Option<usize>, upright: bool) {
        let (width, height) = self.size();
        let Some(at) = at else { return };
        let along = if upright { height } else { width };
        let dot = |i| if upright { (at, i, self.grid_colour) } else { (i, at, self.grid_colour) };
        let dots: Vec<Dot> = (0..along).step_by(4).map(dot).collect();
        self.grid.extend(dots);
    }

    /// Dots from the left and from the top, none beyond the diagram's left and right.
    fn place(&self, x: f64, y: f64) -> Option<(usize, usize)> {
        let (width, height) = self.size();
        let (right, up) = (self.x.share(x), self.y.share(y));
        if !(-1e-9..=1.0 + 1e-9).contains(&right) || up.is_nan() || width == 0 || height == 0 {
            return None;
        }
        let column = (right.clamp(0.0, 1.0) * (width - 1) as f64).round() as usize;
        let row = ((1.0 - up.clamp(0.0, 1.0)) * (height - 1) as f64).round() as usize;
        Some((column, row))
    }

    /// A line through `points`; in each column of dots from its lowest to its highest.
    pub(in crate::tui) fn line(&mut self, points: impl Iterator<Item = (f64, f64)>, colour: Color) {
        let mut before: Option<(usize, usize)> = None;
        for (x, y) in points {
            let Some(here) = self.place(x, y) else {
                before = None;
                continue;
            };
            let from = before.unwrap_or(here);
            self.join(from, here, colour);
            before = Some(here);
        }
    }

    fn join(&mut self, from: (usize, usize), to: (usize, usize), colour: Color) {
        let across = from.0.abs_diff(to.0);
        let steps = across.max(from.1.abs_diff(to.1)).max(1);
        let between = |a: usize, b: usize, i: usize| {
            if b >= a { a + (b - a) * i / steps } else { a - (a - b) * i / steps }
        };
        for i in 0..=steps {
            let dot = (between(from.0, to.0, i), between(from.1, to.1, i), colour);
            if self.dots.last() != Some(&dot) {
                self.dots.push(dot);
            }
        }
    }

    /// An upright line at `x`, dashed.
    pub(in crate::tui) fn upright(&mut self, x: f64, colour: Color) {
        let (_, height) = self.size();
        if let Some((column, _)) = self.place(x, self.y.low) {
            self.dots.extend((0..height).filter(|y| y % 4 < 3).map(|y| (column, y, colour)));
        }
    }

    /// A level line at `y`, dashed.
    pub(in crate::tui) fn level(&mut self, y: f64, colour: Color) {
        let (width, _) = self.size();
        if let Some((_, row)) = self.place(self.x.low, y) {
            self.dots.extend((0..width).filter(|x| x % 4 < 2).map(|x| (x, row, colour)));
        }
    }

    /// Fills an upright strip from `low` to `high` thinly.
    pub(in crate::tui) fn shade(&mut self, low: f64, high: f64, colour: Color) {
        let (_, height) = self.size();
        let inside = |x: f64| x.clamp(self.x.low, self.x.high);
        let (Some((first, _)), Some((last, _))) =
            (self.place(inside(low), self.y.low), self.place(inside(high), self.y.low))
        else {
            return;
        };
        for x in (first..last).step_by(4) {
            self.dots.extend((x % 8..height).step_by(8).map(|y| (x, y, colour)));
        }
    }

    /// The cell of a point, for a letter at it.
    pub(in crate::tui) fn cell(&self, x: f64, y: f64) -> Option<(u16, u16)> {
        let (column, row) = self.place(x, y)?;
        let column = u16::try_from(column / 2).ok()?;
        let row = u16::try_from(row / 4).ok()?;
        Some((self.inner.x + column, self.inner.y + row))
    }

    /// Writes `text` in the diagram, beginning at a point.
    pub(in crate::tui) fn write(
        &self,
        (x, y): (f64, f64),
        text: &str,
        style: Style,
        frame: &mut Frame,
    ) {
        let Some((column, row)) = self.cell(x, y) else { return };
        let place = Rect { x: column, y: row, width: self.inner.right() - column, height: 1 };
        // Nothing of the dots below shows through.
        put(frame.buffer_mut(), place, row, text, Style::reset().patch(style));
    }

    /// Draws grid, dots and labels.
    pub(in crate::tui) fn draw(&self, label_colour: Color, frame: &mut Frame) {
        let canvas =
            Canvas::default().marker(Marker::Braille).x_bounds([0.0, 1.0]).y_bounds([0.0, 1.0]);
        let canvas = canvas.paint(|context| {
            context.draw(&Dots(&self.grid));
            context.layer();
            context.draw(&Dots(&self.dots));
        });
        frame.render_widget(canvas, self.inner);
        let style = Style::new().fg(label_colour);
        let buffer = frame.buffer_mut();
        for value in self.y_marks() {
            if let Some((_, y)) = self.cell(self.x.low, value) {
                let text = self.y.label(value);
                let place = Rect { width: LABEL_COLUMNS, ..self.area };
                put(buffer, place, y, &text, style);
            }
        }
        let bottom = self.inner.bottom();
        for value in self.x_marks() {
            if let Some((x, _)) = self.cell(value, self.y.low) {
                let text = self.x.label(value);
                let length = u16::try_from(text.chars().count()).unwrap_or(u16::MAX);
                let rightmost = self.area.right().saturating_sub(length);
                let x = x.saturating_sub(length / 2).clamp(self.area.x, rightmost.max(self.area.x));
                put(buffer, Rect { x, width: length, ..self.area }, bottom, &text, style);
            }
        }
    }
}

/// Dots on a canvas.
struct Dots<'a>(&'a [Dot]);

impl Shape for Dots<'_> {
    fn draw(&self, painter: &mut Painter) {
        for (x, y, colour) in self.0 {
            painter.paint(*x, *y, *colour);
        }
    }
}
