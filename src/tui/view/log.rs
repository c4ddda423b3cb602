//! Problems of the file, and the lines of its log.

use ratatui::Frame;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Line;

use super::{colour, panel};
use crate::tui::model::ScreenState;

/// Draws the list over the screen, problems first.
pub(super) fn draw(model: &ScreenState, frame: &mut Frame) {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let warning = Style::new().fg(colour(model.palette(), Color::LightRed));
    let set = model.set();
    let mut lines = vec![Line::styled("Problems", bold)];
    if set.problems.is_empty() {
        lines.push(Line::raw("none"));
    }
    for problem in &set.problems {
        lines.push(Line::styled(problem.as_str(), warning));
    }
    lines.push(Line::default());
    lines.push(Line::styled("Log", bold));
    if set.log.is_empty() {
        lines.push(Line::raw("empty"));
    }
    lines.extend(set.log.iter().map(|line| Line::raw(line.as_str())));
    panel(model, "Problems and log", lines, frame);
}
