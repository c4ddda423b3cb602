//! The one who owns the instrument: answers connections, lets time pass, and passes impacts in.

use std::collections::BTreeMap;
use std::future::pending;
use std::time::Duration;

use tokio::sync::mpsc;
use tokio::time::{Instant, Interval, MissedTickBehavior, interval_at};

use super::bench::{Handle, Struck};
use super::desk::{Desk, Talker};
use super::link::{Answer, News, Protocol};
use super::recorder::{Caught, Recorder};
use super::stand::Stand;
use super::{Options, ServeError};
use crate::hislip;
use crate::instrument::acquisition::State;
use crate::instrument::{Accepted, Event, Instrument};
use crate::scene::Scene;

/// How often the instrument hears that time has passed.
const TICK: Duration = Duration::from_millis(5);
/// Shortest time from one strike to the next.
const SHORTEST: Duration = Duration::from_millis(1);
/// A client that sends no more may wait so long for an answer that is still to come: it may as well be gone.
const LINGER: Duration = Duration::from_secs(60);

/// One connection as the owner knows it.
struct Link {
    protocol: Protocol,
    answers: mpsc::Sender<Answer>,
    /// Whether its last piece is still to be answered.
    asked: bool,
    /// Since when it sends no more.
    ended: Option<Instant>,
}

/// Instrument, connections, and the bench.
pub struct Owner {
    desk: Desk,
    links: BTreeMap<u64, Link>,
    hislip: hislip::Server,
    bench: Handle,
    stand: Stand,
    impact_every: Option<Duration>,
    orders: Option<mpsc::Receiver<()>>,
    switched_on: Instant,
    /// The shot that the scope triggered on last.
    caught: Option<Caught>,
}

impl Owner {
    /// Switches the instrument on, set as in the scene.
    pub fn new(scene: &Scene, options: Options, bench: Handle, recorder: Option<Recorder>) -> Self {
        let mut instrument = Instrument::of(&scene.scope, scene.seed);
        let stand = Stand::new(scene, &mut instrument);
        Self {
            desk: Desk::new(instrument, options.header, recorder),
            links: BTreeMap::new(),
            hislip: hislip::Server::default(),
            bench,
            stand,
            impact_every: options.impact_every,
            orders: options.strikes,
            caught: None,
            switched_on: Instant::now(),
        }
    }

    /// Works until there is nobody left who could connect.
    ///
    /// # Errors
    /// [`ServeError`] where the bench or the recording fails.
    pub async fn run(&mut self, mut news: mpsc::Receiver<News>) -> Result<(), ServeError> {
        let mut ticks = every(TICK);
        let mut strikes = self.impact_every.map(every);
        let mut orders = self.orders.take();
        loop {
            tokio::select! {
                heard = news.recv() => {
                    let Some(heard) = heard else { return Ok(()) };
                    self.pass_time();
                    self.hear(heard);
                }
                struck = self.bench.struck() => {
                    let struck = struck?;
                    self.pass_time();
                    self.feel(struck)?;
                }
                () = tick(strikes.as_mut()) => {
                    self.strike();
                }
                () = order(orders.as_mut()) => {
                    self.desk.instrument.bench.ask_for_impact();
                }
                _ = ticks.tick() => {}
            }
            self.pass_time();
            self.resume();
            self.strike_if_asked();
            self.keep_up()?;
        }
    }

    /// Ends the recording, if there is one.
    ///
    /// # Errors
    /// [`ServeError::Record`] where it could not be written.
    pub fn finish(self) -> Result<(), ServeError> {
        self.desk.recorder.map_or(Ok(()), Recorder::finish)
    }

    fn pass_time(&mut self) {
        let now = self.switched_on.elapsed().as_secs_f64();
        self.desk.instrument.advance(now);
        self.hislip.advance(now, &mut self.desk);
    }

    fn hear(&mut self, news: News) {
        match news {
            News::Opened { number, protocol, peer, answers } => {
                self.desk.peers.insert(number, peer);
                self.links.insert(number, Link { protocol, answers, asked: false, ended: None });
                match protocol {
                    Protocol::Raw => self.desk.sit(Talker::Raw(number), number),
                    Protocol::Hislip => self.hislip.opened(number),
                }
            }
            News::Bytes { number, bytes } => {
                let Some(link) = self.links.get_mut(&number) else { return };
                link.asked = true;
                match link.protocol {
                    Protocol::Raw => {
                        let reply = self.desk.receive(Talker::Raw(number), &bytes, false);
                        self.send(number, reply);
                    }
                    Protocol::Hislip => self.hislip.received(number, &bytes, &mut self.desk),
                }
            }
            News::Ended { number } => {
                let waits = self.desk.is_waiting(Talker::Raw(number));
                match self.links.get_mut(&number) {
                    Some(link) if waits => link.ended = Some(Instant::now()),
                    _ => self.forget(number),
                }
            }
            News::Closed { number } => self.forget(number),
        }
        self.stand.settle(&mut self.desk.instrument);
    }

    /// Hands over what a strike brought.
    fn feel(&mut self, struck: Struck) -> Result<(), ServeError> {
        let Struck { shot, scene, wanted, signals } = struck;
        let instrument = &mut self.desk.instrument;
        match signals {
            Ok((signals, truth)) => {
                instrument.bench.impacts = instrument.bench.impacts.saturating_add(1);
                // The time base was turned during the impact: the acquisition has started again without it, as on an instrument.
                if wanted != instrument.wanted() {
                    return Ok(());
                }
                let accepted = instrument.accept_signals(&signals);
                if matches!(accepted, Accepted::Triggered { .. }) {
                    let is_served = self.stand.is_served(&scene);
                    self.caught = Some(Caught { shot, truth, scene, is_served });
                }
                Ok(())
            }
            Err(reason) if self.stand.is_as_served() => Err(ServeError::Impact { shot, reason }),
            // What clients have set up is theirs to put right, and ends nobody's work.
            Err(_) => {
                instrument.status.report(Event::SystemError);
                Ok(())
            }
        }
    }

    fn strike(&mut self) -> bool {
        self.bench.strike(&self.stand.scene, self.desk.instrument.wanted())
    }

    /// Strikes as clients ask for, when the scope can see it.
    fn strike_if_asked(&mut self) {
        let instrument = &self.desk.instrument;
        let is_blind = matches!(instrument.state(), State::Armed | State::Trigger);
        if instrument.bench.asked > 0 && !is_blind && self.strike() {
            self.desk.instrument.bench.asked -= 1;
        }
    }

    /// Goes on with what waited: replies, messages behind a lock, clients that only listen.
    fn resume(&mut self) {
        for (talker, bytes) in self.desk.resume() {
            match talker {
                Talker::Raw(number) => self.say(number, bytes, false),
                Talker::Hislip(session) => self.hislip.reply(session, &bytes),
            }
        }
        for output in self.hislip.take_output() {
            self.say(output.connection, output.bytes, false);
            if output.close {
                self.links.remove(&output.connection);
                self.desk.peers.remove(&output.connection);
            }
        }
        let mut done = Vec::new();
        for (number, link) in &mut self.links {
            if link.asked && !self.hislip.is_held(*number) {
                link.asked = false;
                if link.answers.try_send(Answer { bytes: Vec::new(), to_piece: true }).is_err() {
                    done.push(*number);
                }
            }
            if let Some(since) = link.ended {
                let waits = self.desk.is_waiting(Talker::Raw(*number));
                if !waits || since.elapsed() > LINGER {
                    done.push(*number);
                }
            }
        }
        for number in done {
            self.forget(number);
        }
    }

    /// Answers a connection's piece.
    fn send(&mut self, number: u64, bytes: Vec<u8>) {
        if let Some(link) = self.links.get_mut(&number) {
            link.asked = false;
        }
        self.say(number, bytes, true);
    }

    /// Sends; a connection that cannot take it does not read what it asked for, and is dropped.
    fn say(&mut self, number: u64, bytes: Vec<u8>, to_piece: bool) {
        let Some(link) = self.links.get(&number) else { return };
        let nothing = bytes.is_empty() && !to_piece;
        if !nothing && link.answers.try_send(Answer { bytes, to_piece }).is_err() {
            self.forget(number);
        }
    }

    fn forget(&mut self, number: u64) {
        self.links.remove(&number);
        self.desk.peers.remove(&number);
        self.desk.leave(Talker::Raw(number));
        self.hislip.closed(number, &mut self.desk);
    }

    fn keep_up(&mut self) -> Result<(), ServeError> {
        let finished = self.desk.instrument.take_finished();
        let Some(recorder) = &mut self.desk.recorder else { return Ok(()) };
        if let Some(finished) = finished {
            let caught = self
                .caught
                .take_if(|caught| finished.trigger.is_some_and(|t| t.shot == caught.shot));
            recorder.captures(finished, caught, &mut self.desk.instrument);
        }
        recorder.keep_up()
    }
}

fn every(period: Duration) -> Interval {
    let period = period.max(SHORTEST);
    let mut ticks = interval_at(Instant::now() + period, period);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    ticks
}

/// The next strike that somebody beside the bench asks for; never where nobody does any more.
async fn order(orders: Option<&mut mpsc::Receiver<()>>) {
    if let Some(orders) = orders
        && orders.recv().await.is_some()
    {
        return;
    }
    pending::<()>().await;
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
