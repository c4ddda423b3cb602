//! What one oscilloscope model can do: the content of `instruments/<model>.toml`.

/// Limits of an oscilloscope model, all from its data file.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Model as the instrument writes it, e.g. `TDS 2014`.
    pub name: String,
    /// Serial number as its files write it.
    pub serial: String,
    /// Firmware as its files write it.
    pub firmware: String,
    /// The communication module with its version, as `*IDN?` writes it.
    pub interface: String,
    /// Number of input channels.
    pub channels: u8,
    /// Analogue bandwidth (Hz).
    pub bandwidth: f64,
    /// Bandwidth with the limiter on (Hz).
    pub limited_bandwidth: f64,
    /// Highest real-time sample rate (Hz).
    pub sample_rate: f64,
    /// Points in a record.
    pub record_length: usize,
    /// Horizontal divisions on the screen (div).
    pub horizontal_divisions: f64,
    /// Vertical scales at the input (V/div).
    pub vertical_scales: Vec<f64>,
    /// Time bases (s/div).
    pub time_bases: Vec<f64>,
    /// Probe attenuations (1).
    pub probes: Vec<f64>,
    /// Steps in which vertical positions come (div).
    pub position_step: f64,
    /// Input resistance (Ohm).
    pub input_resistance: f64,
    /// Input capacitance (F).
    pub input_capacitance: f64,
    /// Resistance seen through an attenuating probe (Ohm).
    pub probe_resistance: f64,
    /// Capacitance seen through an attenuating probe (F).
    pub probe_capacitance: f64,
    /// Corner of AC coupling (Hz).
    pub ac_corner: f64,
    /// Farthest trigger level from the screen's centre (div).
    pub trigger_range: f64,
    /// How far a signal must have been on the other side of the level before a crossing counts (div).
    pub trigger_hysteresis: f64,
    /// Farthest trigger level at the external input; the input divided by five goes five times as far (V).
    pub external_trigger_range: f64,
    /// Events that wait at the remote interface before further ones are lost.
    pub event_queue: usize,
}

impl Model {
    /// Time from one point of a record to the next (s).
    #[must_use]
    #[allow(clippy::cast_precision_loss, reason = "a record has a few thousand points")]
    pub fn interval(&self, time_base: f64) -> f64 {
        let interval = time_base / (self.record_length as f64 / self.horizontal_divisions);
        // The instrument's intervals are short decimals, which a binary quotient misses by an ulp: 25 ns / 250 is 0.1 ns.
        format!("{interval:.11e}").parse().unwrap_or(interval)
    }

    /// Time from one sample to the next: a record's interval, but no shorter than the converter's (s).
    #[must_use]
    pub fn sample_interval(&self, time_base: f64) -> f64 {
        self.interval(time_base).max(1.0 / self.sample_rate)
    }

    /// Index of the trigger in the record at a time base (s/div) and horizontal position (s), possibly outside it:
    /// `1250 - position/interval` on this family (1).
    #[must_use]
    #[allow(clippy::cast_precision_loss, reason = "a record has a few thousand points")]
    pub fn trigger_point(&self, time_base: f64, position: f64) -> f64 {
        0.5 * self.record_length as f64 - (position / self.interval(time_base)).round()
    }

    /// First and last time of the record after the trigger, at a time base (s/div) and horizontal position (s) (s).
    #[must_use]
    #[allow(clippy::cast_precision_loss, reason = "a record has a few thousand points")]
    pub fn record_span(&self, time_base: f64, position: f64) -> (f64, f64) {
        let interval = self.interval(time_base);
        let start = -self.trigger_point(time_base, position) * interval;
        (start, start + (self.record_length - 1) as f64 * interval)
    }
}
