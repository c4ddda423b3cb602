//! Reads a CSV file of any kind into captures: what an instrument saved, what spreadsheets and
//! other programs made of it, and tables. What is odd or had to be guessed is noted in the
//! captures.

use super::cells::CsvRows;
use super::columns::TableColumns;
use super::text::{DecodedText, decode};
use super::{header_columns, table};
use crate::recording::Capture;
use crate::recording::error::RecordingError;
use crate::recording::finite::check_numbers;

/// Larger files are refused unread; the family's own have less than 100 000 bytes, two million rows
/// of two channels less than this.
pub const MAXIMUM_BYTES: usize = 64 << 20;

/// Reads the `bytes` of a CSV file with one channel; `file_name` is for messages.
///
/// # Errors
/// As [`read_all`], and for a file with several channels.
pub fn read(bytes: &[u8], file_name: &str) -> Result<Capture, RecordingError> {
    let mut captures = read_all(bytes, file_name)?;
    let found = captures.len();
    captures
        .pop()
        .filter(|_| found == 1)
        .ok_or_else(|| RecordingError::found(file_name, format!("{found} channels"), "one"))
}

/// Reads the `bytes` of a CSV file; one capture for each channel in it.
///
/// # Errors
/// [`RecordingError`] if the file is too large, empty or not text, if a number is not one, if the
/// times are not even, or if it is unclear which column holds what.
pub fn read_all(bytes: &[u8], file_name: &str) -> Result<Vec<Capture>, RecordingError> {
    read_columns(bytes, file_name, &TableColumns::default())
}

/// The same for a table whose columns the user names; [`TableColumns::default`] leaves them to the
/// file.
///
/// # Errors
/// As [`read_all`].
pub fn read_columns(
    bytes: &[u8],
    file_name: &str,
    columns: &TableColumns,
) -> Result<Vec<Capture>, RecordingError> {
    check_size(bytes, file_name)?;
    let DecodedText { text, notes } = decode(bytes, file_name)?;
    let rows = CsvRows::new(file_name, &text)?;
    let mut captures = match header_columns::blocks(&rows) {
        blocks if columns.is_empty() && !blocks.is_empty() => {
            header_columns::read(&blocks, text.ends_with('\n'))?
        }
        _ => table::read(&rows, columns)?,
    };
    for capture in &mut captures {
        capture.notes.extend(notes.iter().cloned());
        check_numbers(&capture.waveform)
            .map_err(|problem| RecordingError::new(file_name, problem))?;
    }
    Ok(captures)
}

fn check_size(bytes: &[u8], file_name: &str) -> Result<(), RecordingError> {
    if bytes.is_empty() {
        return Err(RecordingError::found(file_name, "no bytes", "a Tektronix CSV file"));
    }
    if bytes.len() > MAXIMUM_BYTES {
        let (found, limit) = (bytes.len() as u64, MAXIMUM_BYTES as u64);
        return Err(RecordingError::too_large(file_name, found, limit));
    }
    Ok(())
}
