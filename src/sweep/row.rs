//! One run's results as a line of CSV: what the log keeps and tables are made of.

use std::borrow::Cow;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

/// Type of a column's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColumnKind {
    /// Numbers with a unit.
    Number,
    /// Whole numbers, from 0.
    Count,
    /// Words.
    Text,
}

/// A column of the results.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Its heading, the unit in brackets.
    pub name: String,
    /// Type of its values.
    pub kind: ColumnKind,
}

impl Column {
    pub(super) fn number(name: &str, unit: &str) -> Self {
        Self { name: format!("{name} ({unit})"), kind: ColumnKind::Number }
    }

    pub(super) fn count(name: &str) -> Self {
        Self { name: name.to_owned(), kind: ColumnKind::Count }
    }

    pub(super) fn text(name: &str) -> Self {
        Self { name: name.to_owned(), kind: ColumnKind::Text }
    }
}

/// A line being written.
#[derive(Debug, Default)]
pub(super) struct ResultRow {
    text: String,
    begun: bool,
}

impl ResultRow {
    fn cell(&mut self) -> &mut String {
        if std::mem::replace(&mut self.begun, true) {
            self.text.push(',');
        }
        &mut self.text
    }

    /// With as many digits as tell it from every other number.
    pub(super) fn number(&mut self, value: Option<f64>) {
        let text = self.cell();
        let Some(value) = value.filter(|value| value.is_finite()) else { return };
        let plain = value == 0.0 || (1e-4..1e15).contains(&value.abs());
        // Writing to a text does not fail.
        let _ = if plain { write!(text, "{value}") } else { write!(text, "{value:e}") };
    }

    pub(super) fn count(&mut self, value: u64) {
        let _ = write!(self.cell(), "{value}");
    }

    pub(super) fn text(&mut self, value: &str) {
        let text = self.cell();
        let value = value.replace(['\n', '\r'], " ");
        if value.contains(['"', ',']) {
            let _ = write!(text, "\"{}\"", value.replace('"', "\"\""));
        } else {
            text.push_str(&value);
        }
    }

    pub(super) fn into_line(self) -> String {
        self.text
    }
}

/// The cells of a line.
pub(super) fn cells(line: &str) -> Vec<Cow<'_, str>> {
    let mut cells = Vec::new();
    let mut rest = Some(line);
    while let Some(text) = rest {
        let end = if text.starts_with('"') { closing(text) } else { 0 };
        let end = text[end..].find(',').map_or(text.len(), |comma| end + comma);
        let cell = &text[..end];
        let inner = cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"'));
        cells.push(inner.map_or(Cow::Borrowed(cell), |inner| inner.replace("\"\"", "\"").into()));
        rest = text.get(end + 1..);
    }
    cells
}

/// Where the quotation that `text` begins with ends; a pair of marks is a mark in it.
fn closing(text: &str) -> usize {
    let mut at = 1;
    while let Some(mark) = text[at..].find('"') {
        at += mark + 1;
        if !text[at..].starts_with('"') {
            return at;
        }
        at += 1;
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_come_back() {
        let words = ["plain", "", "a, b", "\"quoted\"", "\"", "two\nlines", ",", "\"\","];
        let mut row = ResultRow::default();
        row.count(7);
        row.number(Some(5.529e-5));
        row.number(None);
        for word in words {
            row.text(word);
        }
        let line = row.into_line();
        assert!(line.starts_with("7,5.529e-5,,plain,"), "{line}");
        let found = cells(&line);
        assert_eq!(
            found[3..].iter().map(|c| c.replace(' ', "_")).collect::<Vec<_>>(),
            words.map(|w| w.replace([' ', '\n'], "_"))
        );
    }

    #[test]
    fn numbers_keep_every_bit() {
        for value in [0.1 + 0.2, 5e-324, f64::MAX, 1.0 / 3.0, -1e-4, 123_456_789.125, 1e15, -0.0] {
            let mut row = ResultRow::default();
            row.number(Some(value));
            let line = row.into_line();
            assert_eq!(line.parse::<f64>().expect("a number").to_bits(), value.to_bits(), "{line}");
        }
    }
}
