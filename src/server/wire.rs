//! The byte stream of a connection: what comes, and writing with a time limit.

use std::io;
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncReadExt as _, AsyncWrite, AsyncWriteExt as _, DuplexStream};
use tokio::net::TcpStream;
use tokio::time::timeout;

/// Longest piece of input that is taken at once (bytes).
const READ_BUFFER: usize = 1024;
/// Time without a byte after which the system asks whether the client is there.
const KEEPALIVE_TIME: Duration = Duration::from_secs(60);
/// Time from one such question to the next.
const KEEPALIVE_INTERVAL: Duration = Duration::from_secs(5);
/// Time after which a client that accepts no bytes is dropped.
const WRITE_TIMEOUT: Duration = Duration::from_secs(10);

/// A stream to a client.
pub trait Stream: AsyncRead + AsyncWrite + Send + Unpin {
    /// Has the system acknowledge at once what comes. A client whose own system gathers small
    /// messages (Nagle) holds a query back until the command before it is acknowledged, which takes
    /// 40 ms otherwise. The system forgets it, hence after each read.
    ///
    /// # Errors
    /// The system's error.
    fn acknowledge(&self) -> io::Result<()> {
        Ok(())
    }
}

impl Stream for TcpStream {
    #[cfg(any(target_os = "linux", target_os = "android"))]
    fn acknowledge(&self) -> io::Result<()> {
        self.set_quickack(true)
    }
}

/// A stream in memory, for tests.
impl Stream for DuplexStream {}

/// `stream` with the options of a connection. The system asks a silent peer every minute whether it
/// is there; one that is not loses its connection within two.
///
/// # Errors
/// The system's error.
pub fn configured(stream: TcpStream) -> io::Result<Box<dyn Stream>> {
    // Clients give an unknown query a millisecond to stay silent.
    stream.set_nodelay(true)?;
    stream.acknowledge()?;
    let keepalive = socket2::TcpKeepalive::new().with_time(KEEPALIVE_TIME);
    #[cfg(not(any(target_os = "openbsd", target_os = "haiku")))]
    let keepalive = keepalive.with_interval(KEEPALIVE_INTERVAL);
    socket2::SockRef::from(&stream).set_tcp_keepalive(&keepalive)?;
    Ok(Box::new(stream))
}

/// A connection's stream.
pub struct Wire {
    stream: Box<dyn Stream>,
    buffer: Vec<u8>,
    /// Bytes after which a fault closes the connection.
    bytes_left: Option<usize>,
}

impl Wire {
    /// The stream of a connection that was accepted.
    pub fn new(stream: Box<dyn Stream>) -> Self {
        Self { stream, buffer: vec![0; READ_BUFFER], bytes_left: None }
    }

    /// The next bytes; none at the end. Loses nothing if it is cancelled.
    ///
    /// # Errors
    /// The system's error.
    pub async fn read(&mut self) -> io::Result<&[u8]> {
        let length = self.stream.read(&mut self.buffer).await?;
        self.stream.acknowledge()?;
        Ok(self.buffer.get(..length).unwrap_or_default())
    }

    /// Closes the connection after `length` further bytes.
    pub fn drop_after(&mut self, length: usize) {
        self.bytes_left = Some(length);
    }

    /// Writes all of `bytes`, as long as the client takes some in time.
    ///
    /// # Errors
    /// The system's error, or that a fault ends the connection here.
    pub async fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut rest = bytes;
        let drops = self.bytes_left.is_some_and(|left| left <= bytes.len());
        if let Some(left) = &mut self.bytes_left {
            rest = bytes.get(..*left).unwrap_or(bytes);
            *left -= rest.len();
        }
        while !rest.is_empty() {
            let written = timeout(WRITE_TIMEOUT, self.stream.write(rest)).await??;
            if written == 0 {
                return Err(io::ErrorKind::WriteZero.into());
            }
            rest = rest.get(written..).unwrap_or_default();
        }
        if drops { Err(io::ErrorKind::ConnectionAborted.into()) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A connection that a fault closes after five bytes is closed with the fifth, also if it is
    /// the last of what is written.
    #[tokio::test]
    async fn a_connection_is_closed_with_the_last_byte_that_a_fault_leaves() {
        for bytes in [&b"12345"[..], b"123456"] {
            let (near, mut far) = tokio::io::duplex(64);
            let mut wire = Wire::new(Box::new(near));
            wire.drop_after(5);
            let closed = wire.write(bytes).await.expect_err("a fault");
            assert_eq!(closed.kind(), io::ErrorKind::ConnectionAborted);
            drop(wire);
            let mut read = Vec::new();
            far.read_to_end(&mut read).await.expect("an end");
            assert_eq!(read, b"12345");
        }
    }
}
