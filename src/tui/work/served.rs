//! Watches a scope that is served somewhere else, over its raw socket, and passes on what is turned on the screen.
//!
//! A few short queries ten times a second tell whether there is anything new; only then set-up and records are asked for. The
//! settings of the transfer (`DATa`) are everybody's: they are set, used and put back within one message, which the instrument
//! carries out as a whole, so that no other client reads a curve that it did not ask for.

mod snapshot;
mod socket;

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use super::{ScreenEvent, guarded, with_reasons};
use crate::recording::set_file::SetFile;
use crate::recording::{Capture, InstrumentIdentity, isf};
use crate::scope::{Model, Source};
use crate::tui::model::served::ServedUpdate;
use snapshot::ServedSnapshot;
pub use socket::Socket;

/// How often it is asked whether there is something new.
const RECORD_POLL_INTERVAL: Duration = Duration::from_millis(100);
/// How often it is asked for everything, since another client may have turned something.
const SNAPSHOT_INTERVAL: Duration = Duration::from_secs(1);
/// Query for a new record.
const STATE_QUERY: &str = ":ACQ:NUMAC?;STATE?;STOPA?;:TRIG:STATE?";
/// Settings of the transfer, in the order of the reply.
const TRANSFER_FIELDS: [&str; 5] = ["ENC", "WID", "STAR", "STOP", "SOU"];

/// A connection to a served scope, or to a real one behind a socket.
#[derive(Debug)]
pub struct ServedConnection {
    socket: Socket,
    /// Where it is, `HOST:PORT`.
    address: String,
    instrument: InstrumentIdentity,
    model: Model,
    /// Whether a bench stands behind it that can be struck.
    bench: bool,
}

impl ServedConnection {
    /// Connects to `address`, `HOST:PORT`, and asks who is there.
    ///
    /// # Errors
    /// A message for the user: no connection, or no oscilloscope of this family.
    pub fn connect(address: &str) -> Result<Self, String> {
        let failed = |error: io::Error| format!("{address}: {error}");
        let mut socket = Socket::connect(address).map_err(failed)?;
        let identity = socket.query(":HEAD OFF;:VERB ON;*IDN?").map_err(|error| {
            format!("{address}: found no answer to *IDN? ({error}), expected an oscilloscope")
        })?;
        let (instrument, model) =
            snapshot::instrument(&identity).map_err(|problem| format!("{address}: {problem}"))?;
        // A scope without a bench answers the second query alone.
        let bench = socket.query(":BENC:IMP?;:HEAD?").map_err(failed)?.contains(';');
        Ok(Self { socket, address: address.to_owned(), instrument, model, bench })
    }

    /// Everything but the records.
    fn poll(
        &mut self,
        short: String,
        before: Option<&ServedSnapshot>,
    ) -> io::Result<ServedSnapshot> {
        let panel = self.socket.query("SET?")?;
        let panel = SetFile::read(panel.as_bytes(), &self.address).map_err(io::Error::other)?;
        let mut look = ServedSnapshot::new(short, panel, self.model.clone());
        if self.bench {
            let named = self.socket.query(":BENC:IMP?;SCEN?")?;
            look.on_bench(&named, before);
            if let Some(query) = look.knobs_query() {
                let knobs = self.socket.query(&query)?;
                look.turned(&knobs);
            }
        }
        Ok(look)
    }

    /// The records of the displayed traces; none where what is displayed has changed meanwhile.
    fn records(&mut self, look: &ServedSnapshot) -> io::Result<Option<Vec<Capture>>> {
        let sources = look.displayed();
        let asked = TRANSFER_FIELDS.map(|word| format!("{word}?")).join(";");
        let before = self.socket.query(&format!(":DAT:{asked}"))?;
        let (found, records) = self.socket.ask_for_records(&message(&sources, &before, &asked))?;
        if found != before {
            // Another client changed the setting between the two messages.
            self.socket.send_line(&format!(":DAT:{}", restored(&found)))?;
        }
        let captures = records.iter().map(|record| self.capture(record, look));
        let captures: Option<Vec<Capture>> = captures.collect();
        Ok(captures.filter(|captures| captures.len() == sources.len()))
    }

    /// A preamble and its block are what an ISF file holds.
    fn capture(&self, record: &[u8], look: &ServedSnapshot) -> Option<Capture> {
        let mut capture = isf::read(record, &self.address).ok()?;
        // What a file does not tell and has to be guessed, the set-up tells.
        capture.notes.clear();
        look.complete(&mut capture);
        capture.instrument = Some(self.instrument.clone());
        Some(capture)
    }
}

/// Sets the transfer, asks for each record with headers as files have them, and puts the transfer back as it was.
fn message(sources: &[Source], before: &str, asked: &str) -> String {
    let records: Vec<String> =
        sources.iter().map(|source| format!(":DAT:SOU {source};:WAVF?")).collect();
    format!(
        ":DAT:{asked};ENC RIB;WID 1;STAR 1;STOP 2500;:HEAD ON;{};:HEAD OFF;:DAT:{}",
        records.join(";"),
        restored(before)
    )
}

/// The commands that set the transfer to what a query of it told.
fn restored(told: &str) -> String {
    let pairs =
        TRANSFER_FIELDS.iter().zip(told.split(';')).map(|(word, value)| format!("{word} {value}"));
    pairs.collect::<Vec<_>>().join(";")
}

/// Starts the thread that watches; it takes commands.
pub fn start(scope: ServedConnection, news: &Sender<ScreenEvent>) -> Sender<String> {
    let (orders, received) = channel();
    let news = news.clone();
    thread::spawn(move || {
        let address = scope.address.clone();
        let mut watch = ServedWorker { scope, news: news.clone(), last: None, records: None };
        let watched = guarded(|| watch.go(&received).map_err(|error| with_reasons(&error)));
        if let Err(words) = watched {
            // The screen may be closed already.
            let _ = news.send(ScreenEvent::Lost(format!("{address}: connection lost: {words}")));
        }
    });
    orders
}

struct ServedWorker {
    scope: ServedConnection,
    news: Sender<ScreenEvent>,
    last: Option<(Instant, ServedSnapshot)>,
    records: Option<Vec<Capture>>,
}

impl ServedWorker {
    /// Looks and passes commands on until the screen is gone.
    fn go(&mut self, orders: &Receiver<String>) -> io::Result<()> {
        loop {
            let mut commanded = false;
            if self.last.is_some() {
                match orders.recv_timeout(RECORD_POLL_INTERVAL) {
                    Ok(command) => {
                        self.scope.socket.send_line(&command)?;
                        for more in orders.try_iter() {
                            self.scope.socket.send_line(&more)?;
                        }
                        commanded = true;
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => return Ok(()),
                }
            }
            let Some(heard) = self.listen(commanded)? else { continue };
            if self.news.send(ScreenEvent::Heard(Box::new(heard))).is_err() {
                return Ok(());
            }
        }
    }

    /// Changes since the last call, if any.
    fn listen(&mut self, commanded: bool) -> io::Result<Option<ServedUpdate>> {
        let short = self.scope.socket.query(STATE_QUERY)?;
        let quiet = |(at, look): &(Instant, ServedSnapshot)| {
            look.short() == short && at.elapsed() < SNAPSHOT_INTERVAL
        };
        if !commanded && self.last.as_ref().is_some_and(quiet) {
            return Ok(None);
        }
        let before = self.last.take().map(|(_, look)| look);
        let mut look = self.scope.poll(short, before.as_ref())?;
        let same = before.as_ref() == Some(&look);
        let wanted = !same && look.has_records() && !look.displayed().is_empty();
        let records = if wanted { self.scope.records(&look)? } else { None };
        if wanted && records.is_none() {
            look.clear();
        }
        let new = records.filter(|records| self.records.as_ref() != Some(records));
        if let Some(records) = &new {
            self.records = Some(records.clone());
        }
        let heard = look.update(self.scope.bench, new);
        self.last = Some((Instant::now(), look));
        Ok((!same).then_some(heard))
    }
}
