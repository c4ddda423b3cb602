//! The task that owns the instrument: executes requests, advances time, and delivers the signals of
//! impacts.

use std::future::pending;
use std::io;
use std::time::Duration;

use tokio::sync::mpsc;
use tokio::time::{Instant, Interval, MissedTickBehavior, interval_at};

use super::bench_state::BenchState;
use super::bench_thread::{BenchHandle, GroundTruth, StrikeSignals};
use super::log::Log;
use super::network::Inbox;
use super::recorder::{Recorder, TriggeredShot};
use super::sessions::Sessions;
use super::{ServeError, ServerOptions};
use crate::instrument::acquisition::State;
use crate::instrument::{Accepted, Event, Instrument};
use crate::recording::TrueSignal;
use crate::scene::Scene;

/// Period at which the instrument's time advances.
const TICK: Duration = Duration::from_millis(5);
/// Shortest time from one strike to the next.
const MIN_STRIKE_INTERVAL: Duration = Duration::from_millis(1);
/// How often records are made of the same signals on the bench's thread when settings change
/// meanwhile; then they are made at once.
const MAX_ATTEMPTS: u32 = 5;
/// Instrument, sessions, and the bench.
pub struct InstrumentTask {
    inbox: Inbox,
    sessions: Sessions,
    bench: BenchHandle,
    bench_state: BenchState,
    impact_every: Option<Duration>,
    strike_requests: Option<mpsc::Receiver<()>>,
    switched_on: Instant,
    /// The shot that the scope triggered on last.
    triggered_shot: Option<TriggeredShot>,
}

impl InstrumentTask {
    /// Switches the instrument on, set as in the scene.
    ///
    /// # Errors
    /// The system's error if the log's thread cannot be started.
    pub fn new(
        scene: &Scene,
        options: ServerOptions,
        bench: BenchHandle,
        recorder: Option<Recorder>,
        inbox: Inbox,
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
            inbox,
            sessions: Sessions::new(instrument, behaviour, recorder, log),
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
    pub async fn run(&mut self) -> Result<(), ServeError> {
        let mut ticks = every(TICK);
        let mut strikes = self.impact_every.map(every);
        let mut strike_requests = self.strike_requests.take();
        loop {
            tokio::select! {
                request = self.inbox.requests.recv() => {
                    let Some(request) = request else { return Ok(()) };
                    self.advance_time();
                    self.write_finished_records().await;
                    self.sessions.execute(request);
                    self.publish_status();
                    self.bench_state.apply_changes(&mut self.sessions.instrument);
                }
                // A scope that was set during an impact first fills its record before the trigger.
                signals = self.bench.signals(), if !self.is_arming() => {
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
                _ = ticks.tick() => {}
            }
            self.advance_time();
            self.write_finished_records().await;
            self.sessions.resume();
            self.publish_status();
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
    }

    /// Publishes the status byte, which connections report to their clients.
    fn publish_status(&self) {
        let now = self.sessions.instrument.status.summary();
        self.inbox.status.send_if_modified(|status| std::mem::replace(status, now) != now);
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
                let accepted = match accepted {
                    Some(accepted) => accepted,
                    // A setting was changed: the same signals are recorded with the new settings.
                    None if attempts < MAX_ATTEMPTS => {
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
                        return Ok(());
                    }
                    None => instrument.accept_signals(&signals),
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

    /// Whether the scope fills the part of its record before the trigger.
    fn is_arming(&self) -> bool {
        self.sessions.instrument.state() == State::Armed
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

    /// Records an acquisition that has ended, and waits until it is written: replies that report it
    /// are sent afterwards.
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
