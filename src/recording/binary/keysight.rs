//! Keysight and Agilent `.bin`: a header, and each waveform behind one of its own.

use super::bytes::{Bytes, Number};
use super::table::{BinaryColumn, BinaryTable};
use crate::recording::RecordingError;

/// Bytes of the headers of a waveform and of a buffer.
const HEADER: usize = 140;
const BUFFER_HEADER: usize = 12;
/// Units by their number.
const UNITS: [&str; 7] = ["", "V", "s", "", "A", "dB", "Hz"];
/// Kinds of buffers whose points are floats: normal, maximum, minimum.
const FLOATS: std::ops::RangeInclusive<usize> = 1..=3;

pub fn read(data: &[u8], file: &str) -> Result<BinaryTable, RecordingError> {
    let mut bytes = Bytes::new(data, file);
    bytes.take(2)?;
    // Newer versions count the file's bytes in eight.
    let long = bytes.take(2)? == b"03";
    bytes.take(if long { 8 } else { 4 })?;
    let waveforms = bytes.count(4)?;
    let mut table = BinaryTable::default();
    for _ in 0..waveforms {
        let start = bytes.at;
        let header = bytes.count(4)?;
        bytes.take(4)?;
        let buffers = bytes.count(4)?;
        let points = bytes.count(4)?;
        bytes.take(4 + 4 + 8)?;
        let (interval, origin) = (bytes.number(Number::Float(8))?, bytes.number(Number::Float(8))?);
        let (x_unit, y_unit) = (bytes.count(4)?, bytes.count(4)?);
        bytes.take(16 + 16)?;
        let frame = bytes.text(24)?;
        let label = bytes.text(16)?;
        if UNITS.get(x_unit) == Some(&"Hz") {
            return Err(bytes.wrong("a waveform over frequency", "waveforms over time"));
        }
        let grid = (origin, interval);
        if *table.grid.get_or_insert(grid) != grid {
            let expected = "waveforms on one grid: save the channels of one acquisition";
            return Err(bytes.wrong(format!("{label} on another grid of times"), expected));
        }
        if let Some((model, serial)) = frame.split_once(':')
            && table.keys.is_empty()
        {
            table.keys = vec![("Model", model.to_owned()), ("Serial Number", serial.to_owned())];
        }
        if header < HEADER {
            return Err(bytes.wrong(format!("a header of {header} bytes"), "140 or more"));
        }
        bytes = bytes.from(start + header);
        for _ in 0..buffers {
            let start = bytes.at;
            let header = bytes.count(4)?;
            let (kind, width, size) = (bytes.count(2)?, bytes.count(2)?, bytes.count(4)?);
            if header < BUFFER_HEADER {
                return Err(bytes.wrong(format!("a header of {header} bytes"), "12 or more"));
            }
            bytes = bytes.from(start + header);
            let mut buffer = bytes.clone();
            bytes.take(size)?;
            if !FLOATS.contains(&kind) || width != 4 || size != 4 * points {
                let found = format!("a buffer of kind {kind} with {width} bytes a point");
                return Err(buffer.wrong(found, "analogue channels: leave digital ones out"));
            }
            let cells = (0..points).map(|_| buffer.digits(Number::Float(4)));
            let cells = cells.collect::<Result<_, _>>()?;
            let name = match label.strip_prefix(|c: char| c.is_ascii_digit()) {
                Some("") => format!("CH{label}"),
                _ => label.clone(),
            };
            let unit = UNITS.get(y_unit).copied().unwrap_or_default().to_owned();
            table.columns.push(BinaryColumn { name, unit, cells });
        }
    }
    Ok(table)
}
