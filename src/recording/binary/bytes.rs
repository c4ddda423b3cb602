//! Numbers in a file's bytes.

use crate::recording::RecordingError;

/// Reads one number after another.
#[derive(Debug, Clone)]
pub struct Bytes<'a> {
    data: &'a [u8],
    /// Where the next number stands.
    pub at: usize,
    /// Whether the most significant byte comes first.
    pub big: bool,
    file: &'a str,
}

/// How numbers are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

impl Number {
    /// Bytes of one.
    pub fn width(self) -> usize {
        match self {
            Self::Signed(width) | Self::Unsigned(width) | Self::Float(width) => width,
        }
    }
}

impl<'a> Bytes<'a> {
    pub fn new(data: &'a [u8], file: &'a str) -> Self {
        Self { data, at: 0, big: false, file }
    }

    /// The same file from another place on.
    pub fn from(&self, at: usize) -> Self {
        Self { at, ..self.clone() }
    }

    /// The file ends too early, or says what cannot be.
    pub fn wrong(&self, found: impl std::fmt::Display, expected: &str) -> RecordingError {
        RecordingError::found(format_args!("{}, byte {}", self.file, self.at), found, expected)
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], RecordingError> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.data.len());
        let Some(end) = end else {
            return Err(self.wrong("the end of the file", "more of the record: it is cut"));
        };
        let taken = &self.data[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn unsigned(&mut self, width: usize) -> Result<u64, RecordingError> {
        let bytes = self.take(width)?;
        let add = |sum: u64, byte: &u8| (sum << 8) | u64::from(*byte);
        Ok(if self.big { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) })
    }

    /// A whole number.
    pub fn whole(&mut self, kind: Number) -> Result<i128, RecordingError> {
        let value = self.unsigned(kind.width())?;
        Ok(match kind {
            Number::Signed(width) => {
                let unused = 64 - 8 * width as u32;
                i128::from(((value << unused) as i64) >> unused)
            }
            Number::Unsigned(_) | Number::Float(_) => i128::from(value),
        })
    }

    /// A count or an offset.
    pub fn count(&mut self, width: usize) -> Result<usize, RecordingError> {
        let value = self.unsigned(width)?;
        usize::try_from(value).map_err(|_| self.wrong(value, "a count"))
    }

    /// A number of any kind.
    pub fn number(&mut self, kind: Number) -> Result<f64, RecordingError> {
        Ok(match kind {
            Number::Float(4) => f64::from(f32::from_bits(self.unsigned(4)? as u32)),
            Number::Float(_) => f64::from_bits(self.unsigned(8)?),
            _ => self.whole(kind)? as f64,
        })
    }

    /// The next number; a 32-bit float becomes the decimal number with the fewest digits that
    /// rounds to it, 0.1 and not 0.100000001.
    pub fn digits(&mut self, kind: Number) -> Result<f64, RecordingError> {
        let value = self.number(kind)?;
        let shortest = || (value as f32).to_string().parse().unwrap_or(value);
        Ok(if kind == Number::Float(4) { shortest() } else { value })
    }

    /// Text in a field of `width` bytes, up to its first zero.
    pub fn text(&mut self, width: usize) -> Result<String, RecordingError> {
        let bytes = self.take(width)?;
        let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
        let text = String::from_utf8_lossy(&bytes[..end]);
        Ok(text.chars().filter(|c| !c.is_control()).collect::<String>().trim().to_owned())
    }

    /// Bytes that are left.
    pub fn left(&self) -> usize {
        self.data.len().saturating_sub(self.at)
    }
}
