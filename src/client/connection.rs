//! Messages, replies and records over a line.
//!
//! A reply has two time limits: one for its next byte, and one for all of it, which grows with the
//! bytes received at the pace of the slowest line. So a side that sends a byte now and then does
//! not hold its client. While it waits, a client looks for a request to stop.

use std::io::{self, ErrorKind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::address::Address;
use super::lines::open;
use super::transport::{LINE_TIMEOUT, Transport, connection_closed, invalid_reply, stopped};

/// Upper bound of a reply (bytes): nine records of 2500 points have 26,000.
const MAX_REPLY_LENGTH: usize = 1 << 16;
/// Most records of one reply: those of four channels, the math trace and four references.
const MAX_RECORDS: usize = 9;
/// Beginning of a record.
const RECORD_PREFIX: &str = ":WFMP";
/// A line without a byte for so long is empty: at 300 baud a byte takes 33 ms.
const QUIET_INTERVAL: Duration = Duration::from_millis(300);
/// Time limit for emptying a line: the longest reply of one scope takes 90 s at 300 baud.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(120);
/// Speed of the slowest line of the family (baud).
const LOWEST_BAUD_RATE: u32 = 300;
/// Bits of one byte on RS-232: start, eight, stop.
const BITS_PER_BYTE: u32 = 10;
/// Time limit for restoring a scope after a request to stop, on a line that takes no time itself.
const RESTORE_TIMEOUT: Duration = Duration::from_millis(200);
/// Bytes that restoring a scope takes, with the reply to `*IDN?`.
const RESTORE_BYTES: u32 = 160;

/// A connection to a scope.
#[derive(Debug)]
pub struct Client {
    address: Address,
    transport: Box<dyn Transport>,
    reply_timeout: Duration,
    stop: Arc<AtomicBool>,
    /// Bytes that were read, and how many of them were used.
    received: (Vec<u8>, usize),
    /// When the present reply was asked for, and how many of its bytes were used.
    reply: (Instant, u32),
    /// Whether a reply was asked for and has not come.
    is_reply_pending: bool,
}

impl Client {
    /// Connects to `address`; the next byte of a reply may take `reply_timeout`. All that waits
    /// ends with an error once `stop` is set.
    ///
    /// # Errors
    /// The system's error.
    pub fn connect(
        address: &Address,
        reply_timeout: Duration,
        stop: &Arc<AtomicBool>,
    ) -> io::Result<Self> {
        let transport = open(address, LINE_TIMEOUT, &|| stop.load(Ordering::Relaxed))?;
        let mut client = Self {
            address: address.clone(),
            transport,
            reply_timeout,
            stop: Arc::clone(stop),
            received: (Vec::new(), 0),
            reply: (Instant::now(), 0),
            is_reply_pending: false,
        };
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
        self.reopen()?;
        self.clear()
    }

    fn reopen(&mut self) -> io::Result<()> {
        let timeout = LINE_TIMEOUT.min(self.reply_timeout);
        self.transport = open(&self.address, timeout, &|| self.stop.load(Ordering::Relaxed))?;
        self.received = (Vec::new(), 0);
        self.is_reply_pending = false;
        Ok(())
    }

    /// The address.
    pub fn address(&self) -> &Address {
        &self.address
    }

    /// Whether all that waits is to end.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Sends `commands`, and waits until `identity` comes as the reply to `*IDN?`: then the line
    /// has carried them. After a request to stop, a pending reply is given up, and little time is
    /// taken.
    ///
    /// # Errors
    /// The system's error.
    pub fn restore(&mut self, commands: &str, identity: &str) -> io::Result<()> {
        if self.is_stopped() {
            // What follows is what the request to stop has to wait for.
            self.stop = Arc::default();
            let byte_time = self.transport.baud().map_or(Duration::ZERO, byte_time);
            self.reply_timeout =
                self.reply_timeout.min(RESTORE_TIMEOUT + RESTORE_BYTES * byte_time);
        }
        let restored = self.send_and_confirm(commands, identity);
        restored.or_else(|error| {
            if error.kind() == ErrorKind::TimedOut {
                return Err(error);
            }
            self.reopen()?;
            self.send_and_confirm(commands, identity)
        })
    }

    fn send_and_confirm(&mut self, commands: &str, identity: &str) -> io::Result<()> {
        if self.is_reply_pending {
            self.transport.clear()?;
        }
        self.send(commands)?;
        self.request("*IDN?")?;
        // The rest of a reply that was given up comes first.
        let mut line = Vec::new();
        while !line.ends_with(identity.as_bytes()) {
            line.push(self.byte()?);
            if line.len() > MAX_REPLY_LENGTH {
                return Err(invalid_reply("a reply without end"));
            }
        }
        self.is_reply_pending = false;
        Ok(())
    }

    /// Drops what the instrument still has to send.
    fn clear(&mut self) -> io::Result<()> {
        self.transport.clear()?;
        let started = Instant::now();
        loop {
            match self.receive(QUIET_INTERVAL) {
                Err(error) if error.kind() == ErrorKind::TimedOut => break,
                Ok(()) if started.elapsed() < DRAIN_TIMEOUT => {}
                Ok(()) => return Err(invalid_reply("a line on which bytes never end")),
                Err(error) => return Err(error),
            }
        }
        self.received = (Vec::new(), 0);
        self.is_reply_pending = false;
        Ok(())
    }

    /// Sends a message.
    ///
    /// # Errors
    /// The system's error.
    pub fn send(&mut self, message: &str) -> io::Result<()> {
        let bytes = self.transport.message(message);
        self.write(&bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let started = Instant::now();
        let mut left = bytes;
        while !left.is_empty() {
            match self.transport.write(left) {
                Ok(count) => left = left.get(count..).unwrap_or_default(),
                Err(error) if error.kind() != ErrorKind::TimedOut => return Err(error),
                Err(_) if self.is_stopped() => return Err(stopped()),
                Err(_) if started.elapsed() < LINE_TIMEOUT.min(self.reply_timeout) => {}
                Err(_) => {
                    return Err(io::Error::new(ErrorKind::TimedOut, self.transport.hint()));
                }
            }
        }
        Ok(())
    }

    /// Sends a message and asks for its reply.
    fn request(&mut self, message: &str) -> io::Result<()> {
        // The second byte of a line end may have come since.
        self.received = (Vec::new(), 0);
        self.send(message)?;
        self.write(self.transport.reply_request())?;
        self.reply = (Instant::now(), 0);
        self.is_reply_pending = true;
        Ok(())
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
        self.is_reply_pending = false;
        String::from_utf8(line).map_err(|_| invalid_reply("a reply that is no text"))
    }

    /// Sends a message that asks for records, too: what is answered before the first, and each with
    /// preamble and block.
    ///
    /// # Errors
    /// The system's error; also for an invalid block, and for one that is longer than it says.
    pub fn ask_for_records(&mut self, message: &str) -> io::Result<(String, Vec<Vec<u8>>)> {
        self.request(message)?;
        let (mut head, mut records, mut part) = (None, Vec::new(), Vec::new());
        let mut is_behind_block = false;
        let mut byte = self.first_byte()?;
        while !matches!(byte, b'\n' | b'\r') {
            if is_behind_block && byte != b';' {
                return Err(invalid_reply("a block that is longer than its header says"));
            }
            is_behind_block = byte == b'#';
            part.push(byte);
            if part.len() > MAX_REPLY_LENGTH {
                return Err(invalid_reply("a reply without end"));
            }
            // Between an answer and the next record stands a semicolon.
            if part.ends_with(RECORD_PREFIX.as_bytes()) {
                let before = part.len() - RECORD_PREFIX.len();
                let text = String::from_utf8_lossy(part.get(..before).unwrap_or_default());
                head.get_or_insert(text.trim_end_matches(';').to_owned());
                part.drain(..before);
            }
            if is_behind_block {
                self.block(&mut part)?;
                if records.len() == MAX_RECORDS {
                    return Err(invalid_reply("more records than a scope has"));
                }
                records.push(std::mem::take(&mut part));
            }
            byte = self.byte()?;
        }
        self.is_reply_pending = false;
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

    /// The next byte of the reply.
    fn byte(&mut self) -> io::Result<u8> {
        if self.received.1 == self.received.0.len() {
            let (asked, bytes) = self.reply;
            let baud = self.transport.baud().unwrap_or(LOWEST_BAUD_RATE);
            let whole = self.reply_timeout + bytes * byte_time(baud);
            let left = whole.saturating_sub(asked.elapsed());
            let is_slow = bytes > 0 && left < self.reply_timeout;
            self.receive(left.min(self.reply_timeout)).map_err(|error| match error.kind() {
                ErrorKind::TimedOut if is_slow => {
                    invalid_reply(&format!("a reply of which {bytes} bytes came in {whole:.1?}"))
                }
                ErrorKind::TimedOut => {
                    let waited = self.reply_timeout.as_secs_f64();
                    io::Error::new(ErrorKind::TimedOut, format!("no reply within {waited} s"))
                }
                _ => error,
            })?;
        }
        let byte = self.received.0.get(self.received.1).copied();
        self.received.1 += 1;
        self.reply.1 += 1;
        byte.ok_or_else(connection_closed)
    }

    /// Waits `timeout` for further bytes, in place of those received before.
    fn receive(&mut self, timeout: Duration) -> io::Result<()> {
        let started = Instant::now();
        let bytes = &mut self.received.0;
        self.received.1 = 0;
        loop {
            bytes.resize(4096, 0);
            let read = if self.stop.load(Ordering::Relaxed) {
                Err(stopped())
            } else {
                self.transport.read(bytes)
            };
            bytes.truncate(*read.as_ref().unwrap_or(&0));
            match read {
                Err(error)
                    if error.kind() == ErrorKind::TimedOut && started.elapsed() < timeout => {}
                read => return read.map(drop),
            }
        }
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

/// Time of one byte at `baud` (baud).
fn byte_time(baud: u32) -> Duration {
    Duration::from_secs(1) * BITS_PER_BYTE / baud
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scope on a line of 300 baud that has its reply to `*IDN?` ready.
    #[derive(Debug)]
    struct SlowLine(&'static [u8]);

    impl Transport for SlowLine {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            io::Read::read(&mut self.0, buffer)
        }

        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            Ok(bytes.len())
        }

        fn baud(&self) -> Option<u32> {
            Some(300)
        }
    }

    /// 160 bytes of 10 bits take 5.33 s at 300 baud: restoring a scope on such a line may take so
    /// long, and 0.2 s more.
    #[test]
    fn restoring_over_a_slow_line_has_the_time_of_its_bytes() {
        let mut client = Client {
            address: Address::Socket(String::new()),
            transport: Box::new(SlowLine(b"TEKTRONIX,TDS 2014\n")),
            reply_timeout: Duration::from_secs(60),
            stop: Arc::new(AtomicBool::new(true)),
            received: (Vec::new(), 0),
            reply: (Instant::now(), 0),
            is_reply_pending: false,
        };
        client.restore(":ACQ:STATE RUN", "TEKTRONIX,TDS 2014").expect("a scope");
        let seconds = client.reply_timeout.as_secs_f64();
        assert!((seconds - (160.0 * 10.0 / 300.0 + 0.2)).abs() < 1e-6, "{seconds}");
    }
}
