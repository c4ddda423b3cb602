//! All channels and links: what each call does, what waits, what is to be sent.

use std::collections::BTreeMap;
use std::net::{IpAddr, Ipv4Addr, SocketAddrV4};

use super::procedure::{
    ABORT_PROGRAM, CORE_PROGRAM, DEVICE_INTR_SRQ, ErrorCode, Patience, Procedure, ProcedureCall,
    VERSION, parse, reason,
};
use super::rpc::{
    Call, MAX_RECEIVE, MAX_RECORD, RecordDecoder, Refusal, call, put_opaque, record, words,
};
use crate::lan::lock::{Grant, Released};
use crate::lan::{Device, FIRST_LINK, Outgoing, ServiceRequest};

/// Links at a time.
pub const MAX_LINKS: usize = 64;

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
    /// What service requests carry, where they are switched on.
    handle: Option<Vec<u8>>,
}

/// The connection to a client that is told of service requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum InterruptChannel {
    /// None.
    #[default]
    Closed,
    /// The server connects, for calls of this program and version.
    Connecting(u32, u32),
    /// It could not.
    Failed,
    /// It is there, which the client is still to be told.
    Ready(u32, u32),
    /// It is there.
    Open(u32, u32),
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
    peer: IpAddr,
    records: RecordDecoder,
    waiting: Option<Waiting>,
    interrupts: InterruptChannel,
}

/// What is to be done about a client's interrupt channel, which the number of its core channel
/// identifies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Interrupt {
    /// Connect; [`Vxi11Server::interrupt_channel`] takes what became of it.
    Connect(u64, SocketAddrV4),
    /// Send these bytes.
    Send(u64, Vec<u8>),
    /// Close it.
    Close(u64),
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
    interrupts: Vec<Interrupt>,
    now: f64,
    calls_made: u32,
}

impl Vxi11Server {
    /// No links; clients reach both channels at `port`.
    pub fn new(port: u16) -> Self {
        Self {
            port,
            channels: BTreeMap::new(),
            links: BTreeMap::new(),
            output: Vec::new(),
            interrupts: Vec::new(),
            now: 0.0,
            calls_made: 0,
        }
    }

    /// A connection is there.
    pub fn opened(&mut self, connection: u64, peer: IpAddr) {
        let interrupts = InterruptChannel::Closed;
        let channel =
            Channel { peer, records: RecordDecoder::default(), waiting: None, interrupts };
        self.channels.insert(connection, channel);
    }

    /// Closes a connection's links.
    pub fn closed(&mut self, connection: u64, device: &mut dyn Device) {
        let Some(channel) = self.channels.remove(&connection) else { return };
        let links = self.links.iter().filter(|(_, link)| link.connection == connection);
        for number in links.map(|(number, _)| *number).collect::<Vec<u16>>() {
            self.destroy(number, device);
        }
        if channel.interrupts != InterruptChannel::Closed {
            self.interrupts.push(Interrupt::Close(connection));
        }
        self.settle(device);
    }

    /// Bytes came.
    pub fn received(&mut self, connection: u64, bytes: &[u8], device: &mut dyn Device) {
        let Some(channel) = self.channels.get_mut(&connection) else { return };
        channel.records.push(bytes);
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

    /// What became of [`Interrupt::Connect`], or that the connection was closed.
    pub fn interrupt_channel(&mut self, connection: u64, is_open: bool) {
        let Some(channel) = self.channels.get_mut(&connection) else { return };
        channel.interrupts = match channel.interrupts {
            InterruptChannel::Connecting(program, version) if is_open => {
                InterruptChannel::Ready(program, version)
            }
            InterruptChannel::Connecting(..) => InterruptChannel::Failed,
            _ => InterruptChannel::Closed,
        };
    }

    /// Time has passed: it is `now` (s), on a clock that does not run backwards. Calls run out, and
    /// those who asked for service are told.
    pub fn advance(&mut self, now: f64, device: &mut dyn Device) {
        self.now = self.now.max(now);
        self.settle(device);
        for link in self.links.values_mut() {
            let (byte, enabled) = device.status(!link.reply.is_empty());
            if !link.service.is_due(byte, enabled) {
                continue;
            }
            let channel = self.channels.get(&link.connection);
            if let (Some(handle), Some(InterruptChannel::Open(program, version))) =
                (&link.handle, channel.map(|channel| channel.interrupts))
            {
                self.calls_made = self.calls_made.wrapping_add(1);
                let mut arguments = Vec::new();
                put_opaque(handle, &mut arguments);
                let told = call(self.calls_made, [program, version, DEVICE_INTR_SRQ], &arguments);
                self.interrupts.push(Interrupt::Send(link.connection, record(&told)));
            }
        }
    }

    /// Output since the last call, in order.
    pub fn take_output(&mut self) -> Vec<Outgoing> {
        std::mem::take(&mut self.output)
    }

    /// What is to be done about interrupt channels since the last call, in order.
    pub fn take_interrupts(&mut self) -> Vec<Interrupt> {
        std::mem::take(&mut self.interrupts)
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
        ProcedureCall { procedure, link, patience }: ProcedureCall<'_>,
        since: f64,
        device: &mut dyn Device,
    ) -> Attempt {
        match procedure {
            Procedure::Null => return Attempt::Results(Vec::new()),
            Procedure::CreateLink { lock, device: name } => {
                return self.create(connection, (lock, name), (patience, since), device);
            }
            Procedure::CreateInterruptChannel { address, program, is_udp } => {
                return self.create_interrupt_channel(connection, (address, program), is_udp);
            }
            Procedure::DestroyInterruptChannel => {
                return self.destroy_interrupt_channel(connection);
            }
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
                | Procedure::EnableServiceRequest { .. }
                | Procedure::DoCommand
        );
        if needs_lock && !device.locks().may_act(number) {
            if since + patience.lock > self.now {
                return Attempt::Wait;
            }
            return Attempt::Results(procedure.failure(ErrorCode::Locked));
        }
        self.act(number, procedure, since + patience.io, device)
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
            Procedure::Trigger => {
                device.trigger(number);
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
            Procedure::EnableServiceRequest { handle } => {
                link.handle = handle.map(<[u8]>::to_vec);
                words(&[0])
            }
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
        (patience, since): (Patience, f64),
        device: &mut dyn Device,
    ) -> Attempt {
        let failure = |code| Attempt::Results([words(&[code as u32]), words(&[0; 3])].concat());
        if !(name.is_empty() || name.eq_ignore_ascii_case(b"inst0")) {
            return failure(ErrorCode::NotAccessible);
        }
        let free = (FIRST_LINK..u16::MAX).find(|number| !self.links.contains_key(number));
        let Some(number) = free.filter(|_| self.links.len() < MAX_LINKS) else {
            return failure(ErrorCode::OutOfResources);
        };
        if lock && device.locks().request(number, &[]) != Grant::Granted {
            let waits = since + patience.lock > self.now;
            return if waits { Attempt::Wait } else { failure(ErrorCode::Locked) };
        }
        self.links.insert(number, Link { connection, ..Link::default() });
        device.open(number, connection);
        let longest = u32::try_from(MAX_RECEIVE).unwrap_or(u32::MAX);
        Attempt::Results(words(&[0, u32::from(number), u32::from(self.port), longest]))
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

    fn create_interrupt_channel(
        &mut self,
        connection: u64,
        ((host, port), (program, version)): ((u32, u16), (u32, u32)),
        is_udp: bool,
    ) -> Attempt {
        let Some(channel) = self.channels.get_mut(&connection) else {
            return ErrorCode::NoChannel.into();
        };
        let address = Ipv4Addr::from(host);
        match channel.interrupts {
            InterruptChannel::Connecting(..) => return Attempt::Wait,
            InterruptChannel::Failed => {
                channel.interrupts = InterruptChannel::Closed;
                return ErrorCode::NoChannel.into();
            }
            InterruptChannel::Ready(program, version) => {
                channel.interrupts = InterruptChannel::Open(program, version);
                return Attempt::Results(words(&[0]));
            }
            InterruptChannel::Open(..) => return ErrorCode::ChannelExists.into(),
            InterruptChannel::Closed if is_udp => return ErrorCode::NotSupported.into(),
            InterruptChannel::Closed if channel.peer.to_canonical() != IpAddr::V4(address) => {
                return ErrorCode::InvalidAddress.into();
            }
            InterruptChannel::Closed => {}
        }
        channel.interrupts = InterruptChannel::Connecting(program, version);
        self.interrupts.push(Interrupt::Connect(connection, SocketAddrV4::new(address, port)));
        Attempt::Wait
    }

    fn destroy_interrupt_channel(&mut self, connection: u64) -> Attempt {
        let channel = self.channels.get_mut(&connection);
        match channel.map(|channel| std::mem::take(&mut channel.interrupts)) {
            Some(InterruptChannel::Open(..)) => {
                self.interrupts.push(Interrupt::Close(connection));
                Attempt::Results(words(&[0]))
            }
            _ => ErrorCode::NoChannel.into(),
        }
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
