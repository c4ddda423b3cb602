//! The instrument with its sessions, one for each client of any protocol, with their transcript and
//! the faults of their replies.

use std::collections::BTreeMap;
use std::time::Duration;

use tokio::sync::mpsc;
use tokio::time::Instant;

use super::log::{Log, shown};
use super::network::{Answer, Interrupts, Request};
use super::recorder::Recorder;
use crate::instrument::Instrument;
use crate::scpi::{Preferences, Reply, Session, TranscriptLine};

/// A session, its client's protocol and address, and the queue of its answers.
struct SessionEntry {
    session: Session,
    peer: String,
    answers: mpsc::Sender<Answer>,
    /// Whether its connection knows that it waits.
    waits: bool,
}

/// A reply that a fault delays.
struct LateReply {
    session: u64,
    due: Instant,
    bytes: Vec<u8>,
}

/// Longest delay of a reply (s): a day.
const MAX_DELAY: f64 = 86_400.0;

/// The instrument and its sessions.
pub struct Sessions {
    /// The instrument.
    pub instrument: Instrument,
    /// The recording.
    pub recorder: Option<Recorder>,
    /// The log.
    pub log: Log,
    entries: BTreeMap<u64, SessionEntry>,
    late: Vec<LateReply>,
    header: bool,
    seed: u64,
}

impl Sessions {
    /// No sessions; `header` is the initial state of response headers, `seed` that of garbled
    /// replies.
    pub fn new(
        mut instrument: Instrument,
        (header, seed): (bool, u64),
        recorder: Option<Recorder>,
        log: Log,
    ) -> Self {
        // Power on is no error.
        instrument.status.take_reported();
        Self { instrument, recorder, log, entries: BTreeMap::new(), late: Vec::new(), header, seed }
    }

    /// Executes a request of a connection.
    pub fn execute(&mut self, request: Request) {
        match request {
            Request::Open { session, peer, answers } => self.open(session, peer, answers),
            Request::Message { session, bytes, end, interrupts } => {
                self.interrupt(session, interrupts);
                let reply = self.with(session, |session, instrument| {
                    let mut reply = bytes_of(session.receive(instrument, &bytes));
                    if end {
                        reply.extend(bytes_of(session.end_of_message(instrument)));
                    }
                    reply
                });
                self.complete(session, reply);
            }
            Request::Trigger { session, interrupts } => {
                self.interrupt(session, interrupts);
                let reply =
                    self.with(session, |session, instrument| bytes_of(session.trigger(instrument)));
                self.complete(session, reply);
            }
            Request::Clear { session, done } => {
                self.late.retain(|late| late.session != session);
                self.with(session, |session, _| session.clear());
                self.note_end_of_wait(session);
                // The connection may have ended meanwhile.
                let _ = done.send(());
            }
            Request::LockKeys(locked) => self.instrument.service.locked = locked,
            Request::Close { session } => self.close(session),
        }
    }

    fn open(&mut self, id: u64, peer: String, answers: mpsc::Sender<Answer>) {
        let session = Session::new(Preferences::new(self.header));
        let is_written = self.recorder.is_some() || self.log.is_on();
        let session = if is_written { session.with_transcript() } else { session };
        self.log.line(&peer, "opened");
        self.entries.insert(id, SessionEntry { session, peer, answers, waits: false });
    }

    fn close(&mut self, id: u64) {
        self.late.retain(|late| late.session != id);
        if let Some(entry) = self.entries.remove(&id) {
            self.log.line(&entry.peer, "closed");
        }
    }

    /// Throws away the reply to the message before, if the client has not read it.
    fn interrupt(&mut self, id: u64, interrupts: Interrupts) {
        let Some(entry) = self.entries.get(&id) else { return };
        let is_late = || self.late.iter().any(|late| late.session == id);
        let is_queued = || entry.answers.capacity() < entry.answers.max_capacity();
        let is_due = match interrupts {
            Interrupts::Never => false,
            Interrupts::IfOwed => entry.session.owes_reply() || is_late() || is_queued(),
            Interrupts::Always => true,
        };
        if is_due {
            self.late.retain(|late| late.session != id);
            self.with(id, Session::interrupt);
            self.send(id, Answer::Interrupted);
        }
    }

    /// Answers a message: by the reply with the faults that are asked for, which may come later,
    /// and its end.
    fn complete(&mut self, id: u64, reply: Vec<u8>) {
        self.reply(id, reply);
        let waits = self.is_waiting(id);
        if let Some(entry) = self.entries.get_mut(&id) {
            entry.waits = waits;
        }
        self.send(id, Answer::Done { waits });
    }

    /// Sends a reply with the faults that are asked for, at once or out of [`Self::resume`].
    fn reply(&mut self, id: u64, mut reply: Vec<u8>) {
        if reply.is_empty() {
            return;
        }
        let faults = &mut self.instrument.bench.faults;
        let Some(entry) = self.entries.get(&id) else { return };
        let (mut delay, mut drop_after) = (None, None);
        if entry.session.is_by_instrument() && !faults.is_empty() {
            let before = reply.clone();
            let found = faults.disturb_reply(&mut reply, self.seed);
            (delay, drop_after) = (found.delay, found.drop_after);
            if before != reply || delay.is_some() || drop_after.is_some() {
                self.log.line(&entry.peer, &format!("* a fault disturbs {}", shown(&before)));
            }
        }
        if let Some(length) = drop_after {
            self.send(id, Answer::DropAfter(length));
        }
        // Replies keep their order.
        let last = self.late.iter().filter(|late| late.session == id).map(|late| late.due).max();
        let own = delay.map(|delay| Instant::now() + Duration::from_secs_f64(delay.min(MAX_DELAY)));
        match own.max(last) {
            Some(due) => self.late.push(LateReply { session: id, due, bytes: reply }),
            None if reply.is_empty() => {}
            None => self.send(id, Answer::Reply(reply)),
        }
    }

    /// Sends an answer; closes a session whose queue of answers is full, since its client does not
    /// read.
    fn send(&mut self, id: u64, answer: Answer) {
        if self.entries.get(&id).is_some_and(|entry| entry.answers.try_send(answer).is_err()) {
            self.close(id);
        }
    }

    /// Whether a session waits: for the end of an acquisition, or for a reply that is late.
    fn is_waiting(&self, id: u64) -> bool {
        let late = self.late.iter().any(|late| late.session == id);
        late || self.entries.get(&id).is_some_and(|entry| entry.session.is_waiting())
    }

    /// Goes on with what waited.
    pub fn resume(&mut self) {
        let waiting = self.entries.iter().filter(|(_, entry)| entry.waits);
        let waiting: Vec<u64> = waiting.map(|(id, _)| *id).collect();
        let now = Instant::now();
        let due: Vec<LateReply> = self.late.extract_if(.., |late| late.due <= now).collect();
        for late in due {
            self.send(late.session, Answer::Reply(late.bytes));
        }
        for id in waiting {
            if self.entries.get(&id).is_some_and(|entry| entry.session.is_waiting()) {
                let reply =
                    self.with(id, |session, instrument| bytes_of(session.resume(instrument)));
                self.reply(id, reply);
            }
            self.note_end_of_wait(id);
        }
    }

    /// Notifies a connection when its session has finished waiting.
    fn note_end_of_wait(&mut self, id: u64) {
        let waits = self.is_waiting(id);
        if let Some(entry) = self.entries.get_mut(&id)
            && entry.waits
            && !waits
        {
            entry.waits = false;
            self.send(id, Answer::Resumed);
        }
    }

    /// Does something with a session, and writes down what was said.
    fn with<T: Default>(
        &mut self,
        id: u64,
        act: impl FnOnce(&mut Session, &mut Instrument) -> T,
    ) -> T {
        let Some(entry) = self.entries.get_mut(&id) else { return T::default() };
        let done = act(&mut entry.session, &mut self.instrument);
        // Taken also where no recording goes on: it would grow.
        let lines = entry.session.take_transcript();
        let events = self.instrument.status.take_reported();
        if self.log.is_on() {
            for line in &lines {
                let (sign, bytes) = match line {
                    TranscriptLine::Command(bytes) => ('>', bytes),
                    TranscriptLine::Reply(bytes) => ('<', bytes),
                };
                self.log.line(&entry.peer, &format!("{sign} {}", shown(bytes)));
            }
            for event in events {
                let message = event.message();
                let message = message.trim_end_matches("; ");
                self.log.line(&entry.peer, &format!("! {} {message}", event.code()));
            }
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.lines(&entry.peer, lines);
        }
        done
    }
}

fn bytes_of(reply: Reply) -> Vec<u8> {
    match reply {
        Reply::None => Vec::new(),
        Reply::Now(bytes) | Reply::WhenIdle(bytes) => bytes,
    }
}
