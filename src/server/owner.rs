//! The one who owns the instrument: answers connections, lets time pass, and passes impacts in.

use std::collections::BTreeMap;
use std::future::pending;
use std::time::Duration;

use tokio::sync::mpsc;
use tokio::time::{Instant, Interval, MissedTickBehavior, interval_at};

use super::bench::Handle;
use super::link::{Answer, News};
use super::{Options, ServeError};
use crate::instrument::Instrument;
use crate::scene::Scene;
use crate::scpi::{Preferences, Reply, Session};

/// How often the instrument hears that time has passed.
const TICK: Duration = Duration::from_millis(5);
/// Shortest time from one strike to the next.
const SHORTEST: Duration = Duration::from_millis(1);

/// One connection as the owner knows it.
struct Client {
    session: Session,
    answers: mpsc::Sender<Answer>,
}

/// Instrument, connections, and the bench.
pub struct Owner {
    instrument: Instrument,
    clients: BTreeMap<u64, Client>,
    bench: Handle,
    options: Options,
    switched_on: Instant,
}

impl Owner {
    /// Switches the instrument on, set as in the scene.
    pub fn new(scene: &Scene, options: Options, bench: Handle) -> Self {
        let instrument = Instrument::of(&scene.scope, scene.seed);
        let switched_on = Instant::now();
        Self { instrument, clients: BTreeMap::new(), bench, options, switched_on }
    }

    /// Works until there is nobody left who could connect.
    ///
    /// # Errors
    /// [`ServeError`] where the bench fails.
    pub async fn run(mut self, mut news: mpsc::Receiver<News>) -> Result<(), ServeError> {
        let mut ticks = every(TICK);
        let mut strikes = self.options.impact_every.map(every);
        loop {
            tokio::select! {
                heard = news.recv() => {
                    let Some(heard) = heard else { return Ok(()) };
                    self.pass_time();
                    self.hear(heard);
                }
                signals = self.bench.signals() => {
                    let signals = signals?;
                    self.pass_time();
                    self.instrument.accept_signals(&signals);
                }
                () = tick(strikes.as_mut()) => self.bench.strike(self.instrument.wanted()),
                _ = ticks.tick() => {}
            }
            self.pass_time();
            self.resume();
        }
    }

    fn pass_time(&mut self) {
        self.instrument.advance(self.switched_on.elapsed().as_secs_f64());
    }

    fn hear(&mut self, news: News) {
        match news {
            News::Opened { number, answers } => {
                let session = Session::new(Preferences::new(self.options.header));
                self.clients.insert(number, Client { session, answers });
            }
            News::Bytes { number, bytes } => {
                let Some(client) = self.clients.get_mut(&number) else { return };
                let reply = client.session.receive(&mut self.instrument, &bytes);
                if !client.send(reply, true) {
                    self.clients.remove(&number);
                }
            }
            News::Closed { number } => {
                self.clients.remove(&number);
            }
        }
    }

    /// Goes on with what waited for the end of an acquisition.
    fn resume(&mut self) {
        let instrument = &mut self.instrument;
        self.clients.retain(|_, client| {
            if !client.session.is_waiting() {
                return true;
            }
            let reply = client.session.resume(instrument);
            client.send(reply, false)
        });
    }
}

impl Client {
    /// Whether the connection can take the reply. One that cannot does not read what it asked for.
    fn send(&self, reply: Reply, to_piece: bool) -> bool {
        let bytes = match reply {
            Reply::None => Vec::new(),
            Reply::Now(bytes) | Reply::WhenIdle(bytes) => bytes,
        };
        let nothing = bytes.is_empty() && !to_piece;
        nothing || self.answers.try_send(Answer { bytes, to_piece }).is_ok()
    }
}

fn every(period: Duration) -> Interval {
    let period = period.max(SHORTEST);
    let mut ticks = interval_at(Instant::now() + period, period);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    ticks
}

/// The next strike's time; never where nobody strikes.
async fn tick(strikes: Option<&mut Interval>) {
    match strikes {
        Some(strikes) => {
            strikes.tick().await;
        }
        None => pending().await,
    }
}
