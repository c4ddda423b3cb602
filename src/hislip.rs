//! The messages of the HiSLIP protocol (IVI-6.1, High-Speed LAN Instrument Protocol, revision 1.1),
//! without I/O: a header of sixteen bytes, then a payload.
//!
//! `"HS"`, type, control code, parameter (four bytes), length of the payload (eight bytes), most
//! significant byte first. Source: IVI-6.1, section 2.

/// Bytes of a header.
pub const HEADER_BYTES: usize = 16;
/// Longest payload that is kept (bytes). Longer ones are skipped and answered by an error.
pub const MAX_PAYLOAD: usize = 64 * 1024;
/// First of the types that vendors may use as they like.
pub const FIRST_VENDOR_TYPE: u8 = 128;

macro_rules! kinds {
    ($($(#[$meta:meta])* $name:ident = $code:literal),+ $(,)?) => {
        /// The type of a message.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum MessageType { $($(#[$meta])* $name = $code),+ }

        impl MessageType {
            /// Every one, by its number.
            pub const ALL: &'static [Self] = &[$(Self::$name),+];
        }
    };
}

kinds! {
    /// A client opens the synchronous connection.
    Initialize = 0,
    /// The server has given it a session.
    InitializeResponse = 1,
    /// The connection cannot go on.
    FatalError = 2,
    /// The message before was not understood; the connection goes on.
    Error = 3,
    /// A client wants a lock, or gives one back.
    AsyncLock = 4,
    /// Reports the state of a lock.
    AsyncLockResponse = 5,
    /// Part of a message or reply.
    Data = 6,
    /// The last part.
    DataEnd = 7,
    /// The client has thrown away what was on the synchronous connection.
    DeviceClearComplete = 8,
    /// Acknowledges a device clear.
    DeviceClearAcknowledge = 9,
    /// A client switches between remote and local control.
    AsyncRemoteLocalControl = 10,
    /// Acknowledges remote or local control.
    AsyncRemoteLocalResponse = 11,
    /// A device trigger.
    Trigger = 12,
    /// A reply was thrown away because another message came.
    Interrupted = 13,
    /// The same as `Interrupted`, on the asynchronous connection.
    AsyncInterrupted = 14,
    /// The largest message that the client takes.
    AsyncMaximumMessageSize = 15,
    /// The largest message that the server takes.
    AsyncMaximumMessageSizeResponse = 16,
    /// A client opens the asynchronous connection of a session.
    AsyncInitialize = 17,
    /// The session is whole.
    AsyncInitializeResponse = 18,
    /// A client begins a device clear.
    AsyncDeviceClear = 19,
    /// The instrument asks for service.
    AsyncServiceRequest = 20,
    /// A client asks for the status byte.
    AsyncStatusQuery = 21,
    /// The status byte.
    AsyncStatusResponse = 22,
    /// The server has begun the device clear.
    AsyncDeviceClearAcknowledge = 23,
    /// A client asks who has locks.
    AsyncLockInfo = 24,
    /// Whether there is an exclusive lock, and how many have one.
    AsyncLockInfoResponse = 25,
}

impl MessageType {
    /// The number on the wire.
    pub fn code(self) -> u8 {
        self as u8
    }

    /// The type with this number.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }
}

/// The header of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MessageHeader {
    /// Number of the message's kind, known or not.
    pub code: u8,
    /// Control code.
    pub control: u8,
    /// Parameter.
    pub parameter: u32,
    /// Bytes of the payload.
    pub length: u64,
}

impl MessageHeader {
    /// The header in `bytes`, if it is one.
    pub fn parse(bytes: &[u8; HEADER_BYTES]) -> Option<Self> {
        let [b'H', b'S', code, control, rest @ ..] = *bytes else { return None };
        let [p0, p1, p2, p3, length @ ..] = rest;
        let parameter = u32::from_be_bytes([p0, p1, p2, p3]);
        Some(Self { code, control, parameter, length: u64::from_be_bytes(length) })
    }

    /// As on the wire.
    pub fn bytes(self) -> [u8; HEADER_BYTES] {
        let mut bytes = [0; HEADER_BYTES];
        bytes[..4].copy_from_slice(&[b'H', b'S', self.code, self.control]);
        bytes[4..8].copy_from_slice(&self.parameter.to_be_bytes());
        bytes[8..].copy_from_slice(&self.length.to_be_bytes());
        bytes
    }
}

/// Appends a message to `out`.
pub fn write(kind: MessageType, control: u8, parameter: u32, payload: &[u8], out: &mut Vec<u8>) {
    let length = payload.len() as u64;
    out.extend_from_slice(&MessageHeader { code: kind.code(), control, parameter, length }.bytes());
    out.extend_from_slice(payload);
}

/// A decoded part of a connection's input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DecodedPiece {
    /// A message.
    Message(MessageHeader, Vec<u8>),
    /// The header of a message whose payload is longer than [`MAX_PAYLOAD`] and is passed over.
    TooLarge(MessageHeader),
    /// No header where one had to be: nothing behind it can be trusted.
    Malformed,
}

/// Takes the bytes of one connection apart.
#[derive(Debug, Clone, Default)]
pub struct Decoder {
    buffer: Vec<u8>,
    /// Bytes of a payload that are still to be passed over.
    skip: u64,
    malformed: bool,
}

impl Decoder {
    /// Takes bytes as they come; [`Self::next_piece`] tells what they complete. Never keeps more
    /// than one message and the bytes of one call.
    pub fn push(&mut self, bytes: &[u8]) {
        if self.malformed {
            return;
        }
        let skipped = usize::try_from(self.skip).unwrap_or(usize::MAX).min(bytes.len());
        self.skip -= skipped as u64;
        self.buffer.extend_from_slice(bytes.get(skipped..).unwrap_or_default());
    }

    /// The next piece, if it is complete.
    pub fn next_piece(&mut self) -> Option<DecodedPiece> {
        if self.malformed || self.skip > 0 {
            return None;
        }
        let head = self.buffer.first_chunk::<HEADER_BYTES>()?;
        let Some(header) = MessageHeader::parse(head) else {
            self.malformed = true;
            self.buffer.clear();
            return Some(DecodedPiece::Malformed);
        };
        let here = self.buffer.len() - HEADER_BYTES;
        let length = usize::try_from(header.length).unwrap_or(usize::MAX);
        if length > MAX_PAYLOAD {
            let skipped = length.min(here);
            self.skip = header.length - skipped as u64;
            self.buffer.drain(..HEADER_BYTES + skipped);
            return Some(DecodedPiece::TooLarge(header));
        }
        if here < length {
            return None;
        }
        let mut message: Vec<u8> = self.buffer.drain(..HEADER_BYTES + length).collect();
        Some(DecodedPiece::Message(header, message.split_off(HEADER_BYTES)))
    }

    /// Bytes that wait for the rest of their message.
    pub fn waiting(&self) -> usize {
        self.buffer.len()
    }
}
