//! The task that owns the instrument: answers connections, advances time, and delivers the signals
//! of impacts.

use std::collections::{BTreeMap, VecDeque};
use std::future::pending;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::time::Duration;

use tokio::sync::mpsc;
use tokio::time::{Instant, Interval, MissedTickBehavior, interval_at};

use super::bench_state::BenchState;
use super::bench_thread::{BenchHandle, GroundTruth, StrikeSignals};
use super::connection::{ConnectionEvent, OutgoingBytes, Protocol};
use super::log::Log;
use super::recorder::{Recorder, TriggeredShot};
use super::sessions::{SessionId, Sessions};
use super::{ServeError, ServerOptions};
use crate::hislip;
use crate::instrument::acquisition::State;
use crate::instrument::{Accepted, Event, Instrument};
use crate::recording::TrueSignal;
use crate::scene::Scene;
use crate::vxi11;

/// Period at which the instrument is told the time.
const TICK: Duration = Duration::from_millis(5);
/// Shortest time from one strike to the next.
const MIN_STRIKE_INTERVAL: Duration = Duration::from_millis(1);
/// How often records are made of the same signals when settings change meanwhile, before the
/// signals are dropped.
const MAX_ATTEMPTS: u32 = 5;
/// Time without a byte after which a connection gives way to another one where there is no room.
const IDLE_TIME: Duration = Duration::from_secs(1);
/// Time after which a connection that is closed for sending is dropped although an answer is
/// pending.
const HALF_CLOSED_TIMEOUT: Duration = Duration::from_secs(60);

/// The state of one connection.
struct ConnectionEntry {
    protocol: Protocol,
    answers: mpsc::Sender<OutgoingBytes>,
    /// Whether its last piece is still to be answered.
    reply_pending: bool,
    /// When bytes came last.
    last_received: Instant,
    /// Since when it sends no more.
    ended: Option<Instant>,
}

/// What is left of a piece of input from a raw connection.
struct RawPiece {
    number: u64,
    bytes: Vec<u8>,
    /// The reply so far.
    reply: Vec<u8>,
}

/// Instrument, connections, and the bench.
pub struct InstrumentTask {
    sessions: Sessions,
    connections: BTreeMap<u64, ConnectionEntry>,
    hislip: hislip::Server,
    vxi11: vxi11::Vxi11Server,
    /// Input of raw connections that is to be executed, a message at a turn.
    pieces: VecDeque<RawPiece>,
    bench: BenchHandle,
    bench_state: BenchState,
    impact_every: Option<Duration>,
    strike_requests: Option<mpsc::Receiver<()>>,
    switched_on: Instant,
    /// The shot that the scope triggered on last.
    triggered_shot: Option<TriggeredShot>,
}

impl InstrumentTask {
    /// Switches the instrument on, set as in the scene; VXI-11 is spoken on `port`.
    ///
    /// # Errors
    /// The system's error if the log's thread cannot be started.
    pub fn new(
        scene: &Scene,
        (options, port): (ServerOptions, u16),
        bench: BenchHandle,
        recorder: Option<Recorder>,
    ) -> io::Result<Self> {
        let mut instrument = Instrument::of(&scene.scope, scene.seed);
        let bench_state = BenchState::new(scene, &mut instrument);
        for fault in options.faults {
            instrument.bench.faults.add(fault);
        }
        let warn = options.warn.unwrap_or(|_| ());
        let behaviour = (options.header, scene.seed);
        instrument.bench.access = options.access;
        let log = Log::start(options.log, options.size_limit, warn)?;
        Ok(Self {
            sessions: Sessions::new(instrument, behaviour, recorder, log),
            connections: BTreeMap::new(),
            hislip: hislip::Server::default(),
            vxi11: vxi11::Vxi11Server::new(port),
            pieces: VecDeque::new(),
            bench,
            bench_state,
            impact_every: options.impact_every,
            strike_requests: options.strikes,
            triggered_shot: None,
            switched_on: Instant::now(),
        })
    }

    /// Runs until no connection can be opened any more.
    ///
    /// # Errors
    /// [`ServeError`] where the bench fails. [`Self::finish`] returns the error of a recording.
    pub async fn run(
        &mut self,
        mut events: mpsc::Receiver<ConnectionEvent>,
    ) -> Result<(), ServeError> {
        let mut ticks = every(TICK);
        let mut strikes = self.impact_every.map(every);
        let mut strike_requests = self.strike_requests.take();
        loop {
            tokio::select! {
                event = events.recv() => {
                    let Some(event) = event else { return Ok(()) };
                    self.advance_time();
                    self.handle_event(event);
                }
                signals = self.bench.signals() => {
                    let signals = signals?;
                    self.advance_time();
                    self.deliver_signals(signals)?;
                }
                () = tick(strikes.as_mut()) => {
                    self.strike();
                }
                () = strike_request(strike_requests.as_mut()) => {
                    self.sessions.instrument.bench.ask_for_impact();
                }
                // Lets the connections' tasks go on between two messages.
                () = tokio::task::yield_now(), if !self.pieces.is_empty() => {
                    self.advance_time();
                    self.execute_message();
                }
                _ = ticks.tick() => {}
            }
            self.advance_time();
            self.write_finished_records().await;
            self.resume();
            self.start_queued_strike();
        }
    }

    /// Ends the log and the recording, if there are any.
    ///
    /// # Errors
    /// [`ServeError`] if the recording could not be written or finished.
    pub async fn finish(self) -> Result<(), ServeError> {
        self.sessions.log.finish().await;
        match self.sessions.recorder {
            Some(recorder) => recorder.finish().await,
            None => Ok(()),
        }
    }

    fn advance_time(&mut self) {
        let now = self.switched_on.elapsed().as_secs_f64();
        self.sessions.instrument.advance(now);
        self.hislip.advance(now, &mut self.sessions);
        self.vxi11.advance(now, &mut self.sessions);
    }

    fn handle_event(&mut self, event: ConnectionEvent) {
        match event {
            ConnectionEvent::Opened { number, protocol, peer, answers } => {
                self.sessions.peers.insert(number, peer);
                self.connections.insert(
                    number,
                    ConnectionEntry {
                        protocol,
                        answers,
                        reply_pending: false,
                        last_received: Instant::now(),
                        ended: None,
                    },
                );
                match protocol {
                    Protocol::Raw => self.sessions.open_session(SessionId::Raw(number), number),
                    Protocol::Hislip => self.hislip.opened(number),
                    Protocol::Vxi11 => self.vxi11.opened(number),
                }
            }
            ConnectionEvent::Bytes { number, bytes } => {
                let Some(connection) = self.connections.get_mut(&number) else { return };
                connection.reply_pending = true;
                // Ends of lines alone keep no connection.
                if connection.protocol != Protocol::Raw || !bytes.trim_ascii().is_empty() {
                    connection.last_received = Instant::now();
                }
                match connection.protocol {
                    Protocol::Raw => {
                        connection.reply_pending = false;
                        self.pieces.push_back(RawPiece { number, bytes, reply: Vec::new() });
                    }
                    Protocol::Hislip => self.hislip.received(number, &bytes, &mut self.sessions),
                    Protocol::Vxi11 => self.vxi11.received(number, &bytes, &mut self.sessions),
                }
            }
            ConnectionEvent::Ended { number } => {
                let waits = self.sessions.is_waiting(SessionId::Raw(number));
                match self.connections.get_mut(&number) {
                    Some(connection) if waits => connection.ended = Some(Instant::now()),
                    _ => self.drop_connection(number),
                }
            }
            ConnectionEvent::Crowded { peer, gave_way } => {
                let idle = self.longest_idle(peer);
                if let Some(number) = idle {
                    self.drop_connection(number);
                }
                // Whoever asked has gone where this fails, and with it the connection that waits.
                let _ = gave_way.send(idle.is_some());
            }
            ConnectionEvent::Closed { number } => self.drop_connection(number),
        }
        self.bench_state.apply_changes(&mut self.sessions.instrument);
    }

    /// Executes one message of the connection whose turn it is: a connection that sends many has to
    /// wait for the others between them.
    fn execute_message(&mut self) {
        let Some(RawPiece { number, mut bytes, mut reply }) = self.pieces.pop_front() else {
            return;
        };
        if !self.connections.contains_key(&number) {
            return;
        }
        let end = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let rest = bytes.split_off(end.map_or(bytes.len(), |end| end + 1));
        let id = SessionId::Raw(number);
        reply.extend(self.sessions.receive(id, &bytes, false));
        self.bench_state.apply_changes(&mut self.sessions.instrument);
        if rest.is_empty() {
            return self.send(number, reply);
        }
        // What comes when an acquisition ends must not overtake what is there already.
        if self.sessions.is_waiting(id) {
            self.send_bytes(number, std::mem::take(&mut reply), false);
        }
        self.pieces.push_back(RawPiece { number, bytes: rest, reply });
    }

    /// Delivers the signals of one impact to the instrument.
    fn deliver_signals(&mut self, strike: StrikeSignals) -> Result<(), ServeError> {
        let StrikeSignals { shot, scene, wanted, signals, is_hidden, mut prepared, attempts } =
            strike;
        let instrument = &mut self.sessions.instrument;
        match signals {
            Ok((signals, truth)) => {
                if attempts == 1 {
                    keep_forces(&scene, &truth, instrument);
                    self.sessions.log.line("bench", &format!("impact {shot}"));
                }
                if is_hidden {
                    return Ok(());
                }
                // The time base was turned during the impact: the acquisition has started again
                // without it, as on an instrument.
                if wanted != instrument.sample_window() {
                    return Ok(());
                }
                let records = prepared.take();
                let accepted = records.and_then(|r| instrument.accept_prepared(&signals, r));
                let Some(accepted) = accepted else {
                    // Another knob was turned: the same signals are recorded as it stands now.
                    if attempts < MAX_ATTEMPTS {
                        let signals = Ok((signals, truth));
                        let again = StrikeSignals {
                            shot,
                            scene,
                            wanted,
                            signals,
                            is_hidden,
                            prepared,
                            attempts,
                        };
                        self.bench.prepare_again(again, instrument);
                    }
                    return Ok(());
                };
                if matches!(accepted, Accepted::Triggered { .. }) {
                    instrument.bench.triggered_at =
                        instrument.trigger_time().map(|t| truth.start + t);
                    let is_served = self.bench_state.is_served(&scene);
                    self.triggered_shot = Some(TriggeredShot { shot, truth, scene, is_served });
                }
                Ok(())
            }
            Err(reason) if self.bench_state.is_as_served() => {
                Err(ServeError::Impact { shot, reason })
            }
            // A set-up that cannot be struck is the clients' to correct; the server goes on.
            Err(_) => {
                instrument.status.report(Event::SystemError);
                Ok(())
            }
        }
    }

    /// The connection, of this peer if one is given, that has been idle for longest, if any is. One
    /// whose reply waits for an acquisition is not; the two of a HiSLIP session are idle together.
    fn longest_idle(&self, peer: Option<IpAddr>) -> Option<u64> {
        let last_received = |number: u64| {
            let own = self.connections.get(&number).map(|connection| connection.last_received);
            let other = self.hislip.partner(number);
            own.max(other.and_then(|n| self.connections.get(&n)).map(|other| other.last_received))
        };
        let is_of_peer = |number: u64| {
            let address = self.sessions.peers.get(&number).map(SocketAddr::ip);
            peer.is_none() || address == peer
        };
        let is_free = |number: u64, connection: &ConnectionEntry| {
            is_of_peer(number)
                && !connection.reply_pending
                && !self.hislip.is_waiting(number, &self.sessions)
                && !self.vxi11.is_waiting(number, &self.sessions)
                && !self.sessions.is_waiting(SessionId::Raw(number))
        };
        let free = self.connections.iter().filter(|(number, entry)| is_free(**number, entry));
        let times = free.filter_map(|(number, _)| Some((last_received(*number)?, *number)));
        let idle = times.filter(|(last_received, _)| last_received.elapsed() >= IDLE_TIME);
        idle.min().map(|(_, number)| number)
    }

    fn strike(&mut self) -> bool {
        let instrument = &mut self.sessions.instrument;
        let is_struck = self.bench.strike(&self.bench_state.scene, instrument);
        if is_struck {
            instrument.bench.faults.count_impact();
        }
        is_struck
    }

    /// Strikes as clients ask for, when the scope can see it.
    fn start_queued_strike(&mut self) {
        let instrument = &self.sessions.instrument;
        let is_blind = matches!(instrument.state(), State::Armed | State::Trigger);
        if instrument.bench.asked > 0 && !is_blind && self.strike() {
            self.sessions.instrument.bench.asked -= 1;
        }
    }

    /// Goes on with what waited: replies, messages behind a lock, clients that only listen.
    fn resume(&mut self) {
        for (id, bytes) in self.sessions.resume() {
            match id {
                SessionId::Raw(number) => self.send_bytes(number, bytes, false),
                SessionId::Lan(session) => {
                    self.hislip.reply(session, &bytes);
                    self.vxi11.reply(session, &bytes);
                }
            }
        }
        self.vxi11.settle(&mut self.sessions);
        let outputs = self.hislip.take_output().into_iter().chain(self.vxi11.take_output());
        for output in outputs.collect::<Vec<_>>() {
            self.send_bytes(output.connection, output.bytes, false);
            if output.close {
                self.connections.remove(&output.connection);
                self.sessions.peers.remove(&output.connection);
            }
        }
        let mut done = Vec::new();
        for (number, connection) in &mut self.connections {
            if connection.reply_pending && !self.hislip.is_held(*number) {
                connection.reply_pending = false;
                if connection
                    .answers
                    .try_send(OutgoingBytes { bytes: Vec::new(), to_piece: true })
                    .is_err()
                {
                    done.push(*number);
                }
            }
            if let Some(since) = connection.ended {
                let waits = self.sessions.is_waiting(SessionId::Raw(*number));
                if !waits || since.elapsed() > HALF_CLOSED_TIMEOUT {
                    done.push(*number);
                }
            }
        }
        for number in done {
            self.drop_connection(number);
        }
    }

    /// Sends the answer to a connection's last piece of input.
    fn send(&mut self, number: u64, bytes: Vec<u8>) {
        if let Some(connection) = self.connections.get_mut(&number) {
            connection.reply_pending = false;
        }
        self.send_bytes(number, bytes, true);
    }

    /// Sends bytes; drops a connection whose queue of answers is full, since its client does not
    /// read.
    fn send_bytes(&mut self, number: u64, mut bytes: Vec<u8>, to_piece: bool) {
        let Some(connection) = self.connections.get(&number) else { return };
        let mut drops = false;
        if let Some(left) = self.sessions.drops.get_mut(&number) {
            drops = bytes.len() >= *left;
            bytes.truncate(*left);
            *left -= bytes.len();
        }
        let nothing = bytes.is_empty() && !to_piece;
        let sent =
            nothing || connection.answers.try_send(OutgoingBytes { bytes, to_piece }).is_ok();
        if drops || !sent {
            self.drop_connection(number);
        }
    }

    fn drop_connection(&mut self, number: u64) {
        self.connections.remove(&number);
        self.sessions.close_session(SessionId::Raw(number));
        self.hislip.closed(number, &mut self.sessions);
        self.vxi11.closed(number, &mut self.sessions);
        self.sessions.peers.remove(&number);
        self.sessions.drops.remove(&number);
    }

    /// Records an acquisition that has ended, and waits until it is written, before any client is
    /// told of it.
    async fn write_finished_records(&mut self) {
        let finished = self.sessions.instrument.take_finished();
        self.sessions.log.keep_pace().await;
        let Some(recorder) = &mut self.sessions.recorder else { return };
        match finished {
            Some(finished) => {
                let triggered_shot = self.triggered_shot.take_if(|triggered_shot| {
                    finished.trigger.is_some_and(|t| t.shot == triggered_shot.shot)
                });
                recorder.add_acquisition(finished, triggered_shot, &mut self.sessions.instrument);
                recorder.drain().await;
            }
            None => recorder.keep_pace().await,
        }
    }
}

/// Keeps an impact's true forces for clients that ask.
fn keep_forces(scene: &Scene, truth: &GroundTruth, instrument: &mut Instrument) {
    let force_at = |sensor: &String| {
        let signal = Some(TrueSignal::Force(sensor.clone()));
        truth.traces.iter().find(|trace| TrueSignal::of(trace) == signal).cloned()
    };
    let channels = scene.scope.channels.iter();
    let bench = &mut instrument.bench;
    bench.forces = channels.map(|c| force_at(c.as_ref()?.input.as_ref()?)).collect();
    bench.triggered_at = None;
    bench.impacts = bench.impacts.saturating_add(1);
}

fn every(period: Duration) -> Interval {
    let period = period.max(MIN_STRIKE_INTERVAL);
    let mut ticks = interval_at(Instant::now() + period, period);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    ticks
}

/// The next strike requested at the bench; pending for ever once the sender is closed.
async fn strike_request(strike_requests: Option<&mut mpsc::Receiver<()>>) {
    if let Some(strike_requests) = strike_requests
        && strike_requests.recv().await.is_some()
    {
        return;
    }
    pending::<()>().await;
}

/// The time of the next timed strike; pending for ever without an interval.
async fn tick(strikes: Option<&mut Interval>) {
    match strikes {
        Some(strikes) => {
            strikes.tick().await;
        }
        None => pending().await,
    }
}
