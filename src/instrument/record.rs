//! From volts at the inputs to records: conditioning, trigger, digitiser, peak detection.

use std::f64::consts::TAU;

use crate::scope::acquire::{TriggerPosition, digitise, find_trigger, record};
use crate::scope::front_end::{condition, noise_stream};
use crate::scope::panel::{Panel, PulsePolarity, PulseWhen, TriggerType};
use crate::scope::{AcquireMode, Setup, Source, TriggerMode, TriggerSource, Waveform};

/// Signals at the inputs: volts at the probes' tips on one sample grid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Signals {
    /// Time base that they were made for; none where their interval alone decides whether they fit
    /// (s/div).
    pub time_base: Option<f64>,
    /// From one sample to the next (s).
    pub interval: f64,
    /// Index of the sample at which automatic mode triggers when nothing crosses the level.
    pub automatic: usize,
    /// Signal of each channel in order; a missing or empty one is an open input, at zero volts (V).
    pub volts: Vec<Vec<f64>>,
    /// Signal of the external trigger input on the same grid; empty at an open one, at zero volts
    /// (V).
    pub external: Vec<f64>,
    /// Number of the shot, which the noise is drawn for.
    pub shot: u32,
}

/// Widths that count as equal: this share of the one asked for, or the model's guard band (1).
const EQUAL_SHARE: f64 = 0.05;
/// Relative difference of sample intervals that rounding may cause (1).
const INTERVAL_TOLERANCE: f64 = 1e-9;

/// One acquisition: settings and the seed of the noise.
pub struct AcquisitionSettings<'a> {
    /// Front panel.
    pub panel: &'a Panel,
    /// The same as front end and digitiser take it.
    pub setup: &'a Setup,
    /// Seed of the noise.
    pub seed: u64,
}

impl AcquisitionSettings<'_> {
    /// The record of every channel that is recorded and the trigger, or none if nothing triggers.
    /// Signals must have this set-up's sample interval; they arrive at `now` (s), which gives the
    /// phase of the mains.
    pub fn take(&self, signals: &Signals, now: f64) -> Option<(Vec<Waveform>, TriggerInstant)> {
        let model = &self.setup.model;
        let interval = self.setup.signal_interval();
        let external = &signals.external;
        let samples = signals.volts.iter().map(Vec::len).max().unwrap_or(0);
        let samples = samples.max(external.len()).max(1);
        let conditioned: Vec<Option<Vec<f64>>> = (1..)
            .zip(&self.setup.channels)
            .map(|(number, channel)| {
                let volts = signals.volts.get(usize::from(number) - 1);
                let mut volts = volts.cloned().unwrap_or_default();
                let last = volts.last().copied().unwrap_or(0.0);
                volts.resize(samples, last);
                let mut noise = noise_stream(self.seed, signals.shot, number);
                let channel = channel.as_ref()?;
                Some(condition(self.setup, channel, interval, &volts, &mut noise))
            })
            .collect();
        let automatic = signals.automatic;
        let found = if let Some(number) = self.panel.trigger.source.channel() {
            let signal = conditioned.get(usize::from(number) - 1).and_then(Option::as_ref);
            let scale = self.panel.channel(number).vertical.scale;
            self.find(signal.map(Vec::as_slice), scale, automatic)
        } else {
            let start = now - automatic as f64 * interval;
            let (signal, scale) = self.other_source(external, samples, start);
            self.find(Some(&signal), scale, automatic)
        }?;
        let record = |number: u8, signal: Option<&Vec<f64>>| {
            let channel = self.setup.channels.get(usize::from(number) - 1)?.as_ref()?;
            let source = Source::Channel(number);
            let signal = self.panel.records(number).then_some(signal)??;
            Some(digitise(self.setup, source, channel, signal, found.index))
        };
        let numbers = 1..=model.channels;
        let records =
            numbers.zip(&conditioned).filter_map(|(n, s)| record(n, s.as_ref())).collect();
        Some((records, TriggerInstant { shot: signals.shot, time: found.index as f64 * interval }))
    }

    /// The records of inputs at which nothing happens, at a time base whose signals are denser than
    /// its records: noise is drawn at the record's points alone, as there are hundreds of samples
    /// between them. None at other time bases, and for peak detection, which shows these samples.
    pub fn take_quiet(&self, shot: u32) -> Option<Vec<Waveform>> {
        let setup = self.setup;
        let interval = setup.model.interval(setup.time_base);
        let is_sparse = setup.acquisition.mode != AcquireMode::PeakDetect
            && setup.signal_interval() < (1.0 - INTERVAL_TOLERANCE) * interval;
        let silence = vec![0.0; setup.model.record_length];
        let quiet = |number: u8| {
            let channel = setup.channels.get(usize::from(number) - 1)?.as_ref()?;
            self.panel.records(number).then(|| {
                let mut noise = noise_stream(self.seed, shot, number);
                let volts = condition(setup, channel, interval, &silence, &mut noise);
                record(setup, Source::Channel(number), channel, volts)
            })
        };
        is_sparse.then(|| (1..=setup.model.channels).filter_map(quiet).collect())
    }

    /// Whether `signals` were made for the time base of this set-up, and have its sample interval,
    /// to rounding.
    pub fn fits(&self, signals: &Signals) -> bool {
        let interval = self.setup.signal_interval();
        signals
            .time_base
            .is_none_or(|made_for| made_for.to_bits() == self.setup.time_base.to_bits())
            && (signals.interval - interval).abs() <= INTERVAL_TOLERANCE * interval
    }

    /// The external input or the mains on the grid of the signals, and the scale that its
    /// sensitivity counts in (V/div).
    fn other_source(&self, external: &[f64], samples: usize, start: f64) -> (Vec<f64>, f64) {
        let (model, source) = (&self.setup.model, self.panel.trigger.source);
        if source == TriggerSource::Line {
            let phase =
                |n| TAU * model.line_frequency * (start + n as f64 * self.setup.signal_interval());
            let scale = TriggerSource::External.external_scale(model);
            return ((0..samples).map(|n| phase(n).sin()).collect(), scale);
        }
        let mut volts = external.to_vec();
        volts.resize(samples, external.last().copied().unwrap_or(0.0));
        (volts, source.external_scale(model))
    }

    fn find(
        &self,
        signal: Option<&[f64]>,
        scale: f64,
        automatic: usize,
    ) -> Option<TriggerPosition> {
        let fallback = (self.setup.trigger.mode == TriggerMode::Auto)
            .then_some(TriggerPosition { index: automatic, crossed: false });
        let Some(signal) = signal else { return fallback };
        match self.panel.trigger_type {
            TriggerType::Edge => {
                // The acquisition has seen to it that the part before the trigger is full.
                find_trigger(self.setup, scale, signal, automatic, 0)
            }
            TriggerType::Pulse => self.find_pulse(signal).or(fallback),
            // No input of this bench carries a video signal.
            TriggerType::Video => fallback,
        }
    }

    /// The end of the first pulse whose width is as asked for.
    fn find_pulse(&self, signal: &[f64]) -> Option<TriggerPosition> {
        let (level, pulse) = (self.panel.trigger.level, self.panel.pulse);
        let sign = match pulse.polarity {
            PulsePolarity::Positive => 1.0,
            PulsePolarity::Negative => -1.0,
        };
        let above = |volts: &f64| sign * (volts - level) >= 0.0;
        let mut inside = signal.first().is_some_and(above);
        let mut begun = None;
        for (index, volts) in signal.iter().enumerate() {
            let now = above(volts);
            if now && !inside {
                begun = Some(index);
            } else if !now
                && inside
                && let Some(start) = begun
                && self.is_wanted((index - start) as f64 * self.setup.signal_interval())
            {
                return Some(TriggerPosition { index, crossed: true });
            }
            inside = now;
        }
        None
    }

    fn is_wanted(&self, width: f64) -> bool {
        let pulse = &self.panel.pulse;
        let guard_band = self.setup.model.limits.pulse_guard_band;
        let tolerance = (EQUAL_SHARE * pulse.width).max(guard_band);
        let equal = (width - pulse.width).abs() <= tolerance;
        match pulse.when {
            PulseWhen::Equal => equal,
            PulseWhen::NotEqual => !equal,
            PulseWhen::Inside => width < pulse.width,
            PulseWhen::Outside => width > pulse.width,
        }
    }
}

/// Where in the signals of a shot the scope triggered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriggerInstant {
    /// Number of the shot.
    pub shot: u32,
    /// Time after the first sample of the signals (s).
    pub time: f64,
}

/// What records are made with: settings, and the time (s).
#[derive(Debug, Clone, PartialEq)]
pub struct Preparation {
    pub(super) panel: Panel,
    pub(super) setup: Setup,
    pub(super) seed: u64,
    pub(super) now: f64,
}

/// Records of signals under some settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    pub(super) by: Preparation,
    pub(super) taken: Option<(Vec<Waveform>, TriggerInstant)>,
}

impl Preparation {
    /// Conditions and digitises `signals`, and looks for the trigger. Signals of another sample
    /// interval have no records.
    pub fn take(self, signals: &Signals) -> Prepared {
        let settings =
            AcquisitionSettings { panel: &self.panel, setup: &self.setup, seed: self.seed };
        let taken = if settings.fits(signals) { settings.take(signals, self.now) } else { None };
        Prepared { by: self, taken }
    }

    /// Whether the same signals have the same records with this front panel and set-up.
    pub(super) fn is_like(&self, panel: &Panel, setup: &Setup) -> bool {
        let records = |number: &u8| self.panel.records(*number) == panel.records(*number);
        self.setup == *setup
            && self.panel.trigger_type == panel.trigger_type
            && self.panel.pulse == panel.pulse
            && (1..=setup.model.channels).all(|number| records(&number))
    }
}
