//! Writes a capture as the instrument itself would have saved it, byte for byte. A capture that the
//! format cannot hold is refused. Equations and sources: the module above.

use std::fmt::Write as _;

use super::abscissa::{self, Abscissa};
use super::layout::{self, Domain, HeaderLayout, Numbers, ROUND_OFF};
use crate::quantity::c_exponential;
use crate::recording::error::{RecordingError, excerpt};
use crate::recording::{Capture, InstrumentIdentity};
use crate::scope::Waveform;
use crate::scope::waveform::{FAMILY_BITS, HIGHEST_CODE, LEVELS_PER_DIVISION, LOWEST_CODE};

/// Bytes to set aside for a row; the longest of the family's own has 70.
const ROW_BYTES: usize = 72;

/// Writes `capture` in the native dialect, the old one where its instrument has neither model nor
/// serial number.
///
/// # Errors
/// [`RecordingError`] without an instrument, or when a part of the capture contradicts another,
/// such as `y_mult` the vertical scale, or has no place in the format, such as a comma in a serial
/// number or a number with more digits than the header prints.
pub fn write(capture: &Capture) -> Result<String, RecordingError> {
    let waveform = &capture.waveform;
    let instrument = capture.instrument.as_ref().ok_or_else(|| {
        let problem = "the capture names no instrument, expected at least its firmware";
        RecordingError::new("", format_args!("{problem}; `--instrument MODEL` gives it one"))
    })?;
    let layout = layout_of(instrument)?;
    let (domain, numbers) = checked(waveform)?;
    let source = layout::spelling(waveform.source, &capture.notes);
    let interval = layout::interval_spelling(numbers.interval, domain, &capture.notes);
    let values =
        header_values((waveform, [&source, &interval]), domain, &numbers, instrument, layout);
    let abscissa = Abscissa {
        domain,
        layout,
        interval: numbers.interval,
        trigger_point: numbers.trigger_point,
    };
    let y_off = whole(waveform.preamble.y_off);
    let mut header = layout.keys().iter().zip(&values);
    let mut text = String::with_capacity(waveform.codes.len() * ROW_BYTES);
    for (index, code) in (0_u32..).zip(&waveform.codes) {
        if let Some((key, value)) = header.next() {
            text.push_str(key);
            text.push(',');
            text.push_str(value);
        } else {
            text.push(',');
        }
        text.push_str(",,");
        text.push_str(&abscissa.text(index));
        let volts = (f64::from(*code) - y_off) * numbers.level() + numbers.y_zero;
        // Writing to a String cannot fail.
        let _ = writeln!(text, ",{volts:10.5},");
    }
    Ok(text)
}

/// The values beside the keys of `layout`, in the same order.
fn header_values(
    (waveform, [source, interval]): (&Waveform, [&str; 2]),
    domain: Domain,
    numbers: &Numbers,
    instrument: &InstrumentIdentity,
    layout: HeaderLayout,
) -> Vec<String> {
    let number = |value| layout::printed(value, domain);
    layout
        .keys()
        .iter()
        .map(|key| match *key {
            layout::RECORD_LENGTH => number(f64::from(domain.record_length())),
            layout::SAMPLE_INTERVAL => interval.to_owned(),
            layout::TRIGGER_POINT => {
                c_exponential(numbers.trigger_point, layout::TRIGGER_POINT_DECIMALS)
            }
            layout::SOURCE => source.to_owned(),
            layout::VERTICAL_UNITS => waveform.preamble.y_unit.clone(),
            layout::VERTICAL_SCALE => number(numbers.scale),
            layout::VERTICAL_OFFSET => number(numbers.offset),
            layout::HORIZONTAL_UNITS => waveform.preamble.x_unit.clone(),
            layout::HORIZONTAL_SCALE => number(numbers.horizontal_scale),
            layout::POINT_FORMAT => waveform.preamble.pt_fmt.to_string(),
            layout::Y_ZERO => number(numbers.y_zero),
            layout::PROBE => number(numbers.probe),
            layout::MODEL => instrument.model.clone(),
            layout::SERIAL => instrument.serial.clone(),
            layout::FIRMWARE => instrument.firmware.clone(),
            _ => String::new(),
        })
        .collect()
}

/// The header that an instrument's files have.
fn layout_of(instrument: &InstrumentIdentity) -> Result<HeaderLayout, RecordingError> {
    for (what, text) in [
        (layout::MODEL, &instrument.model),
        (layout::SERIAL, &instrument.serial),
        (layout::FIRMWARE, &instrument.firmware),
    ] {
        if text.chars().any(|c| c == ',' || c.is_control()) {
            return Err(RecordingError::unwritable(
                what,
                excerpt(text),
                "text without commas and control characters",
            ));
        }
    }
    match (instrument.model.is_empty(), instrument.serial.is_empty()) {
        (false, _) => Ok(HeaderLayout::Named),
        (true, true) => Ok(HeaderLayout::Old),
        (true, false) => Err(RecordingError::unwritable(
            layout::SERIAL,
            excerpt(&instrument.serial),
            "none, for an instrument without a model",
        )),
    }
}

/// The header's numbers, once every part of the waveform agrees with every other.
fn checked(waveform: &Waveform) -> Result<(Domain, Numbers), RecordingError> {
    let preamble = &waveform.preamble;
    let domain = Domain::from_units(&preamble.y_unit, &preamble.x_unit).ok_or_else(|| {
        let units = format!("{} over {}", excerpt(&preamble.y_unit), excerpt(&preamble.x_unit));
        RecordingError::unwritable("the waveform", units, "`V` over `s` or `dB` over `Hz`")
    })?;
    let numbers = Numbers {
        interval: preamble.x_incr,
        trigger_point: waveform.trigger_point,
        scale: waveform.vertical.scale,
        offset: whole(preamble.y_off) * (waveform.vertical.scale / LEVELS_PER_DIVISION),
        horizontal_scale: waveform.horizontal_scale,
        y_zero: preamble.y_zero,
        probe: waveform.vertical.probe,
    };
    if let Some(violation) = numbers.violation(domain) {
        return Err(RecordingError::unwritable(violation.key, violation.found, violation.expected));
    }
    if let Some(bits) = waveform.bits().filter(|bits| *bits != FAMILY_BITS) {
        let expected =
            "8 bits: the format has 25 levels to a division; .mcap, .isf and tables hold more";
        let found = format!("{bits} bits");
        return Err(RecordingError::unwritable("the converter's resolution", found, expected));
    }
    check_codes(waveform, domain)?;
    check_agreement(waveform, &numbers)?;
    Ok((domain, as_printed(&numbers, domain)?))
}

fn check_codes(waveform: &Waveform, domain: Domain) -> Result<(), RecordingError> {
    let expected = usize::from(domain.record_length());
    if waveform.codes.len() != expected {
        return Err(RecordingError::unwritable(
            "the number of points",
            waveform.codes.len(),
            expected,
        ));
    }
    let outside = |code: &i16| !(LOWEST_CODE..=HIGHEST_CODE).contains(code);
    match waveform.codes.iter().enumerate().find(|(_, code)| outside(code)) {
        None => Ok(()),
        Some((index, code)) => {
            let what = format!("the level of point {index}, counted from 0,");
            Err(RecordingError::unwritable(&what, code, format!("{LOWEST_CODE} to {HIGHEST_CODE}")))
        }
    }
}

/// The preamble and the settings say the same twice; the file says it once.
fn check_agreement(waveform: &Waveform, numbers: &Numbers) -> Result<(), RecordingError> {
    let preamble = &waveform.preamble;
    let x_zero = (0.0 - numbers.trigger_point) * numbers.interval;
    let y_off = waveform.vertical.position * LEVELS_PER_DIVISION;
    for (what, found, expected, unit) in [
        ("pt_off", f64::from(preamble.pt_off), 0.0, 0.0),
        ("x_zero", preamble.x_zero, x_zero, numbers.interval),
        ("y_mult", preamble.y_mult, numbers.level(), 0.0),
        ("y_off", preamble.y_off, y_off, 1.0),
    ] {
        let agrees = (found - expected).abs() <= ROUND_OFF * expected.abs().max(unit);
        if !agrees {
            return Err(RecordingError::unwritable(what, found, expected));
        }
    }
    Ok(())
}

/// The numbers as they will be read back, without the round-off of the program that computed them;
/// refuses those that the header's digits would change by more.
fn as_printed(numbers: &Numbers, domain: Domain) -> Result<Numbers, RecordingError> {
    let read = |value: f64, decimals| c_exponential(value, decimals).parse().unwrap_or(f64::NAN);
    let six = |what, value: f64| held(what, value, read(value, layout::DECIMALS));
    let text = layout::printed(numbers.interval, domain);
    let cut = text.parse().unwrap_or(f64::NAN);
    let interval = abscissa::exact_interval(domain, cut, &text);
    let trigger_point = read(numbers.trigger_point, layout::TRIGGER_POINT_DECIMALS);
    let levels = numbers.offset / numbers.level();
    if !near(levels, levels.round()) {
        six(layout::VERTICAL_OFFSET, numbers.offset)?;
    }
    let horizontal_scale = match domain {
        Domain::Time => six(layout::HORIZONTAL_SCALE, numbers.horizontal_scale)?,
        // Follows from the sampling rate and is always cut.
        Domain::Frequency => numbers.horizontal_scale,
    };
    Ok(Numbers {
        interval: held(layout::SAMPLE_INTERVAL, numbers.interval, interval)?,
        trigger_point: held(layout::TRIGGER_POINT, numbers.trigger_point, trigger_point)?,
        scale: six(layout::VERTICAL_SCALE, numbers.scale)?,
        offset: numbers.offset,
        horizontal_scale,
        y_zero: numbers.y_zero,
        probe: six(layout::PROBE, numbers.probe)?,
    })
}

/// `read`, if the header's digits hold all of `value`.
fn held(what: &str, value: f64, read: f64) -> Result<f64, RecordingError> {
    if near(value, read) {
        return Ok(read);
    }
    Err(RecordingError::unwritable(
        what,
        value,
        format!("{read}, all that the header's digits hold"),
    ))
}

/// Equal but for round-off.
fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= ROUND_OFF * expected.abs()
}

/// `y_off` without round-off, where it means a whole number of levels.
fn whole(y_off: f64) -> f64 {
    let round = y_off.round();
    if (y_off - round).abs() <= ROUND_OFF * round.abs().max(1.0) { round } else { y_off }
}
