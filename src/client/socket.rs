//! A raw TCP socket: a served scope, or a real one behind a serial-to-LAN adapter.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::time::Duration;

use super::line::{LINE_TIMEOUT, Line, connection_closed, timed_out};

/// A TCP connection on which messages are lines.
#[derive(Debug)]
pub struct SocketLine(TcpStream);

impl SocketLine {
    /// Connects to `address`, `HOST:PORT`.
    ///
    /// # Errors
    /// The system's error.
    pub fn connect(address: &str) -> io::Result<Self> {
        let mut last = io::Error::new(ErrorKind::NotFound, "found no such host");
        for at in address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&at, LINE_TIMEOUT) {
                Ok(stream) => {
                    stream.set_nodelay(true)?;
                    stream.set_write_timeout(Some(LINE_TIMEOUT))?;
                    return Ok(Self(stream));
                }
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    /// Sends bytes as they are.
    ///
    /// # Errors
    /// The system's error.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)
    }
}

impl Line for SocketLine {
    fn send(&mut self, message: &str) -> io::Result<()> {
        self.write(format!("{message}\n").as_bytes())
    }

    fn read(&mut self, buffer: &mut [u8], limit: Duration) -> io::Result<usize> {
        self.0.set_read_timeout(Some(limit))?;
        loop {
            return match self.0.read(buffer) {
                Ok(0) => Err(connection_closed()),
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) =>
                {
                    Err(timed_out(limit))
                }
                read => read,
            };
        }
    }
}
