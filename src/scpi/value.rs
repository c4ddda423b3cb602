//! Values of replies, before headers are added.

use crate::scope::limits::rounded;
use crate::scope::set_up::nr3;
use crate::scope::word::short_form;

/// One answer.
#[derive(Debug, Clone, PartialEq)]
pub enum ReplyValue {
    /// A setting with decimals, in the unit that the command's manual names (unit).
    Number(f64),
    /// A measurement, in the unit that `MEASUrement` tells (unit).
    Measurement(f64),
    /// A whole number.
    Integer(i64),
    /// One of several words, spelled with its short form in capitals.
    Word(&'static str),
    /// Text in quotation marks.
    Text(String),
    /// As it stands.
    Plain(String),
    /// Bytes that are no text.
    Block(Vec<u8>),
}

impl ReplyValue {
    /// A whole number.
    pub fn integer(value: impl Into<i64>) -> Self {
        Self::Integer(value.into())
    }

    /// A flag as `1` or `0`.
    pub fn flag(on: bool) -> Self {
        Self::integer(on)
    }

    /// A flag as `ON` or `OFF`.
    pub fn on_or_off(on: bool) -> Self {
        Self::Word(if on { "ON" } else { "OFF" })
    }

    /// Bytes behind their count, `#<n><length><bytes>`.
    pub fn block(bytes: &[u8]) -> Self {
        let length = bytes.len().to_string();
        Self::Block([format!("#{}{length}", length.len()).as_bytes(), bytes].concat())
    }

    /// Appends what the instrument writes; `verbose` writes words in full.
    pub fn write(&self, verbose: bool, out: &mut Vec<u8>) {
        let text = match self {
            Self::Number(value) => setting(*value),
            Self::Measurement(value) => measurement(*value),
            Self::Integer(value) => value.to_string(),
            Self::Word(word) => abbreviated(word, verbose),
            Self::Text(text) => format!("\"{}\"", text.replace('"', "\"\"")),
            Self::Plain(text) => text.clone(),
            Self::Block(bytes) => return out.extend_from_slice(bytes),
        };
        out.extend_from_slice(text.as_bytes());
    }
}

/// A word in full, or in its short form.
pub fn abbreviated(word: &str, verbose: bool) -> String {
    if verbose { word.to_ascii_uppercase() } else { short_form(word).to_owned() }
}

/// Significant digits of a setting: more would show the rounding of binary numbers.
const SETTING_DIGITS: usize = 9;
/// Digits after the decimal point of a measurement from 0.01 up.
const MEASUREMENT_DECIMALS: i32 = 10;
/// Significant digits of a smaller measurement.
const MEASUREMENT_DIGITS: i32 = 9;

/// A setting, `5.0E-1`.
pub fn setting(value: f64) -> String {
    nr3(rounded(value, SETTING_DIGITS))
}

/// A measurement, `4.8800115585E0`: the instrument computes in single precision and writes ten
/// decimals, so that the rounding shows. Below 0.01 nine significant digits are written; no reply
/// of that size has been seen.
pub fn measurement(value: f64) -> String {
    let single = value as f32;
    if single == 0.0 || !single.is_finite() {
        return nr3(0.0);
    }
    if single >= f32::MAX / 10.0 {
        return nr3(value);
    }
    let exact = f64::from(single);
    let exponent = exact.abs().log10().floor() as i32;
    let decimals = MEASUREMENT_DECIMALS.max(MEASUREMENT_DIGITS - 1 - exponent);
    let text = format!("{exact:.*}", usize::try_from(decimals).unwrap_or(0));
    nr3(text.parse().unwrap_or(exact))
}

/// Reads a number, whole or with decimals and exponent, in any of the forms NR1 to NR3, clamped to
/// what single precision holds (unit).
pub fn parse(text: &str) -> Option<f64> {
    let plain = text.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
    let value: f64 = plain.then(|| text.parse().ok())??;
    let largest = f64::from(f32::MAX);
    value.is_finite().then_some(value.clamp(-largest, largest))
}

#[cfg(test)]
mod tests {
    use super::measurement;

    /// Replies of a TDS 2024 (FV:v4.12).
    #[test]
    fn measurements_show_single_precision() {
        for (value, text) in [
            (0.140_000_343_3, "1.400003433E-1"),
            (4.880_011_558_5, "4.8800115585E0"),
            (0.099_999_904_6, "9.99999046E-2"),
            (0.0, "0.0E0"),
            (9.9e37, "9.9E37"),
        ] {
            assert_eq!(measurement(value), text);
        }
    }
}
