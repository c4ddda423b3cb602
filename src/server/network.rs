//! What a connection's task and the instrument's task have in common: requests, answers, status,
//! locks and places.
//!
//! A session has at most one message under way at a time, so that sessions take turns, and the
//! queue of requests is no longer than there are sessions. Its answers come in one queue, in the
//! order in which the instrument gave them: replies, also late ones, and the end of each message.

use std::future::poll_fn;
use std::io;
use std::sync::atomic::{AtomicU64, Ordering};
use std::task::{Context, Poll};

use tokio::sync::{mpsc, oneshot, watch};

use super::locks::LockTable;
use super::places::{Busy, Places, Seat};
use crate::instrument::StatusSummary;

/// Answers of a session that wait for its connection. One that takes no more loses its session.
const ANSWER_QUEUE_CAPACITY: usize = 64;
/// Bit of the status byte: the instrument asks for service.
const SERVICE_REQUEST_BIT: u8 = 1 << 6;

/// A request to the instrument's task.
#[derive(Debug)]
pub enum Request {
    /// Opens a session.
    Open {
        /// The session.
        session: u64,
        /// Protocol and address of its client.
        peer: String,
        /// Takes its answers; without it the connection ends.
        answers: mpsc::Sender<Answer>,
    },
    /// Part of a message; answered by replies and [`Answer::Done`].
    Message {
        /// The session.
        session: u64,
        /// The bytes.
        bytes: Vec<u8>,
        /// Whether the message ends with them.
        end: bool,
        /// Whether it interrupts the reply to the message before.
        interrupts: Interrupts,
    },
    /// Device trigger; answered like a message.
    Trigger {
        /// The session.
        session: u64,
        /// Whether it interrupts the reply to the message before.
        interrupts: Interrupts,
    },
    /// Device clear.
    Clear {
        /// The session.
        session: u64,
        /// Resolves when nothing of before is left but what is in the queue of answers.
        done: oneshot::Sender<()>,
    },
    /// Locks or frees the front panel's keys.
    LockKeys(bool),
    /// Ends a session.
    Close {
        /// The session.
        session: u64,
    },
}

/// When a message interrupts the reply to the message before (IEEE 488.2, query interrupted).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interrupts {
    /// Never: it continues a message, or the protocol has no interruptions.
    Never,
    /// If the instrument still owes the reply.
    IfOwed,
    /// In any case: the client has not read the reply.
    Always,
}

/// An answer of the instrument's task.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Part of a reply, terminators included.
    Reply(Vec<u8>),
    /// The reply to the message before was thrown away.
    Interrupted,
    /// A fault: the connection ends after this number of further bytes.
    DropAfter(usize),
    /// The message is executed.
    Done {
        /// Whether a part of it waits for the end of an acquisition, or a reply is late.
        waits: bool,
    },
    /// The session waits no longer.
    Resumed,
}

/// What all connections share.
pub struct Network {
    requests: mpsc::UnboundedSender<Request>,
    status: watch::Receiver<StatusSummary>,
    next_session: AtomicU64,
    /// The locks of all sessions.
    pub locks: LockTable,
    /// The places of all connections.
    pub places: Places,
}

/// The instrument's end of a `Network`.
pub struct Inbox {
    /// The requests.
    pub requests: mpsc::UnboundedReceiver<Request>,
    /// Takes changes of the status byte.
    pub status: watch::Sender<StatusSummary>,
}

impl Network {
    /// A network without connections, and the instrument's end of it.
    pub fn new() -> (Self, Inbox) {
        let (requests, inbox) = mpsc::unbounded_channel();
        let (status_sender, status) = watch::channel(StatusSummary::default());
        let network = Self {
            requests,
            status,
            next_session: AtomicU64::new(1),
            locks: LockTable::default(),
            places: Places::default(),
        };
        (network, Inbox { requests: inbox, status: status_sender })
    }

    /// Opens a session on the connection with this place.
    pub fn open<'a>(&'a self, peer: &str, seat: &'a Seat) -> ClientSession<'a> {
        let number = self.next_session.fetch_add(1, Ordering::Relaxed);
        let (answers, inbox) = mpsc::channel(ANSWER_QUEUE_CAPACITY);
        self.send(Request::Open { session: number, peer: peer.to_owned(), answers });
        ClientSession { network: self, number, answers: inbox, seat, busy: None }
    }

    /// Follows the part of the status byte that all clients share.
    pub fn status(&self) -> watch::Receiver<StatusSummary> {
        self.status.clone()
    }

    /// Waits until the instrument's task has ended.
    pub async fn closed(&self) {
        self.requests.closed().await;
    }

    /// Device clear of a session.
    pub async fn clear(&self, session: u64) {
        let (done, cleared) = oneshot::channel();
        self.send(Request::Clear { session, done });
        // Nothing is left to be cleared where the instrument has ended.
        let _ = cleared.await;
    }

    /// Locks or frees the front panel's keys.
    pub fn lock_keys(&self, locked: bool) {
        self.send(Request::LockKeys(locked));
    }

    fn send(&self, request: Request) {
        // Where the instrument's task has ended, so do the sessions' answers.
        let _ = self.requests.send(request);
    }
}

/// A connection's end of a session, which ends with it, as do its locks. The connection keeps its
/// place while a message is under way or the session waits for the end of an acquisition.
pub struct ClientSession<'a> {
    network: &'a Network,
    number: u64,
    answers: mpsc::Receiver<Answer>,
    seat: &'a Seat,
    busy: Option<Busy>,
}

impl ClientSession<'_> {
    /// Number of the session.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Sends part of a message; to be followed by answers up to [`Answer::Done`].
    pub fn send(&mut self, bytes: Vec<u8>, end: bool, interrupts: Interrupts) {
        self.request(Request::Message { session: self.number, bytes, end, interrupts });
    }

    /// Sends a device trigger; to be followed by answers up to [`Answer::Done`].
    pub fn trigger(&mut self, interrupts: Interrupts) {
        self.request(Request::Trigger { session: self.number, interrupts });
    }

    fn request(&mut self, request: Request) {
        self.busy = Some(self.seat.busy());
        self.network.send(request);
    }

    /// Device clear: what is in the queue of answers afterwards was answered before.
    pub fn clear(&mut self) {
        while self.answers.try_recv().is_ok() {}
        self.busy = None;
    }

    /// The next answer.
    ///
    /// # Errors
    /// That the session has ended.
    pub async fn answer(&mut self) -> io::Result<Answer> {
        poll_fn(|context| self.poll_answer(context)).await
    }

    /// Polls for the next answer.
    ///
    /// # Errors
    /// That the session has ended.
    pub fn poll_answer(&mut self, context: &mut Context<'_>) -> Poll<io::Result<Answer>> {
        self.answers.poll_recv(context).map(|answer| {
            let answer = answer.ok_or(io::ErrorKind::NotConnected)?;
            if let Answer::Done { waits: false } | Answer::Resumed = answer {
                self.busy = None;
            }
            Ok(answer)
        })
    }

    /// Whether a message is under way, or the session waits for the end of an acquisition.
    pub fn is_busy(&self) -> bool {
        self.busy.is_some()
    }
}

impl Drop for ClientSession<'_> {
    fn drop(&mut self) {
        self.network.locks.remove_session(self.number);
        self.network.send(Request::Close { session: self.number });
    }
}

/// What a session's client knows of service requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ServiceRequest {
    /// Reasons that were reported.
    reasons: u8,
    /// Whether one was reported since the status byte was read.
    is_pending: bool,
}

impl ServiceRequest {
    /// Whether there is a new reason to ask for service in a status byte; `enabled` parts of it
    /// are reasons.
    pub fn is_due(&mut self, status: StatusSummary, message_available: bool) -> bool {
        let enabled = status.enabled & !SERVICE_REQUEST_BIT;
        let reasons = status.byte(message_available) & enabled;
        let is_new = reasons & !self.reasons != 0;
        self.reasons = reasons;
        self.is_pending |= is_new;
        is_new
    }

    /// The status byte; its bit 6 is set if service was requested since the last read.
    pub fn read(&mut self, status: StatusSummary, message_available: bool) -> u8 {
        self.is_due(status, message_available);
        let byte = status.byte(message_available) & !SERVICE_REQUEST_BIT;
        let is_pending = std::mem::take(&mut self.is_pending);
        byte | if is_pending { SERVICE_REQUEST_BIT } else { 0 }
    }
}
