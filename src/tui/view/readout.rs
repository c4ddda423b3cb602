//! Readings of the traces below the picture, after the instrument's own.
//!
//! A star stands behind every scale that is not the recorded one. Lines that are too long for the
//! terminal leave out what matters least.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};

use super::colours::{colour, colour_of};
use super::layout::ScreenLayout;
use crate::quantity::engineering;
use crate::recording::Capture;
use crate::scope::{PointFormat, Slope, Source, TriggerMode, Waveform};
use crate::tui::axis::{Vertical, is_spectrum};
pub(in crate::tui) use crate::tui::model::ordinate_unit;
use crate::tui::model::{MathMode, ScreenState, Visibility};

/// Digits of a reading, as on the instrument.
const DIGITS: usize = 3;
/// More digits than this no label has room for.
const MAX_DIGITS: usize = 8;
/// Between two readings.
pub(in crate::tui) const READING_GAP: &str = "  ";

/// A number as commands print it: `500 mV`, `1.00 ms`; decibels without a prefix.
pub(in crate::tui) fn spelled(value: f64, unit: &str, digits: usize) -> String {
    if unit == "dB" {
        let before = usize::try_from(exponent(value) + 1).unwrap_or(0).max(1);
        let decimals = digits.saturating_sub(before);
        format!("{value:.decimals$} {unit}")
    } else {
        engineering(value, unit, digits)
    }
}

/// A setting or a label as the instrument writes it: `500mV`, `1.00ms`.
pub(in crate::tui) fn compact(value: f64, unit: &str, digits: usize) -> String {
    spelled(value, unit, digits).replace(' ', "")
}

/// How many digits tell `value` from `value + scale / 10`.
pub(in crate::tui) fn digits_for(value: f64, scale: f64) -> usize {
    let digits = exponent(value).saturating_sub(exponent(scale)) + 2;
    usize::try_from(digits).unwrap_or(DIGITS).clamp(DIGITS, MAX_DIGITS)
}

/// Decimal exponent; 0 for zero.
fn exponent(value: f64) -> i32 {
    format!("{value:e}").rsplit('e').next().and_then(|exponent| exponent.parse().ok()).unwrap_or(0)
}

/// Columns of `parts` with gaps between and before them.
pub(in crate::tui) fn width(parts: &[Span]) -> usize {
    parts.iter().map(|part| part.width() + READING_GAP.len()).sum()
}

pub(in crate::tui) fn spaced(parts: Vec<Span>) -> Vec<Span> {
    let mut line = Vec::new();
    for part in parts {
        if !line.is_empty() {
            line.push(Span::raw(READING_GAP));
        }
        line.push(part);
    }
    line
}

/// How much a channel's reading says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ReadingDetail {
    Words,
    Signs,
}

/// The line of readings: one a trace from the left, time base and trigger at the right.
pub(in crate::tui) struct Readings {
    pub(in crate::tui) traces: Vec<(Source, Span<'static>)>,
    pub(in crate::tui) base: String,
    pub(in crate::tui) trigger: String,
}

impl Readings {
    pub(in crate::tui) fn of(model: &ScreenState, layout: &ScreenLayout) -> Self {
        let base = model.window().zip(model.selected()).map(|(window, capture)| {
            let reading = compact(window.scale, &capture.waveform.preamble.x_unit, DIGITS);
            let star = if model.is_zoomed() { "*" } else { "" };
            if is_spectrum(&capture.waveform) {
                format!("{reading}/div{star}")
            } else {
                format!("M {reading}{star}")
            }
        });
        let (base, trigger) = (base.unwrap_or_default(), trigger(model).unwrap_or_default());
        let mut readings = Self { traces: Vec::new(), base, trigger };
        let right = readings.right().chars().count();
        let room = usize::from(layout.channels.width).saturating_sub(right);
        let all = |form: ReadingDetail| -> Vec<(Source, Span)> {
            let reading = |c: &Capture| (c.waveform.source, reading(model, &c.waveform, form));
            model.captures().iter().map(reading).collect()
        };
        let fits = |parts: &Vec<(Source, Span)>| {
            parts.iter().map(|(_, part)| part.width() + READING_GAP.len()).sum::<usize>() <= room
        };
        let fitting = [ReadingDetail::Words, ReadingDetail::Signs].into_iter().map(all).find(fits);
        // On a narrow terminal the selected trace's reading is worth more than all of them cut off.
        readings.traces = fitting.unwrap_or_else(|| {
            let selected = all(ReadingDetail::Words).into_iter();
            selected.filter(|(source, _)| model.is_selected(*source)).collect()
        });
        readings
    }

    fn right(&self) -> String {
        let parts = [self.base.as_str(), self.trigger.as_str()];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(READING_GAP)
    }
}

/// One reading a trace, and the time base at the right.
pub(in crate::tui) fn channels(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.channels;
    let readings = Readings::of(model, layout);
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let base = Line::from(Span::styled(readings.right(), bold)).right_aligned();
    let room = usize::from(area.width).saturating_sub(base.width());
    let left = Rect { width: u16::try_from(room).unwrap_or(area.width), ..area };
    let parts = readings.traces.into_iter().map(|(_, part)| part).collect();
    frame.render_widget(Line::from(spaced(parts)), left);
    frame.render_widget(base, area);
}

/// The trigger as the instrument writes it, and its mode: `CH1↑500mV auto`; none where no scene
/// has it.
fn trigger(model: &ScreenState) -> Option<String> {
    let trigger = model.scope()?.trigger;
    let edge = match trigger.slope {
        Slope::Rise => '↑',
        Slope::Fall => '↓',
    };
    let mode = match trigger.mode {
        TriggerMode::Auto => "auto",
        TriggerMode::Normal => "normal",
    };
    Some(format!("{}{edge}{} {mode}", trigger.source, compact(trigger.level, "V", DIGITS)))
}

/// `CH1 500mV`, with a star where the scale is not the recorded one.
fn reading(model: &ScreenState, waveform: &Waveform, form: ReadingDetail) -> Span<'static> {
    let source = waveform.source;
    let visibility = model.visibility(waveform);
    let text = match visibility {
        Visibility::Off => format!("{source} off"),
        Visibility::OtherAxis if is_spectrum(waveform) => format!("{source} (FFT)"),
        Visibility::OtherAxis => format!("{source} (time)"),
        Visibility::Shown => {
            let vertical = model.vertical(waveform);
            let scale = compact(vertical.scale, ordinate_unit(waveform), DIGITS);
            let star = if vertical.same_as(&Vertical::recorded(waveform)) { "" } else { "*" };
            let flag = match (flag(waveform), form) {
                (None, _) => String::new(),
                (Some(word), ReadingDetail::Words) => format!(" {word}"),
                (Some(_), ReadingDetail::Signs) => "!".to_owned(),
            };
            format!("{source} {scale}{star}{flag}")
        }
    };
    let mut style = if visibility == Visibility::Shown {
        Style::new().fg(colour_of(model.palette(), source))
    } else {
        Style::new().fg(colour(model.palette(), Color::DarkGray))
    };
    if model.is_selected(source) {
        style = style.add_modifier(Modifier::BOLD | Modifier::REVERSED);
    }
    Span::styled(text, style)
}

/// A reading's warning.
fn flag(waveform: &Waveform) -> Option<&'static str> {
    if waveform.codes.is_empty() {
        Some("no data")
    } else if clipped(waveform) > 0 {
        Some("clipped")
    } else {
        None
    }
}

/// Points at the converter's ends; a spectrum has passed no converter.
fn clipped(waveform: &Waveform) -> usize {
    if is_spectrum(waveform) { 0 } else { waveform.clipped() }
}

/// Everything about the selected trace that there is room for.
pub(in crate::tui) fn detail(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    frame.render_widget(Line::from(spaced(detail_parts(model, layout))), layout.detail);
}

/// Everything that there is room for, part by part.
pub(in crate::tui) fn detail_parts(
    model: &ScreenState,
    layout: &ScreenLayout,
) -> Vec<Span<'static>> {
    let mut parts: Vec<Span> = Vec::new();
    let Some(capture) = model.selected() else { return parts };
    let room = usize::from(layout.detail.width);
    for text in details(model, capture) {
        parts.push(Span::raw(text));
        if width(&parts) > room + READING_GAP.len() {
            parts.pop();
        }
    }
    if let Some(first) = parts.first_mut() {
        first.style = Style::new()
            .fg(colour_of(model.palette(), capture.waveform.source))
            .add_modifier(Modifier::BOLD);
    }
    parts
}

/// Facts about a trace, the most important first.
fn details(model: &ScreenState, capture: &Capture) -> Vec<String> {
    let waveform = &capture.waveform;
    let setup = &waveform.vertical;
    let unit = ordinate_unit(waveform);
    let vertical = model.vertical(waveform);
    let recorded = Vertical::recorded(waveform);
    let points = waveform.codes.len();
    let scale = |scale: f64| format!("{}/div", compact(scale, unit, DIGITS));

    let mut texts = vec![format!("{} {}", waveform.source, scale(vertical.scale))];
    if waveform.source == Source::Math && model.math() != MathMode::Off {
        texts.push(model.math().name());
    }
    texts.extend(model.sensor(waveform.source).map(|sensor| sensor.name));
    let moved = Vertical { scale: recorded.scale, ..vertical };
    if !moved.same_as(&recorded) {
        let was = scale(recorded.scale);
        texts.push(format!("*recorded {was} at {:.2}div", recorded.position));
    } else if !vertical.same_as(&recorded) {
        texts.push(format!("*recorded {}", scale(recorded.scale)));
    }
    if clipped(waveform) > 0 {
        texts.push(format!("clipped {} of {points}", clipped(waveform)));
    }
    texts.push(format!("pos {:.2}div", vertical.position));
    texts.extend(setup.coupling.map(|coupling| coupling.to_string()));
    if setup.bandwidth_limited == Some(true) {
        texts.push("20MHz BW".to_owned());
    }
    if setup.inverted == Some(true) {
        texts.push("inverted".to_owned());
    }
    if !is_spectrum(waveform) {
        texts.push(format!("probe {}X", setup.probe));
    }
    texts.push(format!("{points} points"));
    if waveform.preamble.pt_fmt == PointFormat::Envelope {
        texts.push("peak detect".to_owned());
    }
    if let Some(instrument) = &capture.instrument {
        texts.push(instrument.model.clone());
    }
    texts.retain(|text| !text.is_empty());
    texts
}
