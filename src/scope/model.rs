//! Limits of an oscilloscope model: the content of `instruments/<model>.toml`.

use std::ops::RangeInclusive;

use super::waveform::{VerticalSetup, codes, levels_per_division};

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
    /// Smallest scale at the input with the full bandwidth; below it the limiter is always on
    /// (V/div).
    pub full_bandwidth_from: f64,
    /// Highest real-time sample rate (Hz).
    pub sample_rate: f64,
    /// Bits of the converter.
    pub bits: u8,
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
    /// How far a signal must have been on the other side of the level before a crossing counts
    /// (div).
    pub trigger_hysteresis: f64,
    /// Corner above which the trigger's high-frequency rejection is deaf (Hz).
    pub high_frequency_reject: f64,
    /// Corner below which the trigger's low-frequency rejection is deaf (Hz).
    pub low_frequency_reject: f64,
    /// Farthest trigger level at the external input; the input divided by five goes five times as
    /// far (V).
    pub external_trigger_range: f64,
    /// Frequency of the mains, which the trigger can follow (Hz).
    pub line_frequency: f64,
    /// Shortest pulse that peak detection keeps (s).
    pub peak_width: f64,
    /// Fastest time base that automatic mode scans (s/div).
    pub scan_from: f64,
    /// Blank part of the screen ahead of a scanned sweep (div).
    pub scan_gap: f64,
    /// Events that wait at the remote interface before further ones are lost.
    pub event_queue: usize,
    /// How far knobs turn.
    pub limits: KnobLimits,
    /// Errors that the data sheet allows.
    pub accuracy: Accuracy,
    /// How a spectrum is computed and scaled.
    pub fft: FftLaw,
}

/// How far knobs turn.
#[derive(Debug, Clone, PartialEq)]
pub struct KnobLimits {
    /// Farthest vertical position at the input on small scales (V).
    pub near_offset: f64,
    /// Largest of the small scales, at the input (V/div).
    pub near_offset_until: f64,
    /// Farthest vertical position at the input on large scales (V).
    pub far_offset: f64,
    /// Farthest that the screen's centre goes before the trigger (div).
    pub earliest_position: f64,
    /// Time base (s/div) up to which the screen's centre goes so far after the trigger (s).
    pub latest_positions: Vec<(f64, f64)>,
    /// Shortest and longest holdoff (s).
    pub holdoff: (f64, f64),
    /// Shortest and longest pulse width (s).
    pub pulse_width: (f64, f64),
    /// Pulse widths that differ by no more count as equal (s).
    pub pulse_guard_band: f64,
    /// Records that can make an average.
    pub averages: Vec<u32>,
}

/// Errors that the data sheet allows.
#[derive(Debug, Clone, PartialEq)]
pub struct Accuracy {
    /// Of the gain (1).
    pub gain: f64,
    /// Of the gain on the smallest scales (1).
    pub low_scale_gain: f64,
    /// Largest of the smallest scales, at the input (V/div).
    pub low_scale_until: f64,
    /// Of zero on the screen (div).
    pub offset: f64,
    /// Of zero at the input, in addition (V).
    pub input_offset: f64,
    /// Of times, which no simulated error is drawn from (1).
    pub time: f64,
}

/// The nearest of `choices` on a logarithmic scale, or `value` if there are none (unit).
pub fn nearest(value: f64, choices: &[f64]) -> f64 {
    let distance = |choice: &f64| if value > 0.0 { (choice / value).ln().abs() } else { *choice };
    choices.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(value)
}

/// Contacts last 20 us and more: their forces run straight over a microsecond to 0.2 % (s).
const RESOLVED: f64 = 1e-6;
/// Most samples of the signal for one of the converter's: what memory allows.
const MOST_SIGNAL_SAMPLES: f64 = 800.0;

/// Samples of the signal for one of the converter's, which come every `interval` (s) (1).
pub fn signal_samples(interval: f64) -> f64 {
    (interval / RESOLVED - 1e-6).ceil().clamp(1.0, MOST_SIGNAL_SAMPLES)
}

impl Accuracy {
    /// Largest error of the gain on `scale` (V/div) at the input (1).
    pub fn gain_at(&self, scale: f64) -> f64 {
        if scale <= self.low_scale_until * RANGE_END_FACTOR {
            self.low_scale_gain
        } else {
            self.gain
        }
    }

    /// Largest offset on `scale` (V/div) at the input, referred to the input (V).
    pub fn offset_at(&self, scale: f64) -> f64 {
        self.offset * scale + self.input_offset
    }
}

/// How a spectrum is computed and scaled: a level is `level` dB, level 0 is
/// `20 log10(V/div) + reference` dB.
#[derive(Debug, Clone, PartialEq)]
pub struct FftLaw {
    /// Points of the record that are transformed, from its middle; twice as many as bins.
    pub points: usize,
    /// One level (dB).
    pub level: f64,
    /// Level 0 on a scale of 1 V/div (dB).
    pub reference: f64,
    /// Lowest level (1).
    pub lowest_level: f64,
    /// Fastest time base whose transform has the odd sample rate (s/div).
    pub slow_from: f64,
    /// The odd sample rate over the record's (1).
    pub slow_rate: f64,
}

/// A hair above one, so that the end of a range of scales belongs to it.
pub(crate) const RANGE_END_FACTOR: f64 = 1.0 + 1e-9;

impl Model {
    /// One digitiser level on `scale` (V/div) (V).
    pub fn level(&self, scale: f64) -> f64 {
        scale / levels_per_division(self.bits)
    }

    /// Lowest to highest level of the converter.
    pub fn codes(&self) -> RangeInclusive<i16> {
        codes(self.bits)
    }

    /// Lowest and highest voltage that the converter shows with these settings (V).
    pub fn range(&self, vertical: &VerticalSetup) -> [f64; 2] {
        let codes = self.codes();
        [*codes.start(), *codes.end()].map(|code| {
            let divisions = f64::from(code) / levels_per_division(self.bits);
            vertical.scale * (divisions - vertical.position)
        })
    }

    /// Time from one point of a record to the next (s).
    pub fn interval(&self, time_base: f64) -> f64 {
        let interval = time_base / (self.record_length as f64 / self.horizontal_divisions);
        // The instrument's intervals are short decimals, which a binary quotient misses by an ulp:
        // 25 ns / 250 is 0.1 ns.
        format!("{interval:.11e}").parse().unwrap_or(interval)
    }

    /// Time from one sample to the next: a record's interval, but no shorter than the converter's
    /// (s).
    pub fn sample_interval(&self, time_base: f64) -> f64 {
        self.interval(time_base).max(1.0 / self.sample_rate)
    }

    /// Time between samples of the signal in front of converter and trigger: a whole part of the
    /// converter's interval that resolves what sensors deliver, so that circuits and the trigger's
    /// comparator see the signal and not the record's samples (s).
    pub fn signal_interval(&self, time_base: f64) -> f64 {
        let slow = self.sample_interval(time_base);
        slow / signal_samples(slow)
    }

    /// Whether automatic mode scans at a time base (s/div).
    pub fn scans(&self, time_base: f64) -> bool {
        time_base * RANGE_END_FACTOR >= self.scan_from
    }

    /// Index of the trigger in the record at a time base (s/div) and horizontal position (s),
    /// possibly outside it: `1250 - position/interval` on this family (1).
    pub fn trigger_point(&self, time_base: f64, position: f64) -> f64 {
        0.5 * self.record_length as f64 - (position / self.interval(time_base)).round()
    }

    /// First and last time of the record after the trigger, at a time base (s/div) and horizontal
    /// position (s) (s).
    pub fn record_span(&self, time_base: f64, position: f64) -> (f64, f64) {
        let interval = self.interval(time_base);
        let start = -self.trigger_point(time_base, position) * interval;
        (start, start + (self.record_length - 1) as f64 * interval)
    }
}
