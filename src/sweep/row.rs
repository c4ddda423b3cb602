//! One run's results as a row: what the log keeps as a line of CSV, and tables are made of.

use crate::table::{Cell, row_line};
pub use crate::table::{Column, ColumnKind};

/// A row being filled.
#[derive(Debug, Default)]
pub(super) struct ResultRow(Vec<Cell>);

impl ResultRow {
    /// Adds a number; absent if it is not known or not finite.
    pub(super) fn number(&mut self, value: Option<f64>) {
        self.0.push(value.filter(|value| value.is_finite()).into());
    }

    pub(super) fn count(&mut self, value: u64) {
        self.0.push(value.into());
    }

    pub(super) fn text(&mut self, value: &str) {
        self.0.push(value.into());
    }

    pub(super) fn into_line(self) -> String {
        row_line(&self.0)
    }
}
