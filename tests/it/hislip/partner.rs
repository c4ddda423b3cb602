//! Clients on one side of the protocol, an instrument that writes everything down on the other.

use std::collections::VecDeque;

use hertzscope::hislip::Server;
use hertzscope::hislip::message::{DecodedPiece, Decoder, MessageType, write};
use hertzscope::lan::Device;
use hertzscope::lan::lock::Locks;

/// An instrument that answers what ends with a question mark: the text before it.
#[derive(Default)]
pub struct Fake {
    pub log: Vec<String>,
    pub owes: bool,
    pub event: bool,
    pub enabled: u8,
    /// The reply to a device trigger.
    pub triggered: Vec<u8>,
    pub locks: Locks,
    text: Vec<u8>,
}

impl Device for Fake {
    fn open(&mut self, session: u16, _: u64) {
        self.log.push(format!("open {session}"));
    }

    fn close(&mut self, session: u16) {
        self.log.push(format!("close {session}"));
    }

    fn input(&mut self, session: u16, bytes: &[u8], end: bool) -> Vec<u8> {
        self.text.extend_from_slice(bytes);
        if !end {
            return Vec::new();
        }
        let text = String::from_utf8(std::mem::take(&mut self.text)).expect("text");
        self.log.push(format!("{session}: {text}"));
        self.owes |= text == "later?";
        match text.strip_suffix('?') {
            Some(answer) if !self.owes => format!("{answer}\n").into_bytes(),
            _ => Vec::new(),
        }
    }

    fn is_waiting(&self, session: u16) -> bool {
        self.owes_reply(session)
    }

    fn owes_reply(&self, _: u16) -> bool {
        self.owes
    }

    fn interrupt(&mut self, session: u16) {
        self.owes = false;
        self.log.push(format!("{session} interrupted"));
    }

    fn clear(&mut self, session: u16) {
        self.owes = false;
        self.text.clear();
        self.log.push(format!("{session} cleared"));
    }

    fn trigger(&mut self, session: u16) -> Vec<u8> {
        self.log.push(format!("{session} triggers"));
        self.triggered.clone()
    }

    fn lock_keys(&mut self, locked: bool) {
        self.log.push(format!("keys {locked}"));
    }

    fn status(&self, message_available: bool) -> (u8, u8) {
        let byte = (u8::from(message_available) << 4) | (u8::from(self.event) << 5);
        let asks = byte & self.enabled != 0;
        (byte | (u8::from(asks) << 6), self.enabled)
    }

    fn locks(&mut self) -> &mut Locks {
        &mut self.locks
    }
}

/// A message as a client sees it: kind, control code, parameter, payload.
pub type Seen = (MessageType, u8, u32, Vec<u8>);

/// A server with its connections, each with what it has been sent.
#[derive(Default)]
pub struct Lab {
    pub server: Server,
    pub fake: Fake,
    inboxes: Vec<(Decoder, VecDeque<Seen>, bool)>,
}

/// A session's two connections and its number.
#[derive(Clone, Copy)]
pub struct Client {
    pub synchronous: u64,
    pub asynchronous: u64,
    pub session: u16,
}

impl Lab {
    pub fn connection(&mut self) -> u64 {
        let number = self.inboxes.len() as u64;
        self.inboxes.push(Default::default());
        self.server.opened(number);
        number
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
        let session = u16::try_from(parameter & 0xFFFF).expect("a number");
        Client { synchronous, asynchronous, session }
    }

    pub fn send(&mut self, at: u64, kind: MessageType, codes: (u8, u32), payload: &[u8]) {
        let mut bytes = Vec::new();
        write(kind, codes.0, codes.1, payload, &mut bytes);
        self.bytes(at, &bytes);
    }

    pub fn bytes(&mut self, connection: u64, bytes: &[u8]) {
        self.server.received(connection, bytes, &mut self.fake);
        self.deliver();
    }

    pub fn wait_until(&mut self, now: f64) {
        self.server.advance(now, &mut self.fake);
        self.deliver();
    }

    pub fn close(&mut self, connection: u64) {
        self.server.closed(connection, &mut self.fake);
        self.deliver();
    }

    pub fn deliver(&mut self) {
        for output in self.server.take_output() {
            let index = usize::try_from(output.connection).expect("a number");
            let (decoder, inbox, closed) = &mut self.inboxes[index];
            decoder.push(&output.bytes);
            while let Some(piece) = decoder.next_piece() {
                let DecodedPiece::Message(header, payload) = piece else { panic!("{piece:?}") };
                let kind = MessageType::from_code(header.code).expect("a known kind");
                inbox.push_back((kind, header.control, header.parameter, payload));
            }
            *closed |= output.close;
        }
    }

    /// The next message that a connection was sent.
    #[track_caller]
    pub fn next(&mut self, connection: u64) -> Seen {
        self.try_next(connection).expect("a message")
    }

    pub fn try_next(&mut self, connection: u64) -> Option<Seen> {
        self.inboxes[usize::try_from(connection).expect("a number")].1.pop_front()
    }

    pub fn is_closed(&self, connection: u64) -> bool {
        self.inboxes[usize::try_from(connection).expect("a number")].2
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
