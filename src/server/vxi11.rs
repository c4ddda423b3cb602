//! VXI-11 connections: the links on them, and what each call does.
//!
//! A client opens the core channel, a TCP connection on which it calls procedures of the server
//! (ONC RPC), and creates links to the instrument on it; a link is a session. The abort channel is
//! a second connection to the same port. Sources: VXI-11, TCP/IP Instrument Protocol Specification,
//! revision 1.0 (1995); RFC 5531 (RPC), RFC 4506 (XDR).
//!
//! Limits: `device_docmd` is not supported, as the instrument has no interface to command; nor are
//! interrupt channels, on which the server would connect to the client: service requests show in
//! `device_readstb`. A link belongs to the connection that created it, and ends with it.

use std::collections::BTreeMap;
use std::future::poll_fn;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::Poll;
use std::time::Duration;

use tokio::sync::Notify;
use tokio::time::{Instant, sleep_until, timeout};

use super::locks::{Grant, Released};
use super::network::{Answer, ClientSession, Interrupts, Network, ServiceRequest};
use super::places::Seat;
use super::wire::Wire;
use crate::instrument::StatusSummary;
use crate::vxi11::procedure::{
    ABORT_PROGRAM, CORE_PROGRAM, ErrorCode, Procedure, ProcedureCall, VERSION, parse, reason,
};
use crate::vxi11::rpc::{
    Call, MAX_RECEIVE, MAX_RECORD, RecordDecoder, Refusal, put_opaque, record, words,
};

/// Links at a time. A further one takes the place of the connection with links that has been idle
/// for longest.
pub const MAX_LINKS: usize = 64;
/// Links of one connection.
pub const MAX_LINKS_OF_CONNECTION: usize = 16;
/// Number of the first link.
const FIRST_LINK: u16 = 1 << 15;

/// A link as other connections know it.
struct LinkEntry {
    /// Place of the connection that created it.
    place: u64,
    /// Ends the call that the link waits with.
    abort: Arc<Notify>,
}

/// The links of all connections, by their numbers.
pub struct Links {
    /// Where clients reach both channels.
    port: u16,
    entries: Mutex<BTreeMap<u16, LinkEntry>>,
}

impl Links {
    /// No links; clients reach both channels at `port`.
    pub fn new(port: u16) -> Self {
        Self { port, entries: Mutex::default() }
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<u16, LinkEntry>> {
        self.entries.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A number for a link on the connection at `place`, if need be one of another connection that
    /// is idle.
    fn reserve(&self, network: &Network, place: u64) -> Option<LinkNumber<'_>> {
        let mut entries = self.lock();
        if entries.values().filter(|link| link.place == place).count() >= MAX_LINKS_OF_CONNECTION {
            return None;
        }
        if entries.len() >= MAX_LINKS {
            let has_links = |other| entries.values().any(|link| link.place == other);
            let idle = network.places.evict(|other| other != place && has_links(other))?;
            entries.retain(|_, link| link.place != idle);
        }
        let number = (FIRST_LINK..u16::MAX).find(|number| !entries.contains_key(number))?;
        let abort = Arc::new(Notify::new());
        entries.insert(number, LinkEntry { place, abort: Arc::clone(&abort) });
        Some(LinkNumber { links: self, number, place, abort })
    }

    /// Ends the call that a link waits with. Whether there is such a link.
    fn abort(&self, link: u32) -> bool {
        let entries = self.lock();
        let entry = u16::try_from(link).ok().and_then(|number| entries.get(&number));
        entry.inspect(|entry| entry.abort.notify_waiters()).is_some()
    }
}

/// A link's number, free again when this is dropped.
struct LinkNumber<'a> {
    links: &'a Links,
    number: u16,
    place: u64,
    abort: Arc<Notify>,
}

impl Drop for LinkNumber<'_> {
    fn drop(&mut self) {
        // The number of a connection that has given way may belong to another one.
        let mut entries = self.links.lock();
        if entries.get(&self.number).is_some_and(|entry| entry.place == self.place) {
            entries.remove(&self.number);
        }
    }
}

/// A link.
struct Link<'a> {
    number: LinkNumber<'a>,
    session: ClientSession<'a>,
    /// What is to be read.
    reply: Vec<u8>,
    /// A message has begun and not ended.
    within_message: bool,
    service: ServiceRequest,
    /// Bytes after which a fault closes the connection.
    drop_after: Option<usize>,
}

/// A core or abort channel, or both.
struct Channel<'a> {
    network: &'a Network,
    links: &'a Links,
    seat: &'a Seat,
    own: BTreeMap<u32, Link<'a>>,
}

/// Serves a connection until either side closes it, or its bytes are no calls.
///
/// # Errors
/// The system's error.
pub async fn run(
    network: &Network,
    links: &Links,
    mut wire: Wire,
    seat: &Seat,
    peer: &str,
) -> io::Result<()> {
    let mut records = RecordDecoder::default();
    let mut channel = Channel { network, links, seat, own: BTreeMap::new() };
    let mut status = network.status();
    loop {
        let next = records.next_record();
        let Some(call) = next.map_err(|_| io::ErrorKind::InvalidData)? else {
            tokio::select! {
                biased;
                answered = channel.take_answer() => answered?,
                bytes = wire.read() => records.push(received(bytes?, seat)?),
                changed = status.changed() => {
                    changed.map_err(|_| io::ErrorKind::NotConnected)?;
                    channel.note_status(*status.borrow_and_update());
                }
            }
            continue;
        };
        let busy = seat.busy();
        let executed = channel.execute(&call, peer);
        let reply = tokio::select! {
            biased;
            reply = executed => reply?,
            ended = receive_more(&mut wire, &mut records, seat) => return ended,
        };
        drop(busy);
        if let Some(length) = channel.own.values_mut().find_map(|link| link.drop_after.take()) {
            wire.drop_after(length);
        }
        wire.write(&record(&reply)).await?;
    }
}

fn received<'a>(bytes: &'a [u8], seat: &Seat) -> io::Result<&'a [u8]> {
    seat.touch();
    if bytes.is_empty() { Err(io::ErrorKind::UnexpectedEof.into()) } else { Ok(bytes) }
}

/// Takes what comes while a call waits, so that the end of the connection is noticed. A client that
/// waits for a reply has little to send: more than a record ends the connection.
async fn receive_more(wire: &mut Wire, records: &mut RecordDecoder, seat: &Seat) -> io::Result<()> {
    while records.waiting() <= MAX_RECORD {
        records.push(received(wire.read().await?, seat)?);
    }
    Err(io::ErrorKind::InvalidData.into())
}

impl<'a> Channel<'a> {
    /// Executes a call; returns its reply, or an error where the record is no call.
    async fn execute(&mut self, message: &[u8], peer: &str) -> io::Result<Vec<u8>> {
        let call = match Call::parse(message) {
            Ok(call) => call,
            Err(Some(reply)) => return Ok(reply),
            Err(None) => return Err(io::ErrorKind::InvalidData.into()),
        };
        let is_abort = call.program == ABORT_PROGRAM;
        let results = if !matches!(call.program, CORE_PROGRAM | ABORT_PROGRAM) {
            Err(Refusal::Program)
        } else if call.version != VERSION {
            Err(Refusal::Version(VERSION))
        } else {
            match parse(call.procedure, is_abort, call.arguments) {
                Ok(request) => Ok(self.results(request, peer).await?),
                Err(refusal) => Err(refusal),
            }
        };
        Ok(call.reply(results))
    }

    /// Takes the next answer of any link.
    async fn take_answer(&mut self) -> io::Result<()> {
        let next = poll_fn(|context| {
            let mut polled = self.own.iter_mut().map(|(number, link)| {
                link.session.poll_answer(context).map(|answer| (*number, answer))
            });
            polled.find(Poll::is_ready).unwrap_or(Poll::Pending)
        });
        let (number, answer) = next.await;
        let (answer, status) = (answer?, *self.network.status().borrow());
        if let Some(link) = self.own.get_mut(&number) {
            link.take(answer);
            link.service.is_due(status, !link.reply.is_empty());
        }
        Ok(())
    }

    fn note_status(&mut self, status: StatusSummary) {
        for link in self.own.values_mut() {
            link.service.is_due(status, !link.reply.is_empty());
        }
    }

    /// The results of a call.
    async fn results(&mut self, call: ProcedureCall<'_>, peer: &str) -> io::Result<Vec<u8>> {
        let ProcedureCall { procedure, link: number, timeouts } = call;
        match procedure {
            Procedure::Null => return Ok(Vec::new()),
            Procedure::CreateLink { lock, device } => {
                let lock = lock.then_some(timeouts.lock);
                return Ok(self.create(lock, device, peer).await);
            }
            Procedure::Interrupts => return Ok(procedure.failure(ErrorCode::NotSupported)),
            Procedure::Abort => {
                let code = if self.links.abort(number) { 0 } else { ErrorCode::InvalidLink as u32 };
                return Ok(words(&[code]));
            }
            _ => {}
        }
        let began = Instant::now();
        let Some(link) = self.own.get_mut(&number) else {
            return Ok(procedure.failure(ErrorCode::InvalidLink));
        };
        let needs_lock = !matches!(
            procedure,
            Procedure::Unlock
                | Procedure::DestroyLink
                | Procedure::DoCommand
                | Procedure::WriteTooMuch
        );
        let abort = Arc::clone(&link.number.abort);
        let locks = &self.network.locks;
        if needs_lock {
            let free = timeout(timeouts.lock, locks.may_act(link.session.number()));
            let code = tokio::select! {
                biased;
                free = free => free.err().map(|_| ErrorCode::Locked),
                () = abort.notified() => Some(ErrorCode::Abort),
            };
            if let Some(code) = code {
                return Ok(procedure.failure(code));
            }
        }
        let status = self.network.status();
        let results = match procedure {
            Procedure::Write { data, end } => {
                // A message that comes before the reply to the one before was read: that reply is
                // lost.
                let begins = !std::mem::replace(&mut link.within_message, !end);
                let interrupts = match (begins, link.reply.is_empty()) {
                    (false, _) => Interrupts::Never,
                    (true, true) => Interrupts::IfOwed,
                    (true, false) => Interrupts::Always,
                };
                link.session.send(data.to_vec(), end, interrupts);
                link.complete().await?;
                words(&[0, u32::try_from(data.len()).unwrap_or(0)])
            }
            Procedure::Read { count, terminator } => {
                let code = link.wait_for_reply(began + timeouts.io).await?;
                match code {
                    Some(code) => procedure.failure(code),
                    None => link.read(count, terminator),
                }
            }
            Procedure::ReadStatus => {
                let byte = link.service.read(*status.borrow(), !link.reply.is_empty());
                words(&[0, u32::from(byte)])
            }
            Procedure::Trigger => {
                link.session.trigger(Interrupts::Never);
                link.complete().await?;
                words(&[0])
            }
            Procedure::Clear => {
                self.network.clear(link.session.number()).await;
                link.session.clear();
                link.reply.clear();
                link.within_message = false;
                words(&[0])
            }
            Procedure::Remote | Procedure::Local => {
                self.network.lock_keys(procedure == Procedure::Remote);
                words(&[0])
            }
            Procedure::Lock => match locks.request(link.session.number(), &[]) {
                Grant::Granted => words(&[0]),
                Grant::Busy | Grant::Invalid => procedure.failure(ErrorCode::Locked),
            },
            Procedure::Unlock => match locks.release(link.session.number()) {
                Released::Nothing => procedure.failure(ErrorCode::NoLock),
                Released::Exclusive | Released::Shared => words(&[0]),
            },
            Procedure::DestroyLink => {
                self.own.remove(&number);
                return Ok(words(&[0]));
            }
            Procedure::WriteTooMuch => procedure.failure(ErrorCode::Parameter),
            // The others have no link.
            _ => procedure.failure(ErrorCode::NotSupported),
        };
        link.service.is_due(*status.borrow(), !link.reply.is_empty());
        Ok(results)
    }

    /// Creates a link; with the lock if it is free within a time.
    async fn create(&mut self, lock: Option<Duration>, name: &[u8], peer: &str) -> Vec<u8> {
        let failure = |code| [words(&[code as u32]), words(&[0; 3])].concat();
        if !(name.is_empty() || name.eq_ignore_ascii_case(b"inst0")) {
            return failure(ErrorCode::NotAccessible);
        }
        let Some(number) = self.links.reserve(self.network, self.seat.number()) else {
            return failure(ErrorCode::OutOfResources);
        };
        let session = self.network.open(peer, self.seat);
        if let Some(within) = lock {
            let grant = self.network.locks.acquire(session.number(), Vec::new(), within).await;
            if grant != Grant::Granted {
                return failure(ErrorCode::Locked);
            }
        }
        let link = u32::from(number.number);
        self.own.insert(
            link,
            Link {
                number,
                session,
                reply: Vec::new(),
                within_message: false,
                service: ServiceRequest::default(),
                drop_after: None,
            },
        );
        let longest = u32::try_from(MAX_RECEIVE).unwrap_or(u32::MAX);
        words(&[0, link, u32::from(self.links.port), longest])
    }
}

impl Link<'_> {
    fn take(&mut self, answer: Answer) {
        match answer {
            Answer::Reply(bytes) => self.reply.extend(bytes),
            Answer::Interrupted => self.reply.clear(),
            Answer::DropAfter(length) => self.drop_after = Some(length),
            Answer::Done { .. } | Answer::Resumed => {}
        }
    }

    /// Waits until a message is executed.
    async fn complete(&mut self) -> io::Result<()> {
        loop {
            let answer = self.session.answer().await?;
            let is_done = matches!(answer, Answer::Done { .. });
            self.take(answer);
            if is_done {
                return Ok(());
            }
        }
    }

    /// Waits for something to read until `end`; returns why there is nothing.
    async fn wait_for_reply(&mut self, end: Instant) -> io::Result<Option<ErrorCode>> {
        let abort = Arc::clone(&self.number.abort);
        while self.reply.is_empty() {
            tokio::select! {
                biased;
                answer = self.session.answer() => self.take(answer?),
                () = abort.notified() => return Ok(Some(ErrorCode::Abort)),
                () = sleep_until(end) => return Ok(Some(ErrorCode::Timeout)),
            }
        }
        Ok(None)
    }

    /// The next part of the reply: at most `count` bytes, or up to the character `terminator`.
    fn read(&mut self, count: usize, terminator: Option<u8>) -> Vec<u8> {
        let most = count.min(self.reply.len());
        let part = self.reply.get(..most).unwrap_or_default();
        let end = terminator.and_then(|character| part.iter().position(|byte| *byte == character));
        let part: Vec<u8> = self.reply.drain(..end.map_or(most, |end| end + 1)).collect();
        let reasons = [
            (part.len() == count, reason::COUNT),
            (end.is_some(), reason::CHARACTER),
            (self.reply.is_empty(), reason::END),
        ];
        let ended = reasons.iter().filter(|(is, _)| *is).map(|(_, reason)| reason).sum();
        let mut results = words(&[0, ended]);
        put_opaque(&part, &mut results);
        results
    }
}
