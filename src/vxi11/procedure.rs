//! The procedures: their numbers, arguments and results. Source: VXI-11, appendix C (the protocol
//! in RPCL), and table B.2 for errors.

use std::time::Duration;

use super::rpc::{MAX_RECEIVE, Refusal, XdrReader, words};

/// Number of the core channel's program.
pub const CORE_PROGRAM: u32 = 0x0006_07AF;
/// Number of the abort channel's program.
pub const ABORT_PROGRAM: u32 = 0x0006_07B0;
/// Version of both.
pub const VERSION: u32 = 1;

/// Longest name of an instrument (bytes).
const MAX_NAME: usize = 256;

/// Flags of a call.
mod flag {
    /// Wait for another link's lock.
    pub const WAIT_FOR_LOCK: u32 = 1;
    /// The message ends with these bytes.
    pub const END: u32 = 1 << 3;
    /// A read ends with a character.
    pub const TERMINATOR: u32 = 1 << 7;
}

/// Why a read ended.
pub mod reason {
    /// It has as many bytes as were asked for.
    pub const COUNT: u32 = 1;
    /// The character came.
    pub const CHARACTER: u32 = 1 << 1;
    /// The message ends.
    pub const END: u32 = 1 << 2;
}

/// The error codes of results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum ErrorCode {
    /// No instrument of this name.
    NotAccessible = 3,
    /// No such link on this connection.
    InvalidLink = 4,
    /// Argument out of range.
    Parameter = 5,
    /// Not supported.
    NotSupported = 8,
    /// Too many links.
    OutOfResources = 9,
    /// Another link has the lock, or this one already.
    Locked = 11,
    /// This link has no lock.
    NoLock = 12,
    /// Nothing to read in time.
    Timeout = 15,
    /// Aborted.
    Abort = 23,
}

/// How long a call waits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Timeouts {
    /// For another session's lock.
    pub lock: Duration,
    /// For something to read.
    pub io: Duration,
}

/// A call with its arguments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Procedure<'a> {
    /// Does nothing.
    Null,
    /// Opens a link, with the lock if `lock`.
    CreateLink {
        /// Whether the link takes the lock.
        lock: bool,
        /// The instrument's name.
        device: &'a [u8],
    },
    /// Part of a message.
    Write {
        /// The bytes.
        data: &'a [u8],
        /// Whether the message ends here.
        end: bool,
    },
    /// Part of a message that is longer than the server takes.
    WriteTooMuch,
    /// Asks for part of a reply.
    Read {
        /// How many bytes at most.
        count: usize,
        /// The character that ends the read.
        terminator: Option<u8>,
    },
    /// Serial poll.
    ReadStatus,
    /// Device trigger.
    Trigger,
    /// Device clear.
    Clear,
    /// Locks the front panel's keys.
    Remote,
    /// Frees them.
    Local,
    /// Takes the lock.
    Lock,
    /// Gives it back.
    Unlock,
    /// A command to an interface.
    DoCommand,
    /// Anything about interrupt channels, which this server has not.
    Interrupts,
    /// Closes a link.
    DestroyLink,
    /// Ends what a link waits for.
    Abort,
}

/// A call: which procedure, on which link, and how long it waits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProcedureCall<'a> {
    /// The procedure.
    pub procedure: Procedure<'a>,
    /// The link's identifier, 0 where there is none.
    pub link: u32,
    /// How long it waits.
    pub timeouts: Timeouts,
}

fn milliseconds(count: u32) -> Duration {
    Duration::from_millis(count.into())
}

/// Procedure `number` of the core or the abort program with its arguments.
///
/// # Errors
/// [`Refusal`] where there is no such procedure, or its arguments cannot be read.
pub fn parse(
    number: u32,
    is_abort: bool,
    mut items: XdrReader<'_>,
) -> Result<ProcedureCall<'_>, Refusal> {
    let items = &mut items;
    let request = match (number, is_abort) {
        (0, _) => Some(of_channel(Procedure::Null)),
        (1, true) => of_link(Procedure::Abort, items),
        (10, false) => create_link(items),
        (11, false) => write(items),
        (12, false) => read(items),
        (13, false) => generic(Procedure::ReadStatus, items),
        (14, false) => generic(Procedure::Trigger, items),
        (15, false) => generic(Procedure::Clear, items),
        (16, false) => generic(Procedure::Remote, items),
        (17, false) => generic(Procedure::Local, items),
        (18, false) => lock(items),
        (19, false) => of_link(Procedure::Unlock, items),
        (22, false) => of_link(Procedure::DoCommand, items),
        (23, false) => of_link(Procedure::DestroyLink, items),
        (20 | 25 | 26, false) => Some(of_channel(Procedure::Interrupts)),
        _ => return Err(Refusal::Procedure),
    };
    request.ok_or(Refusal::Arguments)
}

fn of_channel(procedure: Procedure<'_>) -> ProcedureCall<'_> {
    ProcedureCall { procedure, link: 0, timeouts: Timeouts::default() }
}

fn of_link<'a>(procedure: Procedure<'a>, items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    Some(ProcedureCall { procedure, link: items.word()?, timeouts: Timeouts::default() })
}

/// Waits for a lock if its flag says so.
fn timeouts(flags: u32, lock: u32, io: u32) -> Timeouts {
    let waits = flags & flag::WAIT_FOR_LOCK != 0;
    let lock = if waits { milliseconds(lock) } else { Duration::ZERO };
    Timeouts { lock, io: milliseconds(io) }
}

fn create_link<'a>(items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let _client = items.word()?;
    let (lock, timeout) = (items.word()? != 0, items.word()?);
    let procedure = Procedure::CreateLink { lock, device: items.opaque(MAX_NAME)? };
    Some(ProcedureCall {
        procedure,
        link: 0,
        timeouts: Timeouts { lock: milliseconds(timeout), io: Duration::ZERO },
    })
}

fn write<'a>(items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let (link, io, lock, flags) = (items.word()?, items.word()?, items.word()?, items.word()?);
    let end = flags & flag::END != 0;
    let procedure = match items.length()? {
        length if length > MAX_RECEIVE => Procedure::WriteTooMuch,
        _ => Procedure::Write { data: items.opaque(MAX_RECEIVE)?, end },
    };
    Some(ProcedureCall { procedure, link, timeouts: timeouts(flags, lock, io) })
}

fn read<'a>(items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let (link, count, io) = (items.word()?, items.word()?, items.word()?);
    let (lock, flags, character) = (items.word()?, items.word()?, items.word()?);
    // A character travels as a word, of which the lowest byte counts.
    let [.., character] = character.to_be_bytes();
    let terminator = (flags & flag::TERMINATOR != 0).then_some(character);
    let procedure = Procedure::Read { count: usize::try_from(count).ok()?, terminator };
    Some(ProcedureCall { procedure, link, timeouts: timeouts(flags, lock, io) })
}

fn generic<'a>(procedure: Procedure<'a>, items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let (link, flags, lock, io) = (items.word()?, items.word()?, items.word()?, items.word()?);
    Some(ProcedureCall { procedure, link, timeouts: timeouts(flags, lock, io) })
}

fn lock<'a>(items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let (link, flags, lock) = (items.word()?, items.word()?, items.word()?);
    Some(ProcedureCall { procedure: Procedure::Lock, link, timeouts: timeouts(flags, lock, 0) })
}

impl Procedure<'_> {
    /// The results of a call that failed.
    pub fn failure(&self, code: ErrorCode) -> Vec<u8> {
        let code = code as u32;
        match self {
            // Link, port of the abort channel, longest data.
            Self::CreateLink { .. } => words(&[code, 0, 0, 0]),
            // Reason, no data.
            Self::Read { .. } => words(&[code, 0, 0]),
            // Bytes taken; status byte; no data.
            Self::Write { .. } | Self::WriteTooMuch | Self::ReadStatus | Self::DoCommand => {
                words(&[code, 0])
            }
            _ => words(&[code]),
        }
    }
}
