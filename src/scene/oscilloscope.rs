//! An oscilloscope's data file, `instruments/MODEL.toml`, and the checks of a front panel against
//! it.

use super::table::{Bound, FromTable, TableReader};
use super::table::{count, not_negative, positive, quantity, series, table, table_of, text};
use crate::quantity::{Dimension, engineering};
use crate::scope::Model;
use crate::scope::limits::vertical_reach;
use crate::scope::model::{Accuracy, FftLaw, KnobLimits, nearest};

/// Most points of a record: those of a scope of any make.
const MAX_RECORD_LENGTH: u64 = 1_000_000;
/// Most events that a remote interface may keep.
const MAX_QUEUE_LENGTH: u64 = 1000;
/// A time base that puts fewer points than this on the scene's duration shows nothing of it (1).
const MIN_SAMPLES: f64 = 20.0;
/// Most samples on the scene's duration: each place that is watched keeps them all, 160 MB (1).
const MAX_SAMPLES: f64 = 2e7;
/// Rounding error of a division by the probe's attenuation (1).
const ROUND_OFF: f64 = 1e-12;

/// Words about a table of the file that is missing.
const PART: &str = "a table of the oscilloscope's data file";

table! {
    /// The data file beside its name in `model`.
    pub ModelKeys => Model {
        name = text(),
        serial = text(),
        firmware = text(),
        interface = text(),
        record_length = count(2, MAX_RECORD_LENGTH),
        /// bits of the converter: a division has 25 * 2^(bits - 8) levels
        bits = count(8, 16).or("8"),
        channels = count(1, 4),
        bandwidth = positive(Dimension::FREQUENCY),
        limited_bandwidth = positive(Dimension::FREQUENCY),
        sample_rate = positive(Dimension::FREQUENCY),
        horizontal_divisions = positive(Dimension::DIVISION),
        vertical_scales = series(Dimension::VOLTAGE_PER_DIVISION),
        time_bases = series(Dimension::TIME_PER_DIVISION),
        probes = series(Dimension::NONE),
        position_step = positive(Dimension::DIVISION),
        input_resistance = positive(Dimension::RESISTANCE),
        input_capacitance = positive(Dimension::CAPACITANCE),
        probe_resistance = positive(Dimension::RESISTANCE),
        probe_capacitance = positive(Dimension::CAPACITANCE),
        ac_corner = positive(Dimension::FREQUENCY),
        trigger_range = positive(Dimension::DIVISION),
        trigger_hysteresis = not_negative(Dimension::DIVISION),
        high_frequency_reject = positive(Dimension::FREQUENCY),
        low_frequency_reject = positive(Dimension::FREQUENCY),
        external_trigger_range = positive(Dimension::VOLTAGE),
        line_frequency = positive(Dimension::FREQUENCY),
        full_bandwidth_from = positive(Dimension::VOLTAGE_PER_DIVISION),
        peak_width = positive(Dimension::TIME),
        scan_from = positive(Dimension::TIME_PER_DIVISION),
        scan_gap = positive(Dimension::DIVISION),
        event_queue = count(2, MAX_QUEUE_LENGTH),
        limits "scope_limits" =
            table_of(&[LimitKeys::KEYS]).needs(PART),
        accuracy = table_of(&[AccuracyKeys::KEYS]).needs(PART),
        fft = table_of(&[FftKeys::KEYS]).needs(PART),
    }
}

table! {
    /// `[scope_limits]`.
    pub struct LimitKeys<'a> {
        near_offset: f64 = positive(Dimension::VOLTAGE).required(),
        near_offset_until: f64 = positive(Dimension::VOLTAGE_PER_DIVISION).required(),
        far_offset: f64 = positive(Dimension::VOLTAGE).required(),
        earliest_position: f64 = positive(Dimension::DIVISION).required(),
        latest_positions_until: Vec<f64> = series(Dimension::TIME_PER_DIVISION).required(),
        latest_positions: Vec<f64> = series(Dimension::TIME).required(),
        holdoff: (f64, f64) = series(Dimension::TIME).required(),
        pulse_width: (f64, f64) = series(Dimension::TIME).required(),
        pulse_guard_band: f64 = positive(Dimension::TIME).required(),
        averages: Vec<f64> = series(Dimension::NONE).required(),
    }
}

table! {
    /// `[accuracy]`.
    pub AccuracyKeys => Accuracy {
        gain = not_negative(Dimension::NONE),
        low_scale_gain = not_negative(Dimension::NONE),
        low_scale_until = not_negative(Dimension::VOLTAGE_PER_DIVISION),
        offset = not_negative(Dimension::DIVISION),
        input_offset = not_negative(Dimension::VOLTAGE),
        time = not_negative(Dimension::NONE).or("50 ppm"),
    }
}

table! {
    /// `[fft]`.
    pub struct FftKeys<'a> {
        points: usize = count(4, MAX_RECORD_LENGTH).required(),
        level: f64 = positive(Dimension::NONE).required(),
        reference: f64 = quantity(Dimension::NONE, Bound::Any).required(),
        lowest_level: f64 = quantity(Dimension::NONE, Bound::Any).required(),
        slow_from: f64 = positive(Dimension::TIME_PER_DIVISION).required(),
        slow_rate: (f64, f64) = series(Dimension::NONE).required(),
    }
}

impl FromTable<'_> for KnobLimits {
    fn from_table(table: &TableReader<'_>) -> Option<Self> {
        LimitKeys::read(table).limits()
    }
}

impl FromTable<'_> for FftLaw {
    fn from_table(table: &TableReader<'_>) -> Option<Self> {
        FftKeys::read(table).law()
    }
}

impl LimitKeys<'_> {
    fn limits(self) -> Option<KnobLimits> {
        let (until, latest) = (self.latest_positions_until?, self.latest_positions?);
        if until.len() != latest.len() {
            let found = format!("{} positions", latest.len());
            let expected = format!("{}, one for each of latest_positions_until", until.len());
            self.table.problem("latest_positions", found, expected);
        }
        Some(KnobLimits {
            near_offset: self.near_offset?,
            near_offset_until: self.near_offset_until?,
            far_offset: self.far_offset?,
            earliest_position: self.earliest_position?,
            latest_positions: until.into_iter().zip(latest).collect(),
            holdoff: self.holdoff?,
            pulse_width: self.pulse_width?,
            pulse_guard_band: self.pulse_guard_band?,
            averages: self.averages?.into_iter().map(|number| number.round() as u32).collect(),
        })
    }
}

impl FftKeys<'_> {
    /// The law of spectra.
    fn law(self) -> Option<FftLaw> {
        let points = self.points.filter(|points| points.is_power_of_two());
        if let (Some(points), None) = (self.points, points) {
            self.table.problem("points", points.to_string(), "a power of two");
        }
        let (less, more) = self.slow_rate?;
        Some(FftLaw {
            points: points?,
            level: self.level?,
            reference: self.reference?,
            lowest_level: self.lowest_level?,
            slow_from: self.slow_from?,
            slow_rate: more / less,
        })
    }
}

/// The model of a scope in `table`.
pub fn model(table: &TableReader<'_>) -> Option<Model> {
    let model = ModelKeys::read(table)?;
    if model.fft.points > model.record_length {
        let expected = format!("at most the {} points of a record", model.record_length);
        table.problem("fft", format!("{} points of a spectrum", model.fft.points), expected);
    }
    Some(model)
}

/// Refuses a time base that the instrument does not have or that shows nothing of the scene, and a
/// record that begins after the scene or ends before it. `window`: time base (s/div) and horizontal
/// position (s), if read.
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
    let reach = scale.map_or(f64::INFINITY, |scale| vertical_reach(model, scale, probe));
    if position.abs() > reach {
        let reach = (1e4 * reach).round() / 1e4;
        let expected = format!("a position within {reach} div at this scale");
        table.problem("position", format!("{position} div"), expected);
        return;
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
