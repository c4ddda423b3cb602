//! The results of a sweep as a file: CSV, JSON lines, or Parquet. What was there is replaced when the new file is whole.

#[cfg(feature = "parquet")]
mod parquet_file;

use std::borrow::Cow;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

use super::plan::{Column, ColumnKind};
use super::row::ResultRow;
use super::{SweepError, at};
use crate::files::{NewFile, Output as _};

/// A table that is being written, under another name until it is whole.
pub(super) struct TableWriter {
    file: PathBuf,
    out: Out,
}

enum Out {
    Csv(BufWriter<NewFile>),
    JsonLines(BufWriter<NewFile>, Vec<Column>),
    #[cfg(feature = "parquet")]
    Parquet(parquet_file::ParquetFile),
}

/// Refuses the name of a table that cannot be written, before any work is done.
///
/// # Errors
/// [`SweepError::Format`] and [`SweepError::NoParquet`].
pub fn check(file: &Path) -> Result<(), SweepError> {
    let shown = || file.display().to_string();
    match extension(file) {
        Some("csv" | "jsonl") => Ok(()),
        Some("parquet") if cfg!(feature = "parquet") => Ok(()),
        Some("parquet") => Err(SweepError::NoParquet { file: shown() }),
        _ => Err(SweepError::Format { file: shown() }),
    }
}

fn extension(file: &Path) -> Option<&str> {
    file.extension().and_then(|extension| extension.to_str())
}

impl TableWriter {
    pub(super) fn create(file: &Path, columns: &[Column]) -> Result<Self, SweepError> {
        check(file)?;
        let created = NewFile::replace(file).map_err(at(file))?;
        let out = match extension(file) {
            #[cfg(feature = "parquet")]
            Some("parquet") => {
                Out::Parquet(parquet_file::ParquetFile::new(file, created, columns)?)
            }
            Some("jsonl") => Out::JsonLines(BufWriter::new(created), columns.to_vec()),
            _ => {
                let mut head = ResultRow::default();
                for column in columns {
                    head.text(&column.name);
                }
                let mut out = BufWriter::new(created);
                writeln!(out, "{}", head.into_line()).map_err(at(file))?;
                Out::Csv(out)
            }
        };
        Ok(Self { file: file.to_owned(), out })
    }

    /// Adds a run: its `line`, and the `cells` of that.
    pub(super) fn row(&mut self, line: &str, cells: &[Cow<'_, str>]) -> Result<(), SweepError> {
        match &mut self.out {
            Out::Csv(out) => writeln!(out, "{line}").map_err(at(&self.file)),
            Out::JsonLines(out, columns) => {
                let object = object(columns, cells);
                writeln!(out, "{object}").map_err(at(&self.file))
            }
            #[cfg(feature = "parquet")]
            Out::Parquet(out) => out.row(cells),
        }
    }

    /// Puts the whole table where it belongs.
    pub(super) fn finish(self) -> Result<(), SweepError> {
        let file = match self.out {
            Out::Csv(out) | Out::JsonLines(out, _) => {
                out.into_inner().map_err(|error| at(&self.file)(error.into_error()))?
            }
            #[cfg(feature = "parquet")]
            Out::Parquet(out) => out.finish()?,
        };
        Box::new(file).complete().map(|_| ()).map_err(at(&self.file))
    }
}

/// The object of a run. Numbers stand there with the digits that they have in the log; what is not known is null.
fn object(columns: &[Column], cells: &[Cow<'_, str>]) -> String {
    let mut text = String::from("{");
    for (index, (column, cell)) in columns.iter().zip(cells).enumerate() {
        if index > 0 {
            text.push(',');
        }
        text.push_str(&quoted(&column.name));
        text.push(':');
        match column.kind {
            _ if cell.is_empty() => text.push_str("null"),
            ColumnKind::Number | ColumnKind::Count => text.push_str(cell),
            ColumnKind::Text => text.push_str(&quoted(cell)),
        }
    }
    text.push('}');
    text
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
