//! All channels and links: what each call does, what waits, what is to be sent.

use std::collections::BTreeMap;

use super::procedure::{
    ABORT_PROGRAM, CORE_PROGRAM, ErrorCode, Procedure, ProcedureCall, Timeouts, VERSION, parse,
    reason,
};
use super::rpc::{
    Call, MAX_RECEIVE, MAX_RECORD, RecordDecoder, Refusal, put_opaque, record, words,
};
use crate::lan::lock::{Grant, Released};
use crate::lan::{Device, FIRST_LINK, Outgoing, ServiceRequest};

/// Links at a time. A further one takes the place of the connection with links that has been idle
/// for longest.
pub const MAX_LINKS: usize = 64;
/// Links of one connection.
pub const MAX_LINKS_OF_CONNECTION: usize = 16;
/// Time without a call after which a connection and its links give way to a new link (s).
const IDLE_TIME: f64 = 1.0;

/// A link.
#[derive(Debug, Clone, Default)]
struct Link {
    /// The connection that it was created on.
    connection: u64,
    /// What is to be read.
    reply: Vec<u8>,
    /// A message has begun and not ended.
    within_message: bool,
    service: ServiceRequest,
}

/// A call that waits, and since when (s).
#[derive(Debug, Clone)]
struct Waiting {
    record: Vec<u8>,
    since: f64,
}

/// A channel: core, abort, or both.
#[derive(Debug, Clone)]
struct Channel {
    records: RecordDecoder,
    waiting: Option<Waiting>,
    /// When bytes came last (s).
    last_received: f64,
}

/// What a call has come to.
enum Attempt {
    /// Its results.
    Results(Vec<u8>),
    /// It has to wait.
    Wait,
}

impl From<ErrorCode> for Attempt {
    fn from(code: ErrorCode) -> Self {
        Self::Results(words(&[code as u32]))
    }
}

/// All channels and links.
#[derive(Debug, Clone)]
pub struct Vxi11Server {
    port: u16,
    channels: BTreeMap<u64, Channel>,
    links: BTreeMap<u16, Link>,
    output: Vec<Outgoing>,
    now: f64,
}

impl Vxi11Server {
    /// No links; clients reach both channels at `port`.
    pub fn new(port: u16) -> Self {
        Self {
            port,
            channels: BTreeMap::new(),
            links: BTreeMap::new(),
            output: Vec::new(),
            now: 0.0,
        }
    }

    /// A connection is there.
    pub fn opened(&mut self, connection: u64) {
        let (records, last_received) = (RecordDecoder::default(), self.now);
        let channel = Channel { records, waiting: None, last_received };
        self.channels.insert(connection, channel);
    }

    /// Closes a connection's links.
    pub fn closed(&mut self, connection: u64, device: &mut dyn Device) {
        if self.channels.remove(&connection).is_none() {
            return;
        }
        let links = self.links.iter().filter(|(_, link)| link.connection == connection);
        for number in links.map(|(number, _)| *number).collect::<Vec<u16>>() {
            self.destroy(number, device);
        }
        self.settle(device);
    }

    /// Bytes came.
    pub fn received(&mut self, connection: u64, bytes: &[u8], device: &mut dyn Device) {
        let Some(channel) = self.channels.get_mut(&connection) else { return };
        channel.records.push(bytes);
        channel.last_received = self.now;
        // A client that waits for a reply has nothing to send.
        if channel.waiting.is_some() && channel.records.waiting() > MAX_RECORD {
            return self.refuse(connection, device);
        }
        self.work_off(connection, device);
        self.settle(device);
    }

    /// A reply that was owed.
    pub fn reply(&mut self, number: u16, bytes: &[u8]) {
        if let Some(link) = self.links.get_mut(&number) {
            link.reply.extend_from_slice(bytes);
        }
    }

    /// Whether a connection waits: a call of its own, or the instrument for the end of an
    /// acquisition.
    pub fn is_waiting(&self, connection: u64, device: &dyn Device) -> bool {
        let mut links = self.links.iter().filter(|(_, link)| link.connection == connection);
        self.channels.get(&connection).is_some_and(|channel| channel.waiting.is_some())
            || links.any(|(number, _)| device.is_waiting(*number))
    }

    /// Time has passed: it is `now` (s), on a clock that does not run backwards. Calls run out, and
    /// new reasons for service show in the status byte.
    pub fn advance(&mut self, now: f64, device: &mut dyn Device) {
        self.now = self.now.max(now);
        self.settle(device);
        for link in self.links.values_mut() {
            let (byte, enabled) = device.status(!link.reply.is_empty());
            link.service.is_due(byte, enabled);
        }
    }

    /// Output since the last call, in order.
    pub fn take_output(&mut self) -> Vec<Outgoing> {
        std::mem::take(&mut self.output)
    }

    /// Goes on with the calls that wait, for as long as one of them gets on: it may have freed a
    /// lock.
    pub fn settle(&mut self, device: &mut dyn Device) {
        let waits = |(number, channel): (&u64, &Channel)| channel.waiting.as_ref().map(|_| *number);
        let mut waiting: Vec<u64> = self.channels.iter().filter_map(waits).collect();
        loop {
            let before = waiting.len();
            waiting.retain(|connection| !self.retry(*connection, device));
            if waiting.len() == before {
                return;
            }
        }
    }

    /// Tries the call of a connection again that waits. Whether it is done.
    fn retry(&mut self, connection: u64, device: &mut dyn Device) -> bool {
        let channel = self.channels.get_mut(&connection);
        let Some(waiting) = channel.and_then(|channel| channel.waiting.take()) else { return true };
        self.execute(connection, waiting, device);
        self.work_off(connection, device);
        self.channels.get(&connection).is_none_or(|channel| channel.waiting.is_none())
    }

    /// Executes what a connection has sent, up to a call that waits.
    fn work_off(&mut self, connection: u64, device: &mut dyn Device) {
        while let Some(channel) = self.channels.get_mut(&connection)
            && channel.waiting.is_none()
        {
            match channel.records.next_record() {
                Ok(None) => return,
                Ok(Some(record)) => {
                    let call = Waiting { record, since: self.now };
                    self.execute(connection, call, device);
                }
                Err(_) => return self.refuse(connection, device),
            }
        }
    }

    /// Closes a connection whose bytes cannot be trusted.
    fn refuse(&mut self, connection: u64, device: &mut dyn Device) {
        self.output.push(Outgoing { connection, bytes: Vec::new(), close: true });
        self.closed(connection, device);
    }

    fn execute(&mut self, connection: u64, waiting: Waiting, device: &mut dyn Device) {
        let call = match Call::parse(&waiting.record) {
            Ok(call) => call,
            Err(Some(reply)) => return self.send(connection, &reply),
            Err(None) => return self.refuse(connection, device),
        };
        let is_abort = call.program == ABORT_PROGRAM;
        let results = if !matches!(call.program, CORE_PROGRAM | ABORT_PROGRAM) {
            Err(Refusal::Program)
        } else if call.version != VERSION {
            Err(Refusal::Version(VERSION))
        } else {
            parse(call.procedure, is_abort, call.arguments)
                .map(|request| self.attempt(connection, request, waiting.since, device))
        };
        let results = match results {
            Ok(Attempt::Results(results)) => Ok(results),
            Ok(Attempt::Wait) => {
                if let Some(channel) = self.channels.get_mut(&connection) {
                    channel.waiting = Some(waiting);
                }
                return;
            }
            Err(refusal) => Err(refusal),
        };
        self.send(connection, &call.reply(results));
    }

    fn send(&mut self, connection: u64, message: &[u8]) {
        self.output.push(Outgoing { connection, bytes: record(message), close: false });
    }

    /// Tries a call that came at `since` (s).
    fn attempt(
        &mut self,
        connection: u64,
        ProcedureCall { procedure, link, timeouts }: ProcedureCall<'_>,
        since: f64,
        device: &mut dyn Device,
    ) -> Attempt {
        match procedure {
            Procedure::Null => return Attempt::Results(Vec::new()),
            Procedure::CreateLink { lock, device: name } => {
                return self.create(connection, (lock, name), (timeouts, since), device);
            }
            Procedure::Interrupts => return ErrorCode::NotSupported.into(),
            Procedure::Abort => return self.abort(link, device),
            _ => {}
        }
        let own = |number: &u16| self.links.get(number).is_some_and(|l| l.connection == connection);
        let Some(number) = u16::try_from(link).ok().filter(own) else {
            return Attempt::Results(procedure.failure(ErrorCode::InvalidLink));
        };
        let needs_lock = !matches!(
            procedure,
            Procedure::Unlock
                | Procedure::DestroyLink
                | Procedure::DoCommand
                | Procedure::WriteTooMuch
        );
        if needs_lock && !device.locks().may_act(number) {
            if since + timeouts.lock > self.now {
                return Attempt::Wait;
            }
            return Attempt::Results(procedure.failure(ErrorCode::Locked));
        }
        self.act(number, procedure, since + timeouts.io, device)
    }

    /// What a link that may act does; a read waits until `until` (s).
    fn act(
        &mut self,
        number: u16,
        procedure: Procedure<'_>,
        until: f64,
        device: &mut dyn Device,
    ) -> Attempt {
        let Some(link) = self.links.get_mut(&number) else { return ErrorCode::InvalidLink.into() };
        let results = match procedure {
            Procedure::Write { data, end } => {
                // A message that comes before the reply to the one before was read: that reply is
                // lost.
                let unread = !link.reply.is_empty() || device.owes_reply(number);
                if !std::mem::replace(&mut link.within_message, !end) && unread {
                    link.reply.clear();
                    device.interrupt(number);
                }
                link.reply.extend(device.input(number, data, end));
                words(&[0, u32::try_from(data.len()).unwrap_or(0)])
            }
            Procedure::Read { .. } if link.reply.is_empty() && until > self.now => {
                return Attempt::Wait;
            }
            Procedure::Read { .. } if link.reply.is_empty() => {
                procedure.failure(ErrorCode::Timeout)
            }
            Procedure::Read { count, terminator } => link.read(count, terminator),
            Procedure::ReadStatus => {
                let (byte, _) = device.status(!link.reply.is_empty());
                words(&[0, u32::from(link.service.read(byte))])
            }
            Procedure::WriteTooMuch => procedure.failure(ErrorCode::Parameter),
            Procedure::Trigger => {
                link.reply.extend(device.trigger(number));
                words(&[0])
            }
            Procedure::Clear => {
                link.reply.clear();
                link.within_message = false;
                device.clear(number);
                words(&[0])
            }
            Procedure::Remote | Procedure::Local => {
                device.lock_keys(procedure == Procedure::Remote);
                words(&[0])
            }
            Procedure::Lock => match device.locks().request(number, &[]) {
                Grant::Granted => words(&[0]),
                Grant::Busy | Grant::Invalid => procedure.failure(ErrorCode::Locked),
            },
            Procedure::Unlock => match device.locks().release(number) {
                Released::Nothing => procedure.failure(ErrorCode::NoLock),
                Released::Exclusive | Released::Shared => words(&[0]),
            },
            Procedure::DestroyLink => {
                self.destroy(number, device);
                words(&[0])
            }
            // The others have no link.
            _ => procedure.failure(ErrorCode::NotSupported),
        };
        Attempt::Results(results)
    }

    fn create(
        &mut self,
        connection: u64,
        (lock, name): (bool, &[u8]),
        (timeouts, since): (Timeouts, f64),
        device: &mut dyn Device,
    ) -> Attempt {
        let failure = |code| Attempt::Results([words(&[code as u32]), words(&[0; 3])].concat());
        if !(name.is_empty() || name.eq_ignore_ascii_case(b"inst0")) {
            return failure(ErrorCode::NotAccessible);
        }
        let own = self.links.values().filter(|link| link.connection == connection).count();
        let has_room = own < MAX_LINKS_OF_CONNECTION
            && (self.links.len() < MAX_LINKS || self.close_idle(connection, device));
        let free = (FIRST_LINK..u16::MAX).find(|number| !self.links.contains_key(number));
        let Some(number) = free.filter(|_| has_room) else {
            return failure(ErrorCode::OutOfResources);
        };
        if lock && device.locks().request(number, &[]) != Grant::Granted {
            let waits = since + timeouts.lock > self.now;
            return if waits { Attempt::Wait } else { failure(ErrorCode::Locked) };
        }
        self.links.insert(number, Link { connection, ..Link::default() });
        device.open(number, connection);
        let longest = u32::try_from(MAX_RECEIVE).unwrap_or(u32::MAX);
        Attempt::Results(words(&[0, u32::from(number), u32::from(self.port), longest]))
    }

    /// Closes the connection with links, other than `connection`, that has been idle for longest.
    /// Whether there was one.
    fn close_idle(&mut self, connection: u64, device: &mut dyn Device) -> bool {
        let idle = |(number, channel): &(&u64, &Channel)| {
            **number != connection
                && self.now - channel.last_received >= IDLE_TIME
                && self.links.values().any(|link| link.connection == **number)
                && !self.is_waiting(**number, device)
        };
        let by_time = |a: &(&u64, &Channel), b: &(&u64, &Channel)| {
            a.1.last_received.total_cmp(&b.1.last_received)
        };
        let longest = self.channels.iter().filter(idle).min_by(by_time);
        let Some(number) = longest.map(|(number, _)| *number) else { return false };
        self.refuse(number, device);
        true
    }

    fn destroy(&mut self, number: u16, device: &mut dyn Device) {
        if self.links.remove(&number).is_some() {
            device.locks().remove_session(number);
            device.close(number);
        }
    }

    /// Ends the call that a link waits with.
    fn abort(&mut self, link: u32, device: &mut dyn Device) -> Attempt {
        let link = u16::try_from(link).ok().and_then(|number| self.links.get(&number));
        let Some(connection) = link.map(|link| link.connection) else {
            return ErrorCode::InvalidLink.into();
        };
        let channel = self.channels.get_mut(&connection);
        if let Some(waiting) = channel.and_then(|channel| channel.waiting.take())
            && let Ok(call) = Call::parse(&waiting.record)
            && let Ok(request) = parse(call.procedure, false, call.arguments)
        {
            let aborted = call.reply(Ok(request.procedure.failure(ErrorCode::Abort)));
            self.send(connection, &aborted);
            self.work_off(connection, device);
        }
        Attempt::Results(words(&[0]))
    }
}

impl Link {
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
