//! One session: what it remembers between two messages.

use super::message::{DecodedPiece, HEADER_BYTES, MessageType, write};
use crate::lan::ServiceRequest;

/// Identifier of a client's first message after the start and after a device clear.
const FIRST_MESSAGE_ID: u32 = 0xFFFF_FF00;
/// Identifier of a reply to no message.
const NO_MESSAGE_ID: u32 = 0xFFFF_FFFF;
/// Lower bound of the client's maximum message size (bytes).
const MIN_MESSAGE_LIMIT: u64 = 64;
/// Payload of a reply's part where the client names no limit (bytes).
const DEFAULT_PAYLOAD_LIMIT: usize = 1 << 20;

/// A release that waits for the message that was sent before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Release {
    /// Identifier of that message.
    pub after: u32,
    /// When it is waited for no longer, on the server's clock (s).
    pub until: f64,
}

/// The state of a session.
#[derive(Debug, Clone)]
pub struct HislipSession {
    /// Number of its synchronous connection.
    pub synchronous: u64,
    /// Number of its asynchronous connection, as soon as there is one.
    pub asynchronous: Option<u64>,
    /// A device clear has begun: what comes on the synchronous connection is thrown away until it
    /// is complete.
    pub clearing: bool,
    /// Messages that wait for another session's lock.
    pub held: Vec<DecodedPiece>,
    /// A release that waits.
    pub release: Option<Release>,
    /// Payload of a reply's part at most (bytes).
    part: usize,
    /// Identifier of the last message whose end has come since the start or a device clear.
    last: Option<u32>,
    /// A message has begun and not ended.
    within_message: bool,
    /// A reply was sent that the client has not called delivered.
    undelivered: bool,
    /// What the client knows of service requests.
    pub service: ServiceRequest,
}

impl HislipSession {
    /// A session whose synchronous connection is there.
    pub fn new(synchronous: u64) -> Self {
        Self {
            synchronous,
            asynchronous: None,
            clearing: false,
            held: Vec::new(),
            release: None,
            part: DEFAULT_PAYLOAD_LIMIT,
            last: None,
            within_message: false,
            undelivered: false,
            service: ServiceRequest::default(),
        }
    }

    /// The client takes no message larger than this, header included.
    pub fn limit(&mut self, largest: u64) {
        let largest = usize::try_from(largest.max(MIN_MESSAGE_LIMIT)).unwrap_or(usize::MAX);
        self.part = (largest - HEADER_BYTES).min(DEFAULT_PAYLOAD_LIMIT);
    }

    /// A message or a part of it begins. Whether it is the first part of a message that comes
    /// before the reply to the one before was delivered.
    pub fn begin(&mut self, delivered: bool, owes_reply: bool) -> bool {
        let first = !std::mem::replace(&mut self.within_message, true);
        if delivered {
            self.undelivered = false;
        }
        let interrupts = first && (self.undelivered || owes_reply);
        self.undelivered &= !interrupts;
        interrupts
    }

    /// A device trigger with this identifier, which stands beside a message that has begun. Whether
    /// it comes before the reply to the message before was delivered.
    pub fn trigger(&mut self, delivered: bool, owes_reply: bool, identifier: u32) -> bool {
        let within_message = self.within_message;
        let interrupts = self.begin(delivered, owes_reply);
        self.end(identifier);
        self.within_message = within_message;
        interrupts
    }

    /// The message with this identifier is complete.
    pub fn end(&mut self, identifier: u32) {
        self.within_message = false;
        self.last = Some(identifier);
    }

    /// A reply as messages of the size that the client takes.
    pub fn reply(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.undelivered = true;
        let mut out = Vec::with_capacity(bytes.len() + HEADER_BYTES);
        let mut parts = bytes.chunks(self.part).peekable();
        while let Some(part) = parts.next() {
            let kind =
                if parts.peek().is_some() { MessageType::Data } else { MessageType::DataEnd };
            write(kind, 0, self.last.unwrap_or(NO_MESSAGE_ID), part, &mut out);
        }
        out
    }

    /// Forgets messages and replies, as in a device clear.
    pub fn clear(&mut self) {
        self.held.clear();
        self.last = None;
        self.within_message = false;
        self.undelivered = false;
    }

    /// Whether the message with this identifier, and with it everything sent before, has not come
    /// yet.
    pub fn awaits(&self, identifier: u32) -> bool {
        let Some(last) = self.last else {
            // A client that has sent nothing yet has no identifier to tell.
            return identifier == FIRST_MESSAGE_ID;
        };
        identifier != last && identifier.wrapping_sub(last) < u32::MAX / 2
    }

    /// Whether a reply waits or was not called delivered.
    pub fn message_available(&self) -> bool {
        self.undelivered
    }

    /// The client has called the last reply delivered.
    pub fn delivered(&mut self) {
        self.undelivered = false;
    }
}
