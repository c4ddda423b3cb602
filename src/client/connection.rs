//! Messages, replies and records over a line.

use std::io::{self, ErrorKind};
use std::time::{Duration, Instant};

use super::address::Address;
use super::line::{Line, invalid_reply};
use super::prologix::PrologixLine;
#[cfg(unix)]
use super::serial::SerialLine;
use super::socket::SocketLine;

/// Longest reply that an oscilloscope sends (bytes).
const MAX_REPLY_LENGTH: usize = 1 << 20;
/// Most records of one reply: those of four channels, the math trace and four references.
const MAX_RECORDS: usize = 9;
/// What stands before the block in a record.
const RECORD_PREFIX: &str = ":WFMP";
/// A line is quiet after so long without a byte: at 300 baud a byte takes 33 ms.
const QUIET_INTERVAL: Duration = Duration::from_millis(300);
/// A line that is not quiet after so long is not a scope's: its longest reply takes 90 s at 300
/// baud.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(120);

/// A connection to a scope.
#[derive(Debug)]
pub struct Client {
    address: Address,
    line: Box<dyn Line>,
    /// How long the next byte of a reply may take.
    reply_timeout: Duration,
    /// Bytes that were read, and how many of them were used.
    received: (Vec<u8>, usize),
}

impl Client {
    /// Connects to `address`; the next byte of a reply may take `reply_timeout`.
    ///
    /// # Errors
    /// The system's error.
    pub fn connect(address: &Address, reply_timeout: Duration) -> io::Result<Self> {
        let line = open(address)?;
        let mut client =
            Self { address: address.clone(), line, reply_timeout, received: (Vec::new(), 0) };
        // A new socket is empty; what is behind other lines may still send what its last user asked
        // for.
        if !matches!(address, Address::Socket(_)) {
            client.clear()?;
        }
        Ok(client)
    }

    /// Opens the line again after a failure; a reply that is still on its way is dropped.
    ///
    /// # Errors
    /// The system's error.
    pub fn reconnect(&mut self) -> io::Result<()> {
        self.line = open(&self.address)?;
        self.clear()
    }

    /// The address.
    pub fn address(&self) -> &Address {
        &self.address
    }

    /// Drops what the instrument still has to send.
    fn clear(&mut self) -> io::Result<()> {
        self.line.clear()?;
        let started = Instant::now();
        let mut dropped = [0; 4096];
        loop {
            match self.line.read(&mut dropped, QUIET_INTERVAL) {
                Err(error) if error.kind() == ErrorKind::TimedOut => break,
                Ok(_) if started.elapsed() < DRAIN_TIMEOUT => {}
                Ok(_) => return Err(invalid_reply("a line that is never quiet")),
                Err(error) => return Err(error),
            }
        }
        self.received = (Vec::new(), 0);
        Ok(())
    }

    /// Sends a message.
    ///
    /// # Errors
    /// The system's error.
    pub fn send(&mut self, message: &str) -> io::Result<()> {
        self.line.send(message)
    }

    /// Sends a message and asks for its reply.
    fn request(&mut self, message: &str) -> io::Result<()> {
        // The second byte of a line end may have come since.
        self.received = (Vec::new(), 0);
        self.line.send(message)?;
        self.line.request_reply()
    }

    /// Sends a message and waits for its reply, without the line's end.
    ///
    /// # Errors
    /// The system's error; also for a reply that is not a text.
    pub fn ask(&mut self, message: &str) -> io::Result<String> {
        self.request(message)?;
        let mut line = vec![self.first_byte()?];
        loop {
            match self.byte()? {
                b'\n' | b'\r' => break,
                byte => line.push(byte),
            }
            if line.len() > MAX_REPLY_LENGTH {
                return Err(invalid_reply("a reply without end"));
            }
        }
        String::from_utf8(line).map_err(|_| invalid_reply("a reply that is no text"))
    }

    /// Sends a message that asks for records, too: what is answered before the first, and each with
    /// preamble and block.
    ///
    /// # Errors
    /// The system's error; also for an invalid block.
    pub fn ask_for_records(&mut self, message: &str) -> io::Result<(String, Vec<Vec<u8>>)> {
        self.request(message)?;
        let (mut head, mut records, mut part) = (None, Vec::new(), Vec::new());
        let mut byte = self.first_byte()?;
        while !matches!(byte, b'\n' | b'\r') {
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
            byte = self.byte()?;
        }
        let rest = || String::from_utf8_lossy(&part).trim_end().to_owned();
        Ok((head.unwrap_or_else(rest), records))
    }

    /// The next byte after the ends of lines, since the reply before may have ended with two of
    /// them.
    fn first_byte(&mut self) -> io::Result<u8> {
        for _ in 0..MAX_REPLY_LENGTH {
            match self.byte()? {
                b'\n' | b'\r' => {}
                byte => return Ok(byte),
            }
        }
        Err(invalid_reply("empty lines without end"))
    }

    fn byte(&mut self) -> io::Result<u8> {
        let (bytes, used) = &mut self.received;
        if *used == bytes.len() {
            bytes.resize(4096, 0);
            let read = self.line.read(bytes, self.reply_timeout);
            bytes.truncate(*read.as_ref().unwrap_or(&0));
            *used = 0;
            read?;
        }
        let byte = bytes.get(*used).copied();
        *used += 1;
        byte.ok_or_else(super::line::connection_closed)
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
        for _ in 0..length {
            part.push(self.byte()?);
        }
        Ok(())
    }
}

fn open(address: &Address) -> io::Result<Box<dyn Line>> {
    Ok(match address {
        Address::Socket(pair) => Box::new(SocketLine::connect(pair)?),
        #[cfg(unix)]
        Address::Serial { device, baud } => Box::new(SerialLine::open(device, *baud)?),
        #[cfg(not(unix))]
        Address::Serial { .. } => {
            let words = "serial lines are for Linux and macOS; a serial-to-LAN adapter is reached by tcp://HOST:PORT";
            return Err(io::Error::new(ErrorKind::Unsupported, words));
        }
        Address::Prologix { adapter, gpib } => Box::new(PrologixLine::connect(adapter, *gpib)?),
    })
}
