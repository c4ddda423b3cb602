//! Refuses records whose numbers are not finite, or not once they are computed with. Each reader
//! calls it.

use crate::scope::Waveform;

/// Largest number in a record: that of single precision, in which instruments compute (unit).
const MAX_VALUE: f64 = f32::MAX as f64;
/// Smallest step of time or of voltage: quotients by it stay finite (unit).
const MIN_STEP: f64 = 1e-300;
/// A value of more steps than this is not known to a thousandth of a step in double precision (1).
const MAX_STEPS: f64 = 1e12;

/// Refuses a record whose times or values are not numbers, are too large to compute with, or cannot
/// be told apart. Says what was found and what is expected.
pub(super) fn check_numbers(waveform: &Waveform) -> Result<(), String> {
    let preamble = &waveform.preamble;
    let limited = |(name, value): &(&str, f64)| {
        if value.abs() <= MAX_VALUE {
            return Ok(());
        }
        Err(format!("found {name} = {value}, expected a finite number up to {MAX_VALUE:.1e}"))
    };
    [
        ("x_incr", preamble.x_incr),
        ("x_zero", preamble.x_zero),
        ("y_mult", preamble.y_mult),
        ("y_zero", preamble.y_zero),
        ("y_off", preamble.y_off),
        ("vertical scale", waveform.vertical.scale),
        ("position", waveform.vertical.position),
        ("probe", waveform.vertical.probe),
        ("time base", waveform.horizontal_scale),
        ("trigger point", waveform.trigger_point),
        ("last time", waveform.time(waveform.codes.len())),
    ]
    .iter()
    .try_for_each(limited)?;
    for (name, step) in [("x_incr", preamble.x_incr), ("y_mult", preamble.y_mult.abs())] {
        if step != 0.0 && step < MIN_STEP {
            return Err(format!("found {name} = {step:e}, expected at least {MIN_STEP:e}"));
        }
    }
    let points = preamble.x_zero.abs() / preamble.x_incr;
    if points > MAX_STEPS {
        return Err(format!(
            "found a first point {points:e} sample intervals from the trigger, expected at most {MAX_STEPS:e}: the times cannot be told apart"
        ));
    }
    if preamble.y_off.abs() > MAX_STEPS {
        return Err(format!(
            "found y_off = {:e} levels, expected at most {MAX_STEPS:e}: the levels cannot be told apart",
            preamble.y_off
        ));
    }
    let ends = waveform.extremes().into_iter().flatten().map(|value| ("value", value));
    ends.collect::<Vec<_>>().iter().try_for_each(limited)
}
