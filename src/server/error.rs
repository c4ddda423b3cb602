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
        /// The system's error.
        reason: io::Error,
    },
    /// The chain could not be followed.
    #[error("impact {shot}: {reason}")]
    Impact {
        /// Number of the shot.
        shot: u32,
        /// The cause.
        reason: RunError,
    },
    /// The bench's thread ended.
    #[error("the simulation has ended unexpectedly")]
    BenchLost,
    /// The recording could not be written.
    #[error("the recording could not be written")]
    Record {
        /// The cause.
        #[source]
        reason: WriteError,
    },
}
