//! ONC RPC over TCP: records in fragments, calls, replies, and the XDR items that they consist of.
//!
//! A fragment is a word with its length (31 bits) and, in the uppermost bit, whether it is a
//! record's last, then its bytes. A call is `xid, 0, 2, program, version, procedure`, credentials
//! and verifier, then the arguments. Sources: RFC 5531, sections 9 and 11; RFC 4506.

/// Longest data of a message's part that a client may send (bytes).
pub const MAX_RECEIVE: usize = 64 * 1024;
/// Longest record: data and what is around them, credentials included (bytes).
pub const MAX_RECORD: usize = MAX_RECEIVE + 2048;
/// Longest record that is passed over where it is longer than [`MAX_RECORD`] (bytes).
pub const MAX_PASSED_OVER: usize = 1 << 24;
/// Longest credentials or verifier (bytes).
const MAX_AUTHENTICATION: usize = 400;
/// Bit of a fragment's length: the last one of its record.
const LAST_FRAGMENT: u32 = 1 << 31;
/// Version of the protocol.
const RPC_VERSION: u32 = 2;
/// Kinds of messages.
const CALL: u32 = 0;
const REPLY: u32 = 1;

/// Puts records together from the bytes of one connection.
#[derive(Debug, Clone, Default)]
pub struct RecordDecoder {
    buffer: Vec<u8>,
    record: Vec<u8>,
    /// Length of the record as far as its fragments have come.
    length: usize,
    /// What is missing of the fragment that has begun, and whether it is its record's last.
    fragment: Option<(usize, bool)>,
}

/// Bytes that cannot be a record, or make one that is too long to be passed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Malformed;

impl RecordDecoder {
    /// Takes bytes as they come.
    pub fn push(&mut self, bytes: &[u8]) {
        self.buffer.extend_from_slice(bytes);
    }

    /// Bytes that wait to be looked at.
    pub fn waiting(&self) -> usize {
        self.buffer.len()
    }

    /// The next record, if it is complete. Of one that is longer than [`MAX_RECORD`] the beginning:
    /// a call whose data are too long has a reply.
    ///
    /// # Errors
    /// [`Malformed`] for a record longer than [`MAX_PASSED_OVER`].
    pub fn next_record(&mut self) -> Result<Option<Vec<u8>>, Malformed> {
        loop {
            let (missing, is_last) = if let Some(fragment) = self.fragment {
                fragment
            } else {
                let Some(head) = self.buffer.first_chunk() else { return Ok(None) };
                let head = u32::from_be_bytes(*head);
                self.buffer.drain(..4);
                let length = usize::try_from(head & !LAST_FRAGMENT).unwrap_or(usize::MAX);
                self.length = self.length.saturating_add(length);
                if self.length > MAX_PASSED_OVER {
                    return Err(Malformed);
                }
                (length, head & LAST_FRAGMENT != 0)
            };
            let here = missing.min(self.buffer.len());
            let room = MAX_RECORD.saturating_sub(self.record.len());
            self.record.extend(self.buffer.drain(..here).take(room));
            if here < missing {
                self.fragment = Some((missing - here, is_last));
                return Ok(None);
            }
            self.fragment = None;
            if is_last {
                self.length = 0;
                return Ok(Some(std::mem::take(&mut self.record)));
            }
        }
    }
}

/// `message` as a record of one fragment.
pub fn record(message: &[u8]) -> Vec<u8> {
    let length = u32::try_from(message.len()).unwrap_or(0);
    let mut bytes = (LAST_FRAGMENT | length).to_be_bytes().to_vec();
    bytes.extend_from_slice(message);
    bytes
}

/// Reads XDR items.
#[derive(Debug, Clone, Copy)]
pub struct XdrReader<'a>(pub &'a [u8]);

impl<'a> XdrReader<'a> {
    /// The next word; none at the end.
    pub fn word(&mut self) -> Option<u32> {
        let (head, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(u32::from_be_bytes(*head))
    }

    /// The length of the next bytes of variable length.
    pub fn length(&self) -> Option<usize> {
        usize::try_from(Self(self.0).word()?).ok()
    }

    /// The next bytes of variable length, which are no more than `limit`.
    pub fn opaque(&mut self, limit: usize) -> Option<&'a [u8]> {
        let length = usize::try_from(self.word()?).ok().filter(|length| *length <= limit)?;
        let (bytes, _) = self.0.split_at_checked(length)?;
        (_, self.0) = self.0.split_at_checked(length.next_multiple_of(4))?;
        Some(bytes)
    }
}

/// Words as XDR items.
pub fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_be_bytes()).collect()
}

/// Appends bytes of variable length.
pub fn put_opaque(bytes: &[u8], out: &mut Vec<u8>) {
    out.extend_from_slice(&u32::try_from(bytes.len()).unwrap_or(0).to_be_bytes());
    out.extend_from_slice(bytes);
    out.resize(out.len().next_multiple_of(4), 0);
}

/// A call of a procedure.
#[derive(Debug, Clone, Copy)]
pub struct Call<'a> {
    /// Number by which the client knows the reply.
    pub xid: u32,
    /// Number of the program.
    pub program: u32,
    /// Its version.
    pub version: u32,
    /// Number of the procedure.
    pub procedure: u32,
    /// What comes behind.
    pub arguments: XdrReader<'a>,
}

/// Why a call has no results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// No such program here.
    Program,
    /// Another version of the program: this one is there.
    Version(u32),
    /// No such procedure in the program.
    Procedure,
    /// Arguments that cannot be read.
    Arguments,
}

impl<'a> Call<'a> {
    /// The call in a record or datagram.
    ///
    /// # Errors
    /// The reply to a call in another version of RPC; none where `message` is no call.
    pub fn parse(message: &'a [u8]) -> Result<Self, Option<Vec<u8>>> {
        let mut items = XdrReader(message);
        let mut word = || items.word().ok_or(None);
        let (xid, kind, rpc_version) = (word()?, word()?, word()?);
        if kind != CALL {
            return Err(None);
        }
        if rpc_version != RPC_VERSION {
            // Denied, version mismatch, lowest and highest that are spoken.
            return Err(Some(words(&[xid, REPLY, 1, 0, RPC_VERSION, RPC_VERSION])));
        }
        let (program, version, procedure) = (word()?, word()?, word()?);
        for _credentials_and_verifier in 0..2 {
            items.word().ok_or(None)?;
            items.opaque(MAX_AUTHENTICATION).ok_or(None)?;
        }
        Ok(Self { xid, program, version, procedure, arguments: items })
    }

    /// The reply with `results`, or without.
    pub fn reply(&self, results: Result<Vec<u8>, Refusal>) -> Vec<u8> {
        // Accepted, an empty verifier, then the state.
        let mut out = words(&[self.xid, REPLY, 0, 0, 0]);
        out.extend(match results {
            Ok(results) => [words(&[0]), results].concat(),
            Err(Refusal::Program) => words(&[1]),
            Err(Refusal::Version(version)) => words(&[2, version, version]),
            Err(Refusal::Procedure) => words(&[3]),
            Err(Refusal::Arguments) => words(&[4]),
        });
        out
    }
}
