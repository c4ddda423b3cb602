//! The oscilloscope as an instrument with a memory: front panel, acquisition, waveforms, set-ups,
//! status.
//!
//! Stands between the bench and the remote interface. The bench asks [`Instrument::sample_window`]
//! for the sample grid, passes time in with [`Instrument::advance`], and hands over what happens at
//! the inputs with [`Instrument::accept_signals`], or finished captures with [`Instrument::store`];
//! `scpi` turns messages into changes of the front panel and answers from here. No I/O, no clock,
//! no threads: its owner advances the time.

pub mod acquisition;
mod autoset;
pub mod bench;
pub mod event;
pub mod fault;
pub mod math;
pub mod measure;
mod memory;
pub mod record;
pub mod scan;
mod service;
pub mod status;
pub mod transfer;

pub use acquisition::{Accepted, Finished, SampleWindow};
pub use bench::{BenchAccess, RemoteBench};
pub use event::Event;
pub use fault::{Fault, Faults};
pub use record::{Preparation, Prepared, Signals, TriggerInstant};
pub use service::{AutosetSignal, Service};
pub use status::{Status, StatusSummary};

use std::collections::BTreeMap;

use crate::recording::Capture;
use crate::scope::panel::DisplayFormat;
use crate::scope::{ChannelSetup, Deviation, Model, Panel, Setup, Source, Waveform};
use acquisition::{Acquisition, State};
use record::AcquisitionSettings;
use transfer::{Incoming, Transfer};

/// Set-up memories.
pub const SETUP_MEMORIES: usize = 10;

/// A virtual oscilloscope.
#[derive(Debug, Clone, PartialEq)]
pub struct Instrument {
    /// Limits of the model.
    pub model: Model,
    /// Front panel. Whoever changes it calls [`Self::apply_panel`] afterwards.
    pub(crate) panel: Panel,
    /// How waveforms travel.
    pub transfer: Transfer,
    /// Preamble of the next waveform sent in.
    pub incoming: Incoming,
    /// Registers and events.
    pub status: Status,
    /// Lock, device trigger, serial line and language.
    pub service: Service,
    /// The remote interface's requests to the bench.
    pub bench: RemoteBench,
    /// The front panel at the last [`Self::apply_panel`].
    applied: Panel,
    /// That front panel as front end and digitiser take it.
    setup: Setup,
    autoset_signal: AutosetSignal,
    acquisition: Acquisition,
    /// Reference memories that hold a waveform, by letter.
    references: BTreeMap<char, Waveform>,
    setups: Vec<Panel>,
    front_end: FrontEnd,
    seed: u64,
}

/// Properties that no knob changes.
#[derive(Debug, Clone, PartialEq, Default)]
struct FrontEnd {
    /// Root mean square (div).
    noise: f64,
    /// Offset error of each channel's amplifier at the probe's tip (V), and its deviation.
    errors: Vec<(f64, Deviation)>,
}

impl FrontEnd {
    fn of(setup: &Setup) -> Self {
        let error = |channel: &ChannelSetup| (channel.offset, channel.deviation);
        let errors = setup.channels.iter().map(|c| c.as_ref().map(error).unwrap_or_default());
        Self { noise: setup.noise, errors: errors.collect() }
    }
}

impl Instrument {
    /// An instrument that was just switched on with all the settings, the noise and the errors of
    /// `setup`, running.
    pub fn of(setup: &Setup, seed: u64) -> Self {
        let mut instrument = Self::new(setup.model.clone(), setup.noise, seed);
        instrument.set_front_end(setup);
        instrument.panel = Panel::of(setup);
        instrument.apply_panel();
        instrument
    }

    /// An instrument that was just switched on, with its factory set-up, running. `noise` is that
    /// of its front end, root mean square (div).
    pub fn new(model: Model, noise: f64, seed: u64) -> Self {
        let panel = Panel::factory(&model);
        let points = model.record_length;
        let mut instrument = Self {
            status: Status::power_on(model.event_queue),
            transfer: Transfer::initial(points),
            incoming: Incoming::initial(points),
            service: Service::default(),
            bench: RemoteBench::default(),
            applied: panel.clone(),
            setup: panel.setup(&model),
            autoset_signal: AutosetSignal::None,
            acquisition: Acquisition::default(),
            references: BTreeMap::new(),
            setups: vec![panel.clone(); SETUP_MEMORIES],
            model,
            panel,
            front_end: FrontEnd { noise, errors: Vec::new() },
            seed,
        };
        instrument.setup = instrument.build_setup();
        instrument.acquisition.run();
        instrument
    }

    /// Puts the bench's amplifiers before the digitiser: noise and errors of `setup`, nothing else
    /// of it.
    pub fn set_front_end(&mut self, setup: &Setup) {
        self.front_end = FrontEnd::of(setup);
        self.setup = self.build_setup();
    }

    /// The front panel.
    pub fn panel(&self) -> &Panel {
        &self.panel
    }

    /// The sample grid that signals must have with the present settings.
    pub fn sample_window(&self) -> SampleWindow {
        SampleWindow::of(&self.setup)
    }

    /// Time has passed: it is `now` (s), on any clock that does not run backwards.
    pub fn advance(&mut self, now: f64) {
        let settings =
            AcquisitionSettings { panel: &self.panel, setup: &self.setup, seed: self.seed };
        self.acquisition.advance(&settings, now);
        self.note_completion();
    }

    /// Something happens at the inputs now. The record is complete, and in memory, when
    /// [`Self::advance`] has passed the time that is returned.
    pub fn accept_signals(&mut self, signals: &Signals) -> Accepted {
        let settings =
            AcquisitionSettings { panel: &self.panel, setup: &self.setup, seed: self.seed };
        self.acquisition.accept(&settings, signals)
    }

    /// What records are made with now, for [`Preparation::take`] on another thread.
    pub fn preparation(&self) -> Preparation {
        let (panel, setup) = (self.panel.clone(), self.setup.clone());
        Preparation { panel, setup, seed: self.seed, now: self.acquisition.now() }
    }

    /// As [`Self::accept_signals`] with records that were made before; nothing where they were made
    /// with other settings.
    pub fn accept_prepared(&mut self, signals: &Signals, prepared: Prepared) -> Option<Accepted> {
        if !prepared.by.is_like(&self.panel, &self.setup) {
            return None;
        }
        let settings =
            AcquisitionSettings { panel: &self.panel, setup: &self.setup, seed: self.seed };
        Some(self.acquisition.accept_with(&settings, signals, || prepared.taken))
    }

    /// Shows finished captures as if just taken: their channels are displayed, and the acquisition
    /// stops.
    pub fn store(&mut self, captures: &[Capture]) {
        self.acquisition.stop();
        for capture in captures {
            if let Source::Reference(letter) = capture.waveform.source {
                // A letter that is none is no capture of this instrument.
                let _ = self.put_reference(capture.waveform.clone(), letter);
            }
            if matches!(capture.waveform.source, Source::Channel(n) if n <= self.model.channels) {
                *self.panel.displayed_mut(capture.waveform.source) = true;
                self.acquisition.keep(capture.waveform.clone());
            }
        }
        // What was stored is on the screen: no restart.
        self.applied = self.panel.clone();
        self.setup = self.build_setup();
        self.note_completion();
    }

    /// The front panel as front end and digitiser take it.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    fn build_setup(&self) -> Setup {
        let mut setup = self.panel.setup(&self.model);
        setup.noise = self.front_end.noise;
        for (channel, error) in setup.channels.iter_mut().zip(&self.front_end.errors) {
            if let Some(channel) = channel {
                (channel.offset, channel.deviation) = *error;
            }
        }
        setup
    }

    /// The records of the last acquisition that was triggered, or that ended a single sequence, if
    /// they have not been read since.
    pub fn take_finished(&mut self) -> Option<Finished> {
        self.acquisition.take_finished()
    }

    /// Time of the trigger of the record that is on its way, after the first sample of its signals
    /// (s).
    pub fn trigger_time(&self) -> Option<f64> {
        self.acquisition.trigger_on_its_way().map(|trigger| trigger.time)
    }

    /// Starts an acquisition.
    pub fn run(&mut self) {
        self.acquisition.run();
    }

    /// Stops the acquisition.
    pub fn stop(&mut self) {
        self.acquisition.stop();
        self.note_completion();
    }

    /// Whether the acquisition runs.
    pub fn is_running(&self) -> bool {
        self.acquisition.is_running()
    }

    /// Whether something has to end before `*OPC?` answers.
    pub fn is_busy(&self) -> bool {
        self.acquisition.is_pending(&self.panel)
    }

    /// State of the acquisition.
    pub fn state(&self) -> State {
        self.acquisition.state(&self.panel, &self.setup)
    }

    /// Records taken since the acquisition was started; always none in scan mode (manual,
    /// `ACQuire:NUMACq?`).
    pub fn acquisitions(&self) -> u32 {
        if acquisition::scans(&self.setup) { 0 } else { self.acquisition.count() }
    }

    /// Whether automatic measurements have nothing to measure: the scope scans, or draws one
    /// channel against another.
    pub fn measures_nothing(&self) -> bool {
        self.state() == State::Scan || self.panel.display.format == DisplayFormat::Xy
    }

    /// What the last `AUTOSet` took its signal for.
    pub fn autoset_signal(&self) -> AutosetSignal {
        self.autoset_signal
    }

    /// Triggers now, if the scope waits for a trigger.
    pub fn force_trigger(&mut self) {
        let settings =
            AcquisitionSettings { panel: &self.panel, setup: &self.setup, seed: self.seed };
        self.acquisition.force(&settings);
    }

    /// Applies a changed front panel: settings are brought within their limits, and an acquisition
    /// whose records so far no longer fit is restarted.
    pub fn apply_panel(&mut self) {
        if self.panel == self.applied {
            return;
        }
        self.panel.fit(&self.model);
        let setup = self.build_setup();
        let (panel, applied) = (&self.panel, &self.applied);
        let changed = setup != self.setup
            || panel.trigger_type != applied.trigger_type
            || panel.pulse != applied.pulse
            || panel.stop_after != applied.stop_after;
        if changed {
            self.acquisition.restart();
        }
        self.setup = setup;
        self.applied = self.panel.clone();
    }

    /// The factory set-up. Memories of waveforms and set-ups stay, and so do the settings that the
    /// manual excepts: printer, contrast, lock, language and serial line (all in [`Service`]).
    pub fn reset(&mut self) {
        self.panel = Panel::factory(&self.model);
        self.transfer = Transfer::initial(self.model.record_length);
        self.incoming = Incoming::initial(self.model.record_length);
        self.service.device_trigger.clear();
        self.autoset_signal = AutosetSignal::None;
        self.acquisition.stop();
        self.acquisition.forget();
        self.applied = self.panel.clone();
        self.setup = self.build_setup();
        self.acquisition.run();
        self.note_completion();
    }

    fn note_completion(&mut self) {
        if !self.is_busy() {
            self.status.complete();
        }
    }
}
