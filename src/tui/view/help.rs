//! What the keys `?` and `l` show over the screen: the keys, and problems and log.

use ratatui::Frame;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};

use super::colours::colour;
use super::panel::{PANEL_MARGINS, panel, wrapped};
use crate::tui::keys::{HelpRow, groups};
use crate::tui::model::command::COMMANDS;
use crate::tui::model::{Popup, ScreenState};

/// Draws the help over the screen.
pub(in crate::tui) fn help(model: &ScreenState, frame: &mut Frame) {
    let mut groups = groups();
    let labels = groups.iter().flat_map(|(_, rows)| rows).map(|(label, _)| label);
    let widest = labels.map(|label| Span::raw(label).width()).max().unwrap_or(0);
    let commands = COMMANDS.iter().map(|command| (command.usage(), command.help())).collect();
    groups.push(("Command line: Tab completes, ↑ ↓ bring back", commands));
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let row = |(label, help): HelpRow| {
        let pad = (widest + 2).saturating_sub(Span::raw(&label).width()).max(1);
        Line::from(vec![Span::styled(label, bold), Span::raw(" ".repeat(pad)), Span::raw(help)])
    };
    let searched = model.prompt().to_lowercase();
    let is_found =
        |label: &str, help: &str| format!("{label} {help}").to_lowercase().contains(&searched);
    let mut lines: Vec<Line> = Vec::new();
    for (title, rows) in groups {
        let found: Vec<_> =
            rows.into_iter().filter(|(label, help)| is_found(label, help)).collect();
        if !found.is_empty() {
            lines.push(Line::styled(title, bold.add_modifier(Modifier::UNDERLINED)));
            lines.extend(found.into_iter().map(row));
        }
    }
    if lines.is_empty() {
        lines.push(Line::raw("no key or command has these words: Backspace takes letters back"));
    }
    if searched.is_empty() {
        lines.push(Line::default());
        lines.push(Line::raw("* behind a scale: not as recorded; z goes back"));
        lines.push(Line::raw("Shift + mouse selects text in most terminals"));
        let problems = model.recordings.front().set.problems.len();
        if problems > 0 {
            let plural = if problems == 1 { "" } else { "s" };
            lines.push(Line::raw(format!("{problems} problem{plural} in this file: l lists them")));
        }
    }
    let title = match (model.panel(), searched.is_empty()) {
        (Popup::Search, _) => format!("Keys with: {}_", model.prompt()),
        (_, true) => "Keys: / searches".to_owned(),
        _ => format!("Keys with: {}", model.prompt()),
    };
    panel(model.scroll(), &title, lines, frame);
}

/// Draws the list over the screen, problems first.
pub(in crate::tui) fn log(model: &ScreenState, frame: &mut Frame) {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let warning = Style::new().fg(colour(model.palette(), Color::LightRed));
    let set = &model.recordings.front().set;
    let width = usize::from(frame.area().width.saturating_sub(PANEL_MARGINS));
    let texts = |texts: &[String], none: &'static str, style: Style| -> Vec<Vec<Line>> {
        let lines = texts.iter().map(|text| {
            wrapped(text, width).into_iter().map(|line| Line::styled(line, style)).collect()
        });
        if texts.is_empty() { vec![vec![Line::raw(none)]] } else { lines.collect() }
    };
    let mut entries = vec![vec![Line::styled("Problems", bold)]];
    entries.extend(texts(&set.problems, "none", warning));
    entries.push(vec![Line::default(), Line::styled("Log", bold)]);
    entries.extend(texts(&set.log, "empty", Style::new()));
    let first = entries.iter().take(model.scroll()).map(Vec::len).sum();
    panel(first, "Problems and log", entries.concat(), frame);
}
