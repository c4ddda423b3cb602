//! Thousands of runs of one scene with other values: designed, run on all processors and machines,
//! kept safe, joined into a table.
//!
//! Stands between `experiment`, which runs scenes, and the command line. [`plan`] makes runs out of
//! a file, `work` runs them in blocks and [`log`](mod@log) keeps every finished one, so that a
//! sweep that is killed goes on where it was. [`shard`] is the part of one process out of many,
//! [`gather`] joins their logs into tables and says what is missing. Values, seed
//! and results of a run follow from its number alone: in every process, and beside any other runs,
//! the bytes are the same on processors with the same instructions.

pub mod gather;
pub mod log;
pub mod plan;
mod row;
pub mod shard;
pub mod summary;
pub mod work;

use std::path::{Path, PathBuf};

use crate::scene::SceneError;
use crate::scene::adjust::AdjustError;

/// Why a sweep could not be made, run or gathered.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The sweep's file or the scene that it varies is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A path leads nowhere.
    #[error(transparent)]
    Path(#[from] AdjustError),
    /// A place to watch that the scene does not have.
    #[error("found `{name}` in `watch`, expected one of {}", known.join(", "))]
    Watch {
        /// The name as typed.
        name: String,
        /// Names that exist.
        known: Vec<String>,
    },
    /// Not one scene of the sweep is sound.
    #[error("none of the first {tried} scenes is valid; the first:\n{first}")]
    AllRefused {
        /// How many runs were tried.
        tried: u64,
        /// The first problem.
        first: SceneError,
    },
    /// A file or folder could not be read or written.
    #[error("{file}: {source}")]
    File {
        /// The file.
        file: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// No log, or one of another version.
    #[error("{file}: found no log of a sweep made by this version, expected one")]
    NoLog {
        /// The file.
        file: String,
    },
    /// A folder without logs.
    #[error(
        "{folder}: found no log of a sweep, expected the folder that `hertzscope sweep` keeps its logs in"
    )]
    NothingThere {
        /// The folder.
        folder: String,
    },
    /// A log of another sweep.
    #[error(
        "{file}: found the log of another sweep, expected that of this one: its file, its scene, its accuracy or the program has changed since; remove the folder or name another with --folder"
    )]
    OtherSweep {
        /// The log.
        file: String,
    },
    /// Another process works at the same log.
    #[error("{file}: found another process at work on this log, expected to be alone")]
    Busy {
        /// The log.
        file: String,
    },
    /// A run with two results.
    #[error("found two different results of run {run}, in {} and {}, expected them to be the same: were both made on processors with the same instructions?", files[0], files[1])]
    Differ {
        /// The run.
        run: u64,
        /// The logs.
        files: [String; 2],
    },
    /// Instructions that this machine lacks.
    #[error("found no {wanted} on this processor, expected one of {}", known.join(", "))]
    Instructions {
        /// Instruction set asked for on the command line or recorded in the log.
        wanted: String,
        /// Instruction sets of this processor.
        known: Vec<&'static str>,
    },
    /// Invalid shard number.
    #[error("found {found}, expected {expected}")]
    Shard {
        /// The value found.
        found: String,
        /// The value expected.
        expected: &'static str,
    },
    /// A table could not be written.
    #[error(transparent)]
    Table(#[from] crate::table::TableError),
}

/// Names the file in an error of the system.
fn at(file: &Path) -> impl Fn(std::io::Error) -> SweepError {
    let file: PathBuf = file.to_owned();
    move |source| SweepError::File { file: file.display().to_string(), source }
}
