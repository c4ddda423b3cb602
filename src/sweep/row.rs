//! One run's results as a line of CSV: what the log keeps and tables are made of.

use csv::StringRecord;
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
pub(super) struct ResultRow(StringRecord);

impl ResultRow {
    /// Adds a number with as many digits as distinguish it from every other.
    pub(super) fn number(&mut self, value: Option<f64>) {
        let is_plain = |value: f64| value == 0.0 || (1e-4..1e15).contains(&value.abs());
        let text = match value.filter(|value| value.is_finite()) {
            None => String::new(),
            Some(value) if is_plain(value) => value.to_string(),
            Some(value) => format!("{value:e}"),
        };
        self.0.push_field(&text);
    }

    pub(super) fn count(&mut self, value: u64) {
        self.0.push_field(&value.to_string());
    }

    /// Adds words; a run is one line, so that line ends become spaces.
    pub(super) fn text(&mut self, value: &str) {
        self.0.push_field(&value.replace(['\n', '\r'], " "));
    }

    pub(super) fn into_line(self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        // Writing to memory does not fail.
        let _ = writer.write_record(&self.0);
        let bytes = writer.into_inner().unwrap_or_default();
        String::from_utf8_lossy(&bytes).trim_end_matches('\n').to_owned()
    }
}

/// The cells of a line.
pub(super) fn cells(line: &str) -> StringRecord {
    let reader = csv::ReaderBuilder::new().has_headers(false).from_reader(line.as_bytes());
    reader.into_records().next().and_then(Result::ok).unwrap_or_default()
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
            found.iter().skip(3).map(|c| c.replace(' ', "_")).collect::<Vec<_>>(),
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
