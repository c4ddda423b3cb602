//! Lines and blocks over a raw socket.

use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::time::Duration;

/// Time limit for connecting and for each reply.
const SOCKET_TIMEOUT: Duration = Duration::from_secs(5);
/// A longer reply is none of an oscilloscope's (bytes).
const MAX_REPLY_LENGTH: usize = 1 << 20;
/// Most records of one reply: those of four channels, the math trace and four references.
const MAX_RECORDS: usize = 9;
/// What stands before the block in a record.
const RECORD_PREFIX: &str = ":WFMP";

/// A connection on which messages are lines.
#[derive(Debug)]
pub struct Socket {
    stream: BufReader<TcpStream>,
}

impl Socket {
    /// Connects to `address`, `HOST:PORT`.
    ///
    /// # Errors
    /// The system's error.
    pub fn connect(address: &str) -> io::Result<Self> {
        let mut last = io::Error::new(io::ErrorKind::NotFound, "found no such host");
        for at in address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&at, SOCKET_TIMEOUT) {
                Ok(stream) => {
                    stream.set_nodelay(true)?;
                    stream.set_read_timeout(Some(SOCKET_TIMEOUT))?;
                    stream.set_write_timeout(Some(SOCKET_TIMEOUT))?;
                    return Ok(Self { stream: BufReader::new(stream) });
                }
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    /// Sends a message.
    ///
    /// # Errors
    /// The system's error.
    pub fn send_line(&mut self, message: &str) -> io::Result<()> {
        self.stream.get_mut().write_all(format!("{message}\n").as_bytes())
    }

    /// Sends a message and waits for its reply, without the line's end.
    ///
    /// # Errors
    /// The system's error; also for a reply that is not a text.
    pub fn query(&mut self, message: &str) -> io::Result<String> {
        self.send_line(message)?;
        let mut line = Vec::new();
        self.stream.by_ref().take(MAX_REPLY_LENGTH as u64).read_until(b'\n', &mut line)?;
        if line.pop() != Some(b'\n') {
            return Err(connection_closed());
        }
        let text = String::from_utf8(line).map_err(|_| invalid_reply("a reply that is no text"))?;
        Ok(text.trim_end_matches('\r').to_owned())
    }

    /// Sends a message that asks for records, too: what is answered before the first, and each with preamble and block.
    ///
    /// # Errors
    /// The system's error; also for an invalid block.
    pub fn ask_for_records(&mut self, message: &str) -> io::Result<(String, Vec<Vec<u8>>)> {
        self.send_line(message)?;
        let (mut head, mut records, mut part) = (None, Vec::new(), Vec::new());
        loop {
            let byte = self.byte()?;
            if byte == b'\n' {
                break;
            }
            if part.len() > MAX_REPLY_LENGTH {
                return Err(invalid_reply("a reply without end"));
            }
            part.push(byte);
            // Between an answer and the next record stands a semicolon.
            if part.ends_with(RECORD_PREFIX.as_bytes()) {
                let before = part.len() - RECORD_PREFIX.len();
                let text = String::from_utf8_lossy(part.get(..before).unwrap_or_default());
                head.get_or_insert(text.trim_end_matches(';').to_owned());
                part.drain(..before);
            }
            if byte == b'#' {
                self.block(&mut part)?;
                if records.len() == MAX_RECORDS {
                    return Err(invalid_reply("more records than a scope has"));
                }
                records.push(std::mem::take(&mut part));
            }
        }
        let rest = || String::from_utf8_lossy(&part).trim_end().to_owned();
        Ok((head.unwrap_or_else(rest), records))
    }

    fn byte(&mut self) -> io::Result<u8> {
        let mut byte = [0];
        self.stream.read_exact(&mut byte).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => connection_closed(),
            _ => error,
        })?;
        Ok(byte[0])
    }

    /// `<n><length><bytes>` behind the `#`.
    fn block(&mut self, part: &mut Vec<u8>) -> io::Result<()> {
        let without_length = || invalid_reply("a block without a length");
        let digits = self.byte()?;
        part.push(digits);
        let digits = char::from(digits).to_digit(10).filter(|digits| *digits > 0);
        let mut length = 0;
        // Nine digits at most: the length fits.
        for _ in 0..digits.ok_or_else(without_length)? {
            let digit = self.byte()?;
            part.push(digit);
            length = length * 10 + char::from(digit).to_digit(10).ok_or_else(without_length)?;
        }
        let length = length as usize;
        if length > MAX_REPLY_LENGTH {
            return Err(invalid_reply("a block without end"));
        }
        let start = part.len();
        part.resize(start + length, 0);
        self.stream.read_exact(part.get_mut(start..).unwrap_or_default())
    }
}

fn connection_closed() -> io::Error {
    io::Error::new(io::ErrorKind::UnexpectedEof, "it has closed the connection")
}

fn invalid_reply(found: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("found {found}"))
}
