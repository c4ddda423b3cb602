//! WAV: samples of a sound card, shares of its full scale.

use super::bytes::{Bytes, Number};
use super::table::{BinaryColumn, BinaryTable};
use crate::recording::RecordingError;

/// Kind of samples: integers.
const WHOLE: usize = 1;
/// Kind of samples: floating-point numbers.
const FLOAT: usize = 3;
/// The extended header: the first two bytes of its sub-format give the kind of samples.
const EXTENSIBLE: usize = 0xFFFE;

pub fn read(data: &[u8], file: &str) -> Result<BinaryTable, RecordingError> {
    let mut bytes = Bytes::new(data, file);
    bytes.take(8)?;
    if bytes.take(4)? != b"WAVE" {
        return Err(bytes.wrong("a RIFF file of another kind", "WAVE"));
    }
    let mut format = None;
    loop {
        let name = bytes.take(4)?;
        let length = bytes.count(4)?;
        let mut chunk = bytes.clone();
        match (name, format) {
            (b"fmt ", _) => {
                let (kind, channels) = (chunk.count(2)?, chunk.count(2)?);
                let rate = chunk.count(4)?;
                chunk.take(6)?;
                let bits = chunk.count(2)?;
                let kind = if kind == EXTENSIBLE {
                    chunk.take(8)?;
                    chunk.count(2)?
                } else {
                    kind
                };
                format = Some((kind, channels, rate, bits));
            }
            (b"data", Some((kind, channels, rate, bits))) => {
                let number = match (kind, bits) {
                    // 8-bit samples are unsigned, all others signed.
                    (WHOLE, 8) => Number::Unsigned(1),
                    (WHOLE, 16 | 24 | 32) => Number::Signed(bits / 8),
                    (FLOAT, 32 | 64) => Number::Float(bits / 8),
                    _ => {
                        let found = format!("samples of kind {kind} with {bits} bits");
                        let expected = "PCM of 8 to 32 bits, or floats: save it uncompressed";
                        return Err(bytes.wrong(found, expected));
                    }
                };
                if channels == 0 || rate == 0 {
                    let found = format!("{channels} channels at {rate} Hz");
                    return Err(bytes.wrong(found, "at least one channel and a rate"));
                }
                return samples(chunk, number, channels, rate, length);
            }
            _ => (),
        }
        // Chunks have an even length.
        bytes.take(length + length % 2)?;
    }
}

fn samples(
    mut chunk: Bytes<'_>,
    number: Number,
    channels: usize,
    rate: usize,
    length: usize,
) -> Result<BinaryTable, RecordingError> {
    let name = |channel: usize| format!("CH{}", channel + 1);
    let column = |c: usize| BinaryColumn { name: name(c), ..BinaryColumn::default() };
    let mut columns: Vec<BinaryColumn> = (0..channels).map(column).collect();
    // A recorder that was cut off leaves a length of 0, or one beyond the end.
    let length = if length == 0 { chunk.left() } else { length };
    if length > chunk.left() {
        let found = format!("{} bytes of samples", chunk.left());
        return Err(chunk.wrong(found, &format!("{length}: the file is cut")));
    }
    for _ in 0..length / (number.width() * channels) {
        for column in &mut columns {
            let value = chunk.digits(number)?;
            let cell = match number {
                Number::Float(_) => value,
                Number::Unsigned(_) => (value - 128.0) / 128.0,
                Number::Signed(width) => value / 2f64.powi(8 * width as i32 - 1),
            };
            column.cells.push(cell);
        }
    }
    Ok(BinaryTable { grid: Some((0.0, 1.0 / rate as f64)), columns, ..BinaryTable::default() })
}
