//! The pages over frequency: the selected trace's spectrum with the chain's band edges, and how it
//! changes with time.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};

use super::axes::put;
use super::layout::ScreenLayout;
use super::readout::compact;
use super::sheet::{Diagram, DiagramAxis};
use super::{colour, colour_of, message};
use crate::analysis::spectrum::Spectrum;
use crate::tui::model::{Palette, ScreenState};

/// Decibels from the top of the page to its bottom (dB).
const DECIBEL_RANGE: f64 = 80.0;
/// Decibels from one tone of the map to the next (dB).
const DECIBELS_PER_TONE: f64 = 10.0;
/// Tones of the map, from little to much.
const TONES: [&str; 5] = [" ", "░", "▒", "▓", "█"];

/// The name of the signal, and the band edges; `what` it is in the words that fit into `width`
/// columns.
fn heading(model: &ScreenState, what: [&str; 2], width: u16) -> Line<'static> {
    let [long, short] = what.map(|what| heading_of(model, what));
    if long.width() <= usize::from(width) { long } else { short }
}

fn heading_of(model: &ScreenState, what: &str) -> Line<'static> {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let name = model.selected().map_or_else(String::new, |c| c.waveform.source.to_string());
    let sensor = model.selected().and_then(|c| model.sensor(c.waveform.source));
    let sensor = sensor.map_or_else(String::new, |sensor| format!(" ({})", sensor.name));
    let mut parts = vec![Span::styled(format!("{what} {name}{sensor}  "), bold)];
    match &model.derived().chain {
        Some(chain) => {
            let gap = Style::new().fg(colour(model.palette(), Color::LightRed));
            for (name, edge) in chain.edges() {
                parts.push(Span::styled(format!("{name} {}  ", compact(edge, "Hz", 4)), gap));
            }
            let zoomed = model.is_band_zoomed();
            parts.push(Span::raw(match (zoomed, chain.has_gap()) {
                (true, _) => "z: all",
                (false, true) => "gap f1-f2",
                (false, false) => "no gap",
            }));
        }
        None => parts.push(Span::raw("no band edges: no chain known around this sensor")),
    }
    Line::from(parts)
}

/// The spectrum in decibels below its highest line.
pub(super) fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.page;
    let spectrum = match &model.derived().spectrum {
        Some(Ok(spectrum)) => spectrum,
        Some(Err(problem)) => return message(problem, area, frame),
        None => return message("there is no trace to transform", area, frame),
    };
    let palette = model.palette();
    let chain = model.derived().chain.as_ref();
    let top = spectrum.amplitude.iter().skip(1).copied().fold(0.0, f64::max);
    if !(top > 0.0 && top.is_finite()) {
        return message("this trace never changes: it has no spectrum", area, frame);
    }
    let level = 20.0 * top.log10();
    let high = (level / 10.0).ceil() * 10.0;
    let below = Rect { y: area.y + 1, height: area.height - 1, ..area };
    let (lowest, highest) = model.band().unwrap_or_default();
    let frequency = DiagramAxis::linear(lowest, highest, "Hz");
    let grid = colour(palette, Color::DarkGray);
    let mut sheet =
        Diagram::new(below, frequency, DiagramAxis::linear(high - DECIBEL_RANGE, high, "dB"), grid);
    let edge_colour = colour(palette, Color::LightRed);
    if let Some(chain) = chain {
        sheet.shade(chain.gap_bottom(), chain.gap_top(), colour(palette, Color::Red));
    }
    let source = model.selected().map(|capture| capture.waveform.source);
    let line = source.map_or(Color::Reset, |source| colour_of(palette, source));
    let points = spectrum
        .amplitude
        .iter()
        .enumerate()
        .map(|(bin, amplitude)| (bin as f64 * spectrum.step, 20.0 * amplitude.log10()));
    sheet.line(points, line);
    for (_, edge) in chain.iter().flat_map(|chain| chain.edges()) {
        sheet.upright(edge, edge_colour);
    }
    sheet.draw(colour(palette, Color::Gray), frame);
    let bold = Style::new().fg(edge_colour).add_modifier(Modifier::BOLD);
    for (name, edge) in chain.iter().flat_map(|chain| chain.edges()) {
        sheet.write((edge, high), name, bold, frame);
    }
    let short = format!("|X|/M, dB re 1 {},", spectrum.unit);
    let head = heading(model, [&format!("Spectrum {short} of"), &short], area.width);
    frame.render_widget(head, Rect { height: 1, ..area });
}

/// Frequency upward, time to the right, tones by 10 dB.
pub(super) fn map(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.page;
    let map = match &model.derived().map {
        Some(Ok(map)) => map,
        Some(Err(problem)) => return message(problem, area, frame),
        None => return message("there is no trace to transform", area, frame),
    };
    let (Some(start), Some(end)) = (map.times.first(), map.times.last()) else {
        return message("the record is too short for a map", area, frame);
    };
    let palette = model.palette();
    let chain = model.derived().chain.as_ref();
    let below = Rect { y: area.y + 1, height: area.height - 1, ..area };
    let (shown, grid) = (model.band().unwrap_or_default(), colour(palette, Color::DarkGray));
    let frequency = DiagramAxis::linear(shown.0, shown.1, "Hz");
    let sheet = Diagram::new(below, DiagramAxis::linear(*start, *end, "s"), frequency, grid);
    sheet.draw(colour(palette, Color::Gray), frame);
    let top =
        map.columns.iter().flat_map(|c| c.amplitude.iter().skip(1)).copied().fold(0.0, f64::max);
    let inner = sheet.inner();
    for column in 0..inner.width {
        let place = usize::from(column) * map.columns.len() / usize::from(inner.width.max(1));
        let Some(spectrum) = map.columns.get(place) else { continue };
        for row in 0..inner.height {
            let (low, high) = band(row, inner.height, shown);
            let amplitude = largest_amplitude(spectrum, low, high);
            let (tone, style) = tone(20.0 * (amplitude / top).log10(), palette);
            let at = Rect { x: inner.x + column, y: inner.y + row, width: 1, height: 1 };
            put(frame.buffer_mut(), at, at.y, tone, style);
        }
    }
    let edge = Style::new().fg(colour(palette, Color::LightRed)).add_modifier(Modifier::BOLD);
    for (name, frequency) in chain.iter().flat_map(|chain| chain.edges()) {
        let inside = (shown.0..=shown.1).contains(&frequency);
        if let Some((_, y)) = sheet.cell(*start, frequency).filter(|_| inside) {
            let line = format!("{name}{}", "╌".repeat(usize::from(inner.width / 8)));
            put(frame.buffer_mut(), inner, y, &line, edge);
        }
    }
    let words = ["Spectrum over time, 10 dB a tone, of", "10 dB a tone,"];
    let head = heading(model, words, area.width);
    frame.render_widget(head, Rect { height: 1, ..area });
}

/// Frequencies of a row of cells, from the top (Hz).
fn band(row: u16, rows: u16, (low, high): (f64, f64)) -> (f64, f64) {
    let edge = |row: u16| high - (high - low) * f64::from(row) / f64::from(rows.max(1));
    (edge(row + 1), edge(row))
}

/// The highest amplitude in a band (unit).
fn largest_amplitude(spectrum: &Spectrum, low: f64, high: f64) -> f64 {
    let bin = |frequency: f64| (frequency / spectrum.step).round() as usize;
    let (first, last) = (bin(low).max(1), bin(high).max(bin(low) + 1));
    let inside = spectrum.amplitude.iter().take(last + 1).skip(first);
    inside.copied().fold(0.0, f64::max)
}

/// A tone for decibels below the loudest.
fn tone(decibels: f64, palette: Palette) -> (&'static str, Style) {
    const COLOURS: [Color; 5] =
        [Color::Reset, Color::Blue, Color::Cyan, Color::Yellow, Color::LightRed];
    let steps = TONES.len() - 1;
    let below = (-decibels / DECIBELS_PER_TONE).clamp(0.0, 4.0) as usize;
    let place = steps - below.min(steps);
    let shade = TONES.get(place).copied().unwrap_or(" ");
    let wanted = COLOURS.get(place).copied().unwrap_or(Color::Reset);
    (shade, Style::new().fg(colour(palette, wanted)))
}
