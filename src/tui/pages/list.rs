//! Pages that are lists: one row is selected, and stands in full below the list.

use ratatui::Frame;
use ratatui::crossterm::event::KeyCode;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::Paragraph;

use crate::report::RowTable;
use crate::tui::axis::TurnDirection;
use crate::tui::key::KeyPress;
use crate::tui::model::{Action, ScreenState};
use crate::tui::view::colours::colour;
use crate::tui::view::panel::wrapped;

/// Rows of a list that are shown at least, before what stands below it.
const MIN_ROWS: u16 = 8;
/// Rows that the keys of a page pass.
const PAGE_ROWS: usize = 10;

/// Keys of all lists.
pub(super) const KEYS: &[(KeyPress, Action)] = &[
    (KeyPress::plain(KeyCode::Up), Action::Row(TurnDirection::Up, 1)),
    (KeyPress::plain(KeyCode::Down), Action::Row(TurnDirection::Down, 1)),
    (KeyPress::plain(KeyCode::PageUp), Action::Row(TurnDirection::Up, PAGE_ROWS)),
    (KeyPress::plain(KeyCode::PageDown), Action::Row(TurnDirection::Down, PAGE_ROWS)),
    (KeyPress::letter('N'), Action::Row(TurnDirection::Up, 1)),
    (KeyPress::letter('n'), Action::Row(TurnDirection::Down, 1)),
];

/// A list with what stands above and below it.
pub(super) struct List {
    pub(super) head: Vec<Line<'static>>,
    pub(super) rows: Vec<Line<'static>>,
    /// The selected row in full.
    pub(super) selected: String,
    /// Shown where there is room.
    pub(super) foot: String,
}

impl From<RowTable> for List {
    fn from(table: RowTable) -> Self {
        let lines = |lines: Vec<String>| lines.into_iter().map(Line::raw).collect();
        Self {
            head: lines(table.head),
            rows: lines(table.rows),
            selected: String::new(),
            foot: table.foot,
        }
    }
}

/// Draws as many rows around the selected one as there is room for.
pub(super) fn draw(model: &ScreenState, list: List, area: Rect, frame: &mut Frame) {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let grey = Style::new().fg(colour(model.palette(), Color::Gray));
    let height = |lines: &[Line]| u16::try_from(lines.len()).unwrap_or(u16::MAX);
    let width = usize::from(area.width);
    let styled = |text: &str, style: Style| -> Vec<Line<'static>> {
        wrapped(text, width).into_iter().map(|line| Line::styled(line, style)).collect()
    };
    let free = area.height.saturating_sub(height(&list.head));
    let mut below = styled(&list.selected, bold);
    below.truncate(usize::from(free.saturating_sub(MIN_ROWS)));
    let foot = styled(&list.foot, grey);
    // A sentence is always shown, an explanation where all rows are.
    let rows = if foot.len() > 1 { height(&list.rows) } else { MIN_ROWS };
    if height(&below) + height(&foot) + rows <= free {
        below.extend(foot);
    }
    let rows = usize::from(free - height(&below).min(free)).min(list.rows.len());
    let first = model.row.saturating_sub(rows / 2).min(list.rows.len() - rows);
    let mut lines = list.head;
    let shown = list.rows.into_iter().enumerate().skip(first).take(rows);
    lines.extend(shown.map(|(place, mut row)| {
        if place == model.row {
            row.style = row.style.add_modifier(Modifier::REVERSED);
        }
        row
    }));
    lines.extend(below);
    frame.render_widget(Paragraph::new(lines), area);
}
