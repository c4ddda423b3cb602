//! From an ISF's words and levels to a capture.

use super::block::{Encoding, Levels};
use super::preamble::{self, PreambleText};
use crate::quantity::{Dimension, Quantity, engineering};
use crate::recording::Capture;
use crate::recording::error::{RecordingError, byte};
use crate::recording::finite::check_numbers;
use crate::scope::waveform::{BITS, FAMILY_BITS, LEVELS_PER_DIVISION, levels_per_division};
use crate::scope::{Coupling, PointFormat, Preamble, Source, VerticalSetup, Waveform};

/// Larger files are refused unread; a million points of two bytes take 2 MB.
pub const MAXIMUM_BYTES: usize = 64 << 20;
/// Points in one horizontal division of the family.
const POINTS_PER_DIVISION: f64 = 250.0;
/// How far two statements of the same may differ, relative; files print 5 digits.
const PRINTING_TOLERANCE: f64 = 1e-4;

/// Reads the `bytes` of an ISF file; `file_name` is for messages.
///
/// # Errors
/// [`RecordingError`] with the byte where the file stops making sense.
pub fn read(bytes: &[u8], file_name: &str) -> Result<Capture, RecordingError> {
    if bytes.len() > MAXIMUM_BYTES {
        let found = format!("{} bytes", bytes.len());
        return Err(RecordingError::found(file_name, found, format!("at most {MAXIMUM_BYTES}")));
    }
    let words = PreambleText::read(file_name, bytes)?;
    let mut notes = Vec::new();
    let x_incr = words.positive(preamble::X_INCR)?;
    let y_mult = words.positive(preamble::Y_MULT)?;
    let encoding = Encoding::read(&words, &mut notes)?;
    let levels = encoding.levels(&words, bytes, &mut notes)?;
    note_points(&words, levels.codes.len(), &mut notes)?;
    let mut or_zero = |key: preamble::PreambleKey| -> Result<f64, RecordingError> {
        let number = words.number(key)?;
        if number.is_none() {
            notes.push(format!("{} taken as 0: not given in the file", key.name()));
        }
        Ok(number.unwrap_or_default())
    };
    let (y_off, y_zero) = (or_zero(preamble::Y_OFF)?, or_zero(preamble::Y_ZERO)?);
    let x_zero = or_zero(preamble::X_ZERO)?;
    let pt_off = words.number(preamble::PT_OFF)?.unwrap_or_default();
    let x_unit = words.text(preamble::X_UNIT)?;
    let y_unit = words.text(preamble::Y_UNIT)?;
    let name = Name::read(&words.text(preamble::NAME)?.unwrap_or_default());
    let scale = words.number(preamble::V_SCALE)?.or(name.scale).filter(|scale| *scale > 0.0);
    let scaled = converter_levels(levels, y_mult, y_off, scale);
    let preamble = Preamble {
        x_zero: x_zero - pt_off * x_incr,
        x_incr,
        pt_off: 0,
        x_unit: unit(x_unit.as_deref().unwrap_or("s")),
        y_mult: scaled.y_mult,
        y_zero,
        y_off: scaled.y_off,
        y_unit: unit(y_unit.as_deref().unwrap_or("V")),
        pt_fmt: words
            .choice(
                preamble::POINT_FORMAT,
                &[("Y", PointFormat::Sample), ("ENV", PointFormat::Envelope)],
            )?
            .unwrap_or(PointFormat::Sample),
    };
    settings(&words, (name, scale), scaled.codes, preamble, notes)
}

struct Scaled {
    codes: Vec<i16>,
    y_mult: f64,
    y_off: f64,
}

/// Two-byte levels as those of their converter, whose highest bit is theirs: bits that are 0 in all
/// of them it does not have. Between 8 and 16 bits, only the stated `scale` (V/div) shows that
/// levels fill two bytes.
fn converter_levels(levels: Levels, y_mult: f64, y_off: f64, scale: Option<f64>) -> Scaled {
    let y_off = y_off - f64::from(levels.centre);
    let codes = levels.codes;
    let most = u32::from(BITS.end() - FAMILY_BITS);
    let unused = codes.iter().fold(most, |unused, code| unused.min(code.trailing_zeros()));
    let fills = |scale: f64| {
        let level = scale / levels_per_division(*BITS.end());
        (y_mult - level).abs() <= PRINTING_TOLERANCE * level
    };
    if !levels.two_bytes || unused < most && !scale.is_some_and(fills) {
        return Scaled { codes, y_mult, y_off };
    }
    let factor = f64::from(unused).exp2();
    let codes = codes.iter().map(|code| code >> unused).collect();
    Scaled { codes, y_mult: y_mult * factor, y_off: y_off / factor }
}

fn note_points(
    words: &PreambleText<'_>,
    found: usize,
    notes: &mut Vec<String>,
) -> Result<(), RecordingError> {
    if found == 0 {
        return Err(RecordingError::found(
            byte(words.file, words.block),
            "no points",
            "at least one",
        ));
    }
    let stated = words.number(preamble::POINTS)?;
    if let Some(stated) = stated.filter(|stated| (stated - found as f64).abs() > 0.0) {
        notes.push(format!("found {found} points, the preamble says {stated}"));
    }
    Ok(())
}

/// Value of `WFID`: `Ch1, DC coupling, 5.0E-1 V/div, 5.0E-2 s/div, 2500 points, Sample mode`.
#[derive(Debug, Default)]
struct Name {
    source: Option<Source>,
    coupling: Option<Coupling>,
    /// Vertical scale (V/div; dB/div for an FFT).
    scale: Option<f64>,
    /// Time base (s/div; Hz/div for an FFT).
    horizontal_scale: Option<f64>,
}

impl Name {
    fn read(text: &str) -> Self {
        let mut name = Self::default();
        for (index, item) in text.split(',').map(str::trim).enumerate() {
            if index == 0 {
                name.source = Source::from_name(&item.replace(' ', ""));
            }
            match item {
                "DC coupling" => name.coupling = Some(Coupling::Dc),
                "AC coupling" => name.coupling = Some(Coupling::Ac),
                "GND coupling" => name.coupling = Some(Coupling::Ground),
                _ => {}
            }
            let Some(amount) = item.strip_suffix("/div") else { continue };
            let is_usable = |value: &f64| value.abs() <= preamble::LARGEST;
            let number = |unit| amount.strip_suffix(unit)?.trim().parse().ok().filter(is_usable);
            let quantity: Option<Quantity> = amount.parse().ok();
            let quantity = quantity.filter(|quantity| is_usable(&quantity.value));
            let of = |kind| quantity.filter(|q| q.dimension == kind).map(|q| q.value);
            name.scale = name.scale.or(of(Dimension::VOLTAGE)).or(number("dB"));
            let time = of(Dimension::TIME).or(number("Hz"));
            name.horizontal_scale = name.horizontal_scale.or(time);
        }
        name
    }
}

/// The capture, with the settings that levels and preamble were taken under.
fn settings(
    words: &PreambleText<'_>,
    (name, stated): (Name, Option<f64>),
    codes: Vec<i16>,
    preamble: Preamble,
    mut notes: Vec<String>,
) -> Result<Capture, RecordingError> {
    let mut assume = |what: &str, taken: &str| {
        notes.push(format!("{what} taken as {taken}: not given in the file"));
    };
    let source = name.source.unwrap_or_else(|| {
        assume("source", "CH1");
        Source::Channel(1)
    });
    assume("probe attenuation", "1");
    let scale = stated.unwrap_or_else(|| {
        let scale = preamble.y_mult * LEVELS_PER_DIVISION;
        assume("vertical scale", &engineering(scale, &format!("{}/div", preamble.y_unit), 3));
        scale
    });
    let horizontal_scale = name.horizontal_scale.filter(|s| *s > 0.0).unwrap_or_else(|| {
        let scale = preamble.x_incr * POINTS_PER_DIVISION;
        assume("time base", &engineering(scale, &format!("{}/div", preamble.x_unit), 3));
        scale
    });
    let bits = preamble.bits(scale, PRINTING_TOLERANCE);
    if codes.iter().all(|code| i8::try_from(*code).is_ok()) && bits.is_none() {
        notes.push(format!(
            "a level is {} {}, not 1/25 of a division",
            preamble.y_mult, preamble.y_unit
        ));
    }
    let position = match (bits, words.number(preamble::V_POSITION)?) {
        (Some(bits), _) => preamble.y_off / levels_per_division(bits),
        (None, Some(position)) => position,
        (None, None) => preamble.y_off * (preamble.y_mult / scale),
    };
    let trigger_point = whole_if_near(0.0 - preamble.x_zero / preamble.x_incr);
    let vertical = VerticalSetup {
        scale,
        position,
        coupling: name.coupling,
        bandwidth_limited: None,
        inverted: None,
        probe: 1.0,
    };
    let waveform = Waveform {
        source,
        codes,
        as_read: Vec::new(),
        preamble,
        vertical,
        horizontal_scale,
        trigger_point,
    };
    check_numbers(&waveform).map_err(|problem| words.unusable(problem))?;
    Ok(Capture { waveform, instrument: None, notes })
}

/// The unit as this program writes it.
fn unit(text: &str) -> String {
    match text {
        "Volts" => "V",
        "S" => "s",
        other => other,
    }
    .to_owned()
}

/// `points` without the preamble's rounding, where it means a whole number.
fn whole_if_near(points: f64) -> f64 {
    let whole = points.round();
    if (points - whole).abs() <= 1e-9 * whole.abs().max(1.0) { whole + 0.0 } else { points }
}
