//! Watches a scope that is served somewhere else, over its raw socket, and passes on what is turned
//! on the screen.
//!
//! A few short queries ten times a second tell whether there is anything new; only then set-up and
//! records are asked for. The settings of the transfer (`DATa`) are everybody's: they are set, used
//! and put back within one message, which the instrument carries out as a whole, so that no other
//! client reads a curve that it did not ask for.

mod snapshot;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use super::{ScreenEvent, guarded, with_reasons};
use crate::client::{
    Address, Client, ClientTiming, PLAIN_REPLIES, ReplyForm, ShotRecorder, capture, identity,
    records, wall_clock_time,
};
use crate::recording::mcap::{ShotNotes, WriteError};
use crate::recording::set_file::SetFile;
use crate::recording::{Capture, InstrumentIdentity, Shot, TraceSet};
use crate::scope::Model;
use crate::tui::model::served::ServedUpdate;
use snapshot::ServedSnapshot;

/// How often it is asked whether there is something new.
const RECORD_POLL_INTERVAL: Duration = Duration::from_millis(100);
/// How often it is asked for everything, since another client may have turned something.
const SNAPSHOT_INTERVAL: Duration = Duration::from_secs(1);
/// Query for a new record.
const STATE_QUERY: &str = ":ACQ:NUMAC?;STATE?;STOPA?;:TRIG:STATE?";

/// A connection to a served scope, or to a real one.
pub struct ServedConnection {
    client: Client,
    instrument: InstrumentIdentity,
    model: Model,
    /// The form that replies had before.
    form: ReplyForm,
    /// Whether a bench stands behind it that can be struck.
    bench: bool,
    recorder: Option<ShotRecorder>,
}

impl ServedConnection {
    /// Connects to `address` and asks who is there.
    ///
    /// # Errors
    /// A message for the user: no connection, or no oscilloscope of this family.
    pub fn connect(address: &Address) -> Result<Self, String> {
        let failed = |error: io::Error| format!("{address}: {error}");
        let timeout = ClientTiming::default().reply_timeout;
        let mut client = Client::connect(address, timeout).map_err(failed)?;
        let reply = client.ask("*IDN?").map_err(|error| {
            format!("{address}: found no answer to *IDN? ({error}), expected an oscilloscope")
        })?;
        let instrument = identity(&reply).map_err(|problem| format!("{address}: {problem}"))?;
        let model = snapshot::model(&instrument)
            .ok_or_else(|| format!("{address}: no oscilloscope ships with this program"))?;
        let form = ReplyForm::replace(&mut client).map_err(failed)?;
        let bench = has_bench(&mut client).map_err(failed)?;
        Ok(Self { client, instrument, model, form, bench, recorder: None })
    }

    /// Records what is shown in `file` or, if that exists, by the next free number; its name.
    ///
    /// # Errors
    /// [`WriteError`] where the file cannot be written.
    pub fn record(&mut self, file: &Path) -> Result<PathBuf, WriteError> {
        let recorder = ShotRecorder::create(file, self.client.address(), &self.instrument)?;
        let file = recorder.file().to_owned();
        self.recorder = Some(recorder);
        Ok(file)
    }

    /// Everything but the records.
    fn poll(
        &mut self,
        short: String,
        before: Option<&ServedSnapshot>,
    ) -> io::Result<ServedSnapshot> {
        let panel = self.client.ask("SET?")?;
        let name = self.client.address().to_string();
        let file = SetFile::read(panel.as_bytes(), &name).map_err(io::Error::other)?;
        let mut look = ServedSnapshot::new((short, panel), file, self.model.clone());
        if self.bench {
            let named = self.client.ask(":BENC:IMP?;SCEN?")?;
            look.on_bench(&named, before);
            if let Some(query) = look.knobs_query() {
                let knobs = self.client.ask(&query)?;
                look.turned(&knobs);
            }
        }
        Ok(look)
    }

    /// The records of the displayed traces; none where what is displayed has changed meanwhile.
    fn records(&mut self, look: &ServedSnapshot) -> io::Result<Option<Vec<Capture>>> {
        let sources = look.displayed();
        // In one message: another acquisition may be taken between two.
        let found = records(&mut self.client, &sources)?;
        let captures = found.iter().map(|record| capture(record, look.panel(), &self.instrument));
        let captures: Option<Vec<Capture>> = captures.map(Result::ok).collect();
        Ok(captures.filter(|captures| captures.len() == sources.len()))
    }
}

/// Whether a bench stands behind the scope. Only a socket may have one; a scope without one answers
/// the second query alone, or nothing.
fn has_bench(client: &mut Client) -> io::Result<bool> {
    if !matches!(client.address(), Address::Socket(_)) {
        return Ok(false);
    }
    match client.ask(":BENC:IMP?;:HEAD?") {
        Ok(reply) => Ok(reply.contains(';')),
        Err(error) if error.kind() == io::ErrorKind::TimedOut => {
            client.reconnect()?;
            client.send(PLAIN_REPLIES)?;
            Ok(false)
        }
        Err(error) => Err(error),
    }
}

/// Starts the thread that watches; it takes commands, and ends when their sender is dropped.
pub fn start(
    scope: ServedConnection,
    news: &Sender<ScreenEvent>,
) -> (Sender<String>, JoinHandle<()>) {
    let (orders, received) = channel();
    let news = news.clone();
    let thread = thread::spawn(move || {
        let address = scope.client.address().clone();
        let mut watch =
            ServedWorker { scope, news: news.clone(), last: None, records: None, shots: 0 };
        let watched = guarded(|| watch.go(&received).map_err(|error| with_reasons(&error)));
        // The screen may be closed already, and the line gone.
        let _ = match watched {
            Ok(()) => watch.scope.client.send(&watch.scope.form.commands()).ok(),
            Err(words) => {
                let lost = format!("{address}: connection lost: {words}");
                news.send(ScreenEvent::Lost(lost)).ok()
            }
        };
        if let Some(Err(error)) = watch.scope.recorder.take().map(ShotRecorder::finish) {
            let _ = news.send(ScreenEvent::Told(with_reasons(&error)));
        }
    });
    (orders, thread)
}

struct ServedWorker {
    scope: ServedConnection,
    news: Sender<ScreenEvent>,
    last: Option<(Instant, ServedSnapshot)>,
    records: Option<Vec<Capture>>,
    /// How many were recorded.
    shots: u32,
}

impl ServedWorker {
    /// Looks and passes commands on until the screen is gone.
    fn go(&mut self, orders: &Receiver<String>) -> io::Result<()> {
        loop {
            let mut commanded = false;
            if self.last.is_some() {
                match orders.recv_timeout(RECORD_POLL_INTERVAL) {
                    Ok(command) => {
                        self.scope.client.send(&command)?;
                        for more in orders.try_iter() {
                            self.scope.client.send(&more)?;
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
        let short = self.scope.client.ask(STATE_QUERY)?;
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
        if let Some(set) = &heard.set {
            self.record(set, look.set_up());
        }
        self.last = Some((Instant::now(), look));
        Ok((!same).then_some(heard))
    }

    /// Adds what is shown to the recording; one that cannot be written ends, and the screen goes
    /// on.
    fn record(&mut self, set: &TraceSet, set_up: &str) {
        let (Some(recorder), Some(shot)) = (&mut self.scope.recorder, set.shots.first()) else {
            return;
        };
        self.shots += 1;
        let number = self.shots;
        let mut line = format!("shot {number}: shown on the screen");
        if !self.scope.bench {
            line.push_str("; if the scope ran on, channels may be of different triggers");
        }
        let notes = ShotNotes { set_up: set_up.to_owned(), energy: None, log: vec![(false, line)] };
        let shot = Shot { number, timestamp_ns: wall_clock_time(), ..shot.clone() };
        if let Err(error) = recorder.add(&shot, &notes) {
            self.scope.recorder = None;
            let words = format!("the recording has ended: {}", with_reasons(&error));
            let _ = self.news.send(ScreenEvent::Told(words));
        }
    }
}
