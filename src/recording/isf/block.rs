//! Reads the levels of an ISF: a block of bytes, or numbers in words. Lengths that a file claims
//! are held against what is there before anything is set aside for them.

use super::preamble::{self, PreambleText};
use crate::recording::error::{RecordingError, byte, excerpt_of_bytes};

/// Difference between a level counted from the converter's lowest and one counted from its centre.
const CENTRE_OF_ONE_BYTE: i32 = 1 << 7;
const CENTRE_OF_TWO_BYTES: i32 = 1 << 15;

/// How a level is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// As a number in words.
    Words,
    /// As one byte.
    OneByte,
    /// As two, the most significant first.
    MostFirst,
    /// As two, the least significant first.
    LeastFirst,
}

/// How levels are encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Encoding {
    form: Form,
    /// Whether numbers in words go with two bytes a point.
    two_bytes: bool,
    positive: bool,
}

/// Levels as signed numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Levels {
    pub(super) codes: Vec<i16>,
    /// The offset subtracted from every level to make it signed.
    pub(super) centre: i32,
    pub(super) two_bytes: bool,
}

impl Encoding {
    pub(super) fn read(
        words: &PreambleText<'_>,
        notes: &mut Vec<String>,
    ) -> Result<Self, RecordingError> {
        let mut default = |found: Option<bool>, key: preamble::PreambleKey, taken: &str| {
            found.unwrap_or_else(|| {
                notes.push(format!("{} taken as {taken}: not given in the file", key.name()));
                false
            })
        };
        let encoding = words.choice(preamble::ENCODING, &[("ASC", true), ("BIN", false)])?;
        let bytes = words.choice(preamble::BYTES, &[("1", false), ("2", true)])?;
        let bits = words.choice(preamble::BITS, &[("8", false), ("16", true)])?;
        let numbers = words.choice(preamble::NUMBERS, &[("RP", true), ("RI", false)])?;
        let order = words.choice(preamble::BYTE_ORDER, &[("LSB", true), ("MSB", false)])?;
        let in_words = default(encoding, preamble::ENCODING, "BIN");
        let two_bytes = match bytes.or(bits) {
            Some(two) => two,
            None if in_words => false,
            None => return Err(words.missing(preamble::BYTES)),
        };
        let least_first = two_bytes && default(order, preamble::BYTE_ORDER, "MSB");
        let form = match (in_words, two_bytes, least_first) {
            (true, ..) => Form::Words,
            (false, false, _) => Form::OneByte,
            (false, true, false) => Form::MostFirst,
            (false, true, true) => Form::LeastFirst,
        };
        Ok(Self { form, two_bytes, positive: default(numbers, preamble::NUMBERS, "RI") })
    }

    /// The levels of the block at `start`.
    pub(super) fn levels(
        self,
        words: &PreambleText<'_>,
        bytes: &[u8],
        notes: &mut Vec<String>,
    ) -> Result<Levels, RecordingError> {
        let start = words.block;
        let in_words = self.form == Form::Words;
        let codes = if in_words {
            numbers(words.file, bytes, start)?
        } else {
            self.split(words.file, bytes, block(words.file, bytes, start, notes)?)?
        };
        // Numbers in words are signed whatever BN_FMT says; seen on a TDS2024C.
        let centre = match (self.positive && !in_words, self.two_bytes) {
            (false, _) => 0,
            (true, false) => CENTRE_OF_ONE_BYTE,
            (true, true) => CENTRE_OF_TWO_BYTES,
        };
        Ok(Levels { codes, centre, two_bytes: self.two_bytes })
    }

    /// Levels from the bytes in `range`.
    fn split(
        self,
        file: &str,
        bytes: &[u8],
        range: std::ops::Range<usize>,
    ) -> Result<Vec<i16>, RecordingError> {
        let (offset, block) = (range.start, bytes.get(range).unwrap_or_default());
        // Counting from the lowest level instead of the centre flips the highest bit and nothing
        // else.
        let (flip, wide_flip) = if self.positive { (0x80, 0x8000) } else { (0, 0) };
        if self.form == Form::OneByte {
            return Ok(block.iter().map(|b| i16::from((b ^ flip).cast_signed())).collect());
        }
        let (pairs, odd) = block.as_chunks::<2>();
        if !odd.is_empty() {
            let found = format!("a block of {} bytes", block.len());
            let expected = "an even number, two bytes a point";
            return Err(RecordingError::found(byte(file, offset), found, expected));
        }
        let join =
            if self.form == Form::LeastFirst { u16::from_le_bytes } else { u16::from_be_bytes };
        Ok(pairs.iter().map(|pair| (join(*pair) ^ wide_flip).cast_signed()).collect())
    }
}

/// Where the bytes of the block at `start` lie.
fn block(
    file: &str,
    bytes: &[u8],
    start: usize,
    notes: &mut Vec<String>,
) -> Result<std::ops::Range<usize>, RecordingError> {
    let wrong = |offset: usize, expected: &str| {
        let found = excerpt_of_bytes(bytes.get(offset..).unwrap_or_default());
        RecordingError::found(byte(file, offset), found, expected)
    };
    if bytes.get(start) != Some(&b'#') {
        return Err(wrong(start, "`#`, the number of digits, the length, and the block"));
    }
    let digits = bytes.get(start + 1).copied().filter(u8::is_ascii_digit);
    let digits = usize::from(digits.ok_or_else(|| wrong(start + 1, "a digit"))? - b'0');
    let first = start + 2 + digits;
    if digits == 0 {
        notes.push("the block has no length; it is read to the file's end".to_owned());
        let end = bytes.len() - usize::from(bytes.ends_with(b"\n"));
        return Ok(first..end.max(first));
    }
    let length = bytes
        .get(start + 2..first)
        .filter(|text| text.iter().all(u8::is_ascii_digit))
        .and_then(|text| std::str::from_utf8(text).ok()?.parse::<usize>().ok())
        .ok_or_else(|| wrong(start + 2, &format!("a length of {digits} digits")))?;
    let found = bytes.len().saturating_sub(first);
    if found < length {
        let problem = format!("the file ends after {found} bytes of the block, expected {length}");
        return Err(RecordingError::new(byte(file, bytes.len()), problem));
    }
    let behind = bytes.get(first + length..).unwrap_or_default().trim_ascii().len();
    if behind > 0 {
        notes.push(format!("{behind} bytes behind the block are passed over"));
    }
    Ok(first..first + length)
}

/// Levels as whole numbers with commas between them.
fn numbers(file: &str, bytes: &[u8], start: usize) -> Result<Vec<i16>, RecordingError> {
    let mut offset = start;
    let text = bytes.get(start..).unwrap_or_default();
    let mut codes = Vec::new();
    for cell in text.split(|byte| *byte == b',') {
        let code = std::str::from_utf8(cell.trim_ascii()).ok().and_then(|text| text.parse().ok());
        codes.push(code.ok_or_else(|| {
            let expected = "a whole number from -32768 to 32767";
            RecordingError::found(byte(file, offset), excerpt_of_bytes(cell), expected)
        })?);
        offset += cell.len() + 1;
    }
    Ok(codes)
}
