//! The measurement against the simulation: both traces of the selected channel, their difference,
//! and the scores of all.

use std::sync::{Arc, PoisonError};

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use crate::measurement::compare::{ChannelScore, Compared};
use crate::numeric::intervals::NORMAL_95;
use crate::quantity::Uncertain;
use crate::report::signed_with_expanded;
use crate::scope::Source;
use crate::trace::Trace;
use crate::tui::job::{Job, JobState, Queue, guarded};
use crate::tui::model::comparison::{
    LoadedSide, ShownSide, compared, predicted, predicted_bench, uncertain_bench,
};
use crate::tui::model::live_state::LiveBench;
use crate::tui::model::{Action, Overlay, Page, PageSpec, ScreenState};
use crate::tui::view::colours::{colour, colour_of};
use crate::tui::view::diagram::{Diagram, DiagramAxis};
use crate::tui::view::layout::ScreenLayout;
use crate::tui::view::panel::message;
use crate::tui::view::readout::spelled;

/// The page.
pub const PAGE: Page = Page(&PageSpec {
    name: "comparison",
    key: 'd',
    help: "comparison: both, overlay, difference, off",
    hints: &[
        ("?", "help"),
        ("Esc", "traces"),
        ("d", "overlay, difference"),
        ("1-4", "channel"),
        ("↑ ↓", "V/div"),
        (", .", "shot"),
        ("w", "save"),
    ],
    is_wide: true,
    opened: |model| {
        model.overlay = Overlay::Both;
        model.compare_again();
    },
    shot_changed: ScreenState::compare_again,
    act: next_overlay,
    draw,
    ..PageSpec::PLAIN
});

/// The key that opened the page shows its next view first.
fn next_overlay(model: &mut ScreenState, action: Action) -> bool {
    if action != Action::Page(PAGE) {
        return false;
    }
    model.overlay = match model.overlay {
        Overlay::Both => Overlay::Traces,
        Overlay::Traces => Overlay::Difference,
        Overlay::Difference => return false,
    };
    true
}

impl ScreenState {
    /// Compares what is on screen with `other`: a recording, a folder, or a scene.
    pub fn compare_with(&mut self, other: String) {
        self.compared_with = Some(other);
        self.jobs.comparison = JobState::Busy(0.0);
        self.page = Some(PAGE);
        self.compare_again();
    }

    /// Compares another shot with what the last one was compared with; without a shot that waits
    /// for one.
    pub(in crate::tui) fn compare_again(&mut self) {
        let (Some(other), Some(shot)) = (self.compared_with.clone(), self.shot()) else { return };
        let front = self.recordings.front();
        let set = front.set.with_shot(shot.clone());
        let bench = front.live.as_ref().filter(|live| live.served.is_none());
        let bench = bench.map(LiveBench::text);
        let name = front.title.clone();
        let mut shown = ShownSide { name, set, is_bench: bench.is_some(), predicted: None };
        let side = Arc::clone(&self.other_side);
        self.ask(Job::new(
            Queue::Comparison,
            move |report| {
                let mut side = side.lock().unwrap_or_else(PoisonError::into_inner);
                if side.as_ref().is_none_or(|side| side.name != other) {
                    *side = Some(LoadedSide::load(&other)?);
                    // Those of another scene do not belong to this one.
                    report(Box::new(|model: &mut Self| model.jobs.bands.clear()));
                }
                let side = side.as_mut().ok_or("there is nothing to compare with")?;
                let found = compared(&shown, side)?;
                if let Some(text) = bench {
                    let Some(mut bench) = uncertain_bench(&shown.name, &text)? else {
                        return Ok(found);
                    };
                    report(Box::new(|model: &mut Self| {
                        model.jobs.comparison = JobState::Done(Box::new(found));
                    }));
                    match guarded(|| predicted_bench(&mut bench)) {
                        Ok(predicted) => shown.predicted = Some(predicted),
                        Err(problem) => report(Box::new(move |model: &mut Self| {
                            model.set_notice(format!("no bands of the bench: {problem}"));
                        })),
                    }
                    return compared(&shown, side);
                }
                if !side.is_uncertain || side.predicted.is_some() {
                    return Ok(found);
                }
                report(Box::new(|model: &mut Self| {
                    model.jobs.comparison = JobState::Done(Box::new(found));
                }));
                match guarded(|| predicted(&side.name)) {
                    Ok(predicted) => {
                        let bands = predicted.bands.clone();
                        report(Box::new(|model: &mut Self| model.jobs.bands = bands));
                        side.predicted = Some(predicted);
                    }
                    Err(problem) => {
                        side.is_uncertain = false;
                        let notice = format!("no bands of {}: {problem}", side.name);
                        report(Box::new(|model: &mut Self| model.set_notice(notice)));
                    }
                }
                compared(&shown, side)
            },
            |model: &mut Self, found: Result<Compared, String>| {
                model.jobs.comparison = found.map(Box::new).into();
            },
        ));
    }

    /// The other side of the comparison, if any.
    pub fn compared_with(&self) -> Option<&str> {
        self.compared_with.as_deref()
    }
}

/// Draws the page.
fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.page;
    let compared = match &model.jobs.comparison {
        JobState::Done(compared) => compared,
        JobState::Failed(problem) => {
            return message(&format!("cannot compare: {problem}"), area, frame);
        }
        JobState::Busy(_) => return message("comparing ...", area, frame),
        JobState::Idle => {
            let words = "nothing to compare with yet:  :compare FILE, FOLDER or SCENE";
            return message(words, area, frame);
        }
    };
    let scores =
        u16::try_from(compared.comparison.channels.len() + 1).unwrap_or(5).min(area.height / 2);
    let mut verdict = verdict(model, compared);
    let limits = Line::raw(compared.comparison.tolerance.join(", "));
    let lines = if verdict.width() + limits.width() > usize::from(area.width) {
        vec![verdict, limits]
    } else {
        verdict.extend(limits.spans);
        vec![verdict]
    };
    let heading = Rect { height: if lines.len() > 1 { 2 } else { 1 }, ..area };
    let table = Rect { y: area.bottom() - scores, height: scores, ..area };
    let height = area.height.saturating_sub(heading.height + scores);
    let diagrams = Rect { y: heading.bottom(), height, ..area };
    frame.render_widget(Paragraph::new(lines), heading);
    let place = chosen(model, compared);
    match model.overlay {
        Overlay::Traces => traces(model, (compared, place), diagrams, frame),
        Overlay::Difference => difference(model, (compared, place), diagrams, frame),
        Overlay::Both => {
            let upper = Rect { height: diagrams.height / 2 + diagrams.height % 2, ..diagrams };
            let lower = Rect { y: upper.bottom(), height: diagrams.height / 2, ..diagrams };
            traces(model, (compared, place), upper, frame);
            difference(model, (compared, place), lower, frame);
        }
    }
    table_of(model, (compared, place), table, frame);
}

/// The pair of the selected channel, or the first.
fn chosen(model: &ScreenState, compared: &Compared) -> usize {
    let name = model.selected().map(|capture| capture.waveform.source.to_string());
    let channels = &compared.comparison.channels;
    channels.iter().position(|c| Some(&c.name) == name.as_ref()).unwrap_or(0)
}

/// The result, the shift, and the other side's name.
fn verdict(model: &ScreenState, compared: &Compared) -> Line<'static> {
    let comparison = &compared.comparison;
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let passed = comparison.failures.is_empty();
    let tint = colour(model.palette(), if passed { Color::LightGreen } else { Color::LightRed });
    let expanded = comparison.shift_u_s.map(|u| NORMAL_95 * u);
    let shift = signed_with_expanded(comparison.shift_s, expanded, "s");
    let shifted = format!("  shifted {shift} by {}  ", comparison.align);
    Line::from(vec![
        Span::styled(comparison.verdict.to_uppercase(), bold.fg(tint)),
        Span::styled(shifted, bold),
        Span::raw(format!("against {}  ", comparison.simulated)),
    ])
}

/// Range of a trace with a little room (unit).
fn range<'a>(traces: impl Iterator<Item = &'a Trace>) -> (f64, f64) {
    let values = traces.flat_map(|trace| trace.values.iter().copied());
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low < high { (low - 0.05 * (high - low), high + 0.05 * (high - low)) } else { (-1.0, 1.0) }
}

fn times(trace: &Trace) -> DiagramAxis {
    DiagramAxis::linear(trace.start, trace.time(trace.values.len().saturating_sub(1)), "s")
}

fn points(trace: &Trace) -> impl Iterator<Item = (f64, f64)> + '_ {
    trace.values.iter().enumerate().map(|(index, value)| (trace.time(index), *value))
}

fn source_colour(model: &ScreenState, name: &str) -> Color {
    Source::from_name(name).map_or(Color::White, |source| colour_of(model.palette(), source))
}

fn traces(
    model: &ScreenState,
    (compared, place): (&Compared, usize),
    area: Rect,
    frame: &mut Frame,
) {
    let (Some(pair), Some(score)) =
        (compared.pairs.get(place), compared.comparison.channels.get(place))
    else {
        return;
    };
    let (low, high) = range([&pair.measured, &pair.simulated].into_iter());
    let grid = colour(model.palette(), Color::DarkGray);
    let mut sheet = Diagram::new(
        area,
        times(&pair.measured),
        DiagramAxis::linear(low, high, &score.unit),
        grid,
    );
    let band =
        model.jobs.bands.iter().find(|band| score.unit == "V" && band.channel == score.against);
    for edge in band.into_iter().flat_map(|band| [&band.low_v, &band.high_v].map(|v| (band, v))) {
        let (band, values) = edge;
        let at = |index: usize| band.start_s + score.shift_s + index as f64 * band.interval_s;
        let line = values.iter().enumerate().map(|(index, value)| (at(index), *value));
        sheet.line(line, grid);
    }
    sheet.line(points(&pair.simulated), colour(model.palette(), Color::White));
    sheet.line(points(&pair.measured), source_colour(model, &score.name));
    sheet.draw(colour(model.palette(), Color::Gray), frame);
    let grey = if band.is_some() { ", its 95 % band in grey" } else { "" };
    let text =
        format!("{} measured in colour, {} simulated in white{grey}", score.name, score.against);
    sheet.write((pair.measured.start, high), &text, Style::new(), frame);
}

fn difference(
    model: &ScreenState,
    (compared, place): (&Compared, usize),
    area: Rect,
    frame: &mut Frame,
) {
    let (Some(pair), Some(score)) =
        (compared.pairs.get(place), compared.comparison.channels.get(place))
    else {
        return;
    };
    let residual = pair.residual();
    let (low, high) = range(std::iter::once(&residual));
    let grid = colour(model.palette(), Color::DarkGray);
    let mut sheet =
        Diagram::new(area, times(&residual), DiagramAxis::linear(low, high, &score.unit), grid);
    sheet.level(0.0, colour(model.palette(), Color::Gray));
    sheet.line(points(&residual), colour(model.palette(), Color::LightRed));
    sheet.draw(colour(model.palette(), Color::Gray), frame);
    let newtons =
        score.rms_n.map_or_else(String::new, |rms| format!(" = {}", spelled(rms, "N", 3)));
    let text = format!(
        "difference: rms {} = {:.2} LSB{newtons}, largest {} = {:.1} LSB",
        spelled(score.rms, &score.unit, 3),
        score.rms_lsb,
        spelled(score.max, &score.unit, 3),
        score.max_lsb
    );
    sheet.write((residual.start, high), &text, Style::new(), frame);
}

fn percent(error: Option<Uncertain>) -> String {
    error.map_or("-".to_owned(), crate::report::signed_percent)
}

fn row(score: &ChannelScore) -> String {
    let arrival = score.arrival_error_s.map_or("-".to_owned(), |e| spelled(e.value, "s", 3));
    let force = score.rms_n.map_or("-".to_owned(), |rms| spelled(rms, "N", 3));
    format!(
        "{:<5}{:<7}{:>7.4}{:>17}{:>10}{:>10}{:>7.2}{:>9}{:>8.4}",
        score.name,
        score.against,
        score.gain.value,
        percent(score.peak_error),
        arrival,
        spelled(score.rms, &score.unit, 3),
        score.rms_lsb,
        force,
        score.correlation.unwrap_or(f64::NAN),
    )
}

fn table_of(
    model: &ScreenState,
    (compared, place): (&Compared, usize),
    area: Rect,
    frame: &mut Frame,
) {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let head = format!(
        "{:<5}{:<7}{:>7}{:>17}{:>10}{:>10}{:>7}{:>9}{:>8}",
        "", "against", "gain", "peak", "arrival", "rms", "LSB", "rms", "corr."
    );
    let mut lines = vec![Line::styled(head, bold)];
    for (index, score) in compared.comparison.channels.iter().enumerate() {
        let style = Style::new().fg(source_colour(model, &score.name));
        let style = if index == place { style.add_modifier(Modifier::REVERSED) } else { style };
        lines.push(Line::styled(row(score), style));
    }
    frame.render_widget(Paragraph::new(lines), area);
}
