//! Values of replies, before headers are added.

use super::number;
use crate::instrument::word::short_form;

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
    /// A flag as `1` or `0`.
    pub fn flag(on: bool) -> Self {
        Self::Integer(i64::from(on))
    }

    /// Appends what the instrument writes; `verbose` writes words in full.
    pub fn write(&self, verbose: bool, out: &mut Vec<u8>) {
        let text = match self {
            Self::Number(value) => number::setting(*value),
            Self::Measurement(value) => number::measurement(*value),
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
