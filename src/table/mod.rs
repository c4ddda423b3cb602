//! Tables of typed cells and their files: CSV (RFC 4180), JSON lines, Apache Parquet.
//!
//! A cell is a number, a count, a text, or absent; the writers format it and read no text again, so
//! that all three files hold the same values. A number that is not finite is refused: a value that
//! is not known is absent, which is an empty cell or null. What was there is replaced when the new
//! file is complete.

mod cell;
#[cfg(feature = "parquet")]
mod parquet_file;

pub use cell::{Cell, Column, ColumnKind, Table, TableError};

use std::io::{BufWriter, Read as _, Write as _};
use std::path::{Path, PathBuf};

use crate::files::NewFile;

fn shown(file: &Path) -> String {
    file.display().to_string()
}

fn at(file: &Path) -> impl FnOnce(std::io::Error) -> TableError {
    move |source| TableError::File { file: shown(file), source }
}

fn extension(file: &Path) -> Option<String> {
    file.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase)
}

/// Refuses the name of a table that cannot be written, before any work is done.
///
/// # Errors
/// [`TableError::Format`] and [`TableError::NoParquet`].
pub fn check(file: &Path) -> Result<(), TableError> {
    match extension(file).as_deref() {
        Some("csv" | "jsonl") => Ok(()),
        Some("parquet") if cfg!(feature = "parquet") => Ok(()),
        Some("parquet") => Err(TableError::NoParquet { file: shown(file) }),
        _ => Err(TableError::Format { file: shown(file) }),
    }
}

/// Refuses to replace a file that holds something else than a CSV table with these columns.
///
/// # Errors
/// [`TableError::Exists`].
pub fn check_own(file: &Path, columns: &[Column]) -> Result<(), TableError> {
    let head = head(columns);
    let mut found = Vec::new();
    let read = std::fs::File::open(file)
        .and_then(|file| file.take(head.len() as u64).read_to_end(&mut found));
    match read {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Ok(_) if found == head.as_bytes() => Ok(()),
        _ => Err(TableError::Exists { file: shown(file) }),
    }
}

/// The first line of a CSV table.
fn head(columns: &[Column]) -> String {
    csv_line(columns.iter().map(|column| column.name.as_str()))
}

/// A line of CSV with its line feed: cells with commas, quotation marks or line ends are quoted.
fn csv_line<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    let mut writer = csv::WriterBuilder::new().buffer_capacity(512).from_writer(Vec::new());
    // Writing to memory cannot fail.
    let _ = writer.write_record(cells);
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// A row as a line of CSV without its line feed. Line ends in texts become spaces: the result is
/// one line in every case.
pub fn row_line(cells: &[Cell]) -> String {
    let cells: Vec<String> =
        cells.iter().map(|cell| cell.text().replace(['\n', '\r'], " ")).collect();
    csv_line(cells.iter().map(String::as_str)).trim_end_matches('\n').to_owned()
}

/// The row in a line that [`row_line`] wrote, with the types of `columns`.
pub fn read_row(line: &str, columns: &[Column]) -> Vec<Cell> {
    let record = if line.contains('"') {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(line.as_bytes());
        reader.records().next().and_then(Result::ok).unwrap_or_default()
    } else {
        // A reader for each of a sweep's lines takes longer than the lines.
        line.split(',').collect()
    };
    let cell = |(index, column): (usize, &Column)| match record.get(index) {
        None | Some("") => Cell::Absent,
        Some(text) => match column.kind {
            ColumnKind::Number => text.parse::<f64>().ok().into(),
            ColumnKind::Count => text.parse::<u64>().ok().into(),
            ColumnKind::Text => text.into(),
        },
    };
    columns.iter().enumerate().map(cell).collect()
}

/// Writes `table` in the format that the ending of `file` names.
///
/// # Errors
/// [`TableError`] for an unknown ending, a number that is not finite, or a file that cannot be
/// written.
pub fn write(file: &Path, table: &Table) -> Result<(), TableError> {
    let mut writer = TableWriter::create(file, &table.columns)?;
    table.rows.iter().try_for_each(|row| writer.row(row))?;
    writer.finish()
}

/// A table that is being written, under a temporary name until it is complete.
pub struct TableWriter {
    file: PathBuf,
    columns: Vec<Column>,
    rows: u64,
    out: Out,
}

#[cfg_attr(
    not(feature = "parquet"),
    allow(clippy::large_enum_variant, reason = "one for each file")
)]
enum Out {
    Csv(csv::Writer<NewFile>),
    JsonLines(BufWriter<NewFile>),
    #[cfg(feature = "parquet")]
    Parquet(parquet_file::ParquetFile),
}

impl TableWriter {
    /// Begins the table `file` in the format that its ending names.
    ///
    /// # Errors
    /// As [`write()`].
    pub fn create(file: &Path, columns: &[Column]) -> Result<Self, TableError> {
        check(file)?;
        let created = NewFile::replace(file).map_err(at(file))?;
        let out = match extension(file).as_deref() {
            #[cfg(feature = "parquet")]
            Some("parquet") => {
                Out::Parquet(parquet_file::ParquetFile::new(file, created, columns)?)
            }
            Some("jsonl") => Out::JsonLines(BufWriter::new(created)),
            _ => {
                let mut out = csv::Writer::from_writer(created);
                let names = columns.iter().map(|column| &column.name);
                out.write_record(names).map_err(|error| at(file)(error.into()))?;
                Out::Csv(out)
            }
        };
        Ok(Self { file: file.to_owned(), columns: columns.to_vec(), rows: 0, out })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// As [`write()`].
    pub fn row(&mut self, cells: &[Cell]) -> Result<(), TableError> {
        self.rows += 1;
        for (cell, column) in cells.iter().zip(&self.columns) {
            if let Cell::Number(value) = cell
                && !value.is_finite()
            {
                return Err(TableError::NotFinite {
                    file: shown(&self.file),
                    column: column.name.clone(),
                    row: self.rows,
                    value: *value,
                });
            }
        }
        match &mut self.out {
            Out::Csv(out) => out
                .write_record(cells.iter().map(Cell::text))
                .map_err(|error| at(&self.file)(error.into())),
            Out::JsonLines(out) => {
                writeln!(out, "{}", object(&self.columns, cells)).map_err(at(&self.file))
            }
            #[cfg(feature = "parquet")]
            Out::Parquet(out) => out.row(cells),
        }
    }

    /// Gives the complete table its name.
    ///
    /// # Errors
    /// As [`write()`].
    pub fn finish(self) -> Result<(), TableError> {
        let file = match self.out {
            Out::Csv(out) => {
                out.into_inner().map_err(|error| at(&self.file)(error.into_error()))?
            }
            Out::JsonLines(out) => {
                out.into_inner().map_err(|error| at(&self.file)(error.into_error()))?
            }
            #[cfg(feature = "parquet")]
            Out::Parquet(out) => out.finish()?,
        };
        file.complete().map(|_| ()).map_err(at(&self.file))
    }
}

/// A row as a JSON object, its keys in the order of the columns.
fn object(columns: &[Column], cells: &[Cell]) -> String {
    let pair = |(column, cell): (&Column, &Cell)| {
        format!("{}:{}", cell::quoted(&column.name), cell.json())
    };
    let pairs: Vec<String> = columns.iter().zip(cells).map(pair).collect();
    format!("{{{}}}", pairs.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_from_their_lines() {
        let words = ["plain", "a, b", "\"quoted\"", "\"", "two\nlines", ",", "\"\","];
        let mut columns = vec![Column::count("run"), Column::number("x"), Column::number("y")];
        let mut row: Vec<Cell> = vec![7_u64.into(), 5.529e-5.into(), Cell::Absent];
        for word in words {
            columns.push(Column::text(word));
            row.push(word.replace('\n', " ").as_str().into());
        }
        let line = row_line(&row);
        assert!(line.starts_with("7,5.529e-5,,plain,\"a, b\","), "{line}");
        assert_eq!(read_row(&line, &columns), row);
        // Without a quotation mark, too.
        let (columns, row) = (&columns[..4], &row[..4]);
        assert_eq!(row_line(row), "7,5.529e-5,,plain");
        assert_eq!(read_row("7,5.529e-5,,plain", columns), row);
    }

    #[test]
    fn numbers_keep_every_bit() {
        for value in [0.1 + 0.2, 5e-324, f64::MAX, 1.0 / 3.0, -1e-4, 123_456_789.125, 1e15, -0.0] {
            let text = Cell::Number(value).text();
            assert_eq!(text.parse::<f64>().expect("a number").to_bits(), value.to_bits(), "{text}");
        }
    }

    #[test]
    fn a_number_that_is_not_finite_is_refused_with_its_column() {
        let folder = tempfile::tempdir().expect("a folder");
        let table = Table {
            columns: vec![Column::number("force_N")],
            rows: vec![vec![1.0.into()], vec![f64::INFINITY.into()]],
        };
        let file = folder.path().join("t.csv");
        let error = write(&file, &table).expect_err("an infinite force").to_string();
        assert!(error.contains("found inf in column `force_N`, row 2"), "{error}");
        assert!(!file.exists());
    }
}
