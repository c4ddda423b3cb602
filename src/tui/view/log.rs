//! Problems of the file, and the lines of its log.

use ratatui::Frame;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Line;

use super::colours::colour;
use super::panel::{PANEL_MARGINS, panel, wrapped};
use crate::tui::model::ScreenState;

/// Draws the list over the screen, problems first.
pub(in crate::tui) fn draw(model: &ScreenState, frame: &mut Frame) {
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
