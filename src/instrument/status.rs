//! Status registers and the event queue.
//!
//! An event sets its bit in the event status register and waits; `*ESR?` reads and clears the
//! register and releases the events that waited, which `EVENT?`, `EVMsg?` and `ALLEv?` then read.
//! Source: programmer manual 071-1075, chapter 3.

use std::collections::VecDeque;

use super::event::{EMPTY, Event, PENDING};

/// Registers and queue.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Status {
    register: u8,
    waiting: VecDeque<Event>,
    released: VecDeque<Event>,
    capacity: usize,
    completion_asked: bool,
    /// Events since the last look, whether they are noticed or not.
    reported: Vec<Event>,
    /// Events that are noticed at all (`DESE`).
    pub device_enable: u8,
    /// Events that show in the status byte (`*ESE`).
    pub event_enable: u8,
    /// Parts of the status byte that ask for service (`*SRE`).
    pub service_enable: u8,
    /// Whether the registers are cleared at power on (`*PSC`).
    pub power_on_clear: bool,
}

/// Bit of the status byte: a reply waits.
const MESSAGE_AVAILABLE: u8 = 1 << 4;
/// Bit of the status byte: an enabled event has come.
const EVENT_SUMMARY: u8 = 1 << 5;
/// Bit of the status byte: an enabled part of it is set.
const MASTER_SUMMARY: u8 = 1 << 6;

impl Status {
    /// The state after power on, with room for `capacity` events.
    pub fn power_on(capacity: usize) -> Self {
        let mut status = Self {
            register: 0,
            waiting: VecDeque::new(),
            released: VecDeque::new(),
            capacity: capacity.max(1),
            completion_asked: false,
            reported: Vec::new(),
            device_enable: u8::MAX,
            event_enable: 0,
            service_enable: 0,
            power_on_clear: true,
        };
        status.report(Event::PowerOn);
        status
    }

    /// The events that were reported since the last call, the first ones if they were many.
    pub fn take_reported(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.reported)
    }

    /// Books an event, if `DESE` lets it through. A full queue ends in [`Event::QueueOverflow`].
    pub fn report(&mut self, event: Event) {
        if self.reported.len() < self.capacity {
            self.reported.push(event);
        }
        if event.bit() & self.device_enable == 0 {
            return;
        }
        self.register |= event.bit();
        // Events that are released leave room: the next `*ESR?` drops what is not read of them.
        let events = self.waiting.len();
        if events + 1 < self.capacity {
            self.waiting.push_back(event);
        } else if events < self.capacity {
            self.waiting.push_back(Event::QueueOverflow);
        }
    }

    /// `*ESR?`: reads and clears the register; older events are dropped, the waiting ones released.
    pub fn read_register(&mut self) -> u8 {
        self.released = std::mem::take(&mut self.waiting);
        std::mem::take(&mut self.register)
    }

    /// Code and text of the oldest released event, which leaves the queue.
    pub fn next_event(&mut self) -> (u16, String) {
        let nothing = if self.waiting.is_empty() { EMPTY } else { PENDING };
        match self.released.pop_front() {
            Some(event) => (event.code(), event.message()),
            None => (nothing.0, nothing.1.to_owned()),
        }
    }

    /// Code and text of every released event, oldest first, or of the empty queue; all leave it.
    pub fn all_events(&mut self) -> Vec<(u16, String)> {
        let mut events = vec![self.next_event()];
        events.extend(self.released.drain(..).map(|event| (event.code(), event.message())));
        events
    }

    /// How many events are released.
    pub fn released_events(&self) -> u8 {
        u8::try_from(self.released.len()).unwrap_or(u8::MAX)
    }

    /// `*CLS`.
    pub fn clear(&mut self) {
        self.register = 0;
        self.waiting.clear();
        self.released.clear();
        self.completion_asked = false;
    }

    /// `*OPC`: [`Self::complete`] reports.
    pub fn ask_for_completion(&mut self) {
        self.completion_asked = true;
    }

    /// Nothing is pending any more.
    pub fn complete(&mut self) {
        if std::mem::take(&mut self.completion_asked) {
            self.report(Event::OperationComplete);
        }
    }

    /// The status byte of `*STB?`; `message_available`: a reply waits.
    pub fn byte(&self, message_available: bool) -> u8 {
        self.summary().byte(message_available)
    }

    /// What the status byte is made of beside the replies.
    pub fn summary(&self) -> StatusSummary {
        let event = self.register & self.event_enable != 0;
        StatusSummary { event, enabled: self.service_enable }
    }
}

/// The part of the status byte that is the same for all clients.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StatusSummary {
    /// Whether an enabled event has come.
    pub event: bool,
    /// Parts of the status byte that ask for service (`*SRE`).
    pub enabled: u8,
}

impl StatusSummary {
    /// The status byte; `message_available`: a reply waits.
    pub fn byte(self, message_available: bool) -> u8 {
        let mut byte = 0;
        if message_available {
            byte |= MESSAGE_AVAILABLE;
        }
        if self.event {
            byte |= EVENT_SUMMARY;
        }
        if byte & self.enabled != 0 {
            byte |= MASTER_SUMMARY;
        }
        byte
    }
}
