//! The front panel: how the scope is set before it is armed.

use std::fmt;

use rand_distr::{Distribution as _, StandardUniform};
use rand_pcg::Pcg64;

use super::model::Model;
use super::waveform::VerticalSetup;
use super::word::{Word, words};

/// A channel that is on.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelSetup {
    /// Vertical settings.
    pub vertical: VerticalSetup,
    /// Name of the sensor at its input; none leaves the input open, at zero volts.
    pub input: Option<String>,
    /// Offset error of the channel's amplifier, at the probe's tip (V).
    pub offset: f64,
    /// Errors of this amplifier within its data sheet.
    pub deviation: Deviation,
}

/// How far one amplifier is off, in parts of what its data sheet allows, from -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// Of the gain (1).
    pub gain: f64,
    /// Of zero (1).
    pub offset: f64,
}

impl Deviation {
    /// The deviation of channel `number`: even between the limits, the same for the same `seed`
    /// whatever is measured.
    pub fn drawn(seed: u64, number: u8) -> Self {
        let mut numbers = Pcg64::new(u128::from(seed), DEVIATIONS | u128::from(number));
        let mut draw = || StandardUniform.sample(&mut numbers);
        let (gain, offset): (f64, f64) = (draw(), draw());
        Self { gain: 2.0 * gain - 1.0, offset: 2.0 * offset - 1.0 }
    }
}

/// Streams of random numbers that no noise takes: those count shots in the bits above the
/// channel's.
const DEVIATIONS: u128 = 1 << 64;

words! {
    /// Direction in which the signal crosses the trigger level.
    Slope {
        /// Upward.
        Rise = "RISe",
        /// Downward.
        Fall = "FALL",
    }
}

words! {
    /// Behaviour without a trigger.
    TriggerMode {
        /// The scope takes a record anyway.
        Auto = "AUTO",
        /// The scope waits.
        Normal = "NORMal",
    }
}

/// How much farther the external input reaches with its divider (1).
const DIVIDER: f64 = 5.0;

/// Where the trigger looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TriggerSource {
    /// An input channel, counted from 1.
    Channel(u8),
    /// The external input.
    External,
    /// The external input divided by five.
    External5,
    /// The mains.
    Line,
}

impl TriggerSource {
    /// The channel's number, counted from 1; none for what is no channel.
    pub fn channel(self) -> Option<u8> {
        match self {
            Self::Channel(number) => Some(number),
            Self::External | Self::External5 | Self::Line => None,
        }
    }

    /// Farthest level of a source other than a channel; that of the mains is fixed (V).
    pub fn reach(self, model: &Model) -> f64 {
        match self {
            Self::External => model.external_trigger_range,
            Self::External5 => DIVIDER * model.external_trigger_range,
            Self::Channel(_) | Self::Line => 0.0,
        }
    }

    /// Scale of the external input, by which its sensitivity is stated (V/div).
    pub fn external_scale(self, model: &Model) -> f64 {
        self.reach(model) / model.trigger_range
    }
}

impl Word for TriggerSource {
    const WORDS: &'static [(Self, &'static str)] = &[
        (Self::Channel(1), "CH1"),
        (Self::Channel(2), "CH2"),
        (Self::Channel(3), "CH3"),
        (Self::Channel(4), "CH4"),
        (Self::External, "EXT"),
        (Self::External5, "EXT5"),
        (Self::Line, "LINE"),
    ];

    fn exists(self, channels: u8) -> bool {
        self.channel().is_none_or(|number| number <= channels)
    }
}

impl fmt::Display for TriggerSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Channel(number) => write!(f, "CH{number}"),
            Self::External => f.write_str("EXT"),
            Self::External5 => f.write_str("EXT5"),
            Self::Line => f.write_str("LINE"),
        }
    }
}

words! {
    /// Coupling of the edge trigger.
    EdgeCoupling {
        /// Nothing is left out.
        Dc = "DC",
        /// The mean is left out.
        Ac = "AC",
        /// High frequencies are left out.
        HighFrequencyReject = "HFRej",
        /// Low frequencies are left out.
        LowFrequencyReject = "LFRej",
        /// Crossings must be twice as large.
        NoiseReject = "NOISErej",
    }
}

words! {
    /// Acquisition mode.
    AcquireMode {
        /// The first sample of each interval.
        Sample = "SAMple",
        /// Lowest and highest sample of each two intervals.
        PeakDetect = "PEAKdetect",
        /// The mean of several records.
        Average = "AVErage",
    }
}

/// How records are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AcquireSetup {
    /// Sample, peak detect or average.
    pub mode: AcquireMode,
    /// Records in an average.
    pub averages: u32,
}

impl AcquireSetup {
    /// Records that make one: one, unless they are averaged.
    pub fn depth(self) -> u32 {
        if self.mode == AcquireMode::Average { self.averages.max(1) } else { 1 }
    }
}

impl Default for AcquireSetup {
    fn default() -> Self {
        Self { mode: AcquireMode::Sample, averages: 16 }
    }
}

/// Part of the shortest pulse between samples that still shows nearly all of its height (1).
const SHARE_OF_PEAK: f64 = 0.25;
/// Maximum number of samples per point in peak detection (1).
const MAX_SAMPLES_PER_POINT: f64 = 100.0;

/// The edge trigger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trigger {
    /// The trigger source.
    pub source: TriggerSource,
    /// Level to cross (V).
    pub level: f64,
    /// Direction of the crossing.
    pub slope: Slope,
    /// Auto or normal.
    pub mode: TriggerMode,
    /// Coupling.
    pub coupling: EdgeCoupling,
    /// Time after a trigger in which no other is taken (s).
    pub holdoff: f64,
}

/// The whole front panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Limits of the instrument.
    pub model: Model,
    /// Channels 1 to 4; `None` is off.
    pub channels: Vec<Option<ChannelSetup>>,
    /// Name of the sensor at the external trigger input; none leaves it open.
    pub external: Option<String>,
    /// Time base (s/div).
    pub time_base: f64,
    /// Time of the screen's centre after the trigger: positive puts the trigger left of the centre
    /// (s).
    pub horizontal_position: f64,
    /// The trigger.
    pub trigger: Trigger,
    /// How records are taken.
    pub acquisition: AcquireSetup,
    /// Noise of the front end, root mean square; 0 is off (div).
    pub noise: f64,
}

impl Setup {
    /// Index of the trigger in the record, possibly outside it: `1250 - position/interval` on this
    /// family (1).
    pub fn trigger_point(&self) -> f64 {
        self.model.trigger_point(self.time_base, self.horizontal_position)
    }

    /// Time between samples of the signal: close enough for circuits and trigger, or in peak
    /// detection close enough to keep the shortest pulse, as far as memory allows (s).
    pub fn signal_interval(&self) -> f64 {
        if self.acquisition.mode != AcquireMode::PeakDetect {
            return self.model.signal_interval(self.time_base);
        }
        let slow = self.model.sample_interval(self.time_base);
        let dense = (SHARE_OF_PEAK * self.model.peak_width).max(1.0 / self.model.sample_rate);
        slow / (slow / dense).floor().clamp(1.0, MAX_SAMPLES_PER_POINT)
    }

    /// First and last time of the record after the trigger (s).
    pub fn record_span(&self) -> (f64, f64) {
        self.model.record_span(self.time_base, self.horizontal_position)
    }
}
