//! The virtual oscilloscope behind a protocol's server.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use hertzscope::instrument::Instrument;
use hertzscope::lan::Device;
use hertzscope::lan::lock::Locks;
use hertzscope::scene::Scene;
use hertzscope::scpi::{Preferences, Reply, Session};

static SCENE: LazyLock<Scene> = LazyLock::new(|| Scene::load("magnet-0.61g").expect("it ships"));

pub struct Desk {
    instrument: Instrument,
    sessions: BTreeMap<u16, Session>,
    locks: Locks,
}

impl Default for Desk {
    fn default() -> Self {
        let instrument = Instrument::new(SCENE.scope.model.clone(), 0.0, 1);
        Self { instrument, sessions: BTreeMap::new(), locks: Locks::default() }
    }
}

fn bytes_of(reply: Reply) -> Vec<u8> {
    match reply {
        Reply::None => Vec::new(),
        Reply::Now(bytes) | Reply::WhenIdle(bytes) => bytes,
    }
}

impl Desk {
    fn session(&mut self, number: u16) -> (&mut Session, &mut Instrument) {
        (self.sessions.get_mut(&number).expect("an open session"), &mut self.instrument)
    }

    /// It is `now` (s): what waited goes on; the replies by session.
    pub fn resume(&mut self, now: f64) -> Vec<(u16, Vec<u8>)> {
        self.instrument.advance(now);
        let (sessions, instrument) = (self.sessions.iter_mut(), &mut self.instrument);
        sessions.map(|(number, s)| (*number, bytes_of(s.resume(instrument)))).collect()
    }

    pub fn sessions(&self) -> usize {
        self.sessions.len()
    }
}

impl Device for Desk {
    fn open(&mut self, session: u16, _: u64) {
        let fresh = self.sessions.insert(session, Session::new(Preferences::new(false)));
        assert!(fresh.is_none(), "a session is opened once");
    }

    fn close(&mut self, session: u16) {
        assert!(self.sessions.remove(&session).is_some(), "a session is closed once");
    }

    fn input(&mut self, session: u16, bytes: &[u8], end: bool) -> Vec<u8> {
        let (session, instrument) = self.session(session);
        let mut reply = bytes_of(session.receive(instrument, bytes));
        if end {
            reply.extend(bytes_of(session.end_of_message(instrument)));
        }
        reply
    }

    fn is_waiting(&self, session: u16) -> bool {
        self.owes_reply(session)
    }

    fn owes_reply(&self, session: u16) -> bool {
        self.sessions.get(&session).expect("an open session").owes_reply()
    }

    fn interrupt(&mut self, session: u16) {
        let (session, instrument) = self.session(session);
        session.interrupt(instrument);
    }

    fn clear(&mut self, session: u16) {
        self.session(session).0.clear();
    }

    fn trigger(&mut self, session: u16) -> Vec<u8> {
        let (session, instrument) = self.session(session);
        bytes_of(session.trigger(instrument))
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
