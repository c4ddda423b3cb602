//! Trigger and digitiser: from signals on a common sample grid to records.

use std::borrow::Cow;
use std::f64::consts::TAU;

use super::front_end::{high_pass, low_pass};
use super::model::Model;
use super::setup::{AcquireMode, ChannelSetup, EdgeCoupling, Setup, Slope, TriggerMode};
use super::waveform::{
    PointFormat, Preamble, Source, VerticalSetup, Waveform, levels_per_division,
};

/// How much larger a crossing must be where small ones are rejected (1).
const NOISE_REJECT_FACTOR: f64 = 2.0;
/// Samples of a sinc on either side of a point when a record is denser than the converter's
/// samples.
const SINC_REACH: i64 = 10;

/// Where a trigger was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TriggerPosition {
    /// Index of the first sample past the level.
    pub index: usize,
    /// Whether the signal crossed the level; an automatic trigger did not.
    pub crossed: bool,
}

/// Samples that must have been taken before a trigger is accepted: the record's part before it, and
/// what interpolation reaches for.
pub fn before_trigger(setup: &Setup) -> usize {
    let (start, _) = setup.record_span();
    let samples = (-start / setup.signal_interval()).ceil();
    if samples > 0.0 { samples as usize + SINC_REACH as usize } else { 0 }
}

/// First sample at which the conditioned source `signal` (V) has crossed the trigger level in the
/// right direction, having been `hysteresis` beyond it before. A crossing before sample `earliest`
/// does not count: the part of the record before the trigger is not full yet. Without one,
/// automatic mode triggers at `automatic`.
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
    let coupling = setup.trigger.coupling;
    let share = if coupling == EdgeCoupling::NoiseReject { NOISE_REJECT_FACTOR } else { 1.0 };
    let hysteresis = share * setup.model.trigger_hysteresis * scale;
    let signal = coupled(setup, signal);
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

/// The trigger source's signal after the trigger coupling (V).
fn coupled<'s>(setup: &Setup, signal: &'s [f64]) -> Cow<'s, [f64]> {
    let model = &setup.model;
    let ratio = |corner: f64| TAU * corner * setup.signal_interval();
    match setup.trigger.coupling {
        EdgeCoupling::Dc | EdgeCoupling::NoiseReject => signal.into(),
        EdgeCoupling::Ac => high_pass(signal, ratio(model.ac_corner)).into(),
        EdgeCoupling::LowFrequencyReject => {
            high_pass(signal, ratio(model.low_frequency_reject)).into()
        }
        EdgeCoupling::HighFrequencyReject => {
            low_pass(signal, ratio(model.high_frequency_reject)).into()
        }
    }
}

/// The converter's level for a voltage (V).
pub fn level(model: &Model, vertical: &VerticalSetup, volts: f64) -> i16 {
    let y_mult = model.level(vertical.scale);
    let level = (volts / y_mult + levels_per_division(model.bits) * vertical.position).round();
    let codes = model.codes();
    level.clamp(f64::from(*codes.start()), f64::from(*codes.end())) as i16
}

/// The record of one channel around the trigger sample `trigger` of its conditioned `signal` (V),
/// whose samples come every [`Setup::signal_interval`]. Points beyond the signal hold its nearest
/// sample.
pub fn digitise(
    setup: &Setup,
    source: Source,
    channel: &ChannelSetup,
    signal: &[f64],
    trigger: usize,
) -> Waveform {
    let record = record(setup, source, channel, points(setup, signal, trigger));
    if setup.acquisition.mode == AcquireMode::PeakDetect {
        envelope(record, setup, signal, trigger)
    } else {
        record
    }
}

/// The record of a channel's `volts` at the record's points (V).
pub fn record(setup: &Setup, source: Source, channel: &ChannelSetup, volts: Vec<f64>) -> Waveform {
    let model = &setup.model;
    let interval = model.interval(setup.time_base);
    let trigger_point = setup.trigger_point();
    let vertical = channel.vertical;
    Waveform {
        source,
        codes: volts.into_iter().map(|volts| level(model, &vertical, volts)).collect(),
        as_read: Vec::new(),
        preamble: Preamble {
            x_zero: -trigger_point * interval,
            x_incr: interval,
            pt_off: 0,
            x_unit: "s".to_owned(),
            y_mult: model.level(vertical.scale),
            y_zero: 0.0,
            y_off: levels_per_division(model.bits) * vertical.position,
            y_unit: "V".to_owned(),
            pt_fmt: PointFormat::Sample,
        },
        vertical,
        horizontal_scale: setup.time_base,
        trigger_point,
    }
}

/// The record in peak-detect mode: lowest and highest sample of each two intervals in turn.
fn envelope(mut record: Waveform, setup: &Setup, signal: &[f64], trigger: usize) -> Waveform {
    record.preamble.pt_fmt = PointFormat::Envelope;
    let step = record.preamble.x_incr / setup.signal_interval();
    let vertical = record.vertical;
    let last = signal.len().saturating_sub(1);
    let place = |n: usize| {
        (((n as f64 - record.trigger_point) * step + trigger as f64).round() as usize).min(last)
    };
    for (pair, points) in record.codes.chunks_exact_mut(2).enumerate() {
        let (from, to) = (place(2 * pair), place(2 * pair + 2));
        let window = signal.get(from..to.max(from + 1)).unwrap_or_default();
        let low = window.iter().copied().fold(f64::INFINITY, f64::min);
        let high = window.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if let [first, second] = points
            && low <= high
        {
            (*first, *second) =
                [low, high].map(|volts| level(&setup.model, &vertical, volts)).into();
        }
    }
    record
}

/// Folds record `number` (counted from 1) of an average of up to `depth` into the mean of those
/// before, in levels.
pub fn fold_average(mean: &mut Vec<f64>, record: &mut Waveform, number: u32, depth: u32) {
    if mean.len() != record.codes.len() || number <= 1 {
        *mean = record.codes.iter().map(|code| f64::from(*code)).collect();
        return;
    }
    let weight = 1.0 / f64::from(number.min(depth).max(1));
    for (mean, code) in mean.iter_mut().zip(&mut record.codes) {
        *mean += weight * (f64::from(*code) - *mean);
        let level = mean.round() as i16;
        *code = level;
    }
}

/// The conditioned `signal` (V) at the record's points around its trigger sample, within the
/// converter's range but not rounded (V).
pub fn volts_at_points(
    setup: &Setup,
    vertical: &VerticalSetup,
    signal: &[f64],
    trigger: usize,
) -> Vec<f64> {
    let [low, high] = setup.model.range(vertical);
    points(setup, signal, trigger).into_iter().map(|volts| volts.clamp(low, high)).collect()
}

/// Volts at the record's points: samples of the signal, or a windowed sin(x)/x between them where
/// the record is denser than the converter's fastest rate.
fn points(setup: &Setup, signal: &[f64], trigger: usize) -> Vec<f64> {
    let (model, trigger_point) = (&setup.model, setup.trigger_point());
    let last = signal.len().saturating_sub(1) as i64;
    let sample = |index: i64| signal.get(index.clamp(0, last) as usize).copied().unwrap_or(0.0);
    let density = setup.signal_interval() / model.interval(setup.time_base);
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
