//! Writes a log or a recording on a thread of its own, so that no client waits for a disk that has
//! stalled or for a pipe that is not read.
//!
//! The queue to the thread is limited in bytes. Entries that do not fit are dropped and counted,
//! and the count is written where they would have been.

use std::fmt::Display;
use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use tokio::sync::{OwnedSemaphorePermit, Semaphore, oneshot};
use tokio::time::timeout;

/// Capacity of the queue (bytes).
const QUEUE_CAPACITY: u32 = 1 << 24;
/// Free part of the queue below which the instrument waits for the writer (bytes).
const LOW_WATER: u32 = QUEUE_CAPACITY / 2;
/// Bytes that a working writer takes within [`STALL_TIMEOUT`].
const MIN_PROGRESS: u32 = 1 << 16;
/// Time after which a writer that takes nothing is called stalled.
const STALL_TIMEOUT: Duration = Duration::from_millis(100);
/// Written entries are flushed at the latest after this time.
const FLUSH_INTERVAL: Duration = Duration::from_secs(1);

/// What a writer's thread writes to.
pub trait Sink: Send + 'static {
    /// What it writes.
    type Entry: Send + 'static;
    /// Why it could not.
    type Error: Display + Send + 'static;

    /// Writes an entry.
    fn write(&mut self, entry: Self::Entry) -> Result<(), Self::Error>;
    /// Writes that `count` entries were lost here.
    fn write_loss(&mut self, count: u64) -> Result<(), Self::Error>;
    /// Says that the output has become as large as it may, looked at after each flush.
    fn limit_reached(&self) -> Option<String>;
    /// Hands what was written to the operating system.
    fn flush(&mut self) -> Result<(), Self::Error>;
    /// Ends the output.
    fn finish(self) -> Result<(), Self::Error>;
}

/// An entry in the queue with its share of the capacity, and the number of entries that were lost
/// before it; the last one of a queue may be a loss alone.
struct Queued<T> {
    lost: u64,
    entry: Option<(T, OwnedSemaphorePermit)>,
}

/// The instrument's end of a writer's queue.
pub struct BackgroundWriter<S: Sink> {
    queue: Sender<Queued<S::Entry>>,
    room: Arc<Semaphore>,
    lost: u64,
    is_stalled: bool,
    outcome: oneshot::Receiver<Result<(), S::Error>>,
}

impl<S: Sink> BackgroundWriter<S> {
    /// Starts the thread. Where `sink` fails, `warn` is called on that thread, and the server goes
    /// on without the output.
    ///
    /// # Errors
    /// The system's error if no thread can be started.
    pub fn start(name: &str, sink: S, warn: fn(&str)) -> io::Result<Self> {
        let (queue, inbox) = channel();
        let (sender, outcome) = oneshot::channel();
        thread::Builder::new().name(name.to_owned()).spawn(move || {
            // The server may have ended without waiting for a stalled writer.
            let _ = sender.send(write_all(sink, &inbox, warn));
        })?;
        let room = Arc::new(Semaphore::new(QUEUE_CAPACITY as usize));
        Ok(Self { queue, room, lost: 0, is_stalled: false, outcome })
    }

    /// Queues an entry of about `bytes`, or counts it as lost.
    pub fn push(&mut self, entry: S::Entry, bytes: usize) {
        let bytes = u32::try_from(bytes).unwrap_or(QUEUE_CAPACITY).clamp(1, QUEUE_CAPACITY);
        match Arc::clone(&self.room).try_acquire_many_owned(bytes) {
            Ok(room) => {
                let lost = std::mem::take(&mut self.lost);
                // A writer that has failed takes nothing more.
                let _ = self.queue.send(Queued { lost, entry: Some((entry, room)) });
            }
            Err(_) => self.lost += 1,
        }
    }

    /// Waits while the queue is more than half full and the writer works, so that the clients of a
    /// busy server go at the pace of the disk and nothing is lost.
    pub async fn keep_pace(&mut self) {
        let free = self.free();
        if free >= LOW_WATER {
            self.is_stalled = false;
        } else if !self.is_stalled {
            let progress = self.room.acquire_many(free + MIN_PROGRESS);
            self.is_stalled = timeout(STALL_TIMEOUT, progress).await.is_err();
        }
    }

    /// Waits until all entries are written, unless the writer is stalled.
    pub async fn drain(&mut self) {
        if !self.is_stalled {
            let drained = self.room.acquire_many(QUEUE_CAPACITY);
            self.is_stalled = timeout(STALL_TIMEOUT, drained).await.is_err();
        }
    }

    /// Ends the output, and waits for it as long as the writer takes something within `limit`. None
    /// if it does not.
    pub async fn finish(self, limit: Duration) -> Option<Result<(), S::Error>> {
        let Self { queue, room, lost, mut outcome, .. } = self;
        if lost > 0 {
            let _ = queue.send(Queued { lost, entry: None });
        }
        drop(queue);
        loop {
            let before = room.available_permits();
            match timeout(limit, &mut outcome).await {
                Ok(outcome) => return outcome.ok(),
                Err(_) if room.available_permits() > before => {}
                Err(_) => return None,
            }
        }
    }

    fn free(&self) -> u32 {
        u32::try_from(self.room.available_permits()).unwrap_or(QUEUE_CAPACITY)
    }
}

/// Writes until the queue is closed, the output is as large as it may be, or something fails.
fn write_all<S: Sink>(
    mut sink: S,
    inbox: &Receiver<Queued<S::Entry>>,
    warn: fn(&str),
) -> Result<(), S::Error> {
    match copy(&mut sink, inbox) {
        Ok(None) => sink.finish(),
        Ok(Some(reason)) => {
            warn(&format!("{reason}; the server goes on without it"));
            sink.finish()
        }
        Err(reason) => {
            warn(&format!("{reason}; the server goes on without it"));
            // What was written stays; what failed first is the cause.
            let _ = sink.finish();
            Err(reason)
        }
    }
}

/// Copies entries to the sink; returns why it ended before the queue.
fn copy<S: Sink>(
    sink: &mut S,
    inbox: &Receiver<Queued<S::Entry>>,
) -> Result<Option<String>, S::Error> {
    let mut unflushed: Option<Instant> = None;
    loop {
        let wait = unflushed.map(|since| FLUSH_INTERVAL.saturating_sub(since.elapsed()));
        let received = match wait {
            Some(wait) => inbox.recv_timeout(wait),
            None => inbox.recv().map_err(RecvTimeoutError::from),
        };
        match received {
            Ok(Queued { lost, entry }) => {
                if lost > 0 {
                    sink.write_loss(lost)?;
                }
                if let Some((entry, _room)) = entry {
                    sink.write(entry)?;
                }
                unflushed.get_or_insert_with(Instant::now);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
        }
        if unflushed.is_some_and(|since| since.elapsed() >= FLUSH_INTERVAL) {
            sink.flush()?;
            unflushed = None;
            let reached = sink.limit_reached();
            if reached.is_some() {
                return Ok(reached);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, Sender, channel};
    use std::time::Duration;

    use super::{BackgroundWriter, Sink};

    /// Takes an entry whenever it is allowed one.
    struct Gate {
        allowed: Receiver<()>,
        written: Sender<String>,
    }

    impl Sink for Gate {
        type Entry = u32;
        type Error = String;

        fn write(&mut self, entry: u32) -> Result<(), String> {
            self.allowed.recv().map_err(|_| "closed".to_owned())?;
            self.written.send(entry.to_string()).map_err(|e| e.to_string())
        }

        fn write_loss(&mut self, count: u64) -> Result<(), String> {
            self.written.send(format!("{count} lost")).map_err(|e| e.to_string())
        }

        fn flush(&mut self) -> Result<(), String> {
            Ok(())
        }

        fn limit_reached(&self) -> Option<String> {
            None
        }

        fn finish(self) -> Result<(), String> {
            Ok(())
        }
    }

    /// The queue holds 16 entries of a mebibyte; four of twenty are lost, and the output says so.
    #[tokio::test(start_paused = true)]
    async fn a_writer_that_stalls_stops_nobody_and_its_losses_are_written() {
        let ((allow, allowed), (written, lines)) = (channel(), channel());
        let sink = Gate { allowed, written };
        let mut writer = BackgroundWriter::start("gate", sink, |_| ()).expect("a thread");
        for entry in 0..20 {
            writer.push(entry, 1 << 20);
        }
        writer.keep_pace().await;
        writer.drain().await;
        for _ in 0..17 {
            allow.send(()).expect("a sink");
        }
        let first: Vec<String> = lines.iter().take(16).collect();
        assert_eq!(first, (0..16).map(|entry| entry.to_string()).collect::<Vec<_>>());
        writer.room.acquire_many(super::QUEUE_CAPACITY).await.expect("room").forget();
        writer.room.add_permits(1 << 20);
        writer.push(20, 1 << 20);
        assert_eq!(lines.iter().take(2).collect::<Vec<_>>(), ["4 lost", "20"]);
        // The thread ends in real time.
        tokio::time::resume();
        assert_eq!(writer.finish(Duration::from_secs(1)).await, Some(Ok(())));
    }

    /// A loss at the very end is written, too; a writer that takes nothing is given up.
    #[tokio::test]
    async fn the_end_waits_for_a_writer_that_works_only() {
        let ((allow, allowed), (written, lines)) = (channel(), channel());
        let sink = Gate { allowed, written };
        let mut writer = BackgroundWriter::start("gate", sink, |_| ()).expect("a thread");
        (0..18).for_each(|entry| writer.push(entry, 1 << 20));
        (0..18).for_each(|_| allow.send(()).expect("a sink"));
        assert_eq!(lines.iter().take(16).count(), 16);
        let finished = writer.finish(Duration::from_secs(3600));
        assert_eq!(finished.await, Some(Ok(())));
        assert_eq!(lines.iter().collect::<Vec<_>>(), ["2 lost"]);

        let ((_allow, allowed), (written, _lines)) = (channel(), channel());
        let sink = Gate { allowed, written };
        let mut writer = BackgroundWriter::start("gate", sink, |_| ()).expect("a thread");
        writer.push(0, 1);
        assert_eq!(writer.finish(Duration::from_millis(20)).await, None);
    }
}
