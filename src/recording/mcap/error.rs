//! Why a file is no recording.

use std::path::PathBuf;

/// Largest file that is read into memory.
pub const LARGEST_FILE: u64 = 4 * 1024 * 1024 * 1024;
/// Why a file is no recording at all.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be read.
    #[error("{file}")]
    File {
        /// The file.
        file: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The file is too large to be held in memory.
    #[error(
        "{file}: found {bytes} bytes, expected at most {limit} to be held in memory: name one shot with --shot"
    )]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// Its size.
        bytes: u64,
        /// Largest size (bytes).
        limit: u64,
    },
    /// It does not begin like MCAP.
    #[error("{file}: found {found}, expected an MCAP file, which begins with \\x89MCAP0\\r\\n")]
    NotMcap {
        /// The file.
        file: PathBuf,
        /// Its first bytes, escaped.
        found: String,
    },
    /// MCAP, but nothing of ours in it.
    #[error("{file}: found an MCAP file without a single readable capture, series or fact{}, expected a recording", because(.first.as_ref()))]
    Empty {
        /// The file.
        file: PathBuf,
        /// The first problem met.
        first: Option<String>,
    },
}

fn because(problem: Option<&String>) -> String {
    problem.map(|p| format!(" ({p})")).unwrap_or_default()
}
