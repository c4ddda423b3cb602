//! Writes a capture as an instrument of the TDS2000 family sends it: the 16 fields of `WFMPre?` in
//! their order, with headers on, then the levels, signed, most significant byte first.

use crate::recording::Capture;
use crate::recording::error::RecordingError;
use crate::scope::Waveform;
use crate::scope::set_up::{nr3, waveform_id};
use crate::scope::waveform::{BITS, FAMILY_BITS};

/// Bytes for each level: `DATa:WIDth`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Width {
    /// One.
    One,
    /// Two; the highest bit of a level is that of the upper one.
    Two,
}

/// Largest block whose length takes nine digits.
const LARGEST_BLOCK: usize = 999_999_999;

/// Numbers up to this can be scaled by the steps of two bytes; so can those down to its inverse
/// (unit).
const MAX_SCALABLE_NUMBER: f64 = 1e300;

/// Writes `capture`; levels of more than 8 bits take two bytes whatever `width` says.
///
/// # Errors
/// [`RecordingError`] for a number too large or too small to be scaled, a quote in a unit, or
/// a record without points.
pub fn write(capture: &Capture, width: Width) -> Result<Vec<u8>, RecordingError> {
    let waveform = &capture.waveform;
    check(waveform)?;
    let narrow: Option<Vec<i8>> =
        waveform.codes.iter().map(|code| i8::try_from(*code).ok()).collect();
    let wide = if narrow.is_some() { FAMILY_BITS } else { *BITS.end() };
    let bits = waveform.bits().unwrap_or(wide);
    let (bytes, factor, block): (u8, f64, Vec<u8>) = match (narrow, width) {
        (Some(codes), Width::One) if bits == FAMILY_BITS => {
            (1, 1.0, codes.into_iter().flat_map(i8::to_be_bytes).collect())
        }
        _ => {
            let unused = BITS.end() - bits;
            let bytes = waveform.codes.iter().flat_map(|code| (code << unused).to_be_bytes());
            (2, f64::from(unused).exp2(), bytes.collect())
        }
    };
    let length = block.len().to_string();
    let mut file = preamble(waveform, bytes, factor).into_bytes();
    file.extend_from_slice(format!(";:CURVE #{}{length}", length.len()).as_bytes());
    file.extend_from_slice(&block);
    Ok(file)
}

fn preamble(waveform: &Waveform, bytes: u8, factor: f64) -> String {
    let preamble = &waveform.preamble;
    let y_unit = if preamble.y_unit == "V" { "Volts" } else { &preamble.y_unit };
    let number = |value: f64| nr3(without_round_off(value));
    format!(
        ":WFMPRE:BYT_NR {bytes};BIT_NR {};ENCDG BIN;BN_FMT RI;BYT_OR MSB;NR_PT {};WFID \"{}\";PT_FMT {};\
         XINCR {};PT_OFF {};XZERO {};XUNIT \"{}\";YMULT {};YZERO {};YOFF {};YUNIT \"{y_unit}\"",
        8 * bytes,
        waveform.codes.len(),
        waveform_id(waveform, nr3, "Sample"),
        preamble.pt_fmt,
        number(preamble.x_incr),
        preamble.pt_off,
        number(preamble.x_zero),
        preamble.x_unit,
        number(preamble.y_mult / factor),
        number(preamble.y_zero),
        number(preamble.y_off * factor),
    )
}

fn check(waveform: &Waveform) -> Result<(), RecordingError> {
    let preamble = &waveform.preamble;
    let points = waveform.codes.len();
    if points == 0 || points > LARGEST_BLOCK / 2 {
        let expected = format!("1 to {}", LARGEST_BLOCK / 2);
        return Err(RecordingError::unwritable("the number of points", points, expected));
    }
    for (what, value) in [
        ("x_incr", preamble.x_incr),
        ("x_zero", preamble.x_zero),
        ("y_mult", preamble.y_mult),
        ("y_zero", preamble.y_zero),
        ("y_off", preamble.y_off),
        ("the vertical scale", waveform.vertical.scale),
        ("the time base", waveform.horizontal_scale),
    ] {
        if value.is_nan() || value.abs() > MAX_SCALABLE_NUMBER {
            return Err(RecordingError::unwritable(
                what,
                value,
                format!("a number up to {MAX_SCALABLE_NUMBER:e}"),
            ));
        }
    }
    for (what, value) in [("x_incr", preamble.x_incr), ("y_mult", preamble.y_mult)] {
        if value < 1.0 / MAX_SCALABLE_NUMBER {
            return Err(RecordingError::unwritable(
                what,
                value,
                format!("at least {:e}", 1.0 / MAX_SCALABLE_NUMBER),
            ));
        }
    }
    for (what, unit) in [("x_unit", &preamble.x_unit), ("y_unit", &preamble.y_unit)] {
        if unit.chars().any(|c| c == '"' || c.is_control()) {
            return Err(RecordingError::unwritable(
                what,
                unit.escape_debug(),
                "text without quotes",
            ));
        }
    }
    Ok(())
}

/// `value` to 13 digits, where the rest is round-off of a few operations.
fn without_round_off(value: f64) -> f64 {
    let short: f64 = format!("{value:.12e}").parse().unwrap_or(value);
    if (short - value).abs() <= 4.0 * f64::EPSILON * value.abs() { short } else { value }
}
