//! The side panel: measurements and speeds, or the bench's knobs with the cost of the last impact.

use crate::quantity::Uncertain;
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::{Block, Borders, Clear, Paragraph};

use super::colours::colour_of;
use super::layout::{SIDE_WIDTH, ScreenLayout};
use super::panel::wrapped;
use super::readout::spelled;
use crate::measurement::arrivals::{SpeedBetween, Survey};
use crate::report::with_expanded;
use crate::tui::model::knobs::BenchKnob;
use crate::tui::model::{LiveBench, ScreenState, SidePanel};

/// Columns of a knob's name.
const KNOB_WIDTH: usize = 14;
/// Columns of a measurement's name; value and uncertainty need the rest.
const NAME_WIDTH: usize = 12;
/// Word before the effects that are on.
const EFFECTS_WORD: &str = "on: ";
/// Columns of a pair of channels.
const PAIR_WIDTH: usize = 9;

/// Draws the column.
pub(in crate::tui) fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let (title, lines) = match model.side() {
        SidePanel::Nothing => return,
        SidePanel::Measurements => (" Measure (M) ", measurements(model)),
        SidePanel::Knobs => (" Bench (B) ", knobs(model)),
    };
    // Without room beside the page it lies over it.
    let area = if layout.side.width > 0 {
        layout.side
    } else {
        let width = SIDE_WIDTH.min(layout.page.width);
        Rect { x: layout.page.right() - width, width, ..layout.page }
    };
    frame.render_widget(Clear, area);
    let block = Block::new().borders(Borders::LEFT | Borders::TOP | Borders::RIGHT).title(title);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    frame.render_widget(Paragraph::new(lines), inner);
}

fn pair(name: &str, value: &str) -> Line<'static> {
    Line::raw(format!("{name:<KNOB_WIDTH$}{value}"))
}

fn measurement(name: &str, value: &str) -> Line<'static> {
    Line::raw(format!("{name:<NAME_WIDTH$}{value}"))
}

fn heading(model: &ScreenState, text: String) -> Line<'static> {
    let tint =
        model.selected().map_or(Color::Reset, |c| colour_of(model.palette(), c.waveform.source));
    Line::styled(text, Style::new().fg(tint).add_modifier(Modifier::BOLD))
}

fn measurements(model: &ScreenState) -> Vec<Line<'static>> {
    let derived = model.derived();
    let name =
        model.selected().map_or_else(|| "no trace".to_owned(), |c| c.waveform.source.to_string());
    let mut lines = vec![heading(model, name)];
    for reading in &derived.readings {
        let value = reading.value.map_or_else(|| "?".to_owned(), |v| spelled(v, &reading.unit, 4));
        lines.push(measurement(reading.name, &value));
    }
    if let Some(survey) = &derived.survey {
        arrivals(model, survey, &mut lines);
    }
    lines
}

fn with_u(value: Uncertain, unit: &str) -> String {
    with_expanded(value.value, value.expanded(), unit)
}

/// The selected channel's first pulse, and the speeds between all.
fn arrivals(model: &ScreenState, survey: &Survey, lines: &mut Vec<Line<'static>>) {
    let name = model.selected().map(|c| c.waveform.source.to_string());
    if let Some(channel) = survey.channels.iter().find(|c| Some(&c.channel) == name.as_ref()) {
        let half = channel.arrivals.iter().find(|a| a.estimator == "half_rise");
        lines.extend(half.and_then(|a| a.time_s).map(|t| measurement("arrival", &with_u(t, "s"))));
        let own = channel.height.map(|height| (height, channel.unit.as_str()));
        let height = channel.height_n.map(|force| (force, "N")).or(own);
        lines.extend(height.map(|(height, unit)| measurement("1st peak", &with_u(height, unit))));
    }
    let half = |speed: &&SpeedBetween| speed.estimator == "half_rise";
    let speeds: Vec<&SpeedBetween> = survey.speeds.iter().filter(half).collect();
    if !speeds.is_empty() {
        lines.push(Line::styled(
            "speed, half-rise; ± is 95 %",
            Style::new().add_modifier(Modifier::BOLD),
        ));
    }
    for speed in speeds {
        let value = with_u(speed.m_per_s, "m/s");
        let ends = format!("{}-{}", speed.from, speed.to);
        lines.push(Line::raw(format!("{ends:<PAIR_WIDTH$}{value}")));
    }
}

fn knobs(model: &ScreenState) -> Vec<Line<'static>> {
    let (Some(live), Some(scene)) =
        (model.recordings.front().live.as_ref(), model.recordings.front().scene.as_ref())
    else {
        let served =
            model.recordings.front().live.as_ref().is_some_and(|live| live.served.is_some());
        let words = if served {
            ["its scene does not ship with", "this program; i, :set striker.", "speed 0.5 m/s work"]
        } else {
            ["striking the chain ...", "", ""]
        };
        return words.map(Line::raw).to_vec();
    };
    let source = model.selected().map(|capture| capture.waveform.source);
    let mut lines = Vec::new();
    let shown = BenchKnob::ALL.iter().enumerate().filter(|(_, knob)| knob.is_shown(scene));
    for (index, knob) in shown {
        let row = pair(knob.label, &knob.reading(scene, source));
        let style = if index == live.knob {
            Style::new().add_modifier(Modifier::REVERSED)
        } else {
            Style::new()
        };
        lines.push(row.style(style));
    }
    lines.extend(cost_text(live));
    lines
}

/// Cost, accuracy and effects of the last impact.
fn cost_text(live: &LiveBench) -> Vec<Line<'static>> {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let Some(summary) = &live.summary else { return Vec::new() };
    let accuracy = summary.accuracy.map_or_else(|| "-".to_owned(), |a| format!("{a:.0e}"));
    let mut lines = vec![
        Line::styled(if live.is_waiting() { "run (next on its way)" } else { "run" }, bold),
        pair(&format!("{} steps", summary.steps), &spelled(summary.wall_s, "s", 3)),
        pair("accuracy", &accuracy),
        pair("energy drift", &format!("{:.1e}", summary.energy.drift)),
    ];
    // Behind the word, so that further lines are seen to belong to it.
    let room = usize::from(SIDE_WIDTH) - 2 - EFFECTS_WORD.len();
    for (row, effects) in wrapped(&summary.effects.join(" "), room).into_iter().enumerate() {
        let word = if row == 0 { EFFECTS_WORD } else { "" };
        lines.push(Line::raw(format!("{word:<width$}{effects}", width = EFFECTS_WORD.len())));
    }
    lines
}
