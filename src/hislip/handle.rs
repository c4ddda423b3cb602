//! Executes the messages of a session.
//!
//! Remote and local control: what the control codes of `AsyncRemoteLocalControl` ask for. Source:
//! IVI-6.1, table 17.

use super::message::{DecodedPiece, FIRST_VENDOR_TYPE, MAX_PAYLOAD, MessageHeader, MessageType};
use super::server::{Server, error, fatal};
use super::session::Release;
use crate::lan::Device;
use crate::lan::lock::{Grant, LockRequest, Released};

/// How long a release waits for the message that was sent before it (s).
const RELEASE_TIMEOUT: f64 = 1.0;

impl Server {
    pub(super) fn synchronous(
        &mut self,
        number: u16,
        header: MessageHeader,
        payload: &[u8],
        instrument: &mut dyn Device,
    ) {
        let Some(session) = self.sessions.get_mut(&number) else { return };
        let connection = session.synchronous;
        let kind = MessageType::from_code(header.code);
        if session.clearing && kind != Some(MessageType::DeviceClearComplete) {
            return;
        }
        match kind {
            Some(kind @ (MessageType::Data | MessageType::DataEnd | MessageType::Trigger)) => {
                let delivered = header.control & 1 == 1;
                let owes_reply = instrument.owes_reply(number);
                let interrupts = match kind {
                    MessageType::Trigger => {
                        session.trigger(delivered, owes_reply, header.parameter)
                    }
                    _ => session.begin(delivered, owes_reply),
                };
                if kind == MessageType::DataEnd {
                    session.end(header.parameter);
                }
                if interrupts {
                    self.interrupt(number, header.parameter, instrument);
                }
                let reply = match kind {
                    MessageType::Trigger => instrument.trigger(number),
                    _ => instrument.input(number, payload, kind == MessageType::DataEnd),
                };
                self.reply(number, &reply);
            }
            Some(MessageType::DeviceClearComplete) => {
                session.clear();
                session.clearing = false;
                // Synchronised mode, whatever the client prefers.
                self.send(connection, MessageType::DeviceClearAcknowledge, (0, 0), &[]);
            }
            Some(MessageType::Initialize | MessageType::AsyncInitialize) => {
                let reason = "session already initialised";
                self.refuse(connection, fatal::INVALID_INITIALISATION, reason, instrument);
            }
            _ => self.unknown(connection, header.code),
        }
    }

    fn interrupt(&mut self, number: u16, identifier: u32, instrument: &mut dyn Device) {
        instrument.interrupt(number);
        let Some(session) = self.sessions.get(&number) else { return };
        let (synchronous, asynchronous) = (session.synchronous, session.asynchronous);
        self.send(synchronous, MessageType::Interrupted, (0, identifier), &[]);
        if let Some(asynchronous) = asynchronous {
            self.send(asynchronous, MessageType::AsyncInterrupted, (0, identifier), &[]);
        }
    }

    fn unknown(&mut self, connection: u64, code: u8) {
        let of_vendors = code >= FIRST_VENDOR_TYPE;
        let number =
            if of_vendors { error::UNKNOWN_VENDOR_TYPE } else { error::UNKNOWN_MESSAGE_TYPE };
        self.complain(connection, number, &format!("unknown message type {code}"));
    }

    pub(super) fn asynchronous(
        &mut self,
        number: u16,
        from: u64,
        message: (MessageHeader, &[u8]),
        instrument: &mut dyn Device,
    ) {
        let (header, payload) = message;
        let Some(session) = self.sessions.get_mut(&number) else { return };
        match MessageType::from_code(header.code) {
            Some(MessageType::AsyncMaximumMessageSize) => {
                let Ok(size) = payload.try_into() else {
                    return self.complain(from, error::OTHER_ERROR, "expected 8 bytes");
                };
                session.limit(u64::from_be_bytes(size));
                let own = (MAX_PAYLOAD as u64).to_be_bytes();
                self.send(from, MessageType::AsyncMaximumMessageSizeResponse, (0, 0), &own);
            }
            Some(MessageType::AsyncDeviceClear) => {
                session.clear();
                session.clearing = true;
                instrument.clear(number);
                self.send(from, MessageType::AsyncDeviceClearAcknowledge, (0, 0), &[]);
            }
            Some(MessageType::AsyncStatusQuery) => {
                if header.control & 1 == 1 {
                    session.delivered();
                }
                let (byte, _) = instrument.status(session.message_available());
                let byte = session.service.read(byte);
                self.send(from, MessageType::AsyncStatusResponse, (byte, 0), &[]);
            }
            Some(MessageType::AsyncLock) => {
                self.lock(number, (from, header), payload, instrument);
            }
            Some(MessageType::AsyncLockInfo) => {
                let locks = instrument.locks();
                let holders = u32::try_from(locks.holders()).unwrap_or(u32::MAX);
                let exclusive = u8::from(locks.is_exclusive());
                self.send(from, MessageType::AsyncLockInfoResponse, (exclusive, holders), &[]);
            }
            Some(MessageType::AsyncRemoteLocalControl) => {
                match RemoteControl::from_code(header.control) {
                    Some(RemoteControl::Free) => instrument.lock_keys(false),
                    Some(RemoteControl::LockedOut) => instrument.lock_keys(true),
                    Some(RemoteControl::Unchanged) => {}
                    None => {
                        let reason =
                            format!("unknown control code {}, expected 0 to 6", header.control);
                        return self.complain(from, error::UNKNOWN_CONTROL_CODE, &reason);
                    }
                }
                self.send(from, MessageType::AsyncRemoteLocalResponse, (0, 0), &[]);
            }
            Some(MessageType::Initialize | MessageType::AsyncInitialize) => {
                let reason = "session already initialised";
                self.refuse(from, fatal::INVALID_INITIALISATION, reason, instrument);
            }
            _ => self.unknown(from, header.code),
        }
    }

    fn lock(
        &mut self,
        number: u16,
        (from, header): (u64, MessageHeader),
        key: &[u8],
        instrument: &mut dyn Device,
    ) {
        let Some(session) = self.sessions.get_mut(&number) else { return };
        match header.control {
            1 => {
                // One request at a time: another one ends the first.
                if self.queue.remove(&number).is_some() {
                    self.answer_lock(number, Grant::Busy);
                }
                let until = self.now + f64::from(header.parameter) / 1e3;
                match instrument.locks().request(number, key) {
                    Grant::Busy if header.parameter > 0 => {
                        self.queue.insert(number, LockRequest { key: key.to_vec(), until });
                    }
                    grant => self.answer_lock(number, grant),
                }
            }
            0 => {
                let until = self.now + RELEASE_TIMEOUT;
                session.release = Some(Release { after: header.parameter, until });
            }
            code => {
                let reason =
                    format!("unknown control code {code}, expected 0 (release) or 1 (request)");
                self.complain(from, error::UNKNOWN_CONTROL_CODE, &reason);
            }
        }
    }

    fn answer_lock(&mut self, number: u16, grant: Grant) {
        let code = match grant {
            Grant::Busy => 0,
            Grant::Granted => 1,
            Grant::Invalid => 3,
        };
        let connection = self.sessions.get(&number).and_then(|session| session.asynchronous);
        if let Some(connection) = connection {
            self.send(connection, MessageType::AsyncLockResponse, (code, 0), &[]);
        }
    }

    /// Does what has waited: releases, then requests for locks, then messages of those who may act
    /// again.
    pub(super) fn settle(&mut self, instrument: &mut dyn Device) {
        let numbers: Vec<u16> = self.sessions.keys().copied().collect();
        for number in &numbers {
            self.complete_release(*number, instrument);
        }
        let waiting: Vec<u16> = self.queue.keys().copied().collect();
        for number in waiting {
            let Some(request) = self.queue.get(&number) else { continue };
            let grant = instrument.locks().request(number, &request.key);
            if grant != Grant::Busy || request.until <= self.now {
                self.queue.remove(&number);
                self.answer_lock(number, grant);
            }
        }
        for number in numbers {
            if !instrument.locks().may_act(number) {
                continue;
            }
            let held = self.sessions.get_mut(&number).map(|s| std::mem::take(&mut s.held));
            for piece in held.into_iter().flatten() {
                if let DecodedPiece::Message(header, payload) = piece {
                    self.synchronous(number, header, &payload, instrument);
                }
            }
        }
    }

    fn complete_release(&mut self, number: u16, instrument: &mut dyn Device) {
        let Some(session) = self.sessions.get_mut(&number) else { return };
        let Some(release) = session.release else { return };
        if session.awaits(release.after) && release.until > self.now {
            return;
        }
        session.release = None;
        let Some(connection) = session.asynchronous else { return };
        let code = match instrument.locks().release(number) {
            Released::Exclusive => 1,
            Released::Shared => 2,
            Released::Nothing => 3,
        };
        self.send(connection, MessageType::AsyncLockResponse, (code, 0), &[]);
    }
}

/// Remote and local state of the front panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RemoteControl {
    /// Its keys are free.
    Free,
    /// Its keys are locked out.
    LockedOut,
    /// Any state: a virtual panel is remote and local at once.
    Unchanged,
}

impl RemoteControl {
    /// The request of a control code; none for an unknown code.
    pub fn from_code(code: u8) -> Option<Self> {
        match code {
            // Remote disabled, the same with going to local, go to local.
            0 | 2 | 6 => Some(Self::Free),
            // Remote enabled, the same with going to remote.
            1 | 3 => Some(Self::Unchanged),
            // Remote enabled with local lock-out, the same with going to remote.
            4 | 5 => Some(Self::LockedOut),
            _ => None,
        }
    }
}
