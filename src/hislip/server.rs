//! All sessions: which connection belongs to which, what each message does, what is to be sent.
//!
//! Remote and local control: what the control codes of `AsyncRemoteLocalControl` ask for. Source:
//! IVI-6.1, table 17.

use std::collections::BTreeMap;

use super::message::{
    DecodedPiece, Decoder, FIRST_VENDOR_TYPE, MAX_PAYLOAD, MessageHeader, MessageType, write,
};
use super::session::{HislipSession, Release};
use crate::lan::lock::{Grant, LockRequest, Queue, Released};
use crate::lan::{Device, FIRST_LINK, Outgoing};

/// Protocol that is spoken, 1.0, in the upper half; the session's number goes below.
const PROTOCOL_VERSION: u32 = 0x0100 << 16;

/// Time in which a connection has to become a session with both of its connections (s).
const INITIALISATION_TIMEOUT: f64 = 10.0;

/// How long a release waits for the message that was sent before it (s).
const RELEASE_TIMEOUT: f64 = 1.0;

/// Codes of errors after which a connection is closed (IVI-6.1, table 14).
mod fatal {
    /// Invalid header.
    pub const INVALID_HEADER: u8 = 1;
    /// One channel was used before both were established.
    pub const CHANNEL_NOT_ESTABLISHED: u8 = 2;
    /// Invalid initialisation sequence.
    pub const INVALID_INITIALISATION: u8 = 3;
    /// The server has as many clients as it takes.
    pub const TOO_MANY_CLIENTS: u8 = 4;
}

/// Codes of errors after which a connection goes on (IVI-6.1, table 16).
mod error {
    /// Error without a code of its own.
    pub const OTHER_ERROR: u8 = 0;
    /// Message type that is unknown, or not allowed on this channel.
    pub const UNKNOWN_MESSAGE_TYPE: u8 = 1;
    /// Unknown control code.
    pub const UNKNOWN_CONTROL_CODE: u8 = 2;
    /// Vendor-defined message type.
    pub const UNKNOWN_VENDOR_TYPE: u8 = 3;
    /// Payload longer than the agreed maximum.
    pub const MESSAGE_TOO_LARGE: u8 = 4;
}

/// A connection.
#[derive(Debug, Clone, Default)]
struct Connection {
    decoder: Decoder,
    /// The session it belongs to, as soon as it has one.
    session: Option<u16>,
    /// When it was opened (s).
    since: f64,
}

/// All sessions and their connections.
#[derive(Debug, Clone, Default)]
pub struct Server {
    connections: BTreeMap<u64, Connection>,
    sessions: BTreeMap<u16, HislipSession>,
    queue: Queue,
    output: Vec<Outgoing>,
    now: f64,
}

impl Server {
    /// A connection is there.
    pub fn opened(&mut self, connection: u64) {
        let since = self.now;
        self.connections.insert(connection, Connection { since, ..Connection::default() });
    }

    /// The other connection of the session that `connection` belongs to.
    pub fn partner(&self, connection: u64) -> Option<u64> {
        let session = self.sessions.get(&self.connections.get(&connection)?.session?)?;
        let both = [Some(session.synchronous), session.asynchronous];
        both.into_iter().flatten().find(|other| *other != connection)
    }

    /// Whether the session of `connection` waits: for the end of an acquisition, or for somebody
    /// else's lock.
    pub fn is_waiting(&self, connection: u64, instrument: &dyn Device) -> bool {
        let Some(number) = self.connections.get(&connection).and_then(|link| link.session) else {
            return false;
        };
        let held = self.sessions.get(&number).is_some_and(|session| !session.held.is_empty());
        held || self.queue.contains_key(&number) || instrument.is_waiting(number)
    }

    /// Closes connections that have not completed initialisation in time.
    fn expire(&mut self, instrument: &mut dyn Device) {
        let is_half = |link: &Connection| match link.session {
            None => true,
            Some(number) => {
                self.sessions.get(&number).is_some_and(|session| session.asynchronous.is_none())
            }
        };
        let old = |link: &Connection| self.now - link.since > INITIALISATION_TIMEOUT;
        let links = self.connections.iter().filter(|(_, link)| old(link) && is_half(link));
        for connection in links.map(|(number, _)| *number).collect::<Vec<u64>>() {
            let reason = "the session's second connection did not come in time";
            self.refuse(connection, fatal::CHANNEL_NOT_ESTABLISHED, reason, instrument);
        }
    }

    /// A connection is gone; the other one of its session is closed.
    pub fn closed(&mut self, connection: u64, instrument: &mut dyn Device) {
        let gone = self.connections.remove(&connection);
        let Some(number) = gone.and_then(|gone| gone.session) else { return };
        let Some(session) = self.sessions.remove(&number) else { return };
        instrument.locks().remove_session(number);
        self.queue.remove(&number);
        instrument.close(number);
        for other in [Some(session.synchronous), session.asynchronous].into_iter().flatten() {
            if other != connection && self.connections.remove(&other).is_some() {
                self.output.push(Outgoing { connection: other, bytes: Vec::new(), close: true });
            }
        }
        self.settle(instrument);
    }

    /// Bytes came.
    pub fn received(&mut self, connection: u64, bytes: &[u8], instrument: &mut dyn Device) {
        let Some(link) = self.connections.get_mut(&connection) else { return };
        link.decoder.push(bytes);
        while let Some(link) = self.connections.get_mut(&connection)
            && let Some(piece) = link.decoder.next_piece()
        {
            match link.session {
                None => self.initialise(connection, piece, instrument),
                Some(number) => self.take(number, connection, piece, instrument),
            }
        }
        self.settle(instrument);
    }

    /// Whether the input of a connection waits for another session's lock; such a connection is not
    /// read.
    pub fn is_held(&self, connection: u64) -> bool {
        let session = self.connections.get(&connection).and_then(|link| link.session);
        let session = session.and_then(|number| self.sessions.get(&number));
        session.is_some_and(|s| s.synchronous == connection && !s.held.is_empty())
    }

    /// A reply that was owed.
    pub fn reply(&mut self, number: u16, bytes: &[u8]) {
        if bytes.is_empty() {
            return;
        }
        if let Some(session) = self.sessions.get_mut(&number) {
            let bytes = session.reply(bytes);
            self.output.push(Outgoing { connection: session.synchronous, bytes, close: false });
        }
    }

    /// Time has passed: it is `now` (s), on a clock that does not run backwards. Requests for locks
    /// run out, and those who asked for service are sent.
    pub fn advance(&mut self, now: f64, instrument: &mut dyn Device) {
        self.now = self.now.max(now);
        self.expire(instrument);
        self.settle(instrument);
        for session in self.sessions.values_mut() {
            let (byte, enabled) = instrument.status(session.message_available());
            let asks = session.service.is_due(byte, enabled);
            let Some(connection) = session.asynchronous.filter(|_| asks) else { continue };
            let mut bytes = Vec::new();
            write(MessageType::AsyncServiceRequest, byte, 0, &[], &mut bytes);
            self.output.push(Outgoing { connection, bytes, close: false });
        }
    }

    /// Output since the last call, in order.
    pub fn take_output(&mut self) -> Vec<Outgoing> {
        std::mem::take(&mut self.output)
    }

    fn send(&mut self, connection: u64, kind: MessageType, codes: (u8, u32), payload: &[u8]) {
        let mut bytes = Vec::new();
        write(kind, codes.0, codes.1, payload, &mut bytes);
        self.output.push(Outgoing { connection, bytes, close: false });
    }

    fn refuse(&mut self, connection: u64, code: u8, reason: &str, instrument: &mut dyn Device) {
        let mut bytes = Vec::new();
        write(MessageType::FatalError, code, 0, reason.as_bytes(), &mut bytes);
        self.output.push(Outgoing { connection, bytes, close: true });
        self.closed(connection, instrument);
    }

    fn complain(&mut self, connection: u64, code: u8, reason: &str) {
        self.send(connection, MessageType::Error, (code, 0), reason.as_bytes());
    }

    /// The first message of a connection.
    fn initialise(&mut self, connection: u64, piece: DecodedPiece, instrument: &mut dyn Device) {
        let (header, payload) = match piece {
            DecodedPiece::Message(header, payload) => (header, payload),
            DecodedPiece::TooLarge(_) | DecodedPiece::Malformed => {
                return self.refuse(connection, fatal::INVALID_HEADER, "no message", instrument);
            }
        };
        match MessageType::from_code(header.code) {
            Some(MessageType::Initialize) => {
                let known = payload.is_empty() || payload.eq_ignore_ascii_case(b"hislip0");
                if !known {
                    let reason = "the instrument's name is hislip0";
                    let code = fatal::INVALID_INITIALISATION;
                    return self.refuse(connection, code, reason, instrument);
                }
                let free = (1..FIRST_LINK).find(|number| !self.sessions.contains_key(number));
                let Some(number) = free else {
                    let reason = "too many sessions";
                    return self.refuse(connection, fatal::TOO_MANY_CLIENTS, reason, instrument);
                };
                self.sessions.insert(number, HislipSession::new(connection));
                instrument.open(number, connection);
                self.join(connection, number);
                let parameter = PROTOCOL_VERSION | u32::from(number);
                self.send(connection, MessageType::InitializeResponse, (0, parameter), &[]);
            }
            Some(MessageType::AsyncInitialize) => {
                let number = u16::try_from(header.parameter).unwrap_or(0);
                let session = self.sessions.get_mut(&number);
                let Some(session) = session.filter(|session| session.asynchronous.is_none()) else {
                    let reason = "no such session waits for its second connection";
                    return self.refuse(
                        connection,
                        fatal::INVALID_INITIALISATION,
                        reason,
                        instrument,
                    );
                };
                session.asynchronous = Some(connection);
                self.join(connection, number);
                self.send(connection, MessageType::AsyncInitializeResponse, (0, 0), &[]);
            }
            _ => {
                let reason = "a connection begins with Initialize or AsyncInitialize";
                self.refuse(connection, fatal::INVALID_INITIALISATION, reason, instrument);
            }
        }
    }

    fn join(&mut self, connection: u64, number: u16) {
        if let Some(link) = self.connections.get_mut(&connection) {
            link.session = Some(number);
        }
    }

    fn take(&mut self, number: u16, from: u64, piece: DecodedPiece, instrument: &mut dyn Device) {
        let Some(session) = self.sessions.get_mut(&number) else { return };
        let is_synchronous = session.synchronous == from;
        match &piece {
            DecodedPiece::Malformed => {
                self.refuse(from, fatal::INVALID_HEADER, "no header", instrument);
            }
            DecodedPiece::TooLarge(_) => {
                let reason = format!("at most {MAX_PAYLOAD} bytes");
                self.complain(from, error::MESSAGE_TOO_LARGE, &reason);
            }
            DecodedPiece::Message(header, payload) if is_synchronous => {
                if session.asynchronous.is_none() {
                    let reason = "the second connection is missing";
                    return self.refuse(from, fatal::CHANNEL_NOT_ESTABLISHED, reason, instrument);
                }
                let clears = header.code == MessageType::DeviceClearComplete.code();
                let waits = !session.held.is_empty() || !instrument.locks().may_act(number);
                if waits && !clears && !session.clearing {
                    session.held.push(piece);
                } else {
                    self.synchronous(number, *header, payload, instrument);
                }
            }
            DecodedPiece::Message(header, payload) => {
                self.asynchronous(number, from, (*header, payload), instrument);
            }
        }
    }
}

impl Server {
    fn synchronous(
        &mut self,
        number: u16,
        header: MessageHeader,
        payload: &[u8],
        instrument: &mut dyn Device,
    ) {
        let Some(session) = self.sessions.get_mut(&number) else { return };
        let connection = session.synchronous;
        let kind = MessageType::from_code(header.code);
        if session.clearing && kind != Some(MessageType::DeviceClearComplete) {
            return;
        }
        match kind {
            Some(kind @ (MessageType::Data | MessageType::DataEnd | MessageType::Trigger)) => {
                let delivered = header.control & 1 == 1;
                let owes_reply = instrument.owes_reply(number);
                let interrupts = match kind {
                    MessageType::Trigger => {
                        session.trigger(delivered, owes_reply, header.parameter)
                    }
                    _ => session.begin(delivered, owes_reply),
                };
                if kind == MessageType::DataEnd {
                    session.end(header.parameter);
                }
                if interrupts {
                    self.interrupt(number, header.parameter, instrument);
                }
                let reply = match kind {
                    MessageType::Trigger => instrument.trigger(number),
                    _ => instrument.input(number, payload, kind == MessageType::DataEnd),
                };
                self.reply(number, &reply);
            }
            Some(MessageType::DeviceClearComplete) => {
                session.clear();
                session.clearing = false;
                // Synchronised mode, whatever the client prefers.
                self.send(connection, MessageType::DeviceClearAcknowledge, (0, 0), &[]);
            }
            Some(MessageType::Initialize | MessageType::AsyncInitialize) => {
                let reason = "session already initialised";
                self.refuse(connection, fatal::INVALID_INITIALISATION, reason, instrument);
            }
            _ => self.unknown(connection, header.code),
        }
    }

    fn interrupt(&mut self, number: u16, identifier: u32, instrument: &mut dyn Device) {
        instrument.interrupt(number);
        let Some(session) = self.sessions.get(&number) else { return };
        let (synchronous, asynchronous) = (session.synchronous, session.asynchronous);
        self.send(synchronous, MessageType::Interrupted, (0, identifier), &[]);
        if let Some(asynchronous) = asynchronous {
            self.send(asynchronous, MessageType::AsyncInterrupted, (0, identifier), &[]);
        }
    }

    fn unknown(&mut self, connection: u64, code: u8) {
        let of_vendors = code >= FIRST_VENDOR_TYPE;
        let number =
            if of_vendors { error::UNKNOWN_VENDOR_TYPE } else { error::UNKNOWN_MESSAGE_TYPE };
        self.complain(connection, number, &format!("unknown message type {code}"));
    }

    fn asynchronous(
        &mut self,
        number: u16,
        from: u64,
        message: (MessageHeader, &[u8]),
        instrument: &mut dyn Device,
    ) {
        let (header, payload) = message;
        let Some(session) = self.sessions.get_mut(&number) else { return };
        match MessageType::from_code(header.code) {
            Some(MessageType::AsyncMaximumMessageSize) => {
                let Ok(size) = payload.try_into() else {
                    return self.complain(from, error::OTHER_ERROR, "expected 8 bytes");
                };
                session.limit(u64::from_be_bytes(size));
                let own = (MAX_PAYLOAD as u64).to_be_bytes();
                self.send(from, MessageType::AsyncMaximumMessageSizeResponse, (0, 0), &own);
            }
            Some(MessageType::AsyncDeviceClear) => {
                session.clear();
                session.clearing = true;
                instrument.clear(number);
                self.send(from, MessageType::AsyncDeviceClearAcknowledge, (0, 0), &[]);
            }
            Some(MessageType::AsyncStatusQuery) => {
                if header.control & 1 == 1 {
                    session.delivered();
                }
                let (byte, _) = instrument.status(session.message_available());
                let byte = session.service.read(byte);
                self.send(from, MessageType::AsyncStatusResponse, (byte, 0), &[]);
            }
            Some(MessageType::AsyncLock) => {
                self.lock(number, (from, header), payload, instrument);
            }
            Some(MessageType::AsyncLockInfo) => {
                let locks = instrument.locks();
                let holders = u32::try_from(locks.holders()).unwrap_or(u32::MAX);
                let exclusive = u8::from(locks.is_exclusive());
                self.send(from, MessageType::AsyncLockInfoResponse, (exclusive, holders), &[]);
            }
            Some(MessageType::AsyncRemoteLocalControl) => {
                match RemoteControl::from_code(header.control) {
                    Some(RemoteControl::Free) => instrument.lock_keys(false),
                    Some(RemoteControl::LockedOut) => instrument.lock_keys(true),
                    Some(RemoteControl::Unchanged) => {}
                    None => {
                        let reason =
                            format!("unknown control code {}, expected 0 to 6", header.control);
                        return self.complain(from, error::UNKNOWN_CONTROL_CODE, &reason);
                    }
                }
                self.send(from, MessageType::AsyncRemoteLocalResponse, (0, 0), &[]);
            }
            Some(MessageType::Initialize | MessageType::AsyncInitialize) => {
                let reason = "session already initialised";
                self.refuse(from, fatal::INVALID_INITIALISATION, reason, instrument);
            }
            _ => self.unknown(from, header.code),
        }
    }

    fn lock(
        &mut self,
        number: u16,
        (from, header): (u64, MessageHeader),
        key: &[u8],
        instrument: &mut dyn Device,
    ) {
        let Some(session) = self.sessions.get_mut(&number) else { return };
        match header.control {
            1 => {
                // One request at a time: another one ends the first.
                if self.queue.remove(&number).is_some() {
                    self.answer_lock(number, Grant::Busy);
                }
                let until = self.now + f64::from(header.parameter) / 1e3;
                match instrument.locks().request(number, key) {
                    Grant::Busy if header.parameter > 0 => {
                        self.queue.insert(number, LockRequest { key: key.to_vec(), until });
                    }
                    grant => self.answer_lock(number, grant),
                }
            }
            0 => {
                let until = self.now + RELEASE_TIMEOUT;
                session.release = Some(Release { after: header.parameter, until });
            }
            code => {
                let reason =
                    format!("unknown control code {code}, expected 0 (release) or 1 (request)");
                self.complain(from, error::UNKNOWN_CONTROL_CODE, &reason);
            }
        }
    }

    fn answer_lock(&mut self, number: u16, grant: Grant) {
        let code = match grant {
            Grant::Busy => 0,
            Grant::Granted => 1,
            Grant::Invalid => 3,
        };
        let connection = self.sessions.get(&number).and_then(|session| session.asynchronous);
        if let Some(connection) = connection {
            self.send(connection, MessageType::AsyncLockResponse, (code, 0), &[]);
        }
    }

    /// Does what has waited: releases, then requests for locks, then messages of those who may act
    /// again.
    fn settle(&mut self, instrument: &mut dyn Device) {
        let numbers: Vec<u16> = self.sessions.keys().copied().collect();
        for number in &numbers {
            self.complete_release(*number, instrument);
        }
        let waiting: Vec<u16> = self.queue.keys().copied().collect();
        for number in waiting {
            let Some(request) = self.queue.get(&number) else { continue };
            let grant = instrument.locks().request(number, &request.key);
            if grant != Grant::Busy || request.until <= self.now {
                self.queue.remove(&number);
                self.answer_lock(number, grant);
            }
        }
        for number in numbers {
            if !instrument.locks().may_act(number) {
                continue;
            }
            let held = self.sessions.get_mut(&number).map(|s| std::mem::take(&mut s.held));
            for piece in held.into_iter().flatten() {
                if let DecodedPiece::Message(header, payload) = piece {
                    self.synchronous(number, header, &payload, instrument);
                }
            }
        }
    }

    fn complete_release(&mut self, number: u16, instrument: &mut dyn Device) {
        let Some(session) = self.sessions.get_mut(&number) else { return };
        let Some(release) = session.release else { return };
        if session.awaits(release.after) && release.until > self.now {
            return;
        }
        session.release = None;
        let Some(connection) = session.asynchronous else { return };
        let code = match instrument.locks().release(number) {
            Released::Exclusive => 1,
            Released::Shared => 2,
            Released::Nothing => 3,
        };
        self.send(connection, MessageType::AsyncLockResponse, (code, 0), &[]);
    }
}

/// Remote and local state of the front panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RemoteControl {
    /// Its keys are free.
    Free,
    /// Its keys are locked out.
    LockedOut,
    /// Any state: a virtual panel is remote and local at once.
    Unchanged,
}

impl RemoteControl {
    /// The request of a control code; none for an unknown code.
    pub fn from_code(code: u8) -> Option<Self> {
        match code {
            // Remote disabled, the same with going to local, go to local.
            0 | 2 | 6 => Some(Self::Free),
            // Remote enabled, the same with going to remote.
            1 | 3 => Some(Self::Unchanged),
            // Remote enabled with local lock-out, the same with going to remote.
            4 | 5 => Some(Self::LockedOut),
            _ => None,
        }
    }
}
