//! A line over HiSLIP (IVI-6.1): two connections, on which messages and replies have their ends and
//! numbers.
//!
//! A reply with another number than the last message's is one that was given up, and is dropped. A
//! reply that does not end with a line feed gets one, by which [`Client`](super::Client) sees its
//! end.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use super::transport::{Transport, connect, moved};
use crate::hislip::{DecodedPiece, Decoder, MessageHeader, MessageType, write};

/// Port of HiSLIP (IVI-6.1, section 2.1).
pub(super) const PORT: u16 = 4880;
/// Version 1.0 of the protocol, and a vendor's two letters, `hz`.
const VERSION_AND_VENDOR: u32 = 0x0100_687a;
/// Number of the first message (IVI-6.1, section 3.1.2).
const FIRST_MESSAGE: u32 = 0xffff_ff00;
/// Number of a reply to no certain message.
const ANY_MESSAGE: u32 = 0xffff_ffff;
/// Largest message that is asked for (bytes).
const MAX_MESSAGE: u64 = crate::hislip::MAX_PAYLOAD as u64;

/// One connection of the two.
#[derive(Debug)]
struct Channel {
    stream: TcpStream,
    decoder: Decoder,
}

impl Channel {
    fn open(pair: &str, timeout: Duration, is_stopped: &dyn Fn() -> bool) -> io::Result<Self> {
        Ok(Self { stream: connect(pair, timeout, is_stopped)?, decoder: Decoder::default() })
    }

    /// The next message; waits once.
    fn receive(&mut self) -> io::Result<(MessageHeader, Vec<u8>)> {
        loop {
            match self.decoder.next_piece() {
                Some(DecodedPiece::Message(header, payload)) => {
                    let kind = MessageType::from_code(header.code);
                    if matches!(kind, Some(MessageType::FatalError | MessageType::Error)) {
                        let text = String::from_utf8_lossy(&payload).into_owned();
                        let text = format!("HiSLIP error {}: {text}", header.control);
                        return Err(io::Error::new(ErrorKind::InvalidData, text));
                    }
                    return Ok((header, payload));
                }
                Some(DecodedPiece::TooLarge(_)) => return Err(invalid("a message without end")),
                Some(DecodedPiece::Malformed) => return Err(invalid("no header of HiSLIP")),
                None => {
                    let mut bytes = [0; 4096];
                    let count = moved(self.stream.read(&mut bytes))?;
                    self.decoder.push(bytes.get(..count).unwrap_or_default());
                }
            }
        }
    }

    /// Waits for a message of this type, and drops others.
    fn expect(
        &mut self,
        kind: MessageType,
        timeout: Duration,
    ) -> io::Result<(MessageHeader, Vec<u8>)> {
        let started = Instant::now();
        loop {
            match self.receive() {
                Ok((header, payload)) if header.code == kind.code() => {
                    return Ok((header, payload));
                }
                Ok(_) => {}
                Err(error)
                    if error.kind() == ErrorKind::TimedOut && started.elapsed() < timeout => {}
                Err(error) => return Err(error),
            }
        }
    }

    fn send(&mut self, kind: MessageType, parameter: u32, payload: &[u8]) -> io::Result<()> {
        let mut bytes = Vec::new();
        write(kind, 0, parameter, payload, &mut bytes);
        self.stream.write_all(&bytes)
    }
}

fn invalid(found: &str) -> io::Error {
    super::transport::invalid_reply(found)
}

/// An instrument that speaks HiSLIP.
#[derive(Debug)]
pub(super) struct HislipLine {
    synchronous: Channel,
    asynchronous: Channel,
    timeout: Duration,
    /// Number of the last message, and of the next.
    sent: u32,
    next: u32,
    /// Bytes of a message that are not sent yet.
    outgoing: Vec<u8>,
    /// Bytes of a reply that were not asked for yet.
    incoming: Vec<u8>,
    /// Whether the last byte of the reply so far ends a line.
    is_line_end: bool,
}

impl HislipLine {
    /// Opens a session with the instrument `device` at `pair`, `HOST:PORT`.
    pub(super) fn open(
        pair: &str,
        device: &str,
        timeout: Duration,
        is_stopped: &dyn Fn() -> bool,
    ) -> io::Result<Self> {
        let mut synchronous = Channel::open(pair, timeout, is_stopped)?;
        synchronous.send(MessageType::Initialize, VERSION_AND_VENDOR, device.as_bytes())?;
        let (header, _) = synchronous.expect(MessageType::InitializeResponse, timeout)?;
        let session = header.parameter & 0xffff;
        let mut asynchronous = Channel::open(pair, timeout, is_stopped)?;
        asynchronous.send(MessageType::AsyncInitialize, session, b"")?;
        asynchronous.expect(MessageType::AsyncInitializeResponse, timeout)?;
        let size = MAX_MESSAGE.to_be_bytes();
        asynchronous.send(MessageType::AsyncMaximumMessageSize, 0, &size)?;
        asynchronous.expect(MessageType::AsyncMaximumMessageSizeResponse, timeout)?;
        Ok(Self {
            synchronous,
            asynchronous,
            timeout,
            sent: FIRST_MESSAGE,
            next: FIRST_MESSAGE,
            outgoing: Vec::new(),
            incoming: Vec::new(),
            is_line_end: false,
        })
    }
}

impl Transport for HislipLine {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.incoming.is_empty() {
            let (header, payload) = self.synchronous.receive()?;
            let kind = MessageType::from_code(header.code);
            let is_data = matches!(kind, Some(MessageType::Data | MessageType::DataEnd));
            if !is_data || ![self.sent, ANY_MESSAGE].contains(&header.parameter) {
                continue;
            }
            self.is_line_end = payload.last().map_or(self.is_line_end, |byte| *byte == b'\n');
            self.incoming = payload;
            if kind == Some(MessageType::DataEnd) && !self.is_line_end {
                self.incoming.push(b'\n');
            }
        }
        let count = self.incoming.len().min(buffer.len());
        for (place, byte) in buffer.iter_mut().zip(self.incoming.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.outgoing.is_empty() {
            write(MessageType::DataEnd, 0, self.next, bytes, &mut self.outgoing);
            (self.sent, self.next) = (self.next, self.next.wrapping_add(2));
            self.incoming.clear();
        }
        while !self.outgoing.is_empty() {
            let count = moved(self.synchronous.stream.write(&self.outgoing))?;
            self.outgoing.drain(..count);
        }
        Ok(bytes.len())
    }

    /// A device clear (IVI-6.1, section 3.1.1).
    fn clear(&mut self) -> io::Result<()> {
        self.asynchronous.send(MessageType::AsyncDeviceClear, 0, b"")?;
        self.asynchronous.expect(MessageType::AsyncDeviceClearAcknowledge, self.timeout)?;
        self.synchronous.send(MessageType::DeviceClearComplete, 0, b"")?;
        self.synchronous.expect(MessageType::DeviceClearAcknowledge, self.timeout)?;
        (self.sent, self.next) = (FIRST_MESSAGE, FIRST_MESSAGE);
        self.outgoing.clear();
        self.incoming.clear();
        Ok(())
    }
}
