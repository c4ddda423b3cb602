//! The cursors on the graticule, and what they tell.

use ratatui::Frame;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::canvas::{Painter, Shape};

use super::colours::{colour, colour_of};
use super::layout::ScreenLayout;
use super::layout::dot_of_division;
use super::readout::{spaced, spelled, width};
use crate::tui::axis::DIVISIONS_ACROSS;
use crate::tui::model::{CursorKind, ScreenState};

/// Digits of a cursor's reading.
const CURSOR_DIGITS: usize = 4;

/// One cursor as a line of dots; the active one is denser.
#[derive(Debug)]
pub(in crate::tui) struct Pointer {
    at: usize,
    upright: bool,
    length: u16,
    every: usize,
    colour: Color,
}

impl Shape for Pointer {
    fn draw(&self, painter: &mut Painter) {
        for along in (0..usize::from(self.length)).step_by(self.every) {
            let (x, y) = if self.upright { (self.at, along) } else { (along, self.at) };
            painter.paint(x, y, self.colour);
        }
    }
}

/// Both cursors, as far as they are on the graticule.
pub(in crate::tui) fn pointers(model: &ScreenState, layout: &ScreenLayout) -> Vec<Pointer> {
    let cursors = model.cursors();
    let Some(pair) = cursors.pair else { return Vec::new() };
    let upright = cursors.kind == CursorKind::Time;
    let dot = |at: f64, source| {
        if upright {
            let window = model.window()?;
            let half = f64::from(DIVISIONS_ACROSS) / 2.0;
            Some(((at - window.centre) / window.scale + half) * f64::from(layout.x_dots))
        } else {
            let capture = model.captures().iter().find(|c| c.waveform.source == source)?;
            let vertical = model.vertical(&capture.waveform);
            Some(dot_of_division(layout, at / vertical.scale + vertical.position))
        }
    };
    let (across, length) =
        if upright { (layout.columns(), layout.rows()) } else { (layout.rows(), layout.columns()) };
    let pointer = |(index, cursor): (usize, &crate::tui::model::state::PlacedCursor)| {
        let at = dot(cursor.at, cursor.source)?.round();
        let at = (0.0..f64::from(across)).contains(&at).then_some(at as usize)?;
        let every = if index == cursors.active { 1 } else { 2 };
        let colour = colour(model.palette(), Color::White);
        Some(Pointer { at, upright, length, every, colour })
    };
    pair.iter().enumerate().filter_map(pointer).collect()
}

/// Writes what the cursors tell in the place of the selected trace's details; whether there was
/// something to tell.
pub(in crate::tui) fn readout(
    model: &ScreenState,
    layout: &ScreenLayout,
    frame: &mut Frame,
) -> bool {
    let Some(reading) = model.cursor_reading().filter(|_| model.page.is_none()) else {
        return false;
    };
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let unit = reading.unit.as_str();
    let is_time = model.cursors().kind == CursorKind::Time;
    let name = if !is_time {
        "dV"
    } else if unit == "s" {
        "dt"
    } else {
        "df"
    };
    let mut parts = vec![Span::styled(
        format!("{name} {}", spelled(reading.difference, unit, CURSOR_DIGITS)),
        bold,
    )];
    parts.extend(
        reading.rate.map(|rate| Span::raw(format!("1/dt {}", spelled(rate, "Hz", CURSOR_DIGITS)))),
    );
    if let [Some(first), Some(second)] = reading.values {
        let difference = spelled(second - first, &reading.value_unit, CURSOR_DIGITS);
        parts.push(Span::styled(format!("dV {difference}"), bold));
    }
    parts.extend(reading.speed.map(|speed| {
        let style = bold.fg(colour(model.palette(), Color::LightGreen));
        Span::styled(format!("speed {}", spelled(speed, "m/s", CURSOR_DIGITS)), style)
    }));
    let pair = model.cursors().pair.into_iter().flatten();
    for (index, (cursor, value)) in pair.zip(reading.values).enumerate() {
        let mark = if index == model.cursors().active { "▸" } else { "" };
        let value =
            value.map_or_else(String::new, |v| format!(" {}", spelled(v, &reading.value_unit, 3)));
        let text =
            format!("{mark}{} {}{value}", cursor.source, spelled(cursor.at, unit, CURSOR_DIGITS));
        let style = Style::new().fg(colour_of(model.palette(), cursor.source));
        parts.push(Span::styled(text, style));
    }
    let room = usize::from(layout.detail.width);
    while parts.len() > 1 && width(&parts) > room + 2 {
        parts.pop();
    }
    frame.render_widget(Line::from(spaced(parts)), layout.detail);
    true
}
