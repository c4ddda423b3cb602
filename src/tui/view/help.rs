//! The keys, made from their table.

use ratatui::Frame;
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};

use super::panel;
use crate::tui::keys::BINDINGS;
use crate::tui::model::ScreenState;
use crate::tui::model::command::COMMANDS;

/// Draws the help over the screen.
pub(super) fn draw(model: &ScreenState, frame: &mut Frame) {
    let widest = BINDINGS.iter().map(|binding| Span::raw(binding.label).width()).max().unwrap_or(0);
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let mut lines: Vec<Line> = BINDINGS
        .iter()
        .map(|binding| {
            let pad = " ".repeat(widest + 2 - Span::raw(binding.label).width());
            Line::from(vec![
                Span::styled(binding.label, bold),
                Span::raw(pad),
                Span::raw(binding.help),
            ])
        })
        .collect();
    lines.push(Line::default());
    for (command, help) in COMMANDS {
        let pad = " ".repeat((widest + 2).saturating_sub(command.len()).max(1));
        lines.push(Line::from(vec![
            Span::styled(*command, bold),
            Span::raw(pad),
            Span::raw(*help),
        ]));
    }
    lines.push(Line::default());
    lines.push(Line::raw("* behind a scale: not as recorded; z goes back"));
    lines.push(Line::raw("Shift + mouse selects text in most terminals"));
    let problems = model.set().problems.len();
    if problems > 0 {
        let plural = if problems == 1 { "" } else { "s" };
        lines.push(Line::raw(format!("{problems} problem{plural} in this file: l lists them")));
    }
    panel(model, "Keys", lines, frame);
}
