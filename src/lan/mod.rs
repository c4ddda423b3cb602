//! What the protocols of instruments on a network, HiSLIP and VXI-11, have in common, without I/O:
//! the device behind their sessions, the locks that sessions of both hold against each other, and
//! requests for service.

pub mod lock;

use lock::Locks;

/// First session number of VXI-11 links; HiSLIP sessions have the numbers below.
pub const FIRST_LINK: u16 = 1 << 15;
/// Bit of the status byte: the instrument asks for service.
const SERVICE_REQUEST_BIT: u8 = 1 << 6;

/// The device that executes the sessions' messages.
pub trait Device {
    /// A session begins on this connection.
    fn open(&mut self, session: u16, connection: u64);
    /// A session has ended.
    fn close(&mut self, session: u16);
    /// Takes bytes of a message, whose last they are if `end`; returns the reply, if there is one
    /// at once.
    fn input(&mut self, session: u16, bytes: &[u8], end: bool) -> Vec<u8>;
    /// Whether a reply to an earlier message is still to come.
    fn owes_reply(&self, session: u16) -> bool;
    /// Whether a message waits for the end of an acquisition.
    fn is_waiting(&self, session: u16) -> bool;
    /// Another message came before the reply was read.
    fn interrupt(&mut self, session: u16);
    /// Device clear.
    fn clear(&mut self, session: u16);
    /// Device trigger; returns the reply, if there is one at once.
    fn trigger(&mut self, session: u16) -> Vec<u8>;
    /// The front panel's keys.
    fn lock_keys(&mut self, locked: bool);
    /// The status byte, and the parts of it that ask for service.
    fn status(&self, message_available: bool) -> (u8, u8);
    /// The locks of all sessions.
    fn locks(&mut self) -> &mut Locks;
}

/// Bytes to be sent on a connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outgoing {
    /// Number of the connection.
    pub connection: u64,
    /// The bytes.
    pub bytes: Vec<u8>,
    /// Whether the connection is to be closed afterwards.
    pub close: bool,
}

/// What a session's client knows of service requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ServiceRequest {
    /// Reasons that were told.
    reasons: u8,
    /// Whether one was told since the status byte was read.
    asked: bool,
}

impl ServiceRequest {
    /// Whether `byte`, with `enabled` parts of it, is a new reason to ask for service.
    pub fn is_due(&mut self, byte: u8, enabled: u8) -> bool {
        let reasons = byte & enabled & !SERVICE_REQUEST_BIT;
        let new = reasons & !self.reasons != 0;
        self.reasons = reasons;
        self.asked |= new;
        new
    }

    /// `byte` with the bit that tells whether service was asked for; reading it answers the
    /// request.
    pub fn read(&mut self, byte: u8) -> u8 {
        let asked = std::mem::take(&mut self.asked);
        (byte & !SERVICE_REQUEST_BIT) | if asked { SERVICE_REQUEST_BIT } else { 0 }
    }
}
