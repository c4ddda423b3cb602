//! Errors of reading and writing ISF files.

/// Why a file could not be read, or a capture not be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum IsfError {
    /// The file is larger than any of this format.
    #[error("{file}: found {found} bytes, expected at most {limit}")]
    TooLarge {
        /// The file's name.
        file: String,
        /// Its size in bytes.
        found: usize,
        /// The largest size that is read, in bytes.
        limit: usize,
    },
    /// There is no block of levels.
    #[error("{file}: found no CURVE in the first {searched} bytes, expected an ISF file")]
    NoCurve {
        /// The file's name.
        file: String,
        /// How far it was looked for.
        searched: usize,
    },
    /// The preamble does not tell something that cannot be guessed.
    #[error("{file}: found no {key}, expected it before CURVE")]
    Missing {
        /// The file's name.
        file: String,
        /// The missing part.
        key: &'static str,
    },
    /// A value of the preamble is not what it can be.
    #[error("{file}, byte {offset}: `{key}` is {found}, expected {expected}")]
    Entry {
        /// The file's name.
        file: String,
        /// Where the value stands, counted from 0.
        offset: usize,
        /// Its key.
        key: &'static str,
        /// The value.
        found: String,
        /// The allowed values.
        expected: String,
    },
    /// Numbers of the preamble that cannot be computed with.
    #[error("{file}: {problem}")]
    Numbers {
        /// The file's name.
        file: String,
        /// What was found and what is expected.
        problem: String,
    },
    /// The block does not begin, go on or divide as a block does.
    #[error("{file}, byte {offset}: found {found}, expected {expected}")]
    Block {
        /// The file's name.
        file: String,
        /// Where, counted from 0.
        offset: usize,
        /// The text found.
        found: String,
        /// The text expected.
        expected: String,
    },
    /// The file ends inside the block.
    #[error(
        "{file}, byte {offset}: the file ends after {found} bytes of the block, expected {expected}"
    )]
    Truncated {
        /// The file's name.
        file: String,
        /// Where the file ends, counted from 0.
        offset: usize,
        /// Bytes that are there.
        found: usize,
        /// Bytes that the block promises.
        expected: usize,
    },
    /// The capture holds something that this format cannot say.
    #[error("cannot write: {what} is {found}, expected {expected}")]
    Unwritable {
        /// The part of the capture.
        what: &'static str,
        /// Its value.
        found: String,
        /// The values that the format can hold.
        expected: String,
    },
}

/// `bytes` between backticks, escaped, cut to a length that fits a message.
pub(super) fn excerpt(bytes: &[u8]) -> String {
    const LONGEST: usize = 16;
    let head = bytes.get(..bytes.len().min(LONGEST)).unwrap_or_default();
    let more = if bytes.len() > LONGEST { "…" } else { "" };
    format!("`{}{more}`", head.escape_ascii())
}
