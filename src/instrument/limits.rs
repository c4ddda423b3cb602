//! What a typed number becomes: the nearest setting that the instrument has.
//!
//! Numbers are clamped and snapped, never refused. Sources: vertical positions reach 2 V at the input up to 200 mV/div
//! and 50 V above (programmer manual, table 2-27; 620 set-up files); horizontal positions as in the TDS1000 user manual,
//! table 1-2; holdoff and pulse width as in the TDS2000 service manuals, chapter 1.

use super::panel::{Panel, TriggerSource};
use crate::scope::Model;
use crate::scope::waveform::LEVELS_PER_DIVISION;

/// Highest scale at the input up to which positions reach only [`NEAR_OFFSET`] (V/div).
const FINE_SCALE: f64 = 0.2;
/// Farthest position up to [`FINE_SCALE`] (V).
const NEAR_OFFSET: f64 = 2.0;
/// Farthest position above [`FINE_SCALE`] (V).
const FAR_OFFSET: f64 = 50.0;
/// Shortest and longest holdoff (s).
pub const HOLDOFFS: (f64, f64) = (500e-9, 10.0);
/// Shortest and longest pulse width (s).
pub const PULSE_WIDTHS: (f64, f64) = (33e-9, 10.0);
/// Latest horizontal position up to a time base, both in seconds.
const LATEST_POSITIONS: [(f64, f64); 4] =
    [(10e-9, 0.02), (100e-6, 0.05), (10.0, 50.0), (f64::INFINITY, 250.0)];
/// Earliest horizontal position (div).
const EARLIEST_POSITION: f64 = -4.0;
/// A tolerance on ranges, so that their ends belong to them (1).
const ROUNDING: f64 = 1e-9;

/// The nearest of `choices` on a logarithmic scale, or `value` if there are none (unit).
#[must_use]
pub fn nearest(value: f64, choices: &[f64]) -> f64 {
    let distance = |choice: &f64| if value > 0.0 { (choice / value).ln().abs() } else { *choice };
    choices.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(value)
}

/// A number to `digits` significant decimal digits, so that steps do not show the rounding of binary numbers (unit).
#[must_use]
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*E}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// A vertical scale through a probe: the nearest step of the model's 1-2-5 series (V/div).
#[must_use]
pub fn vertical_scale(model: &Model, scale: f64, probe: f64) -> f64 {
    rounded(nearest(scale / probe, &model.vertical_scales) * probe, 9)
}

/// A vertical position at a scale through a probe, in steps of a level of the digitiser (div).
#[must_use]
pub fn vertical_position(model: &Model, position: f64, scale: f64, probe: f64) -> f64 {
    let at_input = scale / probe;
    let reach = if at_input <= FINE_SCALE * (1.0 + ROUNDING) { NEAR_OFFSET } else { FAR_OFFSET };
    let steps_in_division = (1.0 / model.position_step).round().max(1.0);
    let farthest = (reach / at_input * (1.0 + ROUNDING) * steps_in_division).floor();
    (position * steps_in_division).round().clamp(-farthest, farthest) / steps_in_division
}

/// A time base: the nearest of the model's (s/div).
#[must_use]
pub fn time_base(model: &Model, scale: f64) -> f64 {
    nearest(scale, &model.time_bases)
}

/// A horizontal position in steps of 1/25 division (s).
#[must_use]
pub fn horizontal_position(position: f64, scale: f64) -> f64 {
    let step = scale / LEVELS_PER_DIVISION;
    let latest = LATEST_POSITIONS
        .iter()
        .find(|(until, _)| scale <= until * (1.0 + ROUNDING))
        .map_or(0.0, |(_, latest)| *latest);
    let clamped = position.clamp(EARLIEST_POSITION * scale, latest.max(0.0));
    rounded((clamped / step).round() * step, 9)
}

/// A trigger level: within the reach of its source (V).
#[must_use]
pub fn trigger_level(model: &Model, panel: &Panel, level: f64) -> f64 {
    let (low, high) = match panel.trigger.source {
        TriggerSource::External => (-model.external_trigger_range, model.external_trigger_range),
        TriggerSource::External5 => {
            (-5.0 * model.external_trigger_range, 5.0 * model.external_trigger_range)
        }
        TriggerSource::Line => (0.0, 0.0),
        channel => {
            let vertical = panel.channel(channel.channel().unwrap_or(1)).vertical;
            let volts = |divisions: f64| (divisions - vertical.position) * vertical.scale;
            (volts(-model.trigger_range), volts(model.trigger_range))
        }
    };
    rounded(level.clamp(low, high), 7)
}
