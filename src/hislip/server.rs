//! All sessions: which connection belongs to which, what each message does, what is to be sent.

use std::collections::BTreeMap;

use super::message::{DecodedPiece, Decoder, MAX_PAYLOAD, MessageType, write};
use super::session::HislipSession;
use crate::lan::lock::Queue;
use crate::lan::{Device, FIRST_LINK, Outgoing};

/// Protocol that is spoken, 1.0, in the upper half; the session's number goes below.
const PROTOCOL_VERSION: u32 = 0x0100 << 16;

/// Time in which a connection has to become a session with both of its connections (s).
const INITIALISATION_TIMEOUT: f64 = 10.0;

/// Codes of errors after which a connection is closed (IVI-6.1, table 14).
pub(super) mod fatal {
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
pub(super) mod error {
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
    pub(super) sessions: BTreeMap<u16, HislipSession>,
    pub(super) queue: Queue,
    output: Vec<Outgoing>,
    pub(super) now: f64,
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

    pub(super) fn send(
        &mut self,
        connection: u64,
        kind: MessageType,
        codes: (u8, u32),
        payload: &[u8],
    ) {
        let mut bytes = Vec::new();
        write(kind, codes.0, codes.1, payload, &mut bytes);
        self.output.push(Outgoing { connection, bytes, close: false });
    }

    pub(super) fn refuse(
        &mut self,
        connection: u64,
        code: u8,
        reason: &str,
        instrument: &mut dyn Device,
    ) {
        let mut bytes = Vec::new();
        write(MessageType::FatalError, code, 0, reason.as_bytes(), &mut bytes);
        self.output.push(Outgoing { connection, bytes, close: true });
        self.closed(connection, instrument);
    }

    pub(super) fn complain(&mut self, connection: u64, code: u8, reason: &str) {
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
