//! Values: the arguments of commands read, those of replies written before headers are added.

use super::message::Argument;
use crate::instrument::Event;
use crate::scope::limits::rounded;
use crate::scope::set_up::nr3;
use crate::scope::word::{Word, short_form, words};

/// One answer.
#[derive(Debug, Clone, PartialEq)]
pub enum ReplyValue {
    /// A setting with decimals, in the unit that the command's manual names (unit).
    Number(f64),
    /// A measurement, in the unit that `MEASUrement:...:UNIts?` returns (unit).
    Measurement(f64),
    /// A whole number.
    Integer(i64),
    /// One of several words, spelled with its short form in capitals.
    Word(&'static str),
    /// Text in quotation marks.
    Text(String),
    /// Text that is sent unchanged.
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

words! {
    /// A flag as typed.
    Flag {
        /// True.
        On = "ON",
        /// False.
        Off = "OFF",
    }
}

/// The only argument.
///
/// # Errors
/// For none and for more than one.
pub fn only(arguments: &[Argument]) -> Result<&Argument, Event> {
    match arguments {
        [] => Err(Event::MissingParameter),
        [argument] => Ok(argument),
        _ => Err(Event::ParameterNotAllowed),
    }
}

/// No argument.
///
/// # Errors
/// For any.
pub fn none(arguments: &[Argument]) -> Result<(), Event> {
    if arguments.is_empty() { Ok(()) } else { Err(Event::ParameterNotAllowed) }
}

/// The only argument as one of several words.
///
/// # Errors
/// For another count of arguments, and for a word that is not one of the choices.
pub fn word<T: Word>(arguments: &[Argument]) -> Result<T, Event> {
    match only(arguments)? {
        Argument::Word(typed) => T::from_word(typed).ok_or(Event::IllegalParameter),
        Argument::Text(_) | Argument::Block(_) => Err(Event::DataType),
    }
}

/// The only argument as a flag: `ON`, `OFF`, or a number that is zero for `OFF`.
///
/// # Errors
/// For another count of arguments, and for what is no flag.
pub fn flag(arguments: &[Argument]) -> Result<bool, Event> {
    match real(arguments) {
        Ok(value) => Ok(value.round().abs() > 0.0),
        Err(_) => word::<Flag>(arguments).map(|flag| flag == Flag::On),
    }
}

/// The only argument as a number (unit).
///
/// # Errors
/// For another count of arguments, and for what is no number.
pub fn real(arguments: &[Argument]) -> Result<f64, Event> {
    match only(arguments)? {
        Argument::Word(typed) => parse(typed).ok_or(Event::DataType),
        Argument::Text(_) | Argument::Block(_) => Err(Event::DataType),
    }
}

/// The only argument as a whole number, rounded and clamped into a range.
///
/// # Errors
/// For another count of arguments, and for what is no number.
pub fn whole(arguments: &[Argument], least: u32, most: u32) -> Result<u32, Event> {
    let value = real(arguments)?.round().clamp(f64::from(least), f64::from(most));
    let whole = value as u32;
    Ok(whole)
}

/// The only argument as text in quotation marks.
///
/// # Errors
/// For another count of arguments, and for what is no text.
pub fn text(arguments: &[Argument]) -> Result<&str, Event> {
    match only(arguments)? {
        Argument::Text(text) => Ok(text),
        Argument::Word(_) | Argument::Block(_) => Err(Event::DataType),
    }
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
