//! The procedures: their numbers, arguments and results. Source: VXI-11, appendix C (the protocol
//! in RPCL), and table B.2 for errors.

use super::rpc::{MAX_RECEIVE, Refusal, XdrReader, words};

/// Number of the core channel's program.
pub const CORE_PROGRAM: u32 = 0x0006_07AF;
/// Number of the abort channel's program.
pub const ABORT_PROGRAM: u32 = 0x0006_07B0;
/// Version of both.
pub const VERSION: u32 = 1;
/// Number of the procedure that tells a client of a service request.
pub const DEVICE_INTR_SRQ: u32 = 30;

/// Longest name of an instrument (bytes).
const MAX_NAME: usize = 256;
/// Longest handle of a service request (bytes).
const MAX_HANDLE: usize = 40;

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
    /// There is no interrupt channel.
    NoChannel = 6,
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
    /// Not the client's own address.
    InvalidAddress = 21,
    /// Aborted.
    Abort = 23,
    /// There is an interrupt channel already.
    ChannelExists = 29,
}

/// How long a call waits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Patience {
    /// For another session's lock (s).
    pub lock: f64,
    /// For something to read (s).
    pub io: f64,
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
    /// Switches service requests on or off.
    EnableServiceRequest {
        /// What they carry, if they are on.
        handle: Option<&'a [u8]>,
    },
    /// A command to an interface.
    DoCommand,
    /// Closes a link.
    DestroyLink,
    /// Has the server connect to the client for service requests.
    CreateInterruptChannel {
        /// Address and port.
        address: (u32, u16),
        /// Program and version to be called there.
        program: (u32, u32),
        /// Whether it is to be UDP.
        is_udp: bool,
    },
    /// Closes that connection.
    DestroyInterruptChannel,
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
    pub patience: Patience,
}

fn seconds(milliseconds: u32) -> f64 {
    f64::from(milliseconds) / 1e3
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
        (20, false) => enable_service_request(items),
        (22, false) => of_link(Procedure::DoCommand, items),
        (23, false) => of_link(Procedure::DestroyLink, items),
        (25, false) => create_interrupt_channel(items),
        (26, false) => Some(of_channel(Procedure::DestroyInterruptChannel)),
        _ => return Err(Refusal::Procedure),
    };
    request.ok_or(Refusal::Arguments)
}

fn of_channel(procedure: Procedure<'_>) -> ProcedureCall<'_> {
    ProcedureCall { procedure, link: 0, patience: Patience::default() }
}

fn of_link<'a>(procedure: Procedure<'a>, items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    Some(ProcedureCall { procedure, link: items.word()?, patience: Patience::default() })
}

/// Waits for a lock if its flag says so.
fn patience(flags: u32, lock: u32, io: u32) -> Patience {
    let waits = flags & flag::WAIT_FOR_LOCK != 0;
    Patience { lock: if waits { seconds(lock) } else { 0.0 }, io: seconds(io) }
}

fn create_link<'a>(items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let _client = items.word()?;
    let (lock, timeout) = (items.word()? != 0, items.word()?);
    let procedure = Procedure::CreateLink { lock, device: items.opaque(MAX_NAME)? };
    Some(ProcedureCall {
        procedure,
        link: 0,
        patience: Patience { lock: seconds(timeout), io: 0.0 },
    })
}

fn write<'a>(items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let (link, io, lock, flags) = (items.word()?, items.word()?, items.word()?, items.word()?);
    let data = items.opaque(MAX_RECEIVE)?;
    let procedure = Procedure::Write { data, end: flags & flag::END != 0 };
    Some(ProcedureCall { procedure, link, patience: patience(flags, lock, io) })
}

fn read<'a>(items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let (link, count, io) = (items.word()?, items.word()?, items.word()?);
    let (lock, flags, character) = (items.word()?, items.word()?, items.word()?);
    // A character travels as a word, of which the lowest byte counts.
    let [.., character] = character.to_be_bytes();
    let terminator = (flags & flag::TERMINATOR != 0).then_some(character);
    let procedure = Procedure::Read { count: usize::try_from(count).ok()?, terminator };
    Some(ProcedureCall { procedure, link, patience: patience(flags, lock, io) })
}

fn generic<'a>(procedure: Procedure<'a>, items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let (link, flags, lock, io) = (items.word()?, items.word()?, items.word()?, items.word()?);
    Some(ProcedureCall { procedure, link, patience: patience(flags, lock, io) })
}

fn lock<'a>(items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let (link, flags, lock) = (items.word()?, items.word()?, items.word()?);
    Some(ProcedureCall { procedure: Procedure::Lock, link, patience: patience(flags, lock, 0) })
}

fn enable_service_request<'a>(items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let (link, enable) = (items.word()?, items.word()? != 0);
    let handle = items.opaque(MAX_HANDLE)?;
    let procedure = Procedure::EnableServiceRequest { handle: enable.then_some(handle) };
    Some(ProcedureCall { procedure, link, patience: Patience::default() })
}

fn create_interrupt_channel<'a>(items: &mut XdrReader<'a>) -> Option<ProcedureCall<'a>> {
    let (host, port) = (items.word()?, u16::try_from(items.word()?).ok()?);
    let (program, version, family) = (items.word()?, items.word()?, items.word()?);
    let procedure = Procedure::CreateInterruptChannel {
        address: (host, port),
        program: (program, version),
        is_udp: family != 0,
    };
    Some(of_channel(procedure))
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
            Self::Write { .. } | Self::ReadStatus | Self::DoCommand => words(&[code, 0]),
            _ => words(&[code]),
        }
    }
}
