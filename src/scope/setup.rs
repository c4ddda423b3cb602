//! The front panel: how the scope is set before it is armed.

use super::model::Model;
use super::waveform::{Source, VerticalSetup};

/// A channel that is on.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelSetup {
    /// Vertical settings.
    pub vertical: VerticalSetup,
    /// Name of the sensor at its input; none leaves the input open, at zero volts.
    pub input: Option<String>,
    /// What the channel's amplifier adds to every voltage: its offset error, at the probe's tip (V).
    pub offset: f64,
}

/// Direction in which the signal crosses the trigger level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Slope {
    /// Upward.
    Rise,
    /// Downward.
    Fall,
}

/// What happens when no trigger comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TriggerMode {
    /// The scope takes a record anyway.
    Auto,
    /// The scope waits.
    Normal,
}

/// The edge trigger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trigger {
    /// The channel that is watched.
    pub source: Source,
    /// Level to cross (V).
    pub level: f64,
    /// Direction of the crossing.
    pub slope: Slope,
    /// Auto or normal.
    pub mode: TriggerMode,
}

/// The whole front panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Limits of the instrument.
    pub model: Model,
    /// Channels 1 to 4; `None` is off.
    pub channels: Vec<Option<ChannelSetup>>,
    /// Time base (s/div).
    pub time_base: f64,
    /// Time of the screen's centre after the trigger: positive puts the trigger left of the centre (s).
    pub horizontal_position: f64,
    /// The trigger.
    pub trigger: Trigger,
    /// Noise of the front end, root mean square; 0 is off (div).
    pub noise: f64,
}

impl Setup {
    /// Index of the trigger in the record, possibly outside it: `1250 - position/interval` on this family (1).
    #[must_use]
    pub fn trigger_point(&self) -> f64 {
        self.model.trigger_point(self.time_base, self.horizontal_position)
    }

    /// First and last time of the record after the trigger (s).
    #[must_use]
    pub fn record_span(&self) -> (f64, f64) {
        self.model.record_span(self.time_base, self.horizontal_position)
    }
}
