//! The acquisition's states, and the memories of the channels.
//!
//! `Armed` until the part of the record before the trigger is full, `Ready` until a trigger comes,
//! `Trigger` until the part after it is full, then `Save` after a single sequence and `Armed` again
//! otherwise. In automatic mode a scope that waits for long shows records without trigger: `Auto`,
//! or `Scan` where the time base is slow. Time is passed in, in seconds on any clock that does not
//! run backwards.

use std::collections::BTreeMap;

use super::record::{AcquisitionSettings, Signals, TriggerInstant};
use super::scan::Sweep;
use crate::scope::AcquireMode;
use crate::scope::acquire::fold_average;
use crate::scope::panel::StopAfter;
use crate::scope::word::words;
use crate::scope::{Panel, Setup, Source, TriggerMode, TriggerSource, Waveform};

/// Automatic mode waits for a trigger at least this long (s).
const AUTO_TRIGGER_TIMEOUT: f64 = 0.05;

words! {
    /// State of the acquisition.
    State {
        /// Taking what comes before the trigger.
        Armed = "ARMED",
        /// Waiting for a trigger.
        Ready = "READY",
        /// Taking what comes after the trigger.
        Trigger = "TRIGGER",
        /// Taking records without trigger.
        Auto = "AUTO",
        /// Stopped.
        Save = "SAVE",
        /// Taking slow records without trigger.
        Scan = "SCAN",
    }
}

/// Result of signals at the inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Accepted {
    /// The scope triggered; the record will be complete at this time (s).
    Triggered {
        /// When the record is complete (s).
        complete_at: f64,
    },
    /// The scope scans: the signals go onto the sweep, without a trigger.
    Scanned,
    /// No trigger was found.
    NoTrigger,
    /// The scope was stopped or still filling the part before the trigger.
    NotReady,
    /// The signals have another sample interval than the set-up: they were made for another time
    /// base, and are dropped.
    OtherInterval,
}

/// Records on their way into memory.
#[derive(Debug, Clone, PartialEq)]
struct InFlight {
    /// When they are complete (s).
    complete_at: f64,
    /// One record a displayed channel.
    records: Vec<Waveform>,
    /// The trigger; none if it was not a signal of the bench.
    trigger: Option<TriggerInstant>,
}

/// A finished acquisition that is worth keeping: a triggered one, or the last of a single sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// One record a displayed channel, as in memory.
    pub records: Vec<Waveform>,
    /// The trigger; none if it was not a signal of the bench.
    pub trigger: Option<TriggerInstant>,
}

/// State and memories.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Acquisition {
    running: bool,
    now: f64,
    armed_at: f64,
    untriggered: bool,
    in_flight: Option<InFlight>,
    /// When the last trigger came; the holdoff counts from it (s).
    triggered_at: Option<f64>,
    sweep: Option<Sweep>,
    count: u32,
    shots: u32,
    finished: Option<Finished>,
    /// Records by channel.
    memories: BTreeMap<u8, Waveform>,
    /// Means of averaged records by channel.
    means: BTreeMap<u8, Vec<f64>>,
}

impl Acquisition {
    /// Starts a new acquisition; the memories stay until it has a record.
    pub fn run(&mut self) {
        self.running = true;
        self.rearm();
        self.count = 0;
    }

    /// Stops; records on their way are lost.
    pub fn stop(&mut self) {
        self.running = false;
        self.in_flight = None;
    }

    /// Restarts with other settings, if running; the count restarts in any case.
    pub fn restart(&mut self) {
        self.count = 0;
        if self.running {
            self.run();
        }
    }

    /// Empties all memories.
    pub fn forget(&mut self) {
        self.memories.clear();
        self.means.clear();
        self.count = 0;
    }

    /// The last record worth keeping since the last call.
    pub fn take_finished(&mut self) -> Option<Finished> {
        self.finished.take()
    }

    /// The time that has passed (s).
    pub fn now(&self) -> f64 {
        self.now
    }

    /// Whether it runs.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Where in its signals the record on its way was triggered.
    pub fn trigger_on_its_way(&self) -> Option<TriggerInstant> {
        self.in_flight.as_ref().and_then(|record| record.trigger)
    }

    /// Records taken since the acquisition was started.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Whether something has to end before `*OPC?` answers: a running single sequence.
    pub fn is_pending(&self, panel: &Panel) -> bool {
        self.running && panel.stop_after == StopAfter::Sequence
    }

    /// The present state.
    pub fn state(&self, panel: &Panel, setup: &Setup) -> State {
        let automatic = setup.trigger.mode == TriggerMode::Auto;
        if !self.running {
            State::Save
        } else if scans(setup) {
            State::Scan
        } else if self.in_flight.is_some() {
            State::Trigger
        } else if automatic && self.untriggered {
            State::Auto
        } else if self.now < self.ready_at(panel, setup) {
            State::Armed
        } else {
            State::Ready
        }
    }

    /// Earliest time of a trigger: the part of the record before it is full, and the holdoff has
    /// ended (s).
    fn ready_at(&self, panel: &Panel, setup: &Setup) -> f64 {
        let full = self.armed_at + before_trigger(setup);
        let held_off = self.triggered_at.map_or(full, |at| at + panel.trigger.holdoff);
        full.max(held_off)
    }

    /// The record of a channel.
    pub fn memory(&self, channel: u8) -> Option<&Waveform> {
        self.memories.get(&channel)
    }

    /// Puts a record into its channel's memory.
    pub fn keep(&mut self, record: Waveform) {
        if let Source::Channel(number) = record.source {
            self.memories.insert(number, record);
        }
    }

    /// Moves on to `now` (s): completes records, and lets automatic mode lose its patience.
    pub fn advance(&mut self, settings: &AcquisitionSettings<'_>, now: f64) {
        if now.is_finite() {
            self.now = self.now.max(now);
        }
        if let Some(done) = self.in_flight.take_if(|r| r.complete_at <= self.now) {
            self.armed_at = done.complete_at;
            self.complete(settings.panel, (done.records, done.trigger), true);
        }
        if self.running && scans(settings.setup) {
            return self.scan(settings);
        }
        self.sweep = None;
        // The mains come whatever the bench does.
        let line = settings.panel.trigger.source == TriggerSource::Line;
        if line
            && self.state(settings.panel, settings.setup) == State::Ready
            && self.mains_passed(settings)
        {
            let records = self.quiet(settings);
            self.launch(settings.setup, records, None);
        }
        let automatic = settings.setup.trigger.mode == TriggerMode::Auto;
        let patience = before_trigger(settings.setup)
            + after_trigger(settings.setup).max(AUTO_TRIGGER_TIMEOUT);
        let waiting = self.running && self.in_flight.is_none() && automatic;
        if waiting && self.now >= self.armed_at + patience {
            let records = self.quiet(settings);
            self.armed_at = self.now;
            self.untriggered = true;
            self.complete(settings.panel, (records, None), false);
        }
    }

    /// Takes signals that arrive now, if the scope waits for a trigger.
    pub fn accept(&mut self, settings: &AcquisitionSettings<'_>, signals: &Signals) -> Accepted {
        let now = self.now;
        self.accept_with(settings, signals, || settings.take(signals, now))
    }

    /// The same with records that `take` makes of the signals.
    pub fn accept_with(
        &mut self,
        settings: &AcquisitionSettings<'_>,
        signals: &Signals,
        take: impl FnOnce() -> Option<(Vec<Waveform>, TriggerInstant)>,
    ) -> Accepted {
        match self.state(settings.panel, settings.setup) {
            State::Scan if !Sweep::fits(settings, signals) => return Accepted::OtherInterval,
            State::Ready | State::Auto if !settings.fits(signals) => {
                return Accepted::OtherInterval;
            }
            State::Ready | State::Auto => {}
            State::Scan => {
                let now = self.now;
                self.sweep
                    .get_or_insert_with(|| Sweep::start(settings, now))
                    .accept(settings, signals);
                return Accepted::Scanned;
            }
            State::Armed | State::Trigger | State::Save => return Accepted::NotReady,
        }
        let Some((records, trigger)) = take() else {
            return Accepted::NoTrigger;
        };
        self.untriggered = false;
        Accepted::Triggered { complete_at: self.launch(settings.setup, records, Some(trigger)) }
    }

    /// Triggers now, if the scope waits for a trigger; nothing is at the inputs.
    pub fn force(&mut self, settings: &AcquisitionSettings<'_>) {
        if self.state(settings.panel, settings.setup) == State::Ready {
            let records = self.quiet(settings);
            self.launch(settings.setup, records, None);
        }
    }

    /// The sweep goes on until now.
    fn scan(&mut self, settings: &AcquisitionSettings<'_>) {
        let now = self.now;
        let sweep = self.sweep.get_or_insert_with(|| Sweep::start(settings, now));
        let single = settings.panel.stop_after == StopAfter::Sequence;
        let depth = settings.panel.acquire.depth();
        let progress = sweep.advance(settings, now, single.then_some(depth));
        if !progress.moved {
            return;
        }
        self.count = self.count.saturating_add(progress.sweeps);
        let done = single && self.count >= depth;
        let records = sweep.records(settings, !done);
        if done {
            self.running = false;
            self.sweep = None;
            self.finished = Some(Finished { records: records.clone(), trigger: None });
        }
        for record in records {
            self.keep(record);
        }
    }

    /// Whether the mains have gone through zero upward since the scope was ready for a trigger.
    fn mains_passed(&self, settings: &AcquisitionSettings<'_>) -> bool {
        let cycles = |time: f64| (time * settings.setup.model.line_frequency).floor();
        cycles(self.now) > cycles(self.ready_at(settings.panel, settings.setup))
    }

    fn rearm(&mut self) {
        self.armed_at = self.now;
        self.in_flight = None;
        self.sweep = None;
        self.untriggered = false;
    }

    fn launch(
        &mut self,
        setup: &Setup,
        records: Vec<Waveform>,
        trigger: Option<TriggerInstant>,
    ) -> f64 {
        let complete_at = self.now + after_trigger(setup);
        self.triggered_at = Some(self.now);
        self.in_flight = Some(InFlight { complete_at, records, trigger });
        complete_at
    }

    /// Records of inputs at which nothing happens.
    fn quiet(&mut self, settings: &AcquisitionSettings<'_>) -> Vec<Waveform> {
        self.shots = self.shots.wrapping_add(1);
        let shot = u32::MAX - self.shots;
        if let Some(records) = settings.take_quiet(shot) {
            return records;
        }
        let interval = settings.setup.signal_interval();
        let (start, end) = settings.setup.record_span();
        let silence = vec![0.0; samples((end - start) / interval) + 1];
        let signals = Signals {
            time_base: None,
            interval,
            automatic: silence.len() / 2,
            volts: vec![silence],
            external: Vec::new(),
            shot,
        };
        let mut setup = settings.setup.clone();
        setup.trigger.mode = TriggerMode::Auto;
        let taken =
            AcquisitionSettings { panel: settings.panel, setup: &setup, seed: settings.seed }
                .take(&signals, self.now);
        taken.map(|(records, _)| records).unwrap_or_default()
    }

    fn complete(
        &mut self,
        panel: &Panel,
        (mut records, trigger): (Vec<Waveform>, Option<TriggerInstant>),
        was_triggered: bool,
    ) {
        self.count = self.count.saturating_add(1);
        let averages = panel.acquire.mode == AcquireMode::Average;
        let depth = panel.acquire.depth();
        for record in &mut records {
            if averages && let Source::Channel(number) = record.source {
                let mean = self.means.entry(number).or_default();
                fold_average(mean, record, self.count, depth);
            }
            self.keep(record.clone());
        }
        if panel.stop_after == StopAfter::Sequence && self.count >= depth {
            self.running = false;
        }
        if was_triggered || !self.running {
            self.finished = Some(Finished { records, trigger });
        }
    }
}

/// Whether the scope scans instead of waiting for triggers.
pub fn scans(setup: &Setup) -> bool {
    setup.trigger.mode == TriggerMode::Auto && setup.model.scans(setup.time_base)
}

/// The nearest count of samples.
pub fn samples(number: f64) -> usize {
    number.round() as usize
}

/// Time that the part of the record before the trigger takes (s).
pub fn before_trigger(setup: &Setup) -> f64 {
    (-setup.record_span().0).max(0.0)
}

/// Time that the part of the record after the trigger takes (s).
pub fn after_trigger(setup: &Setup) -> f64 {
    setup.record_span().1.max(0.0)
}

/// The grid on which the instrument wants its signals, and how much of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleWindow {
    /// Time base (s/div).
    pub time_base: f64,
    /// From one sample to the next (s).
    pub interval: f64,
    /// Time before the trigger that the record shows (s).
    pub before: f64,
    /// Time after the trigger that the record shows (s).
    pub after: f64,
}

impl SampleWindow {
    /// The window for a scope with these settings.
    pub fn of(setup: &Setup) -> Self {
        Self {
            time_base: setup.time_base,
            interval: setup.signal_interval(),
            before: before_trigger(setup),
            after: after_trigger(setup),
        }
    }
}
