//! From the messages of a recording to captures and traces; what cannot be is said in words.

use prost::bytes::Buf as _;
use prost::encoding::{DecodeContext, WireType, decode_key, skip_field};

use super::message;
use super::schema::Schema;
use crate::recording::finite::check_numbers;
use crate::recording::{Capture, Direction, InstrumentIdentity, ScpiLine};
use crate::scope::{Coupling, PointFormat, Preamble, Source, VerticalSetup, Waveform};
use crate::trace::Trace;

/// Refuses a message with a double that is not a finite number, by the name of its field.
///
/// # Errors
/// Problems: NaN and infinities; lists are not looked at.
pub fn check_doubles(schema: Schema, mut data: &[u8]) -> Result<(), String> {
    while !data.is_empty() {
        let (tag, kind) = decode_key(&mut data).map_err(|error| error.to_string())?;
        match kind {
            WireType::SixtyFourBit if data.len() >= 8 => {
                let value = data.get_f64_le();
                if !value.is_finite() {
                    let name = schema.field_name(tag).unwrap_or("a number");
                    return Err(format!("found {name} = {value}, expected a finite number"));
                }
            }
            _ => {
                skip_field(kind, tag, &mut data, DecodeContext::default())
                    .map_err(|error| error.to_string())?;
            }
        }
    }
    Ok(())
}

/// The trace in `message`.
///
/// # Errors
/// Problems: values that are not numbers, an interval that is not above zero.
pub fn series(message: message::SeriesMessage) -> Result<Trace, String> {
    if !(message.t0_s.is_finite() && message.dt_s.is_finite() && message.dt_s > 0.0) {
        return Err(format!(
            "found times {} + i * {} s, expected finite, increasing ones",
            message.t0_s, message.dt_s
        ));
    }
    if let Some(index) = message.values.iter().position(|value| !value.is_finite()) {
        return Err(format!("found no finite number as value {index}, expected one"));
    }
    Ok(Trace {
        name: message.name,
        unit: message.unit,
        start: message.t0_s,
        interval: message.dt_s,
        values: message.values,
    })
}

/// The line in `message`, which was written down at `timestamp_ns`.
///
/// # Errors
/// Problems: an unknown direction.
pub fn line(message: message::ScpiLineMessage, timestamp_ns: u64) -> Result<ScpiLine, String> {
    let direction = match message.direction.as_str() {
        "command" => Direction::Command,
        "reply" => Direction::Reply,
        other => return Err(format!("found direction `{other}`, expected command or reply")),
    };
    Ok(ScpiLine { timestamp_ns, peer: message.peer, direction, bytes: message.bytes })
}

/// The capture in `message`.
///
/// # Errors
/// Problems: an unknown source, levels without points, values that are not numbers.
pub fn capture(message: &message::CaptureMessage) -> Result<Capture, String> {
    let source = Source::from_name(&message.source).ok_or_else(|| {
        format!("found source `{}`, expected CH1 to CH8, MATH or REFA to REFD", message.source)
    })?;
    let codes = levels(message)?;
    let (values, points) = (message.values.len(), codes.len());
    if values != 0 && values != points {
        return Err(format!("found {values} values of {points} points, expected as many or none"));
    }
    if let Some(index) = message.values.iter().position(|value| !value.is_finite()) {
        return Err(format!("found no finite number as value {index}, expected one"));
    }
    let given = |number: Option<f64>| number.unwrap_or(0.0);
    let (x_zero, y_off, y_zero) =
        (given(message.t0_s), given(message.y_off), given(message.y_zero));
    let (trigger_point, position) = (given(message.trigger_point), given(message.position_div));
    if message.dt_s <= 0.0 {
        return Err(format!("found dt_s = {}, expected a time above zero", message.dt_s));
    }
    let coupling = match message.coupling.as_str() {
        "DC" => Some(Coupling::Dc),
        "AC" => Some(Coupling::Ac),
        "GND" => Some(Coupling::Ground),
        _ => None,
    };
    let known = !(message.model.is_empty() && message.firmware.is_empty());
    let capture = Capture {
        waveform: Waveform {
            source,
            codes,
            as_read: message.values.clone(),
            preamble: Preamble {
                x_zero,
                x_incr: message.dt_s,
                pt_off: 0,
                x_unit: message.x_unit.clone(),
                y_mult: message.y_mult,
                y_zero,
                y_off,
                y_unit: message.unit.clone(),
                pt_fmt: if message.point_format == "ENV" {
                    PointFormat::Envelope
                } else {
                    PointFormat::Sample
                },
            },
            vertical: VerticalSetup {
                scale: message.vertical_scale,
                position,
                coupling,
                bandwidth_limited: message.bandwidth_limited,
                inverted: message.inverted,
                probe: message.probe,
            },
            horizontal_scale: message.horizontal_scale,
            trigger_point,
        },
        instrument: known.then(|| InstrumentIdentity {
            model: message.model.clone(),
            serial: message.serial.clone(),
            firmware: message.firmware.clone(),
        }),
        notes: message.notes.clone(),
    };
    check_numbers(&capture.waveform)?;
    Ok(capture)
}

/// The digitiser levels: a byte each, or two where one does not suffice.
fn levels(message: &message::CaptureMessage) -> Result<Vec<i16>, String> {
    let points = message.volts.len();
    if message.codes.len() == points {
        Ok(message.codes.iter().map(|byte| i16::from(i8::from_be_bytes([*byte]))).collect())
    } else if message.codes.len() == 2 * points {
        Ok(message
            .codes
            .chunks_exact(2)
            .map(|pair| i16::from_be_bytes([pair[0], pair[1]]))
            .collect())
    } else {
        Err(format!(
            "found {} bytes of levels, expected 1 or 2 for each of {points} points",
            message.codes.len()
        ))
    }
}
