//! Parts of an oscilloscope's data file that stand in tables of their own: limits, accuracy, the
//! law of spectra.

use super::problem::MISSING;
use super::reader::{Bound, TableReader};
use crate::quantity::{Dimension, parse};
use crate::scope::model::{Accuracy, FftLaw, KnobLimits};

/// Reads a table that must be there, to its last key.
fn part<T>(
    table: &TableReader<'_>,
    key: &'static str,
    read: impl Fn(&TableReader<'_>) -> Option<T>,
) -> Option<T> {
    if !table.has(key) {
        table.problem(key, MISSING, "a table of the oscilloscope's data file");
    }
    let inner = table.table(key)?;
    let value = read(&inner);
    inner.finish();
    value
}

/// The two ends of a range.
fn range(table: &TableReader<'_>, key: &'static str, dimension: Dimension) -> Option<(f64, f64)> {
    match series(table, key, dimension, true)?.as_slice() {
        [least, most] => Some((*least, *most)),
        other => {
            table.problem(key, format!("{} values", other.len()), "two, the least and the most");
            None
        }
    }
}

fn counted(number: f64) -> u32 {
    number.round() as u32
}

/// `[scope_limits]`.
pub fn limits(table: &TableReader<'_>) -> Option<KnobLimits> {
    part(table, "scope_limits", |table| {
        let positive = |key, dimension| table.required(key, dimension, Bound::Positive);
        let near_offset = positive("near_offset", Dimension::VOLTAGE);
        let near_offset_until = positive("near_offset_until", Dimension::VOLTAGE_PER_DIVISION);
        let far_offset = positive("far_offset", Dimension::VOLTAGE);
        let earliest_position = positive("earliest_position", Dimension::DIVISION);
        let until = series(table, "latest_positions_until", Dimension::TIME_PER_DIVISION, true);
        let latest = series(table, "latest_positions", Dimension::TIME, true);
        let holdoff = range(table, "holdoff", Dimension::TIME);
        let pulse_width = range(table, "pulse_width", Dimension::TIME);
        let pulse_guard_band = positive("pulse_guard_band", Dimension::TIME);
        let averages = series(table, "averages", Dimension::NONE, true);
        let (until, latest) = (until?, latest?);
        if until.len() != latest.len() {
            let found = format!("{} positions", latest.len());
            let expected = format!("{}, one for each of latest_positions_until", until.len());
            table.problem("latest_positions", found, expected);
        }
        Some(KnobLimits {
            near_offset: near_offset?,
            near_offset_until: near_offset_until?,
            far_offset: far_offset?,
            earliest_position: earliest_position?,
            latest_positions: until.into_iter().zip(latest).collect(),
            holdoff: holdoff?,
            pulse_width: pulse_width?,
            pulse_guard_band: pulse_guard_band?,
            averages: averages?.into_iter().map(counted).collect(),
        })
    })
}

/// `[accuracy]`.
pub fn accuracy(table: &TableReader<'_>) -> Option<Accuracy> {
    part(table, "accuracy", |table| {
        let number = |key, dimension| table.required(key, dimension, Bound::NotNegative);
        let gain = number("gain", Dimension::NONE);
        let low_scale_gain = number("low_scale_gain", Dimension::NONE);
        let low_scale_until = number("low_scale_until", Dimension::VOLTAGE_PER_DIVISION);
        let offset = number("offset", Dimension::DIVISION);
        let input_offset = number("input_offset", Dimension::VOLTAGE);
        Some(Accuracy {
            gain: gain?,
            low_scale_gain: low_scale_gain?,
            low_scale_until: low_scale_until?,
            offset: offset?,
            input_offset: input_offset?,
        })
    })
}

/// `[fft]`, for records of so many points.
pub fn fft(table: &TableReader<'_>, record_length: Option<u64>) -> Option<FftLaw> {
    part(table, "fft", |table| {
        let points =
            table.required_count("points", 4, record_length.unwrap_or(MAX_RECORD_LENGTH).max(4));
        if points.is_some_and(|points| !points.is_power_of_two()) {
            table.problem("points", "a number that is none", "a power of two");
        }
        let level = table.required("level", Dimension::NONE, Bound::Positive);
        let reference = table.required("reference", Dimension::NONE, Bound::Any);
        let lowest_level = table.required("lowest_level", Dimension::NONE, Bound::Any);
        let slow_from = table.required("slow_from", Dimension::TIME_PER_DIVISION, Bound::Positive);
        let slow_rate = range(table, "slow_rate", Dimension::NONE);
        Some(FftLaw {
            points: usize::try_from(points?).ok()?,
            level: level?,
            reference: reference?,
            lowest_level: lowest_level?,
            slow_from: slow_from?,
            slow_rate: slow_rate.map(|(less, more)| more / less)?,
        })
    })
}

/// Most points that a record may have: what a scope of any make keeps in memory.
pub const MAX_RECORD_LENGTH: u64 = 1_000_000;

/// A list of quantities, ascending (unit).
pub fn series(
    table: &TableReader<'_>,
    key: &'static str,
    dimension: Dimension,
    required: bool,
) -> Option<Vec<f64>> {
    let expected = || format!("{dimension} above zero");
    if required && !table.has(key) {
        table.problem(key, "no such key", format!("a list, each {}", expected()));
    }
    if table.is_empty_list(key) {
        table.problem(key, "an empty list", format!("a list, each {}", expected()));
    }
    let mut values = Vec::new();
    for (text, place) in table.texts(key) {
        match parse(text, dimension) {
            Ok(value) if value > 0.0 => values.push(value),
            _ => table.problem_at(place, key, format!("\"{text}\""), expected()),
        }
    }
    values.sort_by(f64::total_cmp);
    (!values.is_empty()).then_some(values)
}
