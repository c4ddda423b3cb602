//! Boxes of text over a page.

use ratatui::Frame;
use ratatui::layout::{Alignment, Constraint, Margin, Rect};
use ratatui::text::Line;
use ratatui::widgets::{Block, Clear, Paragraph, Wrap};

/// Columns of a panel's frame and of the gaps inside it.
pub(in crate::tui) const PANEL_MARGINS: u16 = 4;

/// One sentence in the middle of `area`.
pub(in crate::tui) fn message(text: &str, area: Rect, frame: &mut Frame) {
    let middle = Rect { y: area.y + area.height / 2, height: 2.min(area.height), ..area };
    let words = Paragraph::new(text.to_owned()).alignment(Alignment::Center);
    frame.render_widget(words.wrap(Wrap { trim: true }), middle);
}

/// `text` in lines of at most `width` columns, broken between words.
pub(in crate::tui) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Text in a frame over the screen, as large as it needs and the terminal allows, from the line
/// `first` on.
pub(in crate::tui) fn panel(first: usize, title: &str, lines: Vec<Line>, frame: &mut Frame) {
    let area = frame.area();
    let widest = lines.iter().map(Line::width).max().unwrap_or(0);
    let width = u16::try_from(widest).unwrap_or(u16::MAX).saturating_add(PANEL_MARGINS);
    let width = width.min(area.width);
    let height = u16::try_from(lines.len() + 2).unwrap_or(u16::MAX).min(area.height);
    let place = area.centered(Constraint::Length(width), Constraint::Length(height));
    let inner = place.inner(Margin::new(2, 1));
    let hidden = lines.len().saturating_sub(usize::from(inner.height));
    let first = first.min(hidden);
    let more = if hidden > 0 {
        format!(" {title} ({}/{}, ↑↓) ", first + 1, hidden + 1)
    } else {
        format!(" {title} ")
    };
    frame.render_widget(Clear, place);
    frame.render_widget(Block::bordered().title(more), place);
    let shown: Vec<Line> = lines.into_iter().skip(first).collect();
    frame.render_widget(Paragraph::new(shown), inner);
}
