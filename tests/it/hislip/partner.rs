//! Clients on one side of the protocol, an instrument that writes everything down on the other.

use std::collections::{BTreeMap, VecDeque};
use std::sync::MutexGuard;

use hertzscope::hislip::{DecodedPiece, Decoder, MessageType, write};
use hertzscope::server::{Answer, Interrupts, Protocol, Request};
use tokio::sync::mpsc;

use crate::fuzz_corpora::network::{Device, Network};

/// An instrument that answers what ends with a question mark: the text before it. It owes the reply
/// to `later?`.
#[derive(Default)]
pub struct Fake {
    pub log: Vec<String>,
    pub owes: bool,
    /// The reply to a device trigger.
    pub triggered: Vec<u8>,
    text: Vec<u8>,
    sessions: BTreeMap<u64, mpsc::Sender<Answer>>,
}

impl Fake {
    fn send(&self, session: u64, answer: Answer) {
        // The connection may have ended.
        let _ = self.sessions[&session].try_send(answer);
    }

    /// The reply that it owes to a session.
    pub fn reply(&mut self, session: u64, bytes: &[u8]) {
        self.owes = false;
        self.send(session, Answer::Reply(bytes.to_vec()));
        self.send(session, Answer::Resumed);
    }

    fn interrupt(&mut self, session: u64, interrupts: Interrupts) {
        let is_owed = interrupts == Interrupts::IfOwed && self.owes;
        if is_owed || interrupts == Interrupts::Always {
            self.owes = false;
            self.log.push(format!("{session} interrupted"));
            self.send(session, Answer::Interrupted);
        }
    }

    fn complete(&mut self, session: u64, reply: Vec<u8>) {
        if !reply.is_empty() {
            self.send(session, Answer::Reply(reply));
        }
        self.send(session, Answer::Done { waits: self.owes });
    }
}

impl Device for Fake {
    fn execute(&mut self, request: Request) {
        match request {
            Request::Open { session, answers, .. } => {
                self.log.push(format!("open {session}"));
                self.sessions.insert(session, answers);
            }
            Request::Close { session } => {
                self.log.push(format!("close {session}"));
                self.sessions.remove(&session);
            }
            Request::Message { session, bytes, end, interrupts } => {
                self.interrupt(session, interrupts);
                self.text.extend_from_slice(&bytes);
                let mut reply = Vec::new();
                if end || bytes.ends_with(b"\n") {
                    let text =
                        String::from_utf8_lossy(&std::mem::take(&mut self.text)).into_owned();
                    let text = text.trim_end();
                    self.log.push(format!("{session}: {text}"));
                    self.owes |= text == "later?";
                    if let Some(answer) = text.strip_suffix('?').filter(|_| !self.owes) {
                        reply = format!("{answer}\n").into_bytes();
                    }
                }
                self.complete(session, reply);
            }
            Request::Trigger { session, interrupts } => {
                self.interrupt(session, interrupts);
                self.log.push(format!("{session} triggers"));
                self.complete(session, self.triggered.clone());
            }
            Request::Clear { session, done } => {
                self.owes = false;
                self.text.clear();
                self.log.push(format!("{session} cleared"));
                done.send(()).expect("a connection that waits");
            }
            Request::LockKeys(locked) => self.log.push(format!("keys {locked}")),
        }
    }
}

/// A message as a client sees it: kind, control code, parameter, payload.
pub type Seen = (MessageType, u8, u32, Vec<u8>);

/// Connections, each with what it has been sent.
pub struct Lab {
    pub network: Network<Fake>,
    inboxes: BTreeMap<usize, (Decoder, VecDeque<Seen>)>,
}

impl Default for Lab {
    fn default() -> Self {
        Self::new(0)
    }
}

/// A session's two connections and its number.
#[derive(Clone, Copy)]
pub struct Client {
    pub synchronous: usize,
    pub asynchronous: usize,
    pub session: u64,
}

impl Lab {
    /// VXI-11 is spoken on `vxi11_port`.
    pub fn new(vxi11_port: u16) -> Self {
        Self { network: Network::new(vxi11_port), inboxes: BTreeMap::new() }
    }

    pub fn fake(&self) -> MutexGuard<'_, Fake> {
        self.network.device()
    }

    pub fn connection(&mut self) -> usize {
        self.network.connect(Protocol::Hislip)
    }

    pub fn client(&mut self) -> Client {
        let synchronous = self.connection();
        self.send(synchronous, MessageType::Initialize, (0, 0x0100_7878), b"hislip0");
        let (kind, control, parameter, payload) = self.next(synchronous);
        assert_eq!((kind, control, payload), (MessageType::InitializeResponse, 0, Vec::new()));
        assert_eq!(parameter >> 16, 0x0100, "version 1.0");
        let asynchronous = self.connection();
        self.send(asynchronous, MessageType::AsyncInitialize, (0, parameter & 0xFFFF), b"");
        assert_eq!(
            self.next(asynchronous),
            (MessageType::AsyncInitializeResponse, 0, 0, Vec::new())
        );
        Client { synchronous, asynchronous, session: u64::from(parameter & 0xFFFF) }
    }

    pub fn send(&mut self, at: usize, kind: MessageType, codes: (u8, u32), payload: &[u8]) {
        let mut bytes = Vec::new();
        write(kind, codes.0, codes.1, payload, &mut bytes);
        self.network.send(at, &bytes);
    }

    pub fn wait_until(&mut self, now: f64) {
        self.network.wait_until(now);
    }

    /// The next message that a connection was sent.
    #[track_caller]
    pub fn next(&mut self, connection: usize) -> Seen {
        self.try_next(connection).expect("a message")
    }

    pub fn try_next(&mut self, connection: usize) -> Option<Seen> {
        self.network.settle();
        let (decoder, inbox) = self.inboxes.entry(connection).or_default();
        decoder.push(&self.network.received(connection));
        while let Some(piece) = decoder.next_piece() {
            let DecodedPiece::Message(header, payload) = piece else { panic!("{piece:?}") };
            let kind = MessageType::from_code(header.code).expect("a known kind");
            inbox.push_back((kind, header.control, header.parameter, payload));
        }
        inbox.pop_front()
    }

    pub fn is_closed(&self, connection: usize) -> bool {
        self.network.is_closed(connection)
    }

    /// Sends a whole message as number `number`, counted from 0.
    pub fn say(&mut self, client: Client, number: u32, delivered: bool, text: &str) {
        let identifier = identifier(number);
        let control = u8::from(delivered);
        self.send(client.synchronous, MessageType::DataEnd, (control, identifier), text.as_bytes());
    }
}

/// Identifier of a client's message, counted from 0.
pub fn identifier(number: u32) -> u32 {
    0xFFFF_FF00_u32.wrapping_add(2 * number)
}
