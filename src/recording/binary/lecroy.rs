//! Teledyne `LeCroy` `.trc`: one channel, described by the block `WAVEDESC`.

use super::bytes::{Bytes, Number};
use super::table::{BinaryColumn, BinaryTable};
use crate::recording::RecordingError;

const BLOCK: &[u8] = b"WAVEDESC";
/// How far from the start of the file the block may begin.
const REACH: usize = 64;

/// Where the block begins.
pub fn start(bytes: &[u8]) -> Option<usize> {
    let head = &bytes[..bytes.len().min(REACH)];
    head.windows(BLOCK.len()).position(|window| window == BLOCK)
}

pub fn read(data: &[u8], file: &str) -> Result<BinaryTable, RecordingError> {
    let mut block = Bytes::new(data, file);
    let start = start(data).unwrap_or(0);
    block.big = data.get(start + 34..start + 36) == Some(&[0, 0]);
    let at = |offset: usize| block.from(start + offset);
    let (wide, first) = (at(32).count(2)? == 1, at(36).count(4)?);
    // User's text, a reserved block, times of triggers and of random sampling stand in between.
    let mut before = first;
    for offset in [40, 44, 48, 52] {
        before += at(offset).count(4)?;
    }
    let size = at(60).count(4)?;
    let points = at(116).count(4)?;
    let segments = at(144).count(4)?;
    if segments > 1 {
        let expected = "one: save the segments one by one";
        return Err(block.wrong(format!("a sequence of {segments} segments"), expected));
    }
    let width = if wide { 2 } else { 1 };
    if size < points * width {
        return Err(block.wrong(format!("{size} bytes"), &format!("{points} points")));
    }
    let gain = at(156).digits(Number::Float(4))?;
    let offset = at(160).digits(Number::Float(4))?;
    let interval = at(176).digits(Number::Float(4))?;
    let origin = at(180).number(Number::Float(8))?;
    let mut samples = at(before);
    let value = |_| Ok(gain * samples.number(Number::Signed(width))? - offset);
    let cells = (0..points).map(value).collect::<Result<_, RecordingError>>()?;
    let name = match at(344).count(2)? {
        channel @ 0..=3 => format!("CH{}", channel + 1),
        _ => at(96).text(16)?,
    };
    let keys = vec![
        ("Model", at(76).text(16)?),
        ("Serial Number", at(92).whole(Number::Signed(4))?.to_string()),
    ];
    let column = BinaryColumn { name, unit: at(196).text(48)?, cells };
    Ok(BinaryTable { keys, grid: Some((origin, interval)), columns: vec![column] })
}
