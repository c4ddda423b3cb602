//! The graticule with the traces on it.

use ratatui::Frame;
use ratatui::style::Color;
use ratatui::symbols::Marker;
use ratatui::widgets::canvas::{Canvas, Painter, Shape};

use super::colours::{colour, colour_of};
use super::layout::{ScreenLayout, dot_of_division, whole};
use super::trace::{LineStyle, Projection, TraceLine, spans, spans_of_trace};
use crate::scope::Waveform;
use crate::trace::Trace;
use crate::tui::axis::{DIVISIONS_ACROSS, DIVISIONS_UP, Steps, Vertical, ViewWindow};
use crate::tui::model::{OpenRecording, Palette, ScreenState, Visibility, ordinate_unit};

/// Dots between two of a division line's own, at least.
const MIN_DOT_SPACING: u16 = 3;
/// Marks of a division on axes and lines.
const TICKS_PER_DIVISION: u16 = 5;

/// Draws divisions and traces.
pub(in crate::tui) fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let window = model.window();
    let ticks = window.map_or_else(Vec::new, |window| ticks(model, layout, window));
    let lines = window.map_or_else(Vec::new, |window| lines(model, layout, window));
    let behind = window.map_or_else(Vec::new, |window| behind(model, layout, window));
    let pointers = super::cursors::pointers(model, layout);
    let grid = Grid {
        x_dots: layout.x_dots,
        y_dots: layout.y_dots,
        ticks,
        colour: colour(model.palette(), Color::DarkGray),
    };
    let canvas =
        Canvas::default().marker(Marker::Braille).x_bounds([0.0, 1.0]).y_bounds([0.0, 1.0]).paint(
            |context| {
                context.draw(&grid);
                context.layer();
                for line in behind.iter().chain(&lines) {
                    context.draw(line);
                }
                for pointer in &pointers {
                    context.draw(pointer);
                }
            },
        );
    frame.render_widget(canvas, layout.graticule);
}

/// The traces as lines; the last one lies on top.
fn lines(model: &ScreenState, layout: &ScreenLayout, window: ViewWindow) -> Vec<TraceLine> {
    shown(model)
        .into_iter()
        .map(|waveform| {
            let plain = model.palette() == Palette::Plain;
            let stroke = if plain && !model.is_selected(waveform.source) {
                LineStyle::Dotted
            } else {
                LineStyle::Solid
            };
            let projection = projection(layout, window, model.vertical(waveform));
            TraceLine {
                spans: spans(waveform, &projection),
                rows: projection.rows,
                colour: colour_of(model.palette(), waveform.source),
                stroke,
            }
        })
        .collect()
}

/// The background of the traces: earlier shots, other recordings, bands, and simulated forces.
fn behind(model: &ScreenState, layout: &ScreenLayout, window: ViewWindow) -> Vec<TraceLine> {
    let mut lines = Vec::new();
    let grey = colour(model.palette(), Color::DarkGray);
    let unit = model.selected().map(|c| c.waveform.preamble.x_unit.clone());
    let mut line = |waveform: &Waveform, vertical: Vertical, colour: Color, stroke: LineStyle| {
        if unit.as_deref() == Some(waveform.preamble.x_unit.as_str()) {
            let projection = projection(layout, window, vertical);
            let spans = spans(waveform, &projection);
            lines.push(TraceLine { spans, rows: projection.rows, colour, stroke });
        }
    };
    for capture in model.persisted_traces().into_iter().flatten().flatten() {
        let vertical = model.vertical(&capture.waveform);
        line(&capture.waveform, vertical, grey, LineStyle::Solid);
    }
    for capture in model.recordings.behind().flat_map(OpenRecording::traces) {
        let (waveform, source) = (&capture.waveform, capture.waveform.source);
        // On the axes of the trace in front, so that the two can be compared.
        let front = model.captures().iter().find(|front| front.waveform.source == source);
        let same_unit =
            front.is_some_and(|f| ordinate_unit(&f.waveform) == ordinate_unit(waveform));
        if model.visibility(waveform) == Visibility::Shown && (front.is_none() || same_unit) {
            let vertical = model.vertical(front.map_or(waveform, |front| &front.waveform));
            line(waveform, vertical, colour_of(model.palette(), source), LineStyle::Dotted);
        }
    }
    for waveform in shown(model) {
        let projection = projection(layout, window, model.vertical(waveform));
        let drawn = |trace: &Trace, colour: Color, stroke: LineStyle| TraceLine {
            spans: spans_of_trace(trace, &projection),
            rows: projection.rows,
            colour,
            stroke,
        };
        let edges = model.bands(waveform).into_iter().flatten();
        lines.extend(edges.map(|edge| drawn(edge, grey, LineStyle::Dotted)));
        let white = colour(model.palette(), Color::White);
        let is_plain = model.palette() == Palette::Plain;
        let stroke = if is_plain { LineStyle::Dashed } else { LineStyle::Dotted };
        lines.extend(model.truth(waveform).map(|truth| drawn(&truth, white, stroke)));
    }
    lines
}

/// The visible traces, the selected one last.
pub(in crate::tui) fn shown(model: &ScreenState) -> Vec<&Waveform> {
    let mut shown: Vec<&Waveform> = model
        .captures()
        .iter()
        .map(|capture| &capture.waveform)
        .filter(|waveform| model.visibility(waveform) == Visibility::Shown)
        .collect();
    shown.sort_by_key(|waveform| model.is_selected(waveform.source));
    shown
}

fn projection(layout: &ScreenLayout, window: ViewWindow, vertical: Vertical) -> Projection {
    Projection {
        left: window.left(),
        x_density: f64::from(layout.x_dots) / window.scale,
        zero: dot_of_division(layout, vertical.position),
        y_density: f64::from(layout.y_dots) / vertical.scale,
        columns: layout.columns(),
        rows: layout.rows(),
    }
}

/// The lines of the graticule: frame, dotted division lines, axes with ticks.
struct Grid {
    x_dots: u16,
    y_dots: u16,
    ticks: Vec<(u16, u16)>,
    colour: Color,
}

impl Shape for Grid {
    fn draw(&self, painter: &mut Painter) {
        let width = self.x_dots * DIVISIONS_ACROSS;
        let height = self.y_dots * DIVISIONS_UP;
        let x_marks = marks(self.x_dots, DIVISIONS_ACROSS);
        let y_marks = marks(self.y_dots, DIVISIONS_UP);
        let mut dot = |x: u16, y: u16| painter.paint(x.into(), y.into(), self.colour);
        for line in 0..=DIVISIONS_UP {
            let y = line * self.y_dots;
            for x in &x_marks {
                dot(*x, y);
            }
        }
        for line in 0..=DIVISIONS_ACROSS {
            let x = line * self.x_dots;
            for y in &y_marks {
                dot(x, *y);
            }
        }
        for x in 0..=width {
            dot(x, 0);
            dot(x, height);
        }
        for y in 0..=height {
            dot(0, y);
            dot(width, y);
        }
        for x in (0..=width).step_by(2) {
            dot(x, height / 2);
        }
        for y in (0..=height).step_by(2) {
            dot(width / 2, y);
        }
        for (x, y) in &self.ticks {
            dot(*x, *y);
        }
        // Marks: a dot to either side of the axes.
        for x in x_marks {
            dot(x, height / 2 - 1);
            dot(x, height / 2 + 1);
        }
        for y in y_marks {
            dot(width / 2 - 1, y);
            dot(width / 2 + 1, y);
        }
    }
}

/// Places of the marks along an axis: five a division as on the instrument, fewer where dots would
/// touch.
fn marks(dots: u16, divisions: u16) -> Vec<u16> {
    let each = (dots / MIN_DOT_SPACING).clamp(1, TICKS_PER_DIVISION);
    (0..=divisions * each).map(|mark| mark * dots / each).collect()
}

/// Length of a tick.
const TICK_DOTS: u16 = 3;

/// Round values on the screen of a trace that stands so, each with its multiple of a round step
/// (unit).
pub(in crate::tui) fn ordinate_ticks(vertical: Vertical) -> Vec<(i64, f64)> {
    let half = f64::from(DIVISIONS_UP) / 2.0;
    let edge = |division: f64| (division - vertical.position) * vertical.scale;
    Steps::OneTwoFive.multiples((edge(-half), edge(half)), vertical.scale)
}

/// Round abscissae in a window, each with its multiple of a round step (s; Hz for an FFT).
pub(in crate::tui) fn abscissa_ticks(window: ViewWindow) -> Vec<(i64, f64)> {
    Steps::OneTwoAndHalfFive.multiples((window.left(), window.right()), window.scale)
}

/// Dots of the ticks at round values: at the bottom those of the abscissa, at the left those of the
/// selected trace. Of an axis that is not shifted they are the divisions' lines, and none is drawn.
pub(in crate::tui) fn ticks(
    model: &ScreenState,
    layout: &ScreenLayout,
    window: ViewWindow,
) -> Vec<(u16, u16)> {
    let (last_column, last_row) = (layout.columns() - 1, layout.rows() - 1);
    let density = f64::from(layout.x_dots) / window.scale;
    let columns = abscissa_ticks(window).into_iter();
    let columns = columns.map(|(_, value)| whole(((value - window.left()) * density).round()));
    let columns = columns.filter(|column| *column <= last_column && column % layout.x_dots > 0);
    let upward = columns
        .flat_map(|column| (1..=TICK_DOTS).map(move |dot| (column, last_row.saturating_sub(dot))));
    let selected = model.selected().map(|capture| model.vertical(&capture.waveform));
    let rows = selected.into_iter().flat_map(|vertical| {
        let division = move |value: f64| value / vertical.scale + vertical.position;
        let values = ordinate_ticks(vertical).into_iter();
        values.map(move |(_, value)| whole(dot_of_division(layout, division(value)).round()))
    });
    let rows = rows.filter(|row| *row <= last_row && row % layout.y_dots > 0);
    let inward = rows.flat_map(|row| (1..=TICK_DOTS).map(move |dot| (dot, row)));
    upward.chain(inward).collect()
}
