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
pub mod limits;
pub mod math;
pub mod measure;
mod memory;
mod outcome;
pub mod panel;
mod preparation;
pub mod record;
mod scan;
mod service;
pub mod status;
pub mod timing;
pub mod transfer;
pub mod word;

pub use bench::RemoteBench;
pub use event::Event;
pub use fault::{Fault, Faults};
pub use outcome::{Accepted, Finished, TriggerInstant};
pub use panel::Panel;
pub use preparation::{Preparation, Prepared};
pub use record::Signals;
pub use service::{AutosetSignal, Service};
pub use status::Status;
pub use timing::SampleWindow;

use std::borrow::Cow;

use crate::recording::Capture;
use crate::scope::{ChannelSetup, Deviation, Model, Setup, Source, Waveform};
use acquisition::{Acquisition, State};
use panel::{CursorFunction, DisplayFormat};
use record::Acquirer;
use transfer::{Incoming, Transfer};

/// Set-up memories.
pub const SETUP_MEMORIES: usize = 10;

/// A virtual oscilloscope.
#[derive(Debug, Clone, PartialEq)]
pub struct Instrument {
    /// Limits of the model.
    pub model: Model,
    /// Front panel.
    pub panel: Panel,
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
    settled: Panel,
    /// The settled front panel as front end and digitiser take it: built when something changes,
    /// not at every look.
    settled_setup: Setup,
    autoset_signal: AutosetSignal,
    acquisition: Acquisition,
    references: [Option<Waveform>; 4],
    setups: [Panel; SETUP_MEMORIES],
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
        instrument.keep_consistent();
        instrument
    }

    /// An instrument that was just switched on, with its factory set-up, running. `noise` is that
    /// of its front end, root mean square (div).
    pub fn new(model: Model, noise: f64, seed: u64) -> Self {
        let panel = Panel::default();
        let points = model.record_length;
        let mut instrument = Self {
            status: Status::power_on(model.event_queue),
            transfer: Transfer::initial(points),
            incoming: Incoming::initial(points),
            service: Service::default(),
            bench: RemoteBench::default(),
            settled: panel.clone(),
            settled_setup: panel.setup(&model),
            autoset_signal: AutosetSignal::None,
            acquisition: Acquisition::default(),
            references: Default::default(),
            setups: std::array::from_fn(|_| panel.clone()),
            model,
            panel,
            front_end: FrontEnd { noise, errors: Vec::new() },
            seed,
        };
        instrument.note_settled();
        instrument.acquisition.run();
        instrument
    }

    /// Puts the bench's amplifiers before the digitiser: noise and errors of `setup`, nothing else
    /// of it.
    pub fn set_front_end(&mut self, setup: &Setup) {
        self.front_end = FrontEnd::of(setup);
        self.settled_setup = self.build_setup(&self.settled);
    }

    /// The sample grid on which signals are welcome with the present settings.
    pub fn sample_window(&self) -> SampleWindow {
        SampleWindow::of(&self.current())
    }

    /// Time has passed: it is `now` (s), on any clock that does not run backwards.
    pub fn advance(&mut self, now: f64) {
        let unsettled = self.unsettled_setup();
        let setup = unsettled.as_ref().unwrap_or(&self.settled_setup);
        let by = Acquirer { panel: &self.panel, setup, seed: self.seed };
        self.acquisition.advance(&by, now);
        self.note_completion();
    }

    /// Something happens at the inputs now. The record is complete, and in memory, when
    /// [`Self::advance`] has passed the time that is returned.
    pub fn accept_signals(&mut self, signals: &Signals) -> Accepted {
        let unsettled = self.unsettled_setup();
        let setup = unsettled.as_ref().unwrap_or(&self.settled_setup);
        let by = Acquirer { panel: &self.panel, setup, seed: self.seed };
        self.acquisition.accept(&by, signals)
    }

    /// What records are made with now, for [`Preparation::take`] on another thread.
    pub fn preparation(&self) -> Preparation {
        let (panel, setup) = (self.panel.clone(), self.setup());
        Preparation { panel, setup, seed: self.seed, now: self.acquisition.now() }
    }

    /// As [`Self::accept_signals`] with records that were made before; nothing where they were made
    /// with other settings.
    pub fn accept_prepared(&mut self, signals: &Signals, prepared: Prepared) -> Option<Accepted> {
        let unsettled = self.unsettled_setup();
        let setup = unsettled.as_ref().unwrap_or(&self.settled_setup);
        if !prepared.by.is_like(&self.panel, setup) {
            return None;
        }
        let by = Acquirer { panel: &self.panel, setup, seed: self.seed };
        Some(self.acquisition.accept_with(&by, signals, || prepared.taken))
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
        self.note_settled();
        self.note_completion();
    }

    /// The front panel as front end and digitiser take it.
    pub fn setup(&self) -> Setup {
        self.current().into_owned()
    }

    fn current(&self) -> Cow<'_, Setup> {
        self.unsettled_setup().map_or(Cow::Borrowed(&self.settled_setup), Cow::Owned)
    }

    /// The set-up of a front panel that was turned since the last [`Self::keep_consistent`].
    fn unsettled_setup(&self) -> Option<Setup> {
        (self.panel != self.settled).then(|| self.build_setup(&self.panel))
    }

    /// The front panel as it is now is what the acquisition knows.
    fn note_settled(&mut self) {
        self.settled = self.panel.clone();
        self.settled_setup = self.build_setup(&self.settled);
    }

    fn build_setup(&self, panel: &Panel) -> Setup {
        let mut setup = panel.setup(&self.model);
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
        self.acquisition.state(&self.panel, &self.current())
    }

    /// Records taken since the acquisition was started; always none in scan mode (manual,
    /// `ACQuire:NUMACq?`).
    pub fn acquisitions(&self) -> u32 {
        if timing::scans(&self.current()) { 0 } else { self.acquisition.count() }
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
        let unsettled = self.unsettled_setup();
        let setup = unsettled.as_ref().unwrap_or(&self.settled_setup);
        let by = Acquirer { panel: &self.panel, setup, seed: self.seed };
        self.acquisition.force(&by);
    }

    /// After a change of settings: what a running acquisition has so far no longer fits, and it
    /// begins anew.
    pub fn keep_consistent(&mut self) {
        if self.panel == self.settled {
            return;
        }
        let setup = self.build_setup(&self.panel);
        let changed = setup != self.settled_setup
            || self.panel.trigger != self.settled.trigger
            || self.panel.acquire != self.settled.acquire;
        if changed {
            self.acquisition.restart();
        }
        // Cursors do not leave the screen, and there are none in XY.
        let (start, end) = setup.record_span();
        for time in &mut self.panel.cursor.vertical {
            *time = limits::within(*time, (start, end));
        }
        if self.panel.display.format == DisplayFormat::Xy {
            self.panel.cursor.function = CursorFunction::Off;
        }
        self.settled = self.panel.clone();
        self.settled_setup = setup;
    }

    /// The factory set-up. Memories of waveforms and set-ups stay, and so do the settings that the
    /// manual excepts: printer, contrast, lock, language and serial line.
    pub fn reset(&mut self) {
        let mut panel = Panel::default();
        panel.hard_copy = self.panel.hard_copy;
        panel.display.contrast = self.panel.display.contrast;
        self.panel = panel;
        self.transfer = Transfer::initial(self.model.record_length);
        self.incoming = Incoming::initial(self.model.record_length);
        self.service.device_trigger.clear();
        self.autoset_signal = AutosetSignal::None;
        self.acquisition.stop();
        self.acquisition.forget();
        self.note_settled();
        self.acquisition.run();
        self.note_completion();
    }

    fn note_completion(&mut self) {
        if !self.is_busy() {
            self.status.complete();
        }
    }
}
