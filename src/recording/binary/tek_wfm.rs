//! Tektronix `.wfm`, versions 1 to 3: one channel of a DPO, MSO or MDO.

use super::bytes::{Bytes, Number};
use super::table::{BinaryColumn, BinaryTable};
use crate::recording::RecordingError;

/// Kinds of points by their number in the file.
const POINTS: [Number; 8] = [
    Number::Signed(2),
    Number::Signed(4),
    Number::Unsigned(4),
    Number::Unsigned(8),
    Number::Float(4),
    Number::Float(8),
    Number::Unsigned(1),
    Number::Signed(1),
];
/// Bytes of the description of values and of times, without the density of points (4 or 8).
const EXPLICIT: usize = 152;
const IMPLICIT: usize = 128;
/// Two time bases, when the waveform was updated, flags and checksum of the curve.
const BEFORE_OFFSETS: usize = 24 + 24 + 10;

pub fn read(data: &[u8], file: &str) -> Result<BinaryTable, RecordingError> {
    let mut bytes = Bytes::new(data, file);
    bytes.big = data.first() == Some(&0xf0);
    bytes.take(2)?;
    let version = bytes.text(8)?;
    let Some(version @ 1..=3) = version.strip_prefix(":WFM#").and_then(|v| v.parse::<u8>().ok())
    else {
        return Err(bytes.wrong(version, "version 1 to 3 of a waveform file"));
    };
    let curve = bytes.from(16).count(4)?;
    let frames = bytes.from(72).count(4)?;
    if frames > 0 {
        let expected = "one: save the frames one by one";
        return Err(bytes.wrong(format!("a FastFrame of {} records", frames + 1), expected));
    }
    let label = bytes.from(40).text(32)?;
    // Behind the summary frame, which the first version lacks, and the pixel map; each description
    // stands there twice, for images.
    let explicit = if version == 1 { 166 } else { 168 };
    let density = if version == 3 { 8 } else { 4 };
    let implicit = explicit + 2 * (EXPLICIT + density);
    let offsets = implicit + 2 * (IMPLICIT + density) + BEFORE_OFFSETS;
    let (scale, offset) = scaled(&mut bytes.from(explicit))?;
    let unit = bytes.from(explicit + 20).text(20)?;
    let kind = bytes.from(explicit + 72).count(4)?;
    let (interval, origin) = scaled(&mut bytes.from(implicit))?;
    let time_unit = bytes.from(implicit + 20).text(20)?;
    // Points before and behind the record are for interpolation.
    let mut spec = bytes.from(offsets + 4);
    let (from, to) = (spec.count(4)?, spec.count(4)?);
    let Some(number) = POINTS.get(kind).copied() else {
        return Err(bytes.wrong(format!("points of kind {kind}"), "whole numbers or floats"));
    };
    if time_unit.eq_ignore_ascii_case("hz") {
        return Err(bytes.wrong("a waveform over frequency", "one over time"));
    }
    let points = to.saturating_sub(from) / number.width();
    let mut samples = bytes.from(curve + from);
    let value = |_| Ok(scale * samples.number(number)? + offset);
    let cells = (0..points).map(value).collect::<Result<_, RecordingError>>()?;
    let name = if label.is_empty() { "CH1".to_owned() } else { label };
    let columns = vec![BinaryColumn { name, unit, cells }];
    Ok(BinaryTable { grid: Some((origin, interval)), columns, ..BinaryTable::default() })
}

/// Scale and offset of a dimension (unit).
fn scaled(bytes: &mut Bytes<'_>) -> Result<(f64, f64), RecordingError> {
    Ok((bytes.number(Number::Float(8))?, bytes.number(Number::Float(8))?))
}
