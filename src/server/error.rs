//! Why the server stopped.

use std::io;

use crate::experiment::RunError;
use crate::recording::mcap::WriteError;

/// Why a server ended by itself.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The runtime, a thread or the listener could not be set up.
    #[error("the server could not start: {reason}")]
    Start {
        /// What the system says.
        reason: io::Error,
    },
    /// The chain could not be followed.
    #[error("impact {shot}: {reason}")]
    Impact {
        /// Number of the shot.
        shot: u32,
        /// What went wrong.
        reason: RunError,
    },
    /// The bench's thread ended.
    #[error("the simulation has ended unexpectedly")]
    BenchLost,
    /// The recording could not be written.
    #[error("the recording could not be written")]
    Record {
        /// What went wrong.
        #[source]
        reason: WriteError,
    },
}
