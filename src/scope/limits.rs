//! Rounds typed numbers to the nearest setting of the instrument.
//!
//! Numbers are clamped and snapped, never refused. How far each knob turns is the model's data
//! file's to say.

use super::Model;
use super::model::{RANGE_END_FACTOR, nearest};

/// A number to `digits` significant decimal digits, so that steps do not show the rounding of
/// binary numbers (unit).
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*E}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// Digits of a fine vertical scale: real files hold 59 and 288 mV/div.
const FINE_DIGITS: usize = 3;

/// A vertical scale (V/div) through a probe (1): the nearest step of the model's 1-2-5 series, or
/// if fine any between the smallest and the largest, to three digits (V/div).
pub fn vertical_scale(model: &Model, (scale, probe): (f64, f64), fine: bool) -> f64 {
    let steps = &model.vertical_scales;
    let at_input = match (steps.first(), steps.last()) {
        (Some(least), Some(most)) if fine => {
            rounded(within(scale / probe, (*least, *most)), FINE_DIGITS)
        }
        _ => nearest(scale / probe, steps),
    };
    rounded(at_input * probe, 9)
}

/// A vertical position at a scale through a probe, in steps of a level of the digitiser (div).
pub fn vertical_position(model: &Model, position: f64, scale: f64, probe: f64) -> f64 {
    let steps = position_steps(model);
    let reach = vertical_reach(model, scale, probe);
    ((position * steps).round() / steps).clamp(-reach, reach)
}

/// Farthest vertical position at a scale through a probe (div).
pub fn vertical_reach(model: &Model, scale: f64, probe: f64) -> f64 {
    let at_input = scale / probe;
    let limits = &model.limits;
    let is_near = at_input <= limits.near_offset_until * RANGE_END_FACTOR;
    let reach = if is_near { limits.near_offset } else { limits.far_offset };
    let steps = position_steps(model);
    (reach / at_input * RANGE_END_FACTOR * steps).floor() / steps
}

/// Steps of a position in a division (1).
fn position_steps(model: &Model) -> f64 {
    (1.0 / model.position_step).round().max(1.0)
}

/// A time base: the nearest of the model's (s/div).
pub fn time_base(model: &Model, scale: f64) -> f64 {
    nearest(scale, &model.time_bases)
}

/// A horizontal position in the model's steps of a division (s).
pub fn horizontal_position(model: &Model, position: f64, scale: f64) -> f64 {
    let step = scale * model.position_step;
    let clamped = within(position, horizontal_range(model, scale));
    rounded((clamped / step).round() * step, 9)
}

/// Earliest and latest horizontal position at a time base (s).
pub fn horizontal_range(model: &Model, scale: f64) -> (f64, f64) {
    let limits = &model.limits;
    let latest = limits
        .latest_positions
        .iter()
        .find(|(until, _)| scale <= until * RANGE_END_FACTOR)
        .or(limits.latest_positions.last())
        .map_or(0.0, |(_, latest)| *latest);
    (-limits.earliest_position * scale, latest.max(0.0))
}

/// A number within a range (unit).
pub fn within(value: f64, (least, most): (f64, f64)) -> f64 {
    value.max(least).min(most)
}
