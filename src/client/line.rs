//! What all lines to a scope can do.

use std::fmt::Debug;
use std::io::{self, ErrorKind};
use std::time::Duration;

/// Time limit for connecting, and for sending a message.
pub const LINE_TIMEOUT: Duration = Duration::from_secs(5);

/// A line to one instrument.
pub trait Line: Debug + Send {
    /// Sends one message with its end.
    ///
    /// # Errors
    /// The system's error.
    fn send(&mut self, message: &str) -> io::Result<()>;

    /// Asks for the reply to the message that was sent; most lines need nothing for that.
    ///
    /// # Errors
    /// The system's error.
    fn request_reply(&mut self) -> io::Result<()> {
        Ok(())
    }

    /// Reads at least one byte into `buffer`; returns how many.
    ///
    /// # Errors
    /// [`ErrorKind::TimedOut`] where nothing comes within `limit`, [`ErrorKind::UnexpectedEof`]
    /// where nothing can come any more.
    fn read(&mut self, buffer: &mut [u8], limit: Duration) -> io::Result<usize>;

    /// Asks the instrument to drop what it still has to send, where the line has a way to say so.
    ///
    /// # Errors
    /// The system's error.
    fn clear(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Nothing came in time.
pub fn timed_out(limit: Duration) -> io::Error {
    io::Error::new(ErrorKind::TimedOut, format!("no reply within {} s", limit.as_secs_f64()))
}

/// The other side has gone.
pub fn connection_closed() -> io::Error {
    io::Error::new(ErrorKind::UnexpectedEof, "it has closed the connection")
}

/// The error for a reply that no oscilloscope sends.
pub fn invalid_reply(found: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, format!("found {found}"))
}
