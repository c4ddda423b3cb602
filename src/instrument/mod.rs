//! The oscilloscope as an instrument with a memory: front panel, acquisition, waveforms, set-ups, status.
//!
//! Stands between the bench and the remote interface. The bench asks [`Instrument::wanted`] for the sample grid, passes
//! time in with [`Instrument::advance`], and hands over what happens at the inputs with [`Instrument::accept_signals`],
//! or finished captures with [`Instrument::store`]; `scpi` turns messages into changes of the front panel and answers
//! from here. No I/O, no clock, no threads: whoever owns the instrument decides when time passes.

pub mod acquisition;
pub mod bench;
pub mod event;
pub mod limits;
pub mod math;
pub mod measure;
mod memory;
pub mod panel;
pub mod record;
pub mod status;
pub mod transfer;
pub mod word;

pub use acquisition::{Accepted, Finished, Wanted};
pub use bench::Bench;
pub use event::Event;
pub use panel::Panel;
pub use record::Signals;
pub use status::Status;

use crate::recording::Capture;
use crate::scope::{Model, Setup, Source, Waveform};
use acquisition::{Acquisition, State};
use panel::MeasurementType;
use record::Acquirer;
use transfer::{Incoming, Transfer};

/// Set-up memories.
pub const SETUPS: usize = 10;

/// Settings that belong to no set-up memory.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Service {
    /// Whether the front panel's keys are locked.
    pub locked: bool,
    /// What `*TRG` does (`*DDT`).
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
    /// What the remote interface wants of the bench.
    pub bench: Bench,
    /// What the amplifier of each channel adds to every voltage at the probe's tip (V).
    pub offsets: [f64; 4],
    settled: Panel,
    acquisition: Acquisition,
    references: [Option<Waveform>; 4],
    setups: [Panel; SETUPS],
    /// Noise of the front end, root mean square (div).
    pub noise: f64,
    seed: u64,
}

impl Instrument {
    /// An instrument that was just switched on, with its factory set-up, running. `noise` is that of its front end, root
    /// mean square (div).
    #[must_use]
    pub fn new(model: Model, noise: f64, seed: u64) -> Self {
        let panel = Panel::default();
        let points = model.record_length;
        let mut instrument = Self {
            status: Status::power_on(model.event_queue),
            transfer: Transfer::initial(points),
            incoming: Incoming::initial(points),
            service: Service::default(),
            bench: Bench::default(),
            offsets: [0.0; 4],
            settled: panel.clone(),
            acquisition: Acquisition::default(),
            references: Default::default(),
            setups: std::array::from_fn(|_| panel.clone()),
            model,
            panel,
            noise,
            seed,
        };
        instrument.acquisition.run();
        instrument
    }

    /// The sample grid on which signals are welcome with the present settings.
    #[must_use]
    pub fn wanted(&self) -> Wanted {
        Wanted::of(&self.model, &self.setup())
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
    #[must_use]
    pub fn setup(&self) -> Setup {
        let mut setup = self.panel.setup(&self.model, self.noise);
        for (channel, offset) in setup.channels.iter_mut().zip(self.offsets) {
            if let Some(channel) = channel {
                channel.offset = offset;
            }
        }
        setup
    }

    /// The records of the last acquisition that was triggered, or that ended a single sequence, if nobody has asked since.
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
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.acquisition.is_running()
    }

    /// Whether something has to end before `*OPC?` answers.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.acquisition.is_pending(&self.panel)
    }

    /// What the acquisition is doing.
    #[must_use]
    pub fn state(&self) -> State {
        self.acquisition.state(&self.setup())
    }

    /// Records taken since the acquisition was started.
    #[must_use]
    pub fn acquisitions(&self) -> u32 {
        self.acquisition.count()
    }

    /// Triggers now, if the scope waits for a trigger.
    pub fn force_trigger(&mut self) {
        let setup = self.setup();
        let by = Acquirer { panel: &self.panel, setup: &setup, seed: self.seed };
        self.acquisition.force(&by);
    }

    /// Puts the trigger level half way between the extremes of its source, where there is a record.
    pub fn centre_trigger(&mut self) {
        let channel = self.panel.trigger.source.channel().unwrap_or(1);
        if let Ok(record) = self.waveform(Source::Channel(channel)) {
            let reading = |kind| measure::measure(kind, &record).unwrap_or(0.0);
            let (low, high) =
                (reading(MeasurementType::Minimum), reading(MeasurementType::Maximum));
            let level = f64::midpoint(low, high);
            self.panel.trigger.level = limits::trigger_level(&self.model, &self.panel, level);
        }
    }

    /// After a change of settings: what a running acquisition has so far no longer fits, and it begins anew.
    pub fn settle(&mut self) {
        let changed = self.panel.setup(&self.model, 0.0) != self.settled.setup(&self.model, 0.0)
            || self.panel.trigger != self.settled.trigger
            || self.panel.acquire != self.settled.acquire;
        if changed {
            self.acquisition.restart();
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

    /// Scales every displayed channel to its record and triggers at half height, on its own.
    pub fn autoset(&mut self) {
        for number in 1..=self.model.channels {
            let Ok(record) = self.waveform(Source::Channel(number)) else { continue };
            let swing = measure::measure(MeasurementType::PeakToPeak, &record).unwrap_or(0.0);
            let probe = self.panel.channel(number).vertical.probe;
            let vertical = &mut self.panel.channel_mut(number).vertical;
            vertical.position = 0.0;
            vertical.scale = limits::vertical_scale(&self.model, swing / AUTOSET_SWING, probe);
        }
        self.panel.trigger.mode = crate::scope::TriggerMode::Auto;
        self.panel.acquire.stop_after = panel::StopAfter::RunStop;
        self.centre_trigger();
        self.settled = self.panel.clone();
        self.run();
    }

    fn note_completion(&mut self) {
        if !self.is_busy() {
            self.status.complete();
        }
    }
}

/// Swing that autoset aims at (div).
const AUTOSET_SWING: f64 = 4.0;
