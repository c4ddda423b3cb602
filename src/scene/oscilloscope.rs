//! An oscilloscope's data file, `instruments/<model>.toml`: the limits that a front panel is
//! checked against.

use super::model;
use super::model::{MAX_RECORD_LENGTH, series};
use super::reader::{Bound, TableReader};
use crate::quantity::{Dimension, engineering};
use crate::scope::Model;
use crate::scope::model::nearest;
/// Most events that a remote interface may keep.
const MAX_QUEUE_LENGTH: u64 = 1000;
/// A time base that puts fewer points than this on the scene's duration shows nothing of it (1).
const MIN_SAMPLES: f64 = 20.0;
/// Most samples on the scene's duration: each place that is watched keeps them all, 160 MB (1).
const MAX_SAMPLES: f64 = 2e7;
/// Rounding error of a division by the probe's attenuation (1).
const ROUND_OFF: f64 = 1e-12;

/// Reads the keys of an oscilloscope's data file. Every key is asked for before anything is given
/// up, so that all that is wrong is told at once and nothing right is called unknown.
pub fn model(table: &TableReader<'_>) -> Option<Model> {
    let what = "the name of an oscilloscope, e.g. \"tds2014\"";
    let named = table.required_text("model", what).is_some();
    // Without a model every key of its file would be missing: once is enough.
    let number = if named { TableReader::required } else { TableReader::quantity };
    let count = if named { TableReader::required_count } else { TableReader::count };
    let text =
        |key| if named { table.required_text(key, "text in quotes") } else { table.text(key) };
    let list = |key, dimension| series(table, key, dimension, named);
    let positive = |key, dimension| number(table, key, dimension, Bound::Positive);
    let (name, serial) = (text("name"), text("serial"));
    let (firmware, interface) = (text("firmware"), text("interface"));
    let record_length = count(table, "record_length", 2, MAX_RECORD_LENGTH);
    let channels = count(table, "channels", 1, 4);
    let bandwidth = positive("bandwidth", Dimension::FREQUENCY);
    let limited_bandwidth = positive("limited_bandwidth", Dimension::FREQUENCY);
    let sample_rate = positive("sample_rate", Dimension::FREQUENCY);
    let horizontal_divisions = positive("horizontal_divisions", Dimension::DIVISION);
    let vertical_scales = list("vertical_scales", Dimension::VOLTAGE_PER_DIVISION);
    let time_bases = list("time_bases", Dimension::TIME_PER_DIVISION);
    let probes = list("probes", Dimension::NONE);
    let position_step = positive("position_step", Dimension::DIVISION);
    let input_resistance = positive("input_resistance", Dimension::RESISTANCE);
    let input_capacitance = positive("input_capacitance", Dimension::CAPACITANCE);
    let probe_resistance = positive("probe_resistance", Dimension::RESISTANCE);
    let probe_capacitance = positive("probe_capacitance", Dimension::CAPACITANCE);
    let ac_corner = positive("ac_corner", Dimension::FREQUENCY);
    let trigger_range = positive("trigger_range", Dimension::DIVISION);
    let trigger_hysteresis =
        number(table, "trigger_hysteresis", Dimension::DIVISION, Bound::NotNegative);
    let high_frequency_reject = positive("high_frequency_reject", Dimension::FREQUENCY);
    let low_frequency_reject = positive("low_frequency_reject", Dimension::FREQUENCY);
    let external_trigger_range = positive("external_trigger_range", Dimension::VOLTAGE);
    let line_frequency = positive("line_frequency", Dimension::FREQUENCY);
    let full_bandwidth_from = positive("full_bandwidth_from", Dimension::VOLTAGE_PER_DIVISION);
    let peak_width = positive("peak_width", Dimension::TIME);
    let scan_from = positive("scan_from", Dimension::TIME_PER_DIVISION);
    let scan_gap = positive("scan_gap", Dimension::DIVISION);
    let event_queue = count(table, "event_queue", 2, MAX_QUEUE_LENGTH);
    if !named {
        return None;
    }
    let (limits, accuracy) = (model::limits(table), model::accuracy(table));
    let fft = model::fft(table, record_length);
    Some(Model {
        name: name?.to_owned(),
        serial: serial?.to_owned(),
        firmware: firmware?.to_owned(),
        interface: interface?.to_owned(),
        channels: u8::try_from(channels?).ok()?,
        bandwidth: bandwidth?,
        limited_bandwidth: limited_bandwidth?,
        sample_rate: sample_rate?,
        record_length: usize::try_from(record_length?).ok()?,
        horizontal_divisions: horizontal_divisions?,
        vertical_scales: vertical_scales?,
        time_bases: time_bases?,
        probes: probes?,
        position_step: position_step?,
        input_resistance: input_resistance?,
        input_capacitance: input_capacitance?,
        probe_resistance: probe_resistance?,
        probe_capacitance: probe_capacitance?,
        ac_corner: ac_corner?,
        trigger_range: trigger_range?,
        trigger_hysteresis: trigger_hysteresis?,
        high_frequency_reject: high_frequency_reject?,
        low_frequency_reject: low_frequency_reject?,
        external_trigger_range: external_trigger_range?,
        line_frequency: line_frequency?,
        full_bandwidth_from: full_bandwidth_from?,
        peak_width: peak_width?,
        scan_from: scan_from?,
        scan_gap: scan_gap?,
        event_queue: usize::try_from(event_queue?).ok()?,
        limits: limits?,
        accuracy: accuracy?,
        fft: fft?,
    })
}

/// A time base that the instrument does not have or that shows nothing of the scene is a mistake,
/// not a setting; so is a record that begins after the scene or ends before it. `window`: time base
/// (s/div) and horizontal position (s), if read.
pub fn check_window(
    table: &TableReader<'_>,
    model: &Model,
    window: (f64, Option<f64>),
    duration: Option<f64>,
) {
    let (time_base, position) = window;
    if !is_one_of(time_base, &model.time_bases) {
        let nearest = engineering(nearest(time_base, &model.time_bases), "s/div", 3);
        let expected = format!("a time base of the {}, the nearest is {nearest}", model.name);
        table.problem("time_base", engineering(time_base, "s/div", 4), expected);
    }
    let Some(duration) = duration else { return };
    let seconds = |time: f64| engineering(time, "s", 3);
    let shown = |samples: f64| {
        let time_base = engineering(time_base, "s/div", 3);
        format!("{time_base}, which puts {samples:.4} samples on {}", seconds(duration))
    };
    let points = duration / model.interval(time_base);
    if points < MIN_SAMPLES {
        let expected = format!("at least {MIN_SAMPLES} samples: a faster time base");
        table.problem("time_base", shown(points), expected);
    }
    let samples = duration / model.sample_interval(time_base);
    if samples > MAX_SAMPLES {
        let expected = format!("at most {MAX_SAMPLES:e}: a slower time base, or less time");
        table.problem("time_base", shown(samples), expected);
    }
    let Some(position) = position else { return };
    let (start, end) = model.record_span(time_base, position);
    if end <= 0.0 {
        let found = format!("a record that ends {} before the trigger", seconds(-end));
        table.problem("position", found, "a record that shows something after the trigger");
    }
    if start >= duration {
        let found = format!("a record that starts {} after the trigger", seconds(start));
        let expected = format!("a start within the scene's {}", seconds(duration));
        table.problem("position", found, expected);
    }
}

/// Limits of a channel's knobs: probe (1), scale (V/div) if read, position (div).
pub fn check_vertical(table: &TableReader<'_>, model: &Model, knobs: (f64, Option<f64>, f64)) {
    let (probe, scale, position) = knobs;
    if !is_one_of(probe, &model.probes) {
        let probes: Vec<String> = model.probes.iter().map(f64::to_string).collect();
        table.problem("probe", probe.to_string(), format!("one of {}", probes.join(", ")));
    }
    let (low, high) = ends(&model.vertical_scales);
    let beyond = |scale: f64| {
        let at_input = scale / probe;
        at_input < low * (1.0 - ROUND_OFF) || at_input > high * (1.0 + ROUND_OFF)
    };
    if let Some(scale) = scale.filter(|scale| beyond(*scale)) {
        let volts = |scale: f64| engineering(scale, "V/div", 3);
        let range = format!("{} to {} through this probe", volts(low * probe), volts(high * probe));
        table.problem("scale", volts(scale), range);
    }
    let steps = position / model.position_step;
    if (steps - steps.round()).abs() > 1e-9 * steps.abs().max(1.0) {
        let near = [steps.floor(), steps.ceil()].map(|steps| {
            let position = steps * model.position_step;
            (1e6 * position).round() / 1e6
        });
        let expected = format!(
            "a multiple of {} div, as on the front panel: {} div or {} div",
            model.position_step, near[0], near[1]
        );
        table.problem("position", format!("{position} div"), expected);
    }
}

/// The smallest and the largest of ascending values.
fn ends(values: &[f64]) -> (f64, f64) {
    (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(f64::INFINITY))
}

/// Whether `value` is one of `values`, to round-off.
fn is_one_of(value: f64, values: &[f64]) -> bool {
    values.iter().any(|v| (value - v).abs() <= 1e-9 * v)
}
