//! Pages that are lists: effects, hard cases, messages of the remote interface. One row is
//! selected, and stands in full below the list.

use super::ScreenState;
use super::state::{Page, PrintedTables};
use crate::recording::{ScpiLine, Shot};
use crate::tui::axis::TurnDirection;

impl ScreenState {
    /// Whether the page is a list.
    pub fn is_list(&self) -> bool {
        matches!(self.page, Page::Effects | Page::HardCases | Page::Remote)
    }

    /// Place of the selected row.
    pub fn row(&self) -> usize {
        self.row
    }

    /// Prints tables as the commands do.
    pub fn print_with(&mut self, tables: PrintedTables) {
        self.tables = Some(tables);
    }

    /// How tables are printed; none where nothing prints them.
    pub fn tables(&self) -> Option<&PrintedTables> {
        self.tables.as_ref()
    }

    fn rows(&self) -> usize {
        match self.page {
            Page::Effects => self.questions.ledger.done().map_or(0, |ledger| ledger.entries.len()),
            Page::HardCases => self.questions.hard_cases.done().map_or(0, Vec::len),
            Page::Remote => self.remote_messages().len(),
            _ => 0,
        }
    }

    /// Selects the row that is `by` further on: up is towards the first one.
    pub(super) fn move_row(&mut self, turn: TurnDirection, by: usize) {
        let last = self.rows().saturating_sub(1);
        self.row = match turn {
            TurnDirection::Up => self.row.saturating_sub(by),
            TurnDirection::Down => (self.row + by).min(last),
        };
    }

    /// Selects the first row; among messages the shot.
    pub(super) fn select_first_row(&mut self) {
        self.row = match self.page {
            Page::Remote => {
                self.remote_messages().iter().position(Option::is_none).unwrap_or_default()
            }
            _ => 0,
        };
    }

    /// Messages of the remote interface from the shot before this one to the one after it, in
    /// order; `None` stands where this one does.
    pub fn remote_messages(&self) -> Vec<Option<&ScpiLine>> {
        let Some(here) = self.shot().map(|shot| shot.timestamp_ns) else { return Vec::new() };
        let times = || self.set.shots.iter().map(|shot: &Shot| shot.timestamp_ns);
        let from = times().filter(|at| *at < here).max().map_or(0, |at| at + 1);
        let to = times().filter(|at| *at > here).min().unwrap_or(u64::MAX);
        let inside = |line: &&ScpiLine| (from..=to).contains(&line.timestamp_ns);
        let lines: Vec<&ScpiLine> = self.set.lines.iter().filter(inside).collect();
        if lines.is_empty() {
            return Vec::new();
        }
        let (before, after) = lines.split_at(lines.partition_point(|l| l.timestamp_ns <= here));
        let before = before.iter().copied().map(Some);
        before.chain([None]).chain(after.iter().copied().map(Some)).collect()
    }
}
