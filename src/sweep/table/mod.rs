//! The results of a sweep as a file: CSV, JSON lines, or Parquet. What was there is replaced when
//! the new file is whole.

#[cfg(feature = "parquet")]
mod parquet_file;

use std::io::{BufRead as _, BufReader, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use csv::StringRecord;

use super::row::{Column, ColumnKind, ResultRow, cells};
use super::{SweepError, at};
use crate::files::NewFile;

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
    match extension(file).as_deref() {
        Some("csv" | "jsonl") => Ok(()),
        Some("parquet") if cfg!(feature = "parquet") => Ok(()),
        Some("parquet") => Err(SweepError::NoParquet { file: shown() }),
        _ => Err(SweepError::Format { file: shown() }),
    }
}

/// Refuses to replace a file that holds something else than the table with these columns.
///
/// # Errors
/// [`SweepError::Exists`].
pub fn check_own(file: &Path, columns: &[Column]) -> Result<(), SweepError> {
    let mut first = String::new();
    let read =
        std::fs::File::open(file).and_then(|file| BufReader::new(file).read_line(&mut first));
    match read {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Ok(_) if first.trim_end() == head(columns) => Ok(()),
        _ => Err(SweepError::Exists { file: file.display().to_string() }),
    }
}

/// The line above the rows.
fn head(columns: &[Column]) -> String {
    let mut head = ResultRow::default();
    for column in columns {
        head.text(&column.name);
    }
    head.into_line()
}

fn extension(file: &Path) -> Option<String> {
    file.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase)
}

/// Writes a table of numbers, `csv`, in the format of the extension of `file`.
///
/// # Errors
/// [`SweepError`] where the file cannot be written.
pub fn write(file: &Path, csv: &str) -> Result<(), SweepError> {
    let mut lines = csv.lines();
    let names = cells(lines.next().unwrap_or_default());
    let column = |name: &str| {
        let kind = if name == "shot" { ColumnKind::Count } else { ColumnKind::Number };
        Column { name: name.to_owned(), kind }
    };
    let mut table = TableWriter::create(file, &names.iter().map(column).collect::<Vec<_>>())?;
    lines.try_for_each(|line| table.row(line, &cells(line)))?;
    table.finish()
}

impl TableWriter {
    pub(super) fn create(file: &Path, columns: &[Column]) -> Result<Self, SweepError> {
        check(file)?;
        let created = NewFile::replace(file).map_err(at(file))?;
        let out = match extension(file).as_deref() {
            #[cfg(feature = "parquet")]
            Some("parquet") => {
                Out::Parquet(parquet_file::ParquetFile::new(file, created, columns)?)
            }
            Some("jsonl") => Out::JsonLines(BufWriter::new(created), columns.to_vec()),
            _ => {
                let mut out = BufWriter::new(created);
                writeln!(out, "{}", head(columns)).map_err(at(file))?;
                Out::Csv(out)
            }
        };
        Ok(Self { file: file.to_owned(), out })
    }

    /// Adds a run: its `line`, and the `cells` of that.
    pub(super) fn row(&mut self, line: &str, cells: &StringRecord) -> Result<(), SweepError> {
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
        file.complete().map(|_| ()).map_err(at(&self.file))
    }
}

/// The object of a run. Numbers stand there with the digits that they have in the log; what is not
/// known is null.
fn object(columns: &[Column], cells: &StringRecord) -> String {
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
