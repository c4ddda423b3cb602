//! Trigger and digitiser: from signals on a common sample grid to records.

use super::model::Model;
use super::setup::{ChannelSetup, Setup, Slope, TriggerMode};
use super::waveform::{
    HIGHEST_CODE, LEVELS_PER_DIVISION, LOWEST_CODE, PointFormat, Preamble, Source, VerticalSetup,
    Waveform,
};

/// Samples of a sinc on either side of a point when a record is denser than the converter's samples.
const SINC_REACH: i64 = 10;

/// Where a trigger was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TriggerPosition {
    /// Index of the first sample past the level.
    pub index: usize,
    /// Whether the signal crossed the level; an automatic trigger did not.
    pub crossed: bool,
}

/// Samples that must have been taken before a trigger is accepted: the record's part before it, and what interpolation
/// reaches for.
pub fn before_trigger(setup: &Setup) -> usize {
    let (start, _) = setup.record_span();
    let samples = (-start / setup.model.signal_interval(setup.time_base)).ceil();
    if samples > 0.0 { samples as usize + SINC_REACH as usize } else { 0 }
}

/// First sample at which the conditioned source `signal` (V) has crossed the trigger level in the right direction,
/// having been `hysteresis` beyond it before. A crossing before sample
/// `earliest` does not count: the part of the record before the trigger is not full yet. Without one, automatic mode triggers at
/// `automatic`.
pub fn find_trigger(
    setup: &Setup,
    scale: f64,
    signal: &[f64],
    automatic: usize,
    earliest: usize,
) -> Option<TriggerPosition> {
    let sign = match setup.trigger.slope {
        Slope::Rise => 1.0,
        Slope::Fall => -1.0,
    };
    let hysteresis = setup.model.trigger_hysteresis * scale;
    let mut armed = false;
    for (index, volts) in signal.iter().enumerate() {
        let beyond = sign * (volts - setup.trigger.level);
        if armed && beyond >= 0.0 && index >= earliest {
            return Some(TriggerPosition { index, crossed: true });
        }
        armed |= beyond <= -hysteresis;
    }
    (setup.trigger.mode == TriggerMode::Auto)
        .then_some(TriggerPosition { index: automatic, crossed: false })
}

/// The converter's level for a voltage (V).
pub fn level(vertical: &VerticalSetup, volts: f64) -> i16 {
    let y_mult = vertical.scale / LEVELS_PER_DIVISION;
    let level = (volts / y_mult + LEVELS_PER_DIVISION * vertical.position).round();
    level.clamp(f64::from(LOWEST_CODE), f64::from(HIGHEST_CODE)) as i16
}

/// The record of one channel around the trigger sample `trigger` of its conditioned `signal` (V), whose samples come
/// every `setup.model.signal_interval`. Points beyond the signal hold its nearest sample.
pub fn digitise(
    setup: &Setup,
    source: Source,
    channel: &ChannelSetup,
    signal: &[f64],
    trigger: usize,
) -> Waveform {
    let model = &setup.model;
    let interval = model.interval(setup.time_base);
    let trigger_point = setup.trigger_point();
    let vertical = channel.vertical;
    let codes = points(model, setup.time_base, signal, trigger, trigger_point);
    Waveform {
        source,
        codes: codes.into_iter().map(|volts| level(&vertical, volts)).collect(),
        preamble: Preamble {
            x_zero: -trigger_point * interval,
            x_incr: interval,
            pt_off: 0,
            x_unit: "s".to_owned(),
            y_mult: vertical.scale / LEVELS_PER_DIVISION,
            y_zero: 0.0,
            y_off: LEVELS_PER_DIVISION * vertical.position,
            y_unit: "V".to_owned(),
            pt_fmt: PointFormat::Sample,
        },
        vertical,
        horizontal_scale: setup.time_base,
        trigger_point,
    }
}

/// The conditioned `signal` (V) at the record's points around its trigger sample, before the converter rounds it (V).
pub fn volts_at_points(setup: &Setup, signal: &[f64], trigger: usize) -> Vec<f64> {
    points(&setup.model, setup.time_base, signal, trigger, setup.trigger_point())
}

/// Volts at the record's points: samples of the signal, or a windowed sin(x)/x between them where the record is denser
/// than the converter's fastest rate.
fn points(
    model: &Model,
    time_base: f64,
    signal: &[f64],
    trigger: usize,
    trigger_point: f64,
) -> Vec<f64> {
    let last = signal.len().saturating_sub(1) as i64;
    let sample = |index: i64| signal.get(index.clamp(0, last) as usize).copied().unwrap_or(0.0);
    let density = model.signal_interval(time_base) / model.interval(time_base);
    let point = |n: usize| {
        let place = (n as f64 - trigger_point) / density + trigger as f64;
        let nearest = place.round();
        if (place - nearest).abs() < 1e-6 { sample(nearest as i64) } else { sinc(place, &sample) }
    };
    (0..model.record_length).map(point).collect()
}

/// Lanczos interpolation at `place`, in samples.
fn sinc(place: f64, sample: &dyn Fn(i64) -> f64) -> f64 {
    let kernel = |x: f64| {
        if x == 0.0 { 1.0 } else { (std::f64::consts::PI * x).sin() / (std::f64::consts::PI * x) }
    };
    let base = place.floor() as i64;
    let mut sum = 0.0;
    let mut weights = 0.0;
    for index in base - SINC_REACH + 1..=base + SINC_REACH {
        let x = place - index as f64;
        let weight = kernel(x) * kernel(x / SINC_REACH as f64);
        sum += weight * sample(index);
        weights += weight;
    }
    sum / weights
}
