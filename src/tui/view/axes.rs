//! The surroundings of the graticule: ground and trigger markers, labels of both axes.

use ratatui::Frame;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::{Color, Modifier, Style};

use super::colours::{colour, colour_of};
use super::graticule::{abscissa_ticks, ordinate_ticks, shown};
use super::layout::{ScreenLayout, dot_of_division, whole};
use super::readout::{compact, digits_for, ordinate_unit};
use crate::scope::Source;
use crate::tui::axis::{ViewWindow, is_spectrum};
use crate::tui::model::ScreenState;

/// Draws markers and labels.
pub(in crate::tui) fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let buffer = frame.buffer_mut();
    ground_markers(model, layout, buffer);
    ordinate_labels(model, layout, buffer);
    level_marker(model, layout, buffer);
    if let Some(window) = model.window() {
        trigger_marker(model, layout, window, buffer);
        abscissa_labels(model, layout, window, buffer);
    }
}

/// Where each trace's zero stands, at the left edge; an arrow where it is beyond the screen.
fn ground_markers(model: &ScreenState, layout: &ScreenLayout, buffer: &mut Buffer) {
    for waveform in shown(model) {
        let dot = dot_of_division(layout, model.vertical(waveform).position).round();
        let last = f64::from(layout.rows() - 1);
        let arrow = if dot < 0.0 {
            '▴'
        } else if dot > last {
            '▾'
        } else {
            '▸'
        };
        let y = layout.markers.y + whole(dot.clamp(0.0, last) / 4.0);
        let text = format!("{}{arrow}", letter(waveform.source));
        let style = trace_style(model, waveform.source);
        put(buffer, layout.markers, y, &text, style);
    }
}

/// The mark of a source where there is room for one letter.
fn letter(source: Source) -> char {
    match source {
        Source::Channel(number) => char::from_digit(u32::from(number), 10).unwrap_or('#'),
        Source::Math => 'M',
        Source::Reference(letter) => letter,
    }
}

fn trace_style(model: &ScreenState, source: Source) -> Style {
    let style = Style::new().fg(colour_of(model.palette(), source));
    if model.is_selected(source) { style.add_modifier(Modifier::BOLD) } else { style }
}

/// Values of the selected trace at the division lines.
fn ordinate_labels(model: &ScreenState, layout: &ScreenLayout, buffer: &mut Buffer) {
    let Some(waveform) = model.selected().map(|capture| &capture.waveform) else {
        return;
    };
    let vertical = model.vertical(waveform);
    let unit = ordinate_unit(waveform);
    let style = Style::new().fg(colour_of(model.palette(), waveform.source));
    // Two labels in one row would overwrite each other.
    let every = if layout.y_dots < 4 { 2 } else { 1 };
    for (factor, value) in ordinate_ticks(vertical) {
        if factor % every == 0 {
            let dot = dot_of_division(layout, value / vertical.scale + vertical.position).round();
            let y = layout.labels.y + whole(dot.clamp(0.0, f64::from(layout.rows() - 1)) / 4.0);
            let width = usize::from(layout.labels.width);
            let text = label(value, vertical.scale, unit);
            put(buffer, layout.labels, y, &format!("{text:<width$}"), style);
        }
    }
}

/// A label of an axis with `scale` a division: as many digits as tell one division from the next.
fn label(value: f64, scale: f64, unit: &str) -> String {
    if value == 0.0 { format!("0{unit}") } else { compact(value, unit, digits_for(value, scale)) }
}

/// The trigger's place above the graticule; an arrow to the side where it is beyond the screen.
fn trigger_marker(
    model: &ScreenState,
    layout: &ScreenLayout,
    window: ViewWindow,
    buffer: &mut Buffer,
) {
    let Some(waveform) = model.selected().map(|capture| &capture.waveform) else {
        return;
    };
    let preamble = &waveform.preamble;
    let after_first = waveform.trigger_point - f64::from(preamble.pt_off);
    let time = preamble.x_zero + after_first * preamble.x_incr;
    if is_spectrum(waveform) || !time.is_finite() {
        return;
    }
    let column = ((time - window.left()) / window.scale * f64::from(layout.x_dots)).round() / 2.0;
    let last = f64::from(layout.graticule.width - 1);
    let mark = if column < 0.0 {
        "◀"
    } else if column > last {
        "▶"
    } else {
        "▼"
    };
    let x = layout.trigger.x + whole(column.clamp(0.0, last));
    let place = Rect { x, width: 1, ..layout.trigger };
    let style =
        Style::new().fg(colour(model.palette(), Color::LightRed)).add_modifier(Modifier::BOLD);
    put(buffer, place, place.y, mark, style);
}

/// The trigger's level at the right edge, where the scene tells it.
fn level_marker(model: &ScreenState, layout: &ScreenLayout, buffer: &mut Buffer) {
    let Some(trigger) = model.recordings.front().scene.as_ref().map(|scene| scene.scope.trigger)
    else {
        return;
    };
    let source = trigger.source.channel().map(Source::Channel);
    let watched = shown(model).into_iter().find(|waveform| Some(waveform.source) == source);
    let Some(waveform) = watched.filter(|waveform| ordinate_unit(waveform) == "V") else { return };
    let vertical = model.vertical(waveform);
    let dot = dot_of_division(layout, trigger.level / vertical.scale + vertical.position).round();
    let last = f64::from(layout.rows() - 1);
    let y = layout.graticule.y + whole(dot.clamp(0.0, last) / 4.0);
    let place = Rect { x: layout.graticule.right() - 1, width: 1, ..layout.graticule };
    put(buffer, place, y, "◂", trace_style(model, waveform.source));
}

/// Values of the abscissa below the division lines, as many as there is room for.
fn abscissa_labels(
    model: &ScreenState,
    layout: &ScreenLayout,
    window: ViewWindow,
    buffer: &mut Buffer,
) {
    let unit = model.selected().map_or("s", |capture| capture.waveform.preamble.x_unit.as_str());
    let largest = window.left().abs().max(window.right().abs());
    let digits = digits_for(largest, window.scale);
    let ticks = abscissa_ticks(window).into_iter();
    let labels: Vec<(i64, f64, String)> = ticks
        .map(|(factor, value)| {
            let text = if factor == 0 { format!("0{unit}") } else { compact(value, unit, digits) };
            (factor, value, text)
        })
        .collect();
    let widest = labels.iter().map(|(_, _, text)| text.chars().count()).max().unwrap_or(0);
    let style = Style::new().fg(colour(model.palette(), Color::Gray));
    let area = layout.abscissa;
    let density = f64::from(layout.x_dots) / window.scale;
    let step = labels.windows(2).find_map(|pair| Some(pair.get(1)?.1 - pair.first()?.1));
    let columns = step.map_or(f64::INFINITY, |step| step * density / 2.0);
    let fits = |every: &i32| columns * f64::from(*every) >= (widest + 2) as f64 - 1e-6;
    let every = [1, 2, 4].into_iter().find(fits);
    let every = i64::from(every.unwrap_or(10));
    let mut free = area.x;
    for (_, value, text) in labels.iter().filter(|(factor, ..)| factor % every == 0) {
        let column = whole(((value - window.left()) * density / 2.0).round());
        let centre = layout.graticule.x.saturating_add(column);
        let length = u16::try_from(text.chars().count()).unwrap_or(u16::MAX);
        let rightmost = area.right().saturating_sub(length);
        let x = centre.saturating_sub(length / 2).clamp(area.x, rightmost.max(area.x));
        // At the edges labels are shifted inward.
        if x >= free {
            let place = Rect { x, width: area.right() - x, ..area };
            put(buffer, place, area.y, text, style);
            free = x + length + 1;
        }
    }
}

/// Writes `text` into row `y` of `area`, no further than the area and the screen reach.
pub(in crate::tui) fn put(buffer: &mut Buffer, area: Rect, y: u16, text: &str, style: Style) {
    let area = area.intersection(buffer.area);
    if area.contains(Position::new(area.x, y)) {
        buffer.set_stringn(area.x, y, text, area.width.into(), style);
    }
}
