//! The whole record in a strip, with the part that is on screen between brackets.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::Span;
use ratatui::widgets::canvas::Canvas;

use super::axes::put;
use super::colours::{colour, colour_of};
use super::layout::ScreenLayout;
use super::layout::whole;
use super::trace::{LineStyle, Projection, TraceLine, spans};
use crate::scope::Waveform;
use crate::tui::axis::{ViewWindow, extent};
use crate::tui::model::ScreenState;

/// Draws the strip, if there is a trace.
pub(in crate::tui) fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let (Some(window), Some(capture)) = (model.window(), model.selected()) else {
        return;
    };
    let waveform = &capture.waveform;
    let strip = Rect { x: layout.graticule.x, width: layout.graticule.width, ..layout.overview };
    let line = TraceLine {
        spans: spans(waveform, &projection(waveform, strip)),
        rows: strip.height * 4,
        colour: colour(model.palette(), Color::DarkGray),
        stroke: LineStyle::Solid,
    };
    let canvas = Canvas::default()
        .marker(Marker::Braille)
        .x_bounds([0.0, 1.0])
        .y_bounds([0.0, 1.0])
        .paint(|context| context.draw(&line));
    frame.render_widget(canvas, strip);

    let magnification = ViewWindow::recorded(waveform).scale / window.scale;
    let zoom = if magnification < 10.0 {
        format!("{magnification:.1}x")
    } else {
        format!("{magnification:.0}x")
    };
    let before = Rect { width: strip.x - layout.overview.x, ..layout.overview };
    frame.render_widget(Span::raw(zoom), before);
    mark(model, waveform, strip, frame);
}

/// The record from edge to edge and from its lowest to its highest point.
fn projection(waveform: &Waveform, strip: Rect) -> Projection {
    let (start, end) = extent(waveform);
    let columns = strip.width * 2;
    let rows = strip.height * 4;
    let [one, other] = waveform.extremes().unwrap_or([waveform.volts_of(0); 2]);
    let (bottom, top) = (one.min(other), one.max(other));
    let last_row = f64::from(rows) - 1.0;
    let (y_density, zero) = if top > bottom {
        let density = last_row / (top - bottom);
        (density, top * density)
    } else {
        (0.0, last_row / 2.0)
    };
    Projection {
        left: start,
        x_density: (f64::from(columns) - 1.0) / (end - start),
        zero,
        y_density,
        columns,
        rows,
    }
}

/// Brackets around what is on screen, and the trace's colour between them.
fn mark(model: &ScreenState, waveform: &Waveform, strip: Rect, frame: &mut Frame) {
    let Some(window) = model.window() else {
        return;
    };
    let (start, end) = extent(waveform);
    let last = f64::from(strip.width - 1);
    let cell = |edge: f64| whole(((edge - start) / (end - start) * last).clamp(0.0, last));
    let (left, right) = (cell(window.left()), cell(window.right()));
    let inside = Rect { x: strip.x + left, width: right - left + 1, ..strip };
    let buffer = frame.buffer_mut();
    let colours = Style::new().fg(colour_of(model.palette(), waveform.source));
    buffer.set_style(inside, colours);
    let bold = Style::new().add_modifier(Modifier::BOLD);
    for y in strip.top()..strip.bottom() {
        let marks: &[(u16, &str)] =
            if left == right { &[(left, "▮")] } else { &[(left, "["), (right, "]")] };
        for (x, text) in marks {
            let place = Rect { x: strip.x + x, width: 1, ..strip };
            put(buffer, place, y, text, bold);
        }
    }
}
