//! Why a file could not be read or written.

use std::error::Error;
use std::fmt;
use std::path::Path;

/// A place in a text file.
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

/// Why a file could not be read, or a capture not be written: the place, and what was found and
/// expected there, or the system's error.
#[derive(Debug)]
pub struct RecordingError {
    /// File, line or byte; empty if there is no file yet.
    place: String,
    /// Empty if the source says it.
    problem: String,
    source: Option<Box<dyn Error + Send + Sync>>,
}

impl RecordingError {
    /// A problem at a place, which begins with the file.
    pub fn new(place: impl fmt::Display, problem: impl fmt::Display) -> Self {
        Self { place: place.to_string(), problem: problem.to_string(), source: None }
    }

    /// Something else than expected.
    pub fn found(
        place: impl fmt::Display,
        found: impl fmt::Display,
        expected: impl fmt::Display,
    ) -> Self {
        Self::new(place, format_args!("found {found}, expected {expected}"))
    }

    /// A value of `key` that it cannot have.
    pub fn value(
        place: impl fmt::Display,
        key: &str,
        found: impl fmt::Display,
        expected: impl fmt::Display,
    ) -> Self {
        Self::new(place, format_args!("`{key}` is {found}, expected {expected}"))
    }

    /// A part of a capture that the format cannot hold.
    pub fn unwritable(what: &str, found: impl fmt::Display, expected: impl fmt::Display) -> Self {
        Self::new("", format_args!("cannot write: {what} is {found}, expected {expected}"))
    }

    /// A file that is larger than what is read (bytes).
    pub fn too_large(place: impl fmt::Display, found: u64, limit: u64) -> Self {
        let problem = format!("{found} bytes are more than the {limit} that are read");
        Self::new(place, format_args!("{problem}: cut the record, or save fewer points"))
    }

    /// An error of the operating system, or of the container's writer.
    pub fn caused(file: &Path, source: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        let place = file.display().to_string();
        Self { place, problem: String::new(), source: Some(source.into()) }
    }
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let colon = if self.place.is_empty() || self.problem.is_empty() { "" } else { ": " };
        write!(f, "{}{colon}{}", self.place, self.problem)
    }
}

impl Error for RecordingError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        let source = self.source.as_deref()?;
        Some(source)
    }
}

/// A character of a text file.
pub(super) fn place(file: &str, line: usize, column: usize) -> FileLocation {
    FileLocation { file: file.to_owned(), line, column }
}

/// A byte of a file, counted from 0.
pub(super) fn byte(file: &str, offset: usize) -> String {
    format!("{file}, byte {offset}")
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

/// The same of bytes, which need not be text.
pub(super) fn excerpt_of_bytes(bytes: &[u8]) -> String {
    const LONGEST: usize = 32;
    let head = bytes.get(..bytes.len().min(LONGEST)).unwrap_or_default();
    let more = if bytes.len() > LONGEST { "…" } else { "" };
    format!("`{}{more}`", head.escape_ascii())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excerpts_are_short_and_printable() {
        assert_eq!(excerpt("Sample Interval"), "`Sample Interval`");
        assert_eq!(excerpt("a\r\n"), "`a\\r\\n`");
        assert_eq!(excerpt(&"x".repeat(1000)).chars().count(), 43);
        assert_eq!(excerpt_of_bytes(b"\x89M\n"), "`\\x89M\\n`");
    }
}
