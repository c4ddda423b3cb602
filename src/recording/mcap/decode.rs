//! From a capture's message to a capture, with every number checked.

use super::message;
use crate::recording::{Capture, Instrument};
use crate::scope::{Coupling, PointFormat, Preamble, Source, VerticalSetup, Waveform};

/// The capture that `message` describes.
///
/// # Errors
/// What is wrong with the message, in words.
pub fn capture(message: &message::Capture) -> Result<Capture, String> {
    let source = Source::from_name(&message.source).ok_or_else(|| {
        format!("found source `{}`, expected CH1 to CH4, MATH or REFA to REFD", message.source)
    })?;
    let points = message.volts.len();
    let codes: Vec<i16> = if message.codes.len() == points {
        message.codes.iter().map(|byte| i16::from(i8::from_be_bytes([*byte]))).collect()
    } else if message.codes.len() == 2 * points {
        message.codes.as_chunks::<2>().0.iter().map(|pair| i16::from_be_bytes(*pair)).collect()
    } else {
        return Err(format!(
            "found {} bytes of levels, expected 1 or 2 for each of {points} points",
            message.codes.len()
        ));
    };
    let numbers = [
        ("t0_s", message.t0_s),
        ("dt_s", message.dt_s),
        ("y_mult", message.y_mult),
        ("y_off", message.y_off),
        ("y_zero", message.y_zero),
        ("trigger_point", message.trigger_point),
        ("vertical_scale", message.vertical_scale),
        ("horizontal_scale", message.horizontal_scale),
        ("position_div", message.position_div),
        ("probe", message.probe),
    ];
    if let Some((name, value)) = numbers.iter().find(|(_, value)| !value.is_finite()) {
        return Err(format!("found {name} = {value}, expected a finite number"));
    }
    let coupling = match message.coupling.as_str() {
        "DC" => Some(Coupling::Dc),
        "AC" => Some(Coupling::Ac),
        "GND" => Some(Coupling::Ground),
        _ => None,
    };
    let known = !(message.model.is_empty() && message.firmware.is_empty());
    Ok(Capture {
        waveform: Waveform {
            source,
            codes,
            preamble: Preamble {
                x_zero: message.t0_s,
                x_incr: message.dt_s,
                pt_off: 0,
                x_unit: message.x_unit.clone(),
                y_mult: message.y_mult,
                y_zero: message.y_zero,
                y_off: message.y_off,
                y_unit: message.unit.clone(),
                pt_fmt: if message.point_format == "ENV" {
                    PointFormat::Envelope
                } else {
                    PointFormat::Sample
                },
            },
            vertical: VerticalSetup {
                scale: message.vertical_scale,
                position: message.position_div,
                coupling,
                bandwidth_limited: message.bandwidth_limited,
                inverted: message.inverted,
                probe: message.probe,
            },
            horizontal_scale: message.horizontal_scale,
            trigger_point: message.trigger_point,
        },
        instrument: known.then(|| Instrument {
            model: message.model.clone(),
            serial: message.serial.clone(),
            firmware: message.firmware.clone(),
        }),
        notes: message.notes.clone(),
    })
}
