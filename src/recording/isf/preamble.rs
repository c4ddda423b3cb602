//! Reads the words before an ISF's block: which key stands for what, and what each value may be.

use crate::recording::command_text::{command, unquoted};
use crate::recording::error::{RecordingError, byte, excerpt_of_bytes};

/// The preamble's words take a few hundred bytes; a block not found after this many is not there.
const MAX_PREAMBLE_BYTES: usize = 64 * 1024;

/// A key of the preamble: its full form, and the length of its shortest form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PreambleKey(&'static str, usize);

pub(super) const BYTES: PreambleKey = PreambleKey("BYT_NR", 5);
pub(super) const BITS: PreambleKey = PreambleKey("BIT_NR", 5);
pub(super) const ENCODING: PreambleKey = PreambleKey("ENCDG", 3);
pub(super) const NUMBERS: PreambleKey = PreambleKey("BN_FMT", 4);
pub(super) const BYTE_ORDER: PreambleKey = PreambleKey("BYT_OR", 5);
pub(super) const POINTS: PreambleKey = PreambleKey("NR_PT", 4);
pub(super) const NAME: PreambleKey = PreambleKey("WFID", 3);
pub(super) const POINT_FORMAT: PreambleKey = PreambleKey("PT_FMT", 4);
pub(super) const X_INCR: PreambleKey = PreambleKey("XINCR", 3);
pub(super) const PT_OFF: PreambleKey = PreambleKey("PT_OFF", 4);
pub(super) const X_ZERO: PreambleKey = PreambleKey("XZERO", 3);
pub(super) const X_UNIT: PreambleKey = PreambleKey("XUNIT", 3);
pub(super) const Y_MULT: PreambleKey = PreambleKey("YMULT", 3);
pub(super) const Y_ZERO: PreambleKey = PreambleKey("YZERO", 3);
pub(super) const Y_OFF: PreambleKey = PreambleKey("YOFF", 3);
pub(super) const Y_UNIT: PreambleKey = PreambleKey("YUNIT", 3);
pub(super) const V_SCALE: PreambleKey = PreambleKey("VSCALE", 6);
pub(super) const V_POSITION: PreambleKey = PreambleKey("VPOS", 4);
const CURVE: PreambleKey = PreambleKey("CURVE", 4);

impl PreambleKey {
    /// Whether the last part of `header` names this key.
    fn is(self, header: &[u8]) -> bool {
        let part = header.rsplit(|byte| *byte == b':').next().unwrap_or_default();
        let Self(full, shortest) = self;
        let fits = full.as_bytes().get(..part.len());
        part.len() >= shortest && fits.is_some_and(|full| full.eq_ignore_ascii_case(part))
    }

    pub(super) fn name(self) -> &'static str {
        let Self(full, _) = self;
        full
    }
}

/// One setting: header, value, and where the value begins.
type Entry<'a> = (&'a [u8], &'a [u8], usize);

/// The words of a file, and where its block begins.
#[derive(Debug)]
pub(super) struct PreambleText<'a> {
    pub(super) file: &'a str,
    entries: Vec<Entry<'a>>,
    /// Where the block begins, in bytes.
    pub(super) block: usize,
}

/// Largest number: instruments compute in single precision, and products of a few such numbers stay
/// finite (unit).
pub(super) const LARGEST: f64 = f32::MAX as f64;

impl<'a> PreambleText<'a> {
    pub(super) fn read(file: &'a str, bytes: &'a [u8]) -> Result<Self, RecordingError> {
        let head = bytes.get(..bytes.len().min(MAX_PREAMBLE_BYTES)).unwrap_or_default();
        let (mut at, mut entries) = (0, Vec::new());
        while let Some((found, next)) = command(head, at) {
            if CURVE.is(found.header) {
                return Ok(Self { file, entries, block: found.value_offset });
            }
            entries.push((found.header, found.value, found.value_offset));
            at = next;
        }
        let found = format!("no CURVE in the first {} bytes", head.len());
        Err(RecordingError::found(file, found, "an ISF file"))
    }

    /// The last value of `key`, without quotes, and where it stands.
    fn entry(&self, key: PreambleKey) -> Option<(&'a [u8], usize)> {
        let found = self.entries.iter().rev().find(|(header, ..)| key.is(header));
        found.map(|(_, value, offset)| (*value, *offset))
    }

    pub(super) fn text(&self, key: PreambleKey) -> Result<Option<String>, RecordingError> {
        let Some((value, offset)) = self.entry(key) else { return Ok(None) };
        let text = std::str::from_utf8(value).ok().map(unquoted);
        match text.filter(|text| !text.chars().any(char::is_control)) {
            Some(text) => Ok(Some(text.trim().to_owned())),
            None => Err(self.wrong(key, value, offset, "text")),
        }
    }

    pub(super) fn number(&self, key: PreambleKey) -> Result<Option<f64>, RecordingError> {
        let Some((value, offset)) = self.entry(key) else { return Ok(None) };
        let number = std::str::from_utf8(value).ok().and_then(|text| text.parse::<f64>().ok());
        match number.filter(|number| number.abs() <= LARGEST) {
            Some(number) => Ok(Some(number)),
            None => Err(self.wrong(key, value, offset, "a number up to 3.4e38")),
        }
    }

    /// A number that must be there and be above zero.
    pub(super) fn positive(&self, key: PreambleKey) -> Result<f64, RecordingError> {
        let number = self.number(key)?.ok_or_else(|| self.missing(key))?;
        if number > 0.0 {
            return Ok(number);
        }
        let (value, offset) = self.entry(key).unwrap_or_default();
        Err(self.wrong(key, value, offset, "a number above 0"))
    }

    /// Which of `words` the value of `key` is; words count by their first letters, as keys do.
    pub(super) fn choice<T: Copy>(
        &self,
        key: PreambleKey,
        words: &[(&str, T)],
    ) -> Result<Option<T>, RecordingError> {
        let Some((value, offset)) = self.entry(key) else { return Ok(None) };
        let upper = value.to_ascii_uppercase();
        let is = |word: &str| {
            let whole = word.starts_with(|c: char| c.is_ascii_digit());
            upper.starts_with(word.as_bytes()) && (!whole || upper.len() == word.len())
        };
        if let Some((_, choice)) = words.iter().find(|(word, _)| is(word)) {
            return Ok(Some(*choice));
        }
        let expected = words.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(" or ");
        Err(self.wrong(key, value, offset, &expected))
    }

    pub(super) fn missing(&self, key: PreambleKey) -> RecordingError {
        RecordingError::found(self.file, format!("no {}", key.name()), "it before CURVE")
    }

    /// The numbers do not go together.
    pub(super) fn unusable(&self, problem: String) -> RecordingError {
        RecordingError::new(self.file, problem)
    }

    fn wrong(
        &self,
        key: PreambleKey,
        value: &[u8],
        offset: usize,
        expected: &str,
    ) -> RecordingError {
        RecordingError::value(
            byte(self.file, offset),
            key.name(),
            excerpt_of_bytes(value),
            expected,
        )
    }
}
