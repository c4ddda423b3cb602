//! The oscilloscope as an instrument with a memory: front panel, acquisition, waveforms, set-ups, status.
//!
//! Stands between the bench and the remote interface. The bench asks [`Instrument::sample_window`] for the sample grid, passes
//! time in with [`Instrument::advance`], and hands over what happens at the inputs with [`Instrument::accept_signals`],
//! or finished captures with [`Instrument::store`]; `scpi` turns messages into changes of the front panel and answers
//! from here. No I/O, no clock, no threads: its owner advances the time.

pub mod acquisition;
mod autoset;
pub mod bench;
pub mod event;
pub mod limits;
pub mod math;
pub mod measure;
mod memory;
mod outcome;
pub mod panel;
pub mod record;
mod scan;
pub mod status;
pub mod timing;
pub mod transfer;
pub mod word;

pub use bench::RemoteBench;
pub use event::Event;
pub use outcome::{Accepted, Finished, TriggerInstant};
pub use panel::Panel;
pub use record::Signals;
pub use status::Status;
pub use timing::SampleWindow;

use crate::recording::Capture;
use crate::scope::{ChannelSetup, Deviation, Model, Setup, Source, Waveform};
use acquisition::{Acquisition, State};
use record::Acquirer;
use transfer::{Incoming, Transfer};

/// Set-up memories.
pub const SETUP_MEMORIES: usize = 10;

/// Settings that belong to no set-up memory.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Service {
    /// Whether the front panel's keys are locked.
    pub locked: bool,
    /// Commands of `*TRG` (`*DDT`).
    pub device_trigger: String,
}

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
    /// Lock and device trigger.
    pub service: Service,
    /// The remote interface's requests to the bench.
    pub bench: RemoteBench,
    settled: Panel,
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
    /// An instrument that was just switched on with all the settings, the noise and the errors of `setup`, running.
    pub fn of(setup: &Setup, seed: u64) -> Self {
        let mut instrument = Self::new(setup.model.clone(), setup.noise, seed);
        instrument.set_front_end(setup);
        instrument.panel = Panel::of(setup);
        instrument.keep_consistent();
        instrument
    }

    /// An instrument that was just switched on, with its factory set-up, running. `noise` is that of its front end, root
    /// mean square (div).
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
            acquisition: Acquisition::default(),
            references: Default::default(),
            setups: std::array::from_fn(|_| panel.clone()),
            model,
            panel,
            front_end: FrontEnd { noise, errors: Vec::new() },
            seed,
        };
        instrument.acquisition.run();
        instrument
    }

    /// Puts the bench's amplifiers before the digitiser: noise and errors of `setup`, nothing else of it.
    pub fn set_front_end(&mut self, setup: &Setup) {
        self.front_end = FrontEnd::of(setup);
    }

    /// The sample grid on which signals are welcome with the present settings.
    pub fn sample_window(&self) -> SampleWindow {
        SampleWindow::of(&self.panel, &self.setup())
    }

    /// Time has passed: it is `now` (s), on any clock that does not run backwards.
    pub fn advance(&mut self, now: f64) {
        let setup = self.setup();
        let by = Acquirer { panel: &self.panel, setup: &setup, seed: self.seed };
        self.acquisition.advance(&by, now);
        self.note_completion();
    }

    /// Something happens at the inputs now. The record is complete, and in memory, when [`Self::advance`] has passed the
    /// time that is returned.
    pub fn accept_signals(&mut self, signals: &Signals) -> Accepted {
        let setup = self.setup();
        let by = Acquirer { panel: &self.panel, setup: &setup, seed: self.seed };
        self.acquisition.accept(&by, signals)
    }

    /// Shows finished captures as if just taken: their channels are displayed, and the acquisition stops.
    pub fn store(&mut self, captures: &[Capture]) {
        self.acquisition.stop();
        for capture in captures {
            if matches!(capture.waveform.source, Source::Channel(n) if n <= self.model.channels) {
                *self.panel.displayed_mut(capture.waveform.source) = true;
                self.acquisition.keep(capture.waveform.clone());
            }
        }
        self.settled = self.panel.clone();
        self.note_completion();
    }

    /// The front panel as front end and digitiser take it.
    pub fn setup(&self) -> Setup {
        let mut setup = self.panel.setup(&self.model);
        setup.noise = self.front_end.noise;
        for (channel, error) in setup.channels.iter_mut().zip(&self.front_end.errors) {
            if let Some(channel) = channel {
                (channel.offset, channel.deviation) = *error;
            }
        }
        setup
    }

    /// The records of the last acquisition that was triggered, or that ended a single sequence, if they have not been read since.
    pub fn take_finished(&mut self) -> Option<Finished> {
        self.acquisition.take_finished()
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
        self.acquisition.state(&self.panel, &self.setup())
    }

    /// Records taken since the acquisition was started.
    pub fn acquisitions(&self) -> u32 {
        self.acquisition.count()
    }

    /// Triggers now, if the scope waits for a trigger.
    pub fn force_trigger(&mut self) {
        let setup = self.setup();
        let by = Acquirer { panel: &self.panel, setup: &setup, seed: self.seed };
        self.acquisition.force(&by);
    }

    /// After a change of settings: what a running acquisition has so far no longer fits, and it begins anew.
    pub fn keep_consistent(&mut self) {
        let changed = self.panel.setup(&self.model) != self.settled.setup(&self.model)
            || self.panel.trigger != self.settled.trigger
            || self.panel.acquire != self.settled.acquire;
        if changed {
            self.acquisition.restart();
        }
        // Cursors do not leave the screen.
        let (start, end) = self.setup().record_span();
        for time in &mut self.panel.cursor.vertical {
            *time = limits::within(*time, (start, end));
        }
        if self.panel != self.settled {
            self.settled = self.panel.clone();
        }
    }

    /// The factory set-up; memories of waveforms and set-ups stay.
    pub fn reset(&mut self) {
        self.panel = Panel::default();
        self.transfer = Transfer::initial(self.model.record_length);
        self.incoming = Incoming::initial(self.model.record_length);
        self.service = Service::default();
        self.acquisition.stop();
        self.acquisition.forget();
        self.settled = self.panel.clone();
        self.acquisition.run();
        self.note_completion();
    }

    fn note_completion(&mut self) {
        if !self.is_busy() {
            self.status.complete();
        }
    }
}
