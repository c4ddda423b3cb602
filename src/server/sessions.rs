//! The instrument with its sessions, one for each client of either protocol, and their transcript.

use std::collections::BTreeMap;
use std::net::SocketAddr;

use super::recorder::Recorder;
use crate::hislip;
use crate::instrument::Instrument;
use crate::scpi::{Preferences, Reply, Session};

/// Identifies a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SessionId {
    /// A raw connection, by its number.
    Raw(u64),
    /// A HiSLIP session, by its number.
    Hislip(u16),
}

/// A session and the address of its client.
struct SessionEntry {
    session: Session,
    peer: String,
}

/// The instrument and its sessions.
pub struct Sessions {
    /// The instrument.
    pub instrument: Instrument,
    /// The recording.
    pub recorder: Option<Recorder>,
    /// Client address of each connection.
    pub peers: BTreeMap<u64, SocketAddr>,
    entries: BTreeMap<SessionId, SessionEntry>,
    header: bool,
}

impl Sessions {
    /// No sessions; `header` is the initial state of response headers.
    pub fn new(instrument: Instrument, header: bool, recorder: Option<Recorder>) -> Self {
        Self { instrument, recorder, peers: BTreeMap::new(), entries: BTreeMap::new(), header }
    }

    /// Opens session `id` on connection `connection`.
    pub fn open_session(&mut self, id: SessionId, connection: u64) {
        let session = Session::new(Preferences::new(self.header));
        let session = if self.recorder.is_some() { session.with_transcript() } else { session };
        let address = self.peers.get(&connection).map(ToString::to_string).unwrap_or_default();
        let peer = match id {
            SessionId::Raw(_) => format!("raw {address}"),
            SessionId::Hislip(_) => format!("hislip {address}"),
        };
        self.entries.insert(id, SessionEntry { session, peer });
    }

    /// Closes session `id`.
    pub fn close_session(&mut self, id: SessionId) {
        self.entries.remove(&id);
    }

    /// Passes bytes to a session; returns what it answers at once.
    pub fn receive(&mut self, id: SessionId, bytes: &[u8], end: bool) -> Vec<u8> {
        self.with(id, |session, instrument| {
            let mut reply = bytes_of(session.receive(instrument, bytes));
            if end {
                reply.extend(bytes_of(session.end_of_message(instrument)));
            }
            reply
        })
    }

    /// Whether a session waits for the end of an acquisition.
    pub fn is_waiting(&self, id: SessionId) -> bool {
        self.entries.get(&id).is_some_and(|entry| entry.session.is_waiting())
    }

    /// Goes on with what waited for the end of an acquisition; returns the answers by session.
    pub fn resume(&mut self) -> Vec<(SessionId, Vec<u8>)> {
        let waiting = self.entries.iter().filter(|(_, entry)| entry.session.is_waiting());
        let waiting: Vec<SessionId> = waiting.map(|(id, _)| *id).collect();
        let resumed = waiting.into_iter().map(|id| {
            let resume = |session: &mut Session, instrument: &mut Instrument| {
                bytes_of(session.resume(instrument))
            };
            (id, self.with(id, resume))
        });
        resumed.filter(|(_, bytes)| !bytes.is_empty()).collect()
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

impl hislip::Device for Sessions {
    fn open(&mut self, session: u16, connection: u64) {
        self.open_session(SessionId::Hislip(session), connection);
    }

    fn close(&mut self, session: u16) {
        self.close_session(SessionId::Hislip(session));
    }

    fn input(&mut self, session: u16, bytes: &[u8], end: bool) -> Vec<u8> {
        self.receive(SessionId::Hislip(session), bytes, end)
    }

    fn owes_reply(&self, session: u16) -> bool {
        let entry = self.entries.get(&SessionId::Hislip(session));
        entry.is_some_and(|entry| entry.session.owes_reply())
    }

    fn is_waiting(&self, session: u16) -> bool {
        Self::is_waiting(self, SessionId::Hislip(session))
    }

    fn interrupt(&mut self, session: u16) {
        self.with(SessionId::Hislip(session), Session::interrupt);
    }

    fn clear(&mut self, session: u16) {
        self.with(SessionId::Hislip(session), |session, _| session.clear());
    }

    fn trigger(&mut self, session: u16) {
        // The message of a device trigger is the command for it.
        self.receive(SessionId::Hislip(session), b"*TRG", true);
    }

    fn lock_keys(&mut self, locked: bool) {
        self.instrument.service.locked = locked;
    }

    fn status(&self, message_available: bool) -> (u8, u8) {
        let status = &self.instrument.status;
        (status.byte(message_available), status.service_enable)
    }
}
