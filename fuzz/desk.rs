//! The virtual oscilloscope behind the connections of clients.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use hertzscope::instrument::Instrument;
use hertzscope::scene::Scene;
use hertzscope::scpi::{Preferences, Reply, Session};
use hertzscope::server::{Answer, Interrupts, Request};
use tokio::sync::mpsc;

use super::network::Device;

static SCENE: LazyLock<Scene> = LazyLock::new(|| Scene::load("magnet-0.61g").expect("it ships"));

pub struct Desk {
    instrument: Instrument,
    sessions: BTreeMap<u64, (Session, mpsc::Sender<Answer>)>,
}

impl Default for Desk {
    fn default() -> Self {
        let instrument = Instrument::new(SCENE.scope.model.clone(), 0.0, 1);
        Self { instrument, sessions: BTreeMap::new() }
    }
}

fn bytes_of(reply: Reply) -> Vec<u8> {
    match reply {
        Reply::None => Vec::new(),
        Reply::Now(bytes) | Reply::WhenIdle(bytes) => bytes,
    }
}

/// The connection may have ended.
fn send(answers: &mpsc::Sender<Answer>, reply: Vec<u8>, end: Answer) {
    if !reply.is_empty() {
        let _ = answers.try_send(Answer::Reply(reply));
    }
    let _ = answers.try_send(end);
}

impl Desk {
    /// It is `now` (s): what waited goes on.
    pub fn resume(&mut self, now: f64) {
        self.instrument.advance(now);
        for (session, answers) in self.sessions.values_mut() {
            if session.is_waiting() {
                let reply = bytes_of(session.resume(&mut self.instrument));
                if !session.is_waiting() {
                    send(answers, reply, Answer::Resumed);
                }
            }
        }
    }

    pub fn sessions(&self) -> usize {
        self.sessions.len()
    }

    fn execute_in(
        &mut self,
        session: u64,
        interrupts: Interrupts,
        act: impl FnOnce(&mut Session, &mut Instrument) -> Vec<u8>,
    ) {
        let (session, answers) = self.sessions.get_mut(&session).expect("an open session");
        let owes = session.owes_reply() && interrupts != Interrupts::Never;
        if interrupts == Interrupts::Always || owes {
            session.interrupt(&mut self.instrument);
            let _ = answers.try_send(Answer::Interrupted);
        }
        let reply = act(session, &mut self.instrument);
        send(answers, reply, Answer::Done { waits: session.is_waiting() });
    }
}

impl Device for Desk {
    fn execute(&mut self, request: Request) {
        match request {
            Request::Open { session, answers, .. } => {
                let fresh = (Session::new(Preferences::new(false)), answers);
                assert!(self.sessions.insert(session, fresh).is_none(), "a session is opened once");
            }
            Request::Message { session, bytes, end, interrupts } => {
                self.execute_in(session, interrupts, |session, instrument| {
                    let mut reply = bytes_of(session.receive(instrument, &bytes));
                    if end {
                        reply.extend(bytes_of(session.end_of_message(instrument)));
                    }
                    reply
                });
            }
            Request::Trigger { session, interrupts } => {
                self.execute_in(session, interrupts, |session, instrument| {
                    bytes_of(session.trigger(instrument))
                });
            }
            Request::Clear { session, done } => {
                self.sessions.get_mut(&session).expect("an open session").0.clear();
                let _ = done.send(());
            }
            Request::LockKeys(locked) => self.instrument.service.locked = locked,
            Request::Close { session } => {
                assert!(self.sessions.remove(&session).is_some(), "a session is closed once");
            }
        }
    }
}
