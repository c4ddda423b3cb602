//! Errors of reading a `.SET` file.

/// Why a file is no `.SET` file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SetFileError {
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
    /// Not a setting.
    #[error(
        "{file}, line {line}, byte {offset}: found `{found}`, expected a setting such as `:CH1:SCALE 1.0E0`"
    )]
    NoSetting {
        /// The file's name.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// Where in the file, counted from 0.
        offset: usize,
        /// The text found.
        found: String,
    },
    /// Not one setting.
    #[error("{file}: found no setting, expected at least one, such as `:CH1:SCALE 1.0E0`")]
    Empty {
        /// The file's name.
        file: String,
    },
}
