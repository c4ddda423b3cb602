//! The instrument with everybody who talks to it, whatever the protocol: one session each, and what is written down.

use std::collections::BTreeMap;
use std::net::SocketAddr;

use super::recorder::Recorder;
use crate::hislip;
use crate::instrument::Instrument;
use crate::scpi::{Preferences, Reply, Session};

/// Who talks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Talker {
    /// A raw connection, by its number.
    Raw(u64),
    /// A HiSLIP session, by its number.
    Hislip(u16),
}

/// A talker's session.
struct Seat {
    session: Session,
    peer: String,
}

/// The instrument and its sessions.
pub struct Desk {
    /// The instrument.
    pub instrument: Instrument,
    /// Where everything is written down.
    pub recorder: Option<Recorder>,
    /// Who is at the other end of each connection.
    pub peers: BTreeMap<u64, SocketAddr>,
    seats: BTreeMap<Talker, Seat>,
    header: bool,
}

impl Desk {
    /// Nobody there yet; `header` tells whether headers stand before answers until a client says otherwise.
    pub fn new(instrument: Instrument, header: bool, recorder: Option<Recorder>) -> Self {
        Self { instrument, recorder, peers: BTreeMap::new(), seats: BTreeMap::new(), header }
    }

    /// Somebody comes, on connection `connection`.
    pub fn sit(&mut self, talker: Talker, connection: u64) {
        let session = Session::new(Preferences::new(self.header));
        let session = if self.recorder.is_some() { session.with_transcript() } else { session };
        let address = self.peers.get(&connection).map(ToString::to_string).unwrap_or_default();
        let peer = match talker {
            Talker::Raw(_) => format!("raw {address}"),
            Talker::Hislip(_) => format!("hislip {address}"),
        };
        self.seats.insert(talker, Seat { session, peer });
    }

    /// Somebody goes.
    pub fn leave(&mut self, talker: Talker) {
        self.seats.remove(&talker);
    }

    /// Passes bytes to a session; returns what it answers at once.
    pub fn receive(&mut self, talker: Talker, bytes: &[u8], end: bool) -> Vec<u8> {
        self.with(talker, |session, instrument| {
            let mut reply = bytes_of(session.receive(instrument, bytes));
            if end {
                reply.extend(bytes_of(session.end_of_message(instrument)));
            }
            reply
        })
    }

    /// Whether a session waits for the end of an acquisition.
    pub fn is_waiting(&self, talker: Talker) -> bool {
        self.seats.get(&talker).is_some_and(|seat| seat.session.is_waiting())
    }

    /// Goes on with what waited for the end of an acquisition; returns who has got what to say.
    pub fn resume(&mut self) -> Vec<(Talker, Vec<u8>)> {
        let waiting = self.seats.iter().filter(|(_, seat)| seat.session.is_waiting());
        let waiting: Vec<Talker> = waiting.map(|(talker, _)| *talker).collect();
        let resumed = waiting.into_iter().map(|talker| {
            let resume = |session: &mut Session, instrument: &mut Instrument| {
                bytes_of(session.resume(instrument))
            };
            (talker, self.with(talker, resume))
        });
        resumed.filter(|(_, bytes)| !bytes.is_empty()).collect()
    }

    /// Does something with a session, and writes down what was said.
    fn with<T: Default>(
        &mut self,
        talker: Talker,
        act: impl FnOnce(&mut Session, &mut Instrument) -> T,
    ) -> T {
        let Some(seat) = self.seats.get_mut(&talker) else { return T::default() };
        let done = act(&mut seat.session, &mut self.instrument);
        if let Some(recorder) = &mut self.recorder {
            recorder.lines(&seat.peer, seat.session.take_transcript());
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

impl hislip::Instrument for Desk {
    fn open(&mut self, session: u16, connection: u64) {
        self.sit(Talker::Hislip(session), connection);
    }

    fn close(&mut self, session: u16) {
        self.leave(Talker::Hislip(session));
    }

    fn input(&mut self, session: u16, bytes: &[u8], end: bool) -> Vec<u8> {
        self.receive(Talker::Hislip(session), bytes, end)
    }

    fn owes_reply(&self, session: u16) -> bool {
        let seat = self.seats.get(&Talker::Hislip(session));
        seat.is_some_and(|seat| seat.session.owes_reply())
    }

    fn interrupt(&mut self, session: u16) {
        self.with(Talker::Hislip(session), Session::interrupt);
    }

    fn clear(&mut self, session: u16) {
        self.with(Talker::Hislip(session), |session, _| session.clear());
    }

    fn trigger(&mut self, session: u16) {
        // The message of a device trigger is the command for it.
        self.receive(Talker::Hislip(session), b"*TRG", true);
    }

    fn lock_keys(&mut self, locked: bool) {
        self.instrument.service.locked = locked;
    }

    fn status(&self, message_available: bool) -> (u8, u8) {
        let status = &self.instrument.status;
        (status.byte(message_available), status.service_enable)
    }
}
