//! Why there is no trace from a scope.

use std::io;

/// Why a scope gave no traces.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The line could not be opened, or failed again and again.
    #[error("{address}: {doing}")]
    Line {
        /// The address.
        address: String,
        /// What was being done.
        doing: &'static str,
        /// The system's error.
        source: io::Error,
    },
    /// Something else answers there.
    #[error("{address}: {problem}")]
    NoScope {
        /// The address.
        address: String,
        /// What was found, and what was expected.
        problem: String,
    },
    /// Nothing to read.
    #[error("{address}: no trace is displayed: switch the channels on that are to be recorded")]
    NoTrace {
        /// The address.
        address: String,
    },
    /// The scope is not as it was before.
    #[error(
        "{address}: the scope was left changed: send `{commands}`, or set it at its front panel"
    )]
    NotRestored {
        /// The address.
        address: String,
        /// What would put it back.
        commands: String,
        /// The system's error.
        source: io::Error,
    },
}
