//! HiSLIP sessions: what each message does, and what is sent.
//!
//! A session has two connections, a synchronous one for messages and replies and an asynchronous
//! one for status, locks and device clear. The task of the synchronous connection serves both as
//! soon as the asynchronous one has joined. Source: IVI-6.1, High-Speed LAN Instrument Protocol,
//! revision 1.1.
//!
//! Limits: synchronised mode alone is offered, as the instrument has one thing to say at a time;
//! encryption (protocol 2.0) is not supported, so every client gets version 1.0. Locks bind HiSLIP
//! sessions and VXI-11 links, not raw sockets.

use std::collections::BTreeMap;
use std::future::pending;
use std::io;
use std::pin::Pin;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::{mpsc, oneshot, watch};
use tokio::time::{Instant, timeout, timeout_at};

use super::locks::{Grant, Released};
use super::network::{Answer, ClientSession, Interrupts, Network, ServiceRequest};
use super::places::Seat;
use super::wire::Wire;
use crate::hislip::{
    DecodedPiece, Decoder, FIRST_VENDOR_TYPE, HEADER_BYTES, MAX_PAYLOAD, MessageHeader,
    MessageType, write,
};
use crate::instrument::StatusSummary;

/// Protocol that is spoken, 1.0, in the upper half; the session's number goes below.
const PROTOCOL_VERSION: u32 = 0x0100 << 16;
/// Time in which a connection has to become a session with both of its connections.
const INITIALISATION_TIMEOUT: Duration = Duration::from_secs(10);
/// How long a release waits for the message that was sent before it.
const RELEASE_TIMEOUT: Duration = Duration::from_secs(1);
/// Identifier of a client's first message after the start and after a device clear.
const FIRST_MESSAGE_ID: u32 = 0xFFFF_FF00;
/// Identifier of a reply to no message.
const NO_MESSAGE_ID: u32 = 0xFFFF_FFFF;
/// Lower bound of the client's maximum message size (bytes).
const MIN_MESSAGE_LIMIT: u64 = 64;
/// Payload of a reply's part where the client names no limit (bytes).
const DEFAULT_PAYLOAD_LIMIT: usize = 1 << 20;
/// Interruptions that wait for the asynchronous connection.
const NOTICE_QUEUE_CAPACITY: usize = 16;

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

/// A message: its header and payload.
type Message = (MessageHeader, Vec<u8>);

/// Either connection of a session.
struct Channel {
    wire: Wire,
    decoder: Decoder,
}

impl Channel {
    /// The next piece. Loses nothing if it is cancelled.
    async fn next(&mut self) -> io::Result<DecodedPiece> {
        loop {
            if let Some(piece) = self.decoder.next_piece() {
                return Ok(piece);
            }
            let bytes = self.wire.read().await?;
            if bytes.is_empty() {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            self.decoder.push(bytes);
        }
    }

    async fn send(
        &mut self,
        kind: MessageType,
        codes: (u8, u32),
        payload: &[u8],
    ) -> io::Result<()> {
        let mut bytes = Vec::new();
        write(kind, codes.0, codes.1, payload, &mut bytes);
        self.wire.write(&bytes).await
    }

    /// Reports an error after which the connection goes on.
    async fn complain(&mut self, code: u8, reason: &str) -> io::Result<()> {
        self.send(MessageType::Error, (code, 0), reason.as_bytes()).await
    }

    /// The message in a piece, or none if it was too large.
    async fn message(&mut self, piece: DecodedPiece) -> io::Result<Option<Message>> {
        match piece {
            DecodedPiece::Message(header, payload) => Ok(Some((header, payload))),
            DecodedPiece::TooLarge(_) => {
                let reason = format!("at most {MAX_PAYLOAD} bytes");
                self.complain(error::MESSAGE_TOO_LARGE, &reason).await?;
                Ok(None)
            }
            DecodedPiece::Malformed => self.refuse(fatal::INVALID_HEADER, "no header").await,
        }
    }

    async fn complain_of_type(&mut self, code: u8) -> io::Result<()> {
        let of_vendors = code >= FIRST_VENDOR_TYPE;
        let number =
            if of_vendors { error::UNKNOWN_VENDOR_TYPE } else { error::UNKNOWN_MESSAGE_TYPE };
        self.complain(number, &format!("unknown message type {code}")).await
    }

    /// Reports an error that ends the connection.
    async fn refuse<T>(&mut self, code: u8, reason: &str) -> io::Result<T> {
        self.send(MessageType::FatalError, (code, 0), reason.as_bytes()).await?;
        Err(io::ErrorKind::InvalidData.into())
    }
}

/// A session's asynchronous connection on its way to the task of the synchronous one.
type Joining = (Channel, Seat);

/// Numbers of the sessions. Those whose asynchronous connection has not joined can take it.
#[derive(Default)]
pub struct Sessions {
    numbers: Mutex<BTreeMap<u16, Option<oneshot::Sender<Joining>>>>,
}

impl Sessions {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<u16, Option<oneshot::Sender<Joining>>>> {
        self.numbers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The lowest free number, and what receives the asynchronous connection.
    fn reserve(&self) -> Option<(SessionNumber<'_>, oneshot::Receiver<Joining>)> {
        let mut numbers = self.lock();
        let number = (1..=u16::MAX).find(|number| !numbers.contains_key(number))?;
        let (sender, joined) = oneshot::channel();
        numbers.insert(number, Some(sender));
        Some((SessionNumber { sessions: self, number }, joined))
    }
}

/// A session's number, free again when this is dropped.
struct SessionNumber<'a> {
    sessions: &'a Sessions,
    number: u16,
}

impl Drop for SessionNumber<'_> {
    fn drop(&mut self) {
        self.sessions.lock().remove(&self.number);
    }
}

/// Serves a connection until either side closes it or, if it is an asynchronous one, until it has
/// joined its session.
///
/// # Errors
/// The system's error, or that the connection was refused.
pub async fn run(
    network: &Network,
    sessions: &Sessions,
    wire: Wire,
    seat: Seat,
    peer: &str,
) -> io::Result<()> {
    let end = Instant::now() + INITIALISATION_TIMEOUT;
    let mut channel = Channel { wire, decoder: Decoder::default() };
    let first = tokio::select! {
        first = timeout_at(end, channel.next()) => first,
        () = network.closed() => return Ok(()),
    };
    let Ok(first) = first else { return refuse_late(&mut channel).await };
    let DecodedPiece::Message(header, payload) = first? else {
        return channel.refuse(fatal::INVALID_HEADER, "no message").await;
    };
    seat.touch();
    let invalid = fatal::INVALID_INITIALISATION;
    match MessageType::from_code(header.code) {
        Some(MessageType::Initialize) => {
            let known = payload.is_empty() || payload.eq_ignore_ascii_case(b"hislip0");
            if !known {
                return channel.refuse(invalid, "the instrument's name is hislip0").await;
            }
            let Some((number, joined)) = sessions.reserve() else {
                return channel.refuse(fatal::TOO_MANY_CLIENTS, "too many sessions").await;
            };
            let session = network.open(peer, &seat);
            let parameter = PROTOCOL_VERSION | u32::from(number.number);
            channel.send(MessageType::InitializeResponse, (0, parameter), &[]).await?;
            let joining = timeout_at(end, second_connection(network, &mut channel, joined)).await;
            let Ok(joining) = joining else { return refuse_late(&mut channel).await };
            let (asynchronous, other_seat) = joining?;
            seat.join(other_seat);
            serve(network, session, (channel, asynchronous), &seat).await
        }
        Some(MessageType::AsyncInitialize) => {
            let number = u16::try_from(header.parameter).unwrap_or(0);
            let sender = sessions.lock().get_mut(&number).and_then(Option::take);
            let Some(sender) = sender else {
                let reason = "no such session waits for its second connection";
                return channel.refuse(invalid, reason).await;
            };
            channel.send(MessageType::AsyncInitializeResponse, (0, 0), &[]).await?;
            // The session may have ended meanwhile, and this connection with it.
            let _ = sender.send((channel, seat));
            Ok(())
        }
        _ => {
            let reason = "a connection begins with Initialize or AsyncInitialize";
            channel.refuse(invalid, reason).await
        }
    }
}

async fn refuse_late(channel: &mut Channel) -> io::Result<()> {
    let reason = "the session's second connection did not come in time";
    channel.refuse(fatal::CHANNEL_NOT_ESTABLISHED, reason).await
}

/// Waits for a session's asynchronous connection. Until it is there, the synchronous one is not to
/// be used.
async fn second_connection(
    network: &Network,
    channel: &mut Channel,
    mut joined: oneshot::Receiver<Joining>,
) -> io::Result<Joining> {
    loop {
        tokio::select! {
            biased;
            joining = &mut joined => {
                return joining.map_err(|_| io::ErrorKind::NotConnected.into());
            }
            () = network.closed() => return Err(io::ErrorKind::NotConnected.into()),
            piece = channel.next() => {
                if channel.message(piece?).await?.is_some() {
                    let reason = "the second connection is missing";
                    return channel.refuse(fatal::CHANNEL_NOT_ESTABLISHED, reason).await;
                }
            }
        }
    }
}

/// What the two connections of a session know of each other.
#[derive(Debug, Clone, Copy)]
struct State {
    /// A device clear has begun: what comes on the synchronous connection is thrown away until it
    /// is complete.
    clearing: bool,
    /// A reply was sent that the client has not called delivered.
    undelivered: bool,
    /// Identifier of the last message that was executed to its end since the start or a device
    /// clear.
    executed: Option<u32>,
    /// Payload of a reply's part at most (bytes).
    part: usize,
}

impl State {
    /// Whether the message with this identifier, and with it everything sent before, has not been
    /// executed yet.
    fn awaits(&self, identifier: u32) -> bool {
        let Some(last) = self.executed else {
            // A client that has sent nothing yet has no identifier to name.
            return identifier == FIRST_MESSAGE_ID;
        };
        identifier != last && identifier.wrapping_sub(last) < u32::MAX / 2
    }
}

/// Serves a session until one of its connections ends.
async fn serve(
    network: &Network,
    session: ClientSession<'_>,
    (synchronous, asynchronous): (Channel, Channel),
    seat: &Seat,
) -> io::Result<()> {
    let start =
        State { clearing: false, undelivered: false, executed: None, part: DEFAULT_PAYLOAD_LIMIT };
    let state = watch::Sender::new(start);
    let (notices, inbox) = mpsc::channel(NOTICE_QUEUE_CAPACITY);
    let number = session.number();
    let synchronous = Synchronous {
        network,
        session,
        channel: synchronous,
        seat,
        state: &state,
        notices,
        within_message: false,
        last: None,
    };
    let asynchronous = Asynchronous {
        network,
        number,
        channel: asynchronous,
        seat,
        state: &state,
        service: ServiceRequest::default(),
        requested: None,
        releasing: None,
    };
    tokio::select! {
        // A message that came before a device clear is executed before it.
        biased;
        ended = synchronous.run() => ended,
        ended = asynchronous.run(inbox) => ended,
    }
}

/// The synchronous connection of a session.
struct Synchronous<'a> {
    network: &'a Network,
    session: ClientSession<'a>,
    channel: Channel,
    seat: &'a Seat,
    state: &'a watch::Sender<State>,
    /// Takes the identifiers of messages that interrupt a reply.
    notices: mpsc::Sender<u32>,
    /// A message has begun and not ended.
    within_message: bool,
    /// Identifier of the last message whose end has come since the start or a device clear.
    last: Option<u32>,
}

impl Synchronous<'_> {
    async fn run(mut self) -> io::Result<()> {
        loop {
            tokio::select! {
                biased;
                answer = self.session.answer() => self.take(answer?, NO_MESSAGE_ID).await?,
                piece = self.channel.next() => {
                    if let Some(message) = self.channel.message(piece?).await? {
                        self.receive(message).await?;
                    }
                }
            }
        }
    }

    async fn receive(&mut self, (header, payload): Message) -> io::Result<()> {
        self.seat.touch();
        let kind = MessageType::from_code(header.code);
        if kind == Some(MessageType::DeviceClearComplete) {
            return self.complete_clear().await;
        }
        self.wait_for_lock().await?;
        if self.state.borrow().clearing {
            return Ok(());
        }
        match kind {
            Some(kind @ (MessageType::Data | MessageType::DataEnd | MessageType::Trigger)) => {
                self.execute(kind, header, payload).await
            }
            Some(MessageType::Initialize | MessageType::AsyncInitialize) => {
                let reason = "session already initialised";
                self.channel.refuse(fatal::INVALID_INITIALISATION, reason).await
            }
            _ => self.channel.complain_of_type(header.code).await,
        }
    }

    /// Waits until no other session's lock holds a message back, or a device clear drops it.
    async fn wait_for_lock(&mut self) -> io::Result<()> {
        let _busy = self.seat.busy();
        let (number, mut state) = (self.session.number(), self.state.subscribe());
        loop {
            let cleared = async { _ = state.wait_for(|state| state.clearing).await };
            tokio::select! {
                biased;
                answer = self.session.answer() => self.take(answer?, NO_MESSAGE_ID).await?,
                () = self.network.locks.may_act(number) => return Ok(()),
                () = cleared => return Ok(()),
            }
        }
    }

    /// Executes a message, a part of one, or a trigger, which leaves a message that has begun as it
    /// is.
    async fn execute(
        &mut self,
        kind: MessageType,
        header: MessageHeader,
        payload: Vec<u8>,
    ) -> io::Result<()> {
        let (ends, identifier) = (kind != MessageType::Data, header.parameter);
        if header.control & 1 == 1 {
            self.state.send_modify(|state| state.undelivered = false);
        }
        let interrupts = match (self.within_message, self.state.borrow().undelivered) {
            (true, _) => Interrupts::Never,
            (false, false) => Interrupts::IfOwed,
            (false, true) => Interrupts::Always,
        };
        if kind != MessageType::Trigger {
            self.within_message = !ends;
        }
        if ends {
            self.last = Some(identifier);
        }
        if kind == MessageType::Trigger {
            self.session.trigger(interrupts);
        } else {
            self.session.send(payload, ends, interrupts);
        }
        loop {
            let answer = self.session.answer().await?;
            let is_done = matches!(answer, Answer::Done { .. });
            self.take(answer, identifier).await?;
            if is_done {
                break;
            }
        }
        if ends {
            self.state.send_modify(|state| {
                state.executed = Some(identifier).filter(|_| !state.clearing);
            });
        }
        Ok(())
    }

    /// Takes an answer; `identifier` is that of the message that is executed.
    async fn take(&mut self, answer: Answer, identifier: u32) -> io::Result<()> {
        match answer {
            Answer::Reply(bytes) => {
                if !self.state.borrow().clearing {
                    self.reply(&bytes).await?;
                }
            }
            Answer::Interrupted => {
                self.state.send_modify(|state| state.undelivered = false);
                self.channel.send(MessageType::Interrupted, (0, identifier), &[]).await?;
                // The client reads both connections, or loses them.
                let _ = self.notices.send(identifier).await;
            }
            Answer::DropAfter(length) => self.channel.wire.drop_after(length),
            Answer::Done { .. } | Answer::Resumed => {}
        }
        Ok(())
    }

    /// Sends a reply as messages of the size that the client takes.
    async fn reply(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.state.send_modify(|state| state.undelivered = true);
        let part = self.state.borrow().part;
        let mut out = Vec::with_capacity(bytes.len() + HEADER_BYTES);
        let mut parts = bytes.chunks(part).peekable();
        while let Some(part) = parts.next() {
            let kind =
                if parts.peek().is_some() { MessageType::Data } else { MessageType::DataEnd };
            write(kind, 0, self.last.unwrap_or(NO_MESSAGE_ID), part, &mut out);
        }
        self.channel.wire.write(&out).await
    }

    async fn complete_clear(&mut self) -> io::Result<()> {
        self.session.clear();
        (self.within_message, self.last) = (false, None);
        self.state.send_modify(|state| {
            (state.clearing, state.undelivered, state.executed) = (false, false, None);
        });
        // Synchronised mode, whatever the client prefers.
        self.channel.send(MessageType::DeviceClearAcknowledge, (0, 0), &[]).await
    }
}

/// A lock or release that is waited for.
type Waiting<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// The asynchronous connection of a session.
struct Asynchronous<'a> {
    network: &'a Network,
    /// Number of the session.
    number: u64,
    channel: Channel,
    seat: &'a Seat,
    state: &'a watch::Sender<State>,
    service: ServiceRequest,
    /// A lock that was requested.
    requested: Option<Waiting<'a, Grant>>,
    /// A release that waits for the message that was sent before it.
    releasing: Option<Waiting<'a, ()>>,
}

impl Asynchronous<'_> {
    async fn run(mut self, mut notices: mpsc::Receiver<u32>) -> io::Result<()> {
        let mut status = self.network.status();
        let mut state = self.state.subscribe();
        loop {
            status.mark_unchanged();
            state.mark_unchanged();
            self.request_service().await?;
            tokio::select! {
                biased;
                Some(identifier) = notices.recv() => {
                    self.channel.send(MessageType::AsyncInterrupted, (0, identifier), &[]).await?;
                }
                () = finished(&mut self.releasing) => self.release().await?,
                grant = finished(&mut self.requested) => self.answer_lock(grant).await?,
                piece = self.channel.next() => {
                    if let Some(message) = self.channel.message(piece?).await? {
                        self.receive(message).await?;
                    }
                },
                _ = state.changed() => {}
                changed = status.changed() => {
                    changed.map_err(|_| io::ErrorKind::NotConnected)?;
                }
            }
        }
    }

    /// The shared part of the status byte, and whether a reply is undelivered.
    fn status(&self) -> (StatusSummary, bool) {
        (*self.network.status().borrow(), self.state.borrow().undelivered)
    }

    /// Asks the client for service if there is a new reason.
    async fn request_service(&mut self) -> io::Result<()> {
        let (summary, undelivered) = self.status();
        if self.service.is_due(summary, undelivered) {
            let byte = summary.byte(undelivered);
            self.channel.send(MessageType::AsyncServiceRequest, (byte, 0), &[]).await?;
        }
        Ok(())
    }

    async fn receive(&mut self, (header, payload): Message) -> io::Result<()> {
        self.seat.touch();
        match MessageType::from_code(header.code) {
            Some(MessageType::AsyncMaximumMessageSize) => {
                let Ok(size) = payload.try_into() else {
                    return self.channel.complain(error::OTHER_ERROR, "expected 8 bytes").await;
                };
                let largest = u64::from_be_bytes(size).max(MIN_MESSAGE_LIMIT);
                let largest = usize::try_from(largest).unwrap_or(usize::MAX);
                let part = (largest - HEADER_BYTES).min(DEFAULT_PAYLOAD_LIMIT);
                self.state.send_modify(|state| state.part = part);
                let own = (MAX_PAYLOAD as u64).to_be_bytes();
                let kind = MessageType::AsyncMaximumMessageSizeResponse;
                self.channel.send(kind, (0, 0), &own).await
            }
            Some(MessageType::AsyncDeviceClear) => {
                self.state.send_modify(|state| {
                    (state.clearing, state.undelivered, state.executed) = (true, false, None);
                });
                self.network.clear(self.number).await;
                self.channel.send(MessageType::AsyncDeviceClearAcknowledge, (0, 0), &[]).await
            }
            Some(MessageType::AsyncStatusQuery) => {
                if header.control & 1 == 1 {
                    self.state.send_modify(|state| state.undelivered = false);
                }
                self.request_service().await?;
                let (summary, undelivered) = self.status();
                let byte = self.service.read(summary, undelivered);
                self.channel.send(MessageType::AsyncStatusResponse, (byte, 0), &[]).await
            }
            Some(MessageType::AsyncLock) => self.lock(header, payload).await,
            Some(MessageType::AsyncLockInfo) => {
                let (is_exclusive, holders) = self.network.locks.holders();
                let codes = (u8::from(is_exclusive), u32::try_from(holders).unwrap_or(u32::MAX));
                self.channel.send(MessageType::AsyncLockInfoResponse, codes, &[]).await
            }
            Some(MessageType::AsyncRemoteLocalControl) => {
                match header.control {
                    // Remote disabled, the same with going to local, go to local.
                    0 | 2 | 6 => self.network.lock_keys(false),
                    // Remote enabled with local lock-out, the same with going to remote.
                    4 | 5 => self.network.lock_keys(true),
                    // Remote enabled, the same with going to remote: a virtual panel is remote and
                    // local at once (IVI-6.1, table 17).
                    1 | 3 => {}
                    code => {
                        let reason = format!("unknown control code {code}, expected 0 to 6");
                        return self.channel.complain(error::UNKNOWN_CONTROL_CODE, &reason).await;
                    }
                }
                self.channel.send(MessageType::AsyncRemoteLocalResponse, (0, 0), &[]).await
            }
            Some(MessageType::Initialize | MessageType::AsyncInitialize) => {
                let reason = "session already initialised";
                self.channel.refuse(fatal::INVALID_INITIALISATION, reason).await
            }
            _ => self.channel.complain_of_type(header.code).await,
        }
    }

    async fn lock(&mut self, header: MessageHeader, key: Vec<u8>) -> io::Result<()> {
        match header.control {
            1 => {
                // One request at a time: another one ends the first.
                if self.requested.take().is_some() {
                    self.answer_lock(Grant::Busy).await?;
                }
                let within = Duration::from_millis(header.parameter.into());
                let (network, number, busy) = (self.network, self.number, self.seat.busy());
                self.requested = Some(Box::pin(async move {
                    let _busy = busy;
                    network.locks.acquire(number, key, within).await
                }));
                Ok(())
            }
            0 => {
                let mut state = self.state.subscribe();
                let after = header.parameter;
                self.releasing = Some(Box::pin(async move {
                    let executed = state.wait_for(|state| !state.awaits(after));
                    // In any case at the end of the time.
                    let _ = timeout(RELEASE_TIMEOUT, executed).await;
                }));
                Ok(())
            }
            code => {
                let reason =
                    format!("unknown control code {code}, expected 0 (release) or 1 (request)");
                self.channel.complain(error::UNKNOWN_CONTROL_CODE, &reason).await
            }
        }
    }

    async fn answer_lock(&mut self, grant: Grant) -> io::Result<()> {
        let code = match grant {
            Grant::Busy => 0,
            Grant::Granted => 1,
            Grant::Invalid => 3,
        };
        self.channel.send(MessageType::AsyncLockResponse, (code, 0), &[]).await
    }

    async fn release(&mut self) -> io::Result<()> {
        let code = match self.network.locks.release(self.number) {
            Released::Exclusive => 1,
            Released::Shared => 2,
            Released::Nothing => 3,
        };
        self.channel.send(MessageType::AsyncLockResponse, (code, 0), &[]).await
    }
}

/// Result of the future in `waiting`, which is removed; without a future this never ends.
async fn finished<T>(waiting: &mut Option<Waiting<'_, T>>) -> T {
    let Some(future) = waiting else { return pending().await };
    let result = future.await;
    *waiting = None;
    result
}

#[cfg(test)]
mod tests {
    use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};

    use super::{Network, Sessions, Wire, run};
    use crate::hislip::{HEADER_BYTES, MessageHeader, MessageType, write};

    /// IVI-6.1, table 14: code 4 is "server refused connection due to maximum number of clients
    /// exceeded".
    #[tokio::test]
    async fn a_session_without_a_free_number_is_refused_as_one_too_many() {
        let (network, _inbox) = Network::new();
        let sessions = Sessions::default();
        sessions.lock().extend((1..=u16::MAX).map(|number| (number, None)));
        let (mut client, stream) = tokio::io::duplex(1000);
        let mut bytes = Vec::new();
        write(MessageType::Initialize, 0, 0x0100_0000, b"hislip0", &mut bytes);
        client.write_all(&bytes).await.expect("room");
        let (seat, _end) = network.places.admit([127, 0, 0, 1].into()).expect("a place");
        let ended = run(&network, &sessions, Wire::new(Box::new(stream)), seat, "");
        ended.await.expect_err("refused");
        let mut head = [0; HEADER_BYTES];
        client.read_exact(&mut head).await.expect("a message");
        let header = MessageHeader::parse(&head).expect("a header");
        assert_eq!((header.code, header.control), (MessageType::FatalError.code(), 4));
    }
}
