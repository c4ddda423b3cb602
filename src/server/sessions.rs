//! The instrument with its sessions, one for each client of any protocol, with their transcript and
//! the faults of their replies.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::time::Duration;

use tokio::time::Instant;

use super::connection::Protocol;
use super::log::{Log, shown};
use super::recorder::Recorder;
use crate::instrument::Instrument;
use crate::lan::lock::Locks;
use crate::lan::{Device, FIRST_LINK};
use crate::scpi::{Preferences, Reply, Session, TranscriptLine};

/// Identifies a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SessionId {
    /// A raw connection, by its number.
    Raw(u64),
    /// A HiSLIP session or a VXI-11 link, by its number.
    Lan(u16),
}

/// A session and the address of its client.
struct SessionEntry {
    session: Session,
    connection: u64,
    peer: String,
}

/// A reply that a fault delays.
struct LateReply {
    id: SessionId,
    due: Instant,
    bytes: Vec<u8>,
}

/// Longest delay of a reply (s): a day.
const MAX_DELAY: f64 = 86_400.0;

/// The instrument and its sessions.
pub struct Sessions {
    /// The instrument.
    pub instrument: Instrument,
    /// The recording.
    pub recorder: Option<Recorder>,
    /// Client address of each connection.
    pub peers: BTreeMap<u64, SocketAddr>,
    /// Bytes after which a fault closes a connection, by its number.
    pub drops: BTreeMap<u64, usize>,
    /// The log.
    pub log: Log,
    entries: BTreeMap<SessionId, SessionEntry>,
    late: Vec<LateReply>,
    locks: Locks,
    header: bool,
    seed: u64,
}

impl Sessions {
    /// No sessions; `header` is the initial state of response headers, `seed` that of garbled
    /// replies.
    pub fn new(
        mut instrument: Instrument,
        (header, seed): (bool, u64),
        recorder: Option<Recorder>,
        log: Log,
    ) -> Self {
        // Power on is no error.
        instrument.status.take_reported();
        Self {
            instrument,
            recorder,
            peers: BTreeMap::new(),
            drops: BTreeMap::new(),
            log,
            entries: BTreeMap::new(),
            late: Vec::new(),
            locks: Locks::default(),
            header,
            seed,
        }
    }

    /// Opens session `id` on connection `connection`.
    pub fn open_session(&mut self, id: SessionId, connection: u64) {
        let session = Session::new(Preferences::new(self.header));
        let is_written = self.recorder.is_some() || self.log.is_on();
        let session = if is_written { session.with_transcript() } else { session };
        let protocol = match id {
            SessionId::Raw(_) => Protocol::Raw,
            SessionId::Lan(number) if number < FIRST_LINK => Protocol::Hislip,
            SessionId::Lan(_) => Protocol::Vxi11,
        };
        let peer = self.peer(connection, protocol);
        self.log.line(&peer, "opened");
        self.entries.insert(id, SessionEntry { session, connection, peer });
    }

    /// Protocol and address of a connection's client.
    fn peer(&self, connection: u64, protocol: Protocol) -> String {
        let address = self.peers.get(&connection).map(ToString::to_string).unwrap_or_default();
        format!("{} {address}", protocol.name())
    }

    /// Closes session `id`.
    pub fn close_session(&mut self, id: SessionId) {
        self.late.retain(|late| late.id != id);
        if let Some(entry) = self.entries.remove(&id) {
            self.log.line(&entry.peer, "closed");
        }
    }

    /// Passes bytes to a session; returns what it answers at once.
    pub fn receive(&mut self, id: SessionId, bytes: &[u8], end: bool) -> Vec<u8> {
        let reply = self.with(id, |session, instrument| {
            let mut reply = bytes_of(session.receive(instrument, bytes));
            if end {
                reply.extend(bytes_of(session.end_of_message(instrument)));
            }
            reply
        });
        self.disturb(id, reply)
    }

    /// A reply with the faults that are asked for; nothing where it comes later, out of
    /// [`Self::resume`].
    fn disturb(&mut self, id: SessionId, mut reply: Vec<u8>) -> Vec<u8> {
        let faults = &mut self.instrument.bench.faults;
        if reply.is_empty() || (faults.is_empty() && self.late.is_empty()) {
            return reply;
        }
        let Some(entry) = self.entries.get(&id) else { return reply };
        let mut delay = None;
        if entry.session.is_by_instrument() && !faults.is_empty() {
            let before = reply.clone();
            let found = faults.disturb_reply(&mut reply, self.seed);
            delay = found.delay;
            if let Some(length) = found.drop_after {
                self.drops.insert(entry.connection, length);
            }
            if before != reply || delay.or(found.drop_after.map(|_| 0.0)).is_some() {
                self.log.line(&entry.peer, &format!("* a fault disturbs {}", shown(&before)));
            }
        }
        // Replies keep their order.
        let last = self.late.iter().filter(|late| late.id == id).map(|late| late.due).max();
        let own = delay.map(|delay| Instant::now() + Duration::from_secs_f64(delay.min(MAX_DELAY)));
        match own.max(last) {
            Some(due) => {
                self.late.push(LateReply { id, due, bytes: reply });
                Vec::new()
            }
            None => reply,
        }
    }

    /// Whether a session waits: for the end of an acquisition, or for a reply that is late.
    pub fn is_waiting(&self, id: SessionId) -> bool {
        let late = self.late.iter().any(|late| late.id == id);
        late || self.entries.get(&id).is_some_and(|entry| entry.session.is_waiting())
    }

    /// Goes on with what waited; returns the answers by session.
    pub fn resume(&mut self) -> Vec<(SessionId, Vec<u8>)> {
        let waiting = self.entries.iter().filter(|(_, entry)| entry.session.is_waiting());
        let waiting: Vec<SessionId> = waiting.map(|(id, _)| *id).collect();
        let now = Instant::now();
        let due = self.late.extract_if(.., |late| late.due <= now);
        let mut replies: Vec<_> = due.map(|late| (late.id, late.bytes)).collect();
        for id in waiting {
            let resume = |session: &mut Session, instrument: &mut Instrument| {
                bytes_of(session.resume(instrument))
            };
            let reply = self.with(id, resume);
            replies.push((id, self.disturb(id, reply)));
        }
        replies.retain(|(_, bytes)| !bytes.is_empty());
        replies
    }

    /// Does something with a session, and writes down what was said.
    fn with<T: Default>(
        &mut self,
        id: SessionId,
        act: impl FnOnce(&mut Session, &mut Instrument) -> T,
    ) -> T {
        let Some(entry) = self.entries.get_mut(&id) else { return T::default() };
        let done = act(&mut entry.session, &mut self.instrument);
        // Taken also where no recording goes on: it would grow.
        let lines = entry.session.take_transcript();
        let events = self.instrument.status.take_reported();
        if self.log.is_on() {
            for line in &lines {
                let (sign, bytes) = match line {
                    TranscriptLine::Command(bytes) => ('>', bytes),
                    TranscriptLine::Reply(bytes) => ('<', bytes),
                };
                self.log.line(&entry.peer, &format!("{sign} {}", shown(bytes)));
            }
            for event in events {
                let message = event.message();
                let message = message.trim_end_matches("; ");
                self.log.line(&entry.peer, &format!("! {} {message}", event.code()));
            }
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.lines(&entry.peer, lines);
        }
        done
    }
}

fn bytes_of(reply: Reply) -> Vec<u8> {
    match reply {
        Reply::None => Vec::new(),
        Reply::Now(bytes) | Reply::WhenIdle(bytes) => bytes,
    }
}

impl Device for Sessions {
    fn open(&mut self, session: u16, connection: u64) {
        self.open_session(SessionId::Lan(session), connection);
    }

    fn close(&mut self, session: u16) {
        self.close_session(SessionId::Lan(session));
    }

    fn input(&mut self, session: u16, bytes: &[u8], end: bool) -> Vec<u8> {
        self.receive(SessionId::Lan(session), bytes, end)
    }

    fn owes_reply(&self, session: u16) -> bool {
        let id = SessionId::Lan(session);
        let late = self.late.iter().any(|late| late.id == id);
        late || self.entries.get(&id).is_some_and(|entry| entry.session.owes_reply())
    }

    fn is_waiting(&self, session: u16) -> bool {
        Self::is_waiting(self, SessionId::Lan(session))
    }

    fn interrupt(&mut self, session: u16) {
        self.late.retain(|late| late.id != SessionId::Lan(session));
        self.with(SessionId::Lan(session), Session::interrupt);
    }

    fn clear(&mut self, session: u16) {
        self.late.retain(|late| late.id != SessionId::Lan(session));
        self.with(SessionId::Lan(session), |session, _| session.clear());
    }

    fn trigger(&mut self, session: u16) -> Vec<u8> {
        let id = SessionId::Lan(session);
        let reply = self.with(id, |session, instrument| bytes_of(session.trigger(instrument)));
        self.disturb(id, reply)
    }

    fn lock_keys(&mut self, locked: bool) {
        self.instrument.service.locked = locked;
    }

    fn status(&self, message_available: bool) -> (u8, u8) {
        let status = &self.instrument.status;
        (status.byte(message_available), status.service_enable)
    }

    fn locks(&mut self) -> &mut Locks {
        &mut self.locks
    }
}
