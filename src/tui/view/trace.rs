//! From a record to dots: for each column of dots the highest and the lowest point that the trace
//! passes.
//!
//! The line through all points is followed, so that no spike between two columns is lost and few
//! points are still joined. The cost is one pass over the record and one over the columns.

use std::ops::Range;

use ratatui::style::Color;
use ratatui::widgets::canvas::{Painter, Shape};

use crate::scope::Waveform;
use crate::trace::Trace;

/// How abscissa and ordinate become dots, counted from the top left.
#[derive(Debug, Clone, Copy)]
pub(in crate::tui) struct Projection {
    /// Abscissa of column 0 (s; Hz for an FFT).
    pub(in crate::tui) left: f64,
    /// Columns in a unit of the abscissa (dots/s).
    pub(in crate::tui) x_density: f64,
    /// Row of zero volts (dots).
    pub(in crate::tui) zero: f64,
    /// Rows in a unit of the ordinate (dots/V).
    pub(in crate::tui) y_density: f64,
    /// Number of columns.
    pub(in crate::tui) columns: u16,
    /// Number of rows.
    pub(in crate::tui) rows: u16,
}

/// Rows that a trace covers in one column of dots, from the top; empty if `top > bottom`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::tui) struct Span {
    top: f64,
    bottom: f64,
}

impl Span {
    const EMPTY: Self = Self { top: f64::INFINITY, bottom: f64::NEG_INFINITY };

    fn take(&mut self, y: f64) {
        self.top = self.top.min(y);
        self.bottom = self.bottom.max(y);
    }
}

/// The column that holds `x`, also left of the first and right of the last one.
fn column(x: f64) -> i64 {
    x.round() as i64
}

/// The spans of `waveform`, one a column; only points on the screen and one to either side are
/// looked at.
pub(in crate::tui) fn spans(waveform: &Waveform, projection: &Projection) -> Vec<Span> {
    let incr = waveform.preamble.x_incr;
    let seen = seen(waveform.time(0), incr, waveform.codes.len(), projection);
    let point = |index: usize| Some((waveform.time(index), waveform.volts(index)?));
    joined((seen.start..seen.end).filter_map(point), projection)
}

/// The same for a signal that passed no digitiser.
pub(in crate::tui) fn spans_of_trace(trace: &Trace, projection: &Projection) -> Vec<Span> {
    let seen = seen(trace.start, trace.interval, trace.values.len(), projection);
    let values = trace.values.iter().enumerate().take(seen.end).skip(seen.start);
    joined(values.map(|(index, value)| (trace.time(index), *value)), projection)
}

/// Which of `count` points may be seen, one to either side included.
fn seen(first: f64, interval: f64, count: usize, projection: &Projection) -> Range<usize> {
    let right = projection.left + f64::from(projection.columns) / projection.x_density;
    let index = |time: f64| (time - first) / interval;
    let (one, other) = (index(projection.left), index(right));
    if !(one.is_finite() && other.is_finite()) {
        return 0..count;
    }
    // Half a column to either side belongs to the outermost ones.
    let margin = 2.0 + (1.0 / (projection.x_density * interval)).abs();
    let (low, high) = (one.min(other) - margin, one.max(other) + margin);
    (low.max(0.0) as usize).min(count)..(high.max(0.0).ceil() as usize).min(count)
}

/// The spans of the line through `points`.
fn joined(points: impl Iterator<Item = (f64, f64)>, projection: &Projection) -> Vec<Span> {
    let mut spans = vec![Span::EMPTY; usize::from(projection.columns)];
    let mut before = None;
    for (abscissa, ordinate) in points {
        let x = (abscissa - projection.left) * projection.x_density;
        let y = projection.zero - ordinate * projection.y_density;
        let here = (x.is_finite() && y.is_finite()).then_some((x, y));
        if let Some((x, y)) = here {
            let at = usize::try_from(column(x)).ok();
            if let Some(span) = at.and_then(|at| spans.get_mut(at)) {
                span.take(y);
            }
            if let Some(before) = before {
                join(&mut spans, before, (x, y));
            }
        }
        before = here;
    }
    spans
}

/// Adds the straight line between two points to the columns it passes.
fn join(spans: &mut [Span], from: (f64, f64), to: (f64, f64)) {
    let ((x0, y0), (x1, y1)) = if from.0 <= to.0 { (from, to) } else { (to, from) };
    if column(x0) == column(x1) {
        return;
    }
    let slope = (y1 - y0) / (x1 - x0);
    let first = usize::try_from(column(x0).max(0)).unwrap_or(usize::MAX);
    let last = usize::try_from(column(x1)).unwrap_or(0);
    if column(x1) < 0 {
        return;
    }
    let count = last.saturating_sub(first).saturating_add(1);
    for (at, span) in spans.iter_mut().enumerate().skip(first).take(count) {
        let centre = at as f64;
        for x in [x0.max(centre - 0.5), x1.min(centre + 0.5)] {
            span.take(y0 + (x - x0) * slope);
        }
    }
}

/// How a trace is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::tui) enum LineStyle {
    /// Every dot.
    Solid,
    /// Every other dot, where colours cannot tell traces apart.
    Dotted,
    /// Dashes of three columns.
    Dashed,
}

impl LineStyle {
    /// Whether a line has a dot at column `x` and row `y`.
    fn has_dot(self, x: usize, y: usize) -> bool {
        match self {
            Self::Solid => true,
            Self::Dotted => (x + y).is_multiple_of(2),
            Self::Dashed => (x / 3).is_multiple_of(2),
        }
    }
}

/// A trace on a canvas of `rows` rows of dots.
#[derive(Debug)]
pub(in crate::tui) struct TraceLine {
    pub(in crate::tui) spans: Vec<Span>,
    pub(in crate::tui) rows: u16,
    pub(in crate::tui) colour: Color,
    pub(in crate::tui) stroke: LineStyle,
}

impl Shape for TraceLine {
    fn draw(&self, painter: &mut Painter) {
        let below = i64::from(self.rows);
        for (x, span) in self.spans.iter().enumerate() {
            if span.top > span.bottom {
                continue;
            }
            let top = column(span.top).max(0);
            let bottom = column(span.bottom).min(below - 1);
            for y in top..=bottom {
                let Ok(y) = usize::try_from(y) else { continue };
                if self.stroke.has_dot(x, y) {
                    painter.paint(x, y, self.colour);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scope::{PointFormat, Preamble, Source, VerticalSetup};

    fn record(codes: Vec<i16>, x_incr: f64) -> Waveform {
        Waveform {
            source: Source::Channel(1),
            codes,
            as_read: Vec::new(),
            preamble: Preamble {
                x_zero: 0.0,
                x_incr,
                pt_off: 0,
                x_unit: "s".to_owned(),
                y_mult: 1.0,
                y_zero: 0.0,
                y_off: 0.0,
                y_unit: "V".to_owned(),
                pt_fmt: PointFormat::Sample,
            },
            vertical: VerticalSetup {
                scale: 25.0,
                position: 0.0,
                coupling: None,
                bandwidth_limited: None,
                inverted: None,
                probe: 1.0,
            },
            horizontal_scale: 1.0,
            trigger_point: 0.0,
        }
    }

    /// One dot a second and a volt, zero volts on row 50.
    fn projection(columns: u16) -> Projection {
        Projection { left: 0.0, x_density: 1.0, zero: 50.0, y_density: 1.0, columns, rows: 100 }
    }

    fn rounded(spans: &[Span]) -> Vec<(i64, i64)> {
        spans.iter().map(|span| (column(span.top), column(span.bottom))).collect()
    }

    /// The truth without colours beside a trace that is not selected.
    #[test]
    fn dashes_and_dots_differ() {
        let row = |style: LineStyle| (0..12).map(|x| style.has_dot(x, 1)).collect::<Vec<_>>();
        let dashes = [[true; 3], [false; 3], [true; 3], [false; 3]].concat();
        assert_eq!(row(LineStyle::Dashed), dashes);
        assert_eq!(row(LineStyle::Dotted), [false, true].repeat(6));
    }

    #[test]
    fn a_spike_of_one_sample_among_hundreds_is_kept() {
        let mut codes = vec![0; 400];
        codes[137] = 40;
        let spans = spans(&record(codes, 0.01), &projection(4));
        assert_eq!(rounded(&spans), [(50, 50), (10, 50), (50, 50), (50, 50)]);
    }

    #[test]
    fn points_far_apart_are_joined_by_a_straight_line() {
        let spans = spans(&record(vec![0, 8], 4.0), &projection(5));
        // 2 V a column; the ends of the line are half a column wide.
        assert_eq!(rounded(&spans), [(49, 50), (47, 49), (45, 47), (43, 45), (42, 43)]);
    }

    #[test]
    fn the_line_from_a_point_left_of_the_screen_to_one_right_of_it_is_seen() {
        let mut left_of_it = projection(3);
        left_of_it.left = 10.0;
        let spans = spans(&record(vec![5, 5], 100.0), &left_of_it);
        assert_eq!(rounded(&spans), [(45, 45); 3]);
    }

    #[test]
    fn what_is_beyond_the_screen_leaves_no_dots() {
        let mut far = projection(3);
        far.left = 1e6;
        for x_incr in [1.0, -1.0, 0.0, 1e300, f64::INFINITY, f64::NAN] {
            for span in spans(&record(vec![0, 1, 2], x_incr), &far) {
                assert!(span == Span::EMPTY || x_incr > 1e6, "{x_incr}: {span:?}");
            }
        }
    }
}
