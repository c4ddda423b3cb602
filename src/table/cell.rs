//! Columns, cells and tables in memory, and the error of their files.

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

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Its heading, with the unit.
    pub name: String,
    /// Type of its values.
    pub kind: ColumnKind,
}

impl Column {
    /// A column of numbers.
    pub fn number(name: impl Into<String>) -> Self {
        Self { name: name.into(), kind: ColumnKind::Number }
    }

    /// A column of whole numbers.
    pub fn count(name: impl Into<String>) -> Self {
        Self { name: name.into(), kind: ColumnKind::Count }
    }

    /// A column of words.
    pub fn text(name: impl Into<String>) -> Self {
        Self { name: name.into(), kind: ColumnKind::Text }
    }
}

/// A value in a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Not known.
    Absent,
    /// A number (unit).
    Number(f64),
    /// A whole number.
    Count(u64),
    /// Words.
    Text(String),
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<u32> for Cell {
    fn from(count: u32) -> Self {
        Self::Count(count.into())
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Absent, Into::into)
    }
}

impl Cell {
    /// The value as in a CSV file, before quoting: numbers with as many digits as distinguish them
    /// from all others, absent values empty.
    pub(super) fn text(&self) -> String {
        match self {
            Self::Absent => String::new(),
            Self::Number(value) if *value == 0.0 || (1e-4..1e15).contains(&value.abs()) => {
                value.to_string()
            }
            Self::Number(value) => format!("{value:e}"),
            Self::Count(count) => count.to_string(),
            Self::Text(text) => text.clone(),
        }
    }

    pub(super) fn json(&self) -> String {
        match self {
            Self::Absent => "null".to_owned(),
            Self::Text(text) => quoted(text),
            number => number.text(),
        }
    }
}

/// A table in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Its columns.
    pub columns: Vec<Column>,
    /// Its rows, each with a cell for every column.
    pub rows: Vec<Vec<Cell>>,
}

/// Error of a table's file.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file could not be read or written.
    #[error("{file}: {source}")]
    File {
        /// The file.
        file: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// The file exists and holds something else than this table.
    #[error(
        "{file}: exists already and is no table of this sweep: name another with -o, or replace it with --force"
    )]
    Exists {
        /// The file.
        file: String,
    },
    /// The name of the file has an unknown ending.
    #[error("{file}: found no .csv, .jsonl or .parquet at the end, expected one of them")]
    Format {
        /// The file.
        file: String,
    },
    /// The program was built without Parquet.
    #[error(
        "{file}: found a program without Parquet, expected one built with it: cargo install --features parquet"
    )]
    NoParquet {
        /// The file.
        file: String,
    },
    /// A number is infinite or not a number.
    #[error("{file}: found {value} in column `{column}`, row {row}, expected a finite number")]
    NotFinite {
        /// The file.
        file: String,
        /// Heading of the column.
        column: String,
        /// Row, counted from 1 below the heading.
        row: u64,
        /// The value (unit).
        value: f64,
    },
    /// Parquet could not be written.
    #[cfg(feature = "parquet")]
    #[error("{file}: {source}")]
    Parquet {
        /// The file.
        file: String,
        /// The format library's error.
        source: parquet::errors::ParquetError,
    },
}

/// `text` as a JSON string.
pub(super) fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
