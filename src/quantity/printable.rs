//! Text from files and from other programs, made safe for terminals and documents.

use std::borrow::Cow;
use std::fmt::Write as _;

/// Whether a character may reach a terminal or a document: no control character but the line feed,
/// and none that turns the direction of text or is invisible.
fn is_printable(character: char) -> bool {
    character == '\n'
        || !(character.is_control()
            || matches!(character, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
            || matches!(character, '\u{2060}'..='\u{206f}' | '\u{feff}'))
}

/// `text` with every character that a terminal might obey written as `\uXXXX`, which means the same
/// in JSON. Line feeds stay.
pub fn printable(text: &str) -> Cow<'_, str> {
    if text.chars().all(is_printable) {
        return text.into();
    }
    let mut out = String::with_capacity(text.len() + 16);
    for character in text.chars() {
        if is_printable(character) {
            out.push(character);
        } else {
            // All of them have four digits.
            let _ = write!(out, "\\u{:04x}", u32::from(character));
        }
    }
    out.into()
}

/// The same on one line: line feeds are written out, too.
pub fn printable_line(text: &str) -> Cow<'_, str> {
    match printable(text) {
        line if line.contains('\n') => line.replace('\n', "\\u000a").into(),
        line => line,
    }
}
