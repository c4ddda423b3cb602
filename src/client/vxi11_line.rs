//! A line over VXI-11: procedure calls, of which each writes a message or reads a part of a reply.
//!
//! Reading without a reply on its way would be an error of the instrument: only messages with a
//! question mark have one. A call that has not come back is waited for by the next read or write.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};

use super::transport::{POLL_INTERVAL, Transport, connect, invalid_reply, moved};
use crate::vxi11::port_mapper;
use crate::vxi11::procedure::{CORE_PROGRAM, ErrorCode, VERSION};
use crate::vxi11::rpc::{MAX_RECEIVE, RecordDecoder, XdrReader, put_opaque, record, words};

/// Procedures of the core channel (VXI-11, appendix C).
const CREATE_LINK: u32 = 10;
const DEVICE_WRITE: u32 = 11;
const DEVICE_READ: u32 = 12;
const DEVICE_CLEAR: u32 = 15;
/// Flag of a write: the message ends.
const END: u32 = 1 << 3;
/// Bit of a reason: the reply ends.
const REASON_END: u32 = 1 << 2;
/// How long an instrument may wait in one call (ms).
const IO_TIMEOUT_MS: u32 = 1000;
/// Procedure of the port mapper that looks a port up, its program, version, and TCP.
const GET_PORT: u32 = 3;
const MAPPER: u32 = 100_000;
const MAPPER_VERSION: u32 = 2;
const TCP: u32 = 6;

/// A connection for procedure calls.
#[derive(Debug)]
struct Calls {
    stream: TcpStream,
    decoder: RecordDecoder,
    program: (u32, u32),
    number: u32,
}

impl Calls {
    fn begin(&mut self, procedure: u32, arguments: &[u8]) -> io::Result<()> {
        self.number = self.number.wrapping_add(1);
        let (program, version) = self.program;
        // Number, a call, RPC version 2; no credentials, no verifier.
        let mut call = words(&[self.number, 0, 2, program, version, procedure, 0, 0, 0, 0]);
        call.extend_from_slice(arguments);
        self.stream.write_all(&record(&call))
    }

    /// The results of the last call; waits once.
    fn results(&mut self) -> io::Result<Vec<u8>> {
        loop {
            let record = self.decoder.next_record().map_err(|_| invalid_reply("no RPC record"))?;
            let Some(record) = record else {
                let mut bytes = [0; 4096];
                let count = moved(self.stream.read(&mut bytes))?;
                self.decoder.push(bytes.get(..count).unwrap_or_default());
                continue;
            };
            let mut reader = XdrReader(&record);
            if reader.word() != Some(self.number) {
                // The reply to a call that was given up.
                continue;
            }
            // A reply, accepted, with a verifier, successful.
            let (kind, accepted, _) = (reader.word(), reader.word(), reader.word());
            let verifier = reader.opaque(400);
            let status = reader.word();
            if (kind, accepted, status) != (Some(1), Some(0), Some(0)) || verifier.is_none() {
                return Err(invalid_reply("a refused procedure call"));
            }
            return Ok(reader.0.to_vec());
        }
    }

    fn call(&mut self, procedure: u32, arguments: &[u8], timeout: Duration) -> io::Result<Vec<u8>> {
        self.begin(procedure, arguments)?;
        let started = Instant::now();
        loop {
            match self.results() {
                Err(error)
                    if error.kind() == ErrorKind::TimedOut && started.elapsed() < timeout => {}
                done => return done,
            }
        }
    }
}

/// What a call that has not come back does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum InFlight {
    Write,
    Read,
}

/// An instrument that speaks VXI-11.
#[derive(Debug)]
pub(super) struct Vxi11Line {
    calls: Calls,
    link: u32,
    timeout: Duration,
    in_flight: Option<InFlight>,
    /// Whether a reply is on its way.
    is_expected: bool,
    incoming: Vec<u8>,
}

impl Vxi11Line {
    /// Opens a link to the instrument `device` at `host`; its port is looked up if `port` is none.
    pub(super) fn open(
        (host, port): (&str, Option<u16>),
        device: &str,
        timeout: Duration,
        is_stopped: &dyn Fn() -> bool,
    ) -> io::Result<Self> {
        let connect_to = |port: u16, program: (u32, u32)| {
            let stream = connect(&format!("{host}:{port}"), timeout, is_stopped)?;
            Ok::<_, io::Error>(Calls {
                stream,
                decoder: RecordDecoder::default(),
                program,
                number: 0,
            })
        };
        let port = if let Some(port) = port {
            port
        } else {
            let mut mapper = connect_to(port_mapper::PORT, (MAPPER, MAPPER_VERSION))?;
            let asked = words(&[CORE_PROGRAM, VERSION, TCP, 0]);
            let found = mapper.call(GET_PORT, &asked, timeout)?;
            let port = XdrReader(&found).word().and_then(|port| u16::try_from(port).ok());
            port.filter(|port| *port > 0).ok_or_else(|| {
                io::Error::new(ErrorKind::NotFound, "its port mapper knows no VXI-11 instrument")
            })?
        };
        let mut calls = connect_to(port, (CORE_PROGRAM, VERSION))?;
        // A client's number, no lock, no time for one.
        let mut arguments = words(&[std::process::id(), 0, 0]);
        put_opaque(device.as_bytes(), &mut arguments);
        let created = calls.call(CREATE_LINK, &arguments, timeout)?;
        let mut created = XdrReader(&created);
        let (code, link) = (created.word(), created.word());
        let link = checked(code).and_then(|()| link.ok_or_else(|| invalid_reply("no link")))?;
        let (in_flight, is_expected, incoming) = (None, false, Vec::new());
        Ok(Self { calls, link, timeout, in_flight, is_expected, incoming })
    }

    /// The results of the call in flight, which is begun if it is not `kind`.
    fn results(&mut self, kind: InFlight, begin: (u32, &[u8])) -> io::Result<Vec<u8>> {
        if self.in_flight != Some(kind) {
            self.calls.begin(begin.0, begin.1)?;
            self.in_flight = Some(kind);
        }
        let done = self.calls.results();
        if !done.as_ref().is_err_and(|error| error.kind() == ErrorKind::TimedOut) {
            self.in_flight = None;
        }
        done
    }
}

fn checked(code: Option<u32>) -> io::Result<()> {
    match code {
        Some(0) => Ok(()),
        Some(code) if code == ErrorCode::Timeout as u32 => Err(ErrorKind::TimedOut.into()),
        Some(code) => Err(io::Error::other(format!("VXI-11 error {code}"))),
        None => Err(invalid_reply("no error code of VXI-11")),
    }
}

impl Transport for Vxi11Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.incoming.is_empty() {
            if !self.is_expected {
                thread::sleep(POLL_INTERVAL);
                return Err(ErrorKind::TimedOut.into());
            }
            let count = u32::try_from(MAX_RECEIVE / 2).unwrap_or(u32::MAX);
            let asked = words(&[self.link, count, IO_TIMEOUT_MS, 0, 0, 0]);
            let found = self.results(InFlight::Read, (DEVICE_READ, &asked))?;
            let mut found = XdrReader(&found);
            checked(found.word())?;
            let reason = found.word().unwrap_or_default();
            let data = found.opaque(MAX_RECEIVE).ok_or_else(|| invalid_reply("no data"))?;
            self.incoming = data.to_vec();
            if reason & REASON_END != 0 {
                self.is_expected = false;
                if data.last() != Some(&b'\n') {
                    self.incoming.push(b'\n');
                }
            }
        }
        let count = self.incoming.len().min(buffer.len());
        for (place, byte) in buffer.iter_mut().zip(self.incoming.drain(..count)) {
            *place = byte;
        }
        if count == 0 { Err(ErrorKind::TimedOut.into()) } else { Ok(count) }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut arguments = words(&[self.link, IO_TIMEOUT_MS, 0, END]);
        put_opaque(bytes, &mut arguments);
        let written = self.results(InFlight::Write, (DEVICE_WRITE, &arguments))?;
        let mut written = XdrReader(&written);
        checked(written.word())?;
        self.incoming.clear();
        self.is_expected = bytes.contains(&b'?');
        let count = written.word().and_then(|count| usize::try_from(count).ok());
        count.filter(|count| *count > 0).ok_or_else(|| invalid_reply("a message that is not taken"))
    }

    fn clear(&mut self) -> io::Result<()> {
        self.in_flight = None;
        let asked = words(&[self.link, 0, 0, IO_TIMEOUT_MS]);
        let found = self.calls.call(DEVICE_CLEAR, &asked, self.timeout)?;
        (self.is_expected, self.incoming) = (false, Vec::new());
        checked(XdrReader(&found).word())
    }
}
