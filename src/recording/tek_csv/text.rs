//! Turns the bytes of a table into text: UTF-8, UTF-16 with its byte order mark, else Latin-1
//! (Windows-1252 has the same letters in the places that matter here: degree sign, micro sign,
//! umlauts).

use std::borrow::Cow;

use crate::recording::error::{RecordingError, place};

/// Sets a UTF-8 file's beginning apart; spreadsheets write it.
pub(super) const BYTE_ORDER_MARK: char = '\u{feff}';

/// The text of a file, with what had to be assumed of its encoding or its line ends.
pub(super) struct DecodedText<'a> {
    pub(super) text: Cow<'a, str>,
    pub(super) notes: Vec<String>,
}

/// The text of `bytes`.
///
/// # Errors
/// [`RecordingError`] for bytes that no text has.
pub(super) fn decode<'a>(bytes: &'a [u8], file: &str) -> Result<DecodedText<'a>, RecordingError> {
    let mut notes = Vec::new();
    let text = match bytes {
        [0xFF, 0xFE, rest @ ..] => Cow::Owned(utf_16(rest, u16::from_le_bytes)),
        [0xFE, 0xFF, rest @ ..] => Cow::Owned(utf_16(rest, u16::from_be_bytes)),
        _ => {
            if let Ok(text) = std::str::from_utf8(bytes) {
                Cow::Borrowed(text)
            } else {
                notes.push("the text is not UTF-8 and was read as Latin-1".to_owned());
                Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect())
            }
        }
    };
    // A table has tabs and line ends, and no other control characters.
    let control = |c: char| c.is_ascii_control() && !matches!(c, '\t' | '\n' | '\r' | '\u{c}');
    if let Some((at, found)) = text.char_indices().find(|(_, c)| control(*c)) {
        let before = text.get(..at).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        let found = u8::try_from(found).unwrap_or_default();
        let place = place(file, line, column);
        return Err(RecordingError::found(place, format!("byte 0x{found:02X}"), "UTF-8 text"));
    }
    if text.contains('\r') && !text.contains('\n') {
        return Ok(DecodedText { text: Cow::Owned(text.replace('\r', "\n")), notes });
    }
    Ok(DecodedText { text, notes })
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.chunks_exact(2).map(|pair| match pair {
        [first, second] => unit([*first, *second]),
        _ => 0,
    });
    char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_give_the_same_text() {
        let text = "t (µs),T (°)\n1,2\n";
        let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
        let units: Vec<u16> = std::iter::once(0xFEFF).chain(text.encode_utf16()).collect();
        let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
        let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
        for bytes in [text.as_bytes().to_vec(), latin, little, big] {
            assert_eq!(
                decode(&bytes, "a.csv").ok().map(|t| t.text.into_owned()).as_deref(),
                Some(text)
            );
        }
        let error = decode(b"a\0b", "a.csv").err().map(|error| error.to_string());
        assert!(error.is_some_and(|error| error.contains("expected UTF-8 text")));
    }
}
