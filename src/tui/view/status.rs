//! The line above the picture, and the line of hints below everything.
//!
//! Lines too long for the terminal are shortened, the least important parts first.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Clear, Paragraph};

use super::colours::colour;
use super::layout::ScreenLayout;
use super::panel::wrapped;
use super::readout::{READING_GAP, compact, digits_for, spaced, width};
use crate::recording::Origin;
use crate::scope::Waveform;
use crate::tui::axis::{ViewWindow, is_spectrum};
use crate::tui::keys::{KNOB_HINTS, RECORDING_HINTS, TRACE_HINTS};
use crate::tui::model::command::commands_of;
use crate::tui::model::{Popup, RunState, ScreenState, SidePanel};

/// Hints that stand first on every page: help, and out.
const FIRST_HINTS: usize = 2;
/// Rows of a long notice, at most.
const MOST_NOTICE_ROWS: u16 = 4;
/// Columns that the title keeps at least while the line drops other things.
const TITLE_WIDTH: usize = 12;
/// The same where several recordings are named in it, at most.
const MOST_TITLE_WIDTH: usize = 50;

/// Title, state, origin, problems, shot and position of the screen's centre.
pub(in crate::tui) fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let warning = bold.fg(colour(model.palette(), Color::LightRed));
    let mut parts: Vec<Span> = Vec::new();
    parts.push(Span::styled(state(model), bold));
    if let Some(shot) = model.shot() {
        parts.push(match shot.origin {
            Origin::Simulated => Span::raw("simulated"),
            Origin::Measured => Span::raw("measured"),
        });
    }
    let problems = model.recordings.front().set.problems.len();
    if problems > 0 {
        let plural = if problems == 1 { "" } else { "s" };
        parts.push(Span::styled(format!("{problems} problem{plural} (l)"), warning));
    }
    if let Some(shot) = model.shot() {
        let place = model.shot_index() + 1;
        let number = if usize::try_from(shot.number) == Ok(place) {
            String::new()
        } else {
            format!(" (#{})", shot.number)
        };
        let more = if model.is_growing() { "+" } else { "" };
        let count = model.shots();
        let words = match model.recordings.front().live.as_ref() {
            Some(_) => format!("Shot {}", shot.number),
            None => format!("Shot {place}/{count}{more}{number}"),
        };
        parts.push(Span::styled(words, bold));
    }
    if let (Some(window), Some(capture)) = (model.window(), model.selected()) {
        parts.push(Span::raw(centre(window, &capture.waveform)));
    }
    let area = layout.status;
    let room = usize::from(area.width);
    let behind = model.recordings.behind().map(|other| format!("  ┄ {}", other.label()));
    let title = behind.fold(model.recordings.front().title.clone(), |title, other| title + &other);
    // Of several recordings the names matter more than the state.
    let least =
        if model.recordings.behind().next().is_some() { MOST_TITLE_WIDTH } else { TITLE_WIDTH };
    let least = least.min(Span::raw(&title).width()).max(TITLE_WIDTH);
    while parts.len() > 1 && width(&parts) + least > room {
        parts.remove(0);
    }
    let right = Line::from(spaced(parts)).right_aligned();
    let left = room.saturating_sub(right.width() + READING_GAP.len());
    let title = Span::styled(shortened(&title, left), bold);
    frame.render_widget(title, area);
    frame.render_widget(right, area);
}

/// State of the acquisition, as the instrument names it.
fn state(model: &ScreenState) -> String {
    let Some(live) = model.recordings.front().live.as_ref() else {
        return if model.is_playing() {
            format!("Play {}x", model.play.speed)
        } else {
            "Stop".to_owned()
        };
    };
    if let Some(served) = &live.served {
        return match served.state.as_str() {
            "ARMED" => "Armed",
            "READY" => "Ready",
            "TRIGGER" => "Trig'd",
            "AUTO" => "Auto",
            "SCAN" => "Scan",
            "LOST" => "Lost",
            _ => "Stop",
        }
        .to_owned();
    }
    let crossed = live.summary.as_ref().is_some_and(|summary| summary.trigger.crossed);
    match live.acquisition {
        RunState::Stopped => "Stop",
        RunState::Armed => "Armed",
        RunState::Running if crossed => "Trig'd",
        RunState::Running => "Auto",
    }
    .to_owned()
}

/// Where the screen's centre stands after the trigger, or in the spectrum.
fn centre(window: ViewWindow, waveform: &Waveform) -> String {
    let digits = digits_for(window.centre, window.scale);
    let position = compact(window.centre, &waveform.preamble.x_unit, digits);
    let name = if is_spectrum(waveform) { "Pos" } else { "M Pos" };
    format!("{name}: {position}")
}

/// `text` in at most `room` columns, with an ellipsis where something is missing.
fn shortened(text: &str, room: usize) -> String {
    if Span::raw(text).width() <= room {
        return text.to_owned();
    }
    let mut short = String::new();
    for letter in text.chars() {
        let longer = format!("{short}{letter}");
        if Span::raw(&longer).width() + 1 > room {
            break;
        }
        short = longer;
    }
    if room > 0 {
        short.push('…');
    }
    short
}

/// Help for the command being typed, or how to leave.
fn command_help(typed: &str) -> String {
    let word = typed.split(' ').next().unwrap_or_default();
    match commands_of(word).first().filter(|_| !word.is_empty()) {
        Some(command) => format!("{}: {}", command.usage(), command.help()),
        None => "Enter does it, Esc leaves".to_owned(),
    }
}

/// Writes `text` on `last` and as many rows above it as it needs.
fn over_rows(text: &str, style: Style, last: Rect, frame: &mut Frame) {
    let lines = wrapped(text, usize::from(last.width));
    let height = u16::try_from(lines.len()).unwrap_or(u16::MAX).clamp(1, MOST_NOTICE_ROWS);
    let rows = Rect { y: (last.y + 1).saturating_sub(height), height, ..last };
    frame.render_widget(Clear, rows);
    let lines: Vec<Line> = lines.into_iter().map(|line| Line::styled(line, style)).collect();
    frame.render_widget(Paragraph::new(lines), rows);
}

/// The notice of the last action, or else the most important keys.
pub(in crate::tui) fn hints(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.hints;
    if model.panel() == Popup::Prompt {
        let bold = Style::new().add_modifier(Modifier::BOLD);
        let (before, behind) = model.prompt_parts();
        let mut rest = behind.chars();
        let under_cursor = rest.next().map_or_else(|| " ".to_owned(), String::from);
        let mut line = Line::from(vec![
            Span::styled(format!(":{before}"), bold),
            Span::styled(under_cursor, bold.add_modifier(Modifier::REVERSED)),
            Span::styled(rest.as_str().to_owned(), bold),
        ]);
        let words =
            model.notice.as_deref().map_or_else(|| command_help(model.prompt()), str::to_owned);
        let gap = READING_GAP.len();
        if line.width() + gap + Span::raw(&words).width() <= usize::from(area.width) {
            line.push_span(Span::raw(format!("{READING_GAP}{words}")));
        } else {
            over_rows(&words, Style::new(), Rect { y: area.y.saturating_sub(1), ..area }, frame);
        }
        frame.render_widget(Clear, area);
        frame.render_widget(line, area);
        return;
    }
    if let Some(notice) = model.notice.as_deref() {
        let style = Style::new().fg(colour(model.palette(), Color::LightRed));
        over_rows(notice, style, area, frame);
        return;
    }
    let room = usize::from(area.width);
    let grey = Style::new().fg(colour(model.palette(), Color::Gray));
    let mut parts: Vec<Span> = Vec::new();
    let knobs = if model.side() == SidePanel::Knobs { KNOB_HINTS } else { &[] };
    let others = if model.recordings.behind().next().is_some() { RECORDING_HINTS } else { &[] };
    let hints = model.page.map_or(TRACE_HINTS, |page| page.0.hints);
    let (first, rest) = hints.split_at(FIRST_HINTS);
    // A recording has no knobs.
    let is_offered = |(_, what): &&(&str, &str)| *what != "knob" || model.has_bench();
    let all = first.iter().chain(others).chain(knobs).chain(rest);
    for (keys, what) in all.filter(is_offered) {
        parts.push(Span::styled(format!("{keys} {what}"), grey));
        if width(&parts) > room + READING_GAP.len() {
            parts.pop();
        }
    }
    frame.render_widget(Line::from(spaced(parts)), area);
}
