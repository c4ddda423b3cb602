//! Errors of reading and writing native CSV files. Used by the reader
//! and the writer of this folder; source of the rules: the module above.

use std::fmt;

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileLocation {
    /// The file's name as the reader was told.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Character in the line, counted from 1.
    pub column: usize,
}

impl fmt::Display for FileLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, line {}, column {}", self.file, self.line, self.column)
    }
}

/// Why a file could not be read, or a capture not be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TekCsvError {
    /// The file is larger than what is read.
    #[error(
        "{file}: {found} bytes are more than the {limit} that are read: cut the record, or save fewer points"
    )]
    TooLarge {
        /// The file's name.
        file: String,
        /// Its size in bytes.
        found: u64,
        /// The largest size that is read, in bytes.
        limit: u64,
    },
    /// There is nothing in the file.
    #[error("{file}: found no bytes, expected a Tektronix CSV file")]
    Empty {
        /// The file's name.
        file: String,
    },
    /// Not text.
    #[error("{place}: found byte 0x{found:02X}, expected UTF-8 text")]
    NotText {
        /// Where.
        place: FileLocation,
        /// The first byte that does not belong.
        found: u8,
    },
    /// A header row's value is not what it can be.
    #[error("{place}: `{key}` is {found}, expected {expected}")]
    Entry {
        /// Where the value stands.
        place: FileLocation,
        /// Its key.
        key: String,
        /// The value.
        found: String,
        /// The allowed values.
        expected: String,
    },
    /// A field that should be empty or a number is not.
    #[error("{place}: found {found}, expected {expected}")]
    Field {
        /// Where.
        place: FileLocation,
        /// The text found.
        found: String,
        /// The text expected.
        expected: &'static str,
    },
    /// Times that are not evenly spaced.
    #[error("{place}: found {found} {unit}, expected {expected} {unit} by even spacing")]
    Uneven {
        /// Where.
        place: FileLocation,
        /// The number found.
        found: String,
        /// The text expected.
        expected: String,
        /// Its unit.
        unit: &'static str,
    },
    /// Too few rows of samples, or too many.
    #[error("{file}: found {found} rows, expected {lowest} to {highest} with samples")]
    SampleCount {
        /// The file's name.
        file: String,
        /// Rows with samples.
        found: usize,
        /// Fewest that make a record.
        lowest: usize,
        /// Most that are read.
        highest: usize,
    },
    /// More rows than are read.
    #[error(
        "{file}: {found} rows are more than the {limit} that are read: cut the record, or save fewer points"
    )]
    TooManyRows {
        /// The file's name.
        file: String,
        /// Its rows.
        found: usize,
        /// Most that are read.
        limit: usize,
    },
    /// Numbers that cannot be computed with.
    #[error("{file}: {problem}")]
    Numbers {
        /// The file's name.
        file: String,
        /// What was found and what is expected.
        problem: String,
    },
    /// A table of no known form, or one whose columns cannot be told.
    #[error(
        "{file}: this is nearest to {nearest}, but lacks {missing}; say what its columns are, e.g. --columns {example}"
    )]
    Unrecognised {
        /// The file's name.
        file: String,
        /// The nearest form.
        nearest: &'static str,
        /// What it lacks, or what is unclear.
        missing: String,
        /// How columns are given.
        example: &'static str,
    },
    /// The capture does not name the instrument that took it.
    #[error("the capture names no instrument, expected at least its firmware")]
    NoInstrument,
    /// The capture holds something that this format cannot say.
    #[error("cannot write: {what} is {found}, expected {expected}")]
    Unwritable {
        /// The part of the capture.
        what: String,
        /// Its value.
        found: String,
        /// The values that the format can hold.
        expected: String,
    },
}

/// `text` between backticks, control characters escaped, cut to a length that fits a message.
pub(super) fn excerpt(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut shown: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    format!("`{shown}`")
}

pub(super) fn place(file: &str, line: usize, column: usize) -> FileLocation {
    FileLocation { file: file.to_owned(), line, column }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excerpts_are_short_and_printable() {
        assert_eq!(excerpt("Sample Interval"), "`Sample Interval`");
        assert_eq!(excerpt("a\r\n"), "`a\\r\\n`");
        assert_eq!(excerpt(&"x".repeat(1000)).chars().count(), 43);
    }
}
