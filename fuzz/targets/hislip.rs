//! Connections of all kinds to one HiSLIP server, whose instrument is the virtual oscilloscope.
//!
//! Each step begins with two bytes: which of five connections it is about and what happens there (bytes come, or a message with a
//! sound header around them, or it is closed), and how many bytes belong to it. Time passes between steps.

#![cfg_attr(not(test), no_main)]

use std::collections::BTreeMap;
use std::sync::LazyLock;

use hertzscope::hislip::message::MessageHeader;
use hertzscope::hislip::{Device as Behind, Server};
use hertzscope::instrument::Instrument;
use hertzscope::scene::Scene;
use hertzscope::scpi::{Preferences, Reply, Session};

static SCENE: LazyLock<Scene> = LazyLock::new(|| Scene::load("magnet-0.61g").expect("it ships"));

struct Desk {
    instrument: Instrument,
    sessions: BTreeMap<u16, Session>,
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
}

impl Behind for Desk {
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

    fn trigger(&mut self, session: u16) {
        self.input(session, b"*TRG", true);
    }

    fn lock_keys(&mut self, locked: bool) {
        self.instrument.service.locked = locked;
    }

    fn status(&self, message_available: bool) -> (u8, u8) {
        let status = &self.instrument.status;
        (status.byte(message_available), status.service_enable)
    }
}

/// One input.
pub fn run(input: &[u8]) {
    let instrument = Instrument::new(SCENE.scope.model.clone(), 0.0, 1);
    let mut desk = Desk { instrument, sessions: BTreeMap::new() };
    let mut server = Server::default();
    let mut now = 0.0;
    let mut open = [false; 5];
    let mut rest = input;
    while let [what, length, tail @ ..] = rest {
        let (bytes, tail) = tail.split_at(usize::from(*length).min(tail.len()));
        rest = tail;
        let slot = usize::from(what % 5);
        let number = slot as u64;
        if !open[slot] {
            server.opened(number);
            open[slot] = true;
        }
        match what / 5 % 4 {
            0 => server.received(number, bytes, &mut desk),
            1 => {
                server.closed(number, &mut desk);
                open[slot] = false;
            }
            // A sound header: kind, control code and parameter from the bytes, the others are the payload.
            _ => {
                let [code, control, parameter, payload @ ..] = bytes else { continue };
                let parameter = u32::from(*parameter);
                let length = payload.len() as u64;
                let header = MessageHeader { code: *code, control: *control, parameter, length };
                let mut message = header.bytes().to_vec();
                message.extend_from_slice(payload);
                server.received(number, &message, &mut desk);
            }
        }
        now += 0.01;
        desk.instrument.advance(now);
        let waiting: Vec<u16> = desk.sessions.keys().copied().collect();
        for session in waiting {
            let (state, instrument) = desk.session(session);
            let reply = bytes_of(state.resume(instrument));
            server.reply(session, &reply);
        }
        server.advance(now, &mut desk);
        for output in server.take_output() {
            assert!(output.bytes.is_empty() || output.bytes.starts_with(b"HS"));
            let slot = usize::try_from(output.connection).expect("a slot");
            if output.close {
                open[slot] = false;
            }
        }
    }
    for slot in 0..5 {
        server.closed(slot, &mut desk);
    }
    assert!(desk.sessions.is_empty(), "every session ends with its connections");
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
