//! Why the server stopped.

use std::io;

use crate::experiment::RunError;
use crate::recording::RecordingError;

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
    #[error("the recording could not be written: {}", causes(reason))]
    Record {
        /// The cause.
        reason: RecordingError,
    },
    /// The disk stalled, and the recording has no end.
    #[error(
        "the recording is not finished: the disk took nothing for {seconds} s; what it has can be read"
    )]
    RecordStalled {
        /// How long it was waited for (s).
        seconds: u64,
    },
}

/// An error with all that lies behind it.
fn causes(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        text = format!("{text}: {cause}");
        next = cause.source();
    }
    text
}
