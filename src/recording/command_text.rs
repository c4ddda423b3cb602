//! The instrument's way to write settings as text,
//! `:CH1:SCALE 2.0E0;POSITION 0.0E0;:HORIZONTAL:...`, taken apart. `.SET` files are such a text,
//! and an ISF begins with one.
//!
//! A header without a leading `:` continues the path of the one before it:
//! `:MATH:DEFINE "..";FFT:HORIZONTAL:SCALE 1` sets `MATH:FFT:HORIZONTAL:SCALE`. Source: Tektronix
//! programmer manual 071-1075, command syntax; the rule gives every path of the `.SET` files in the
//! project's fact sheet, section 2.7.

/// One setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SettingCommand<'a> {
    /// Header as written.
    pub(super) header: &'a [u8],
    /// Its value, without white space at the ends.
    pub(super) value: &'a [u8],
    /// Where the header begins in the text, in bytes.
    pub(super) offset: usize,
    /// Where the value begins.
    pub(super) value_offset: usize,
}

/// The command that begins at or after `from`, and where the next one may begin; `None` at the end.
pub(super) fn command(text: &[u8], from: usize) -> Option<(SettingCommand<'_>, usize)> {
    let rest = text.get(from..)?;
    let blank = rest.iter().take_while(|b| b.is_ascii_whitespace() || **b == b';').count();
    let offset = from + blank;
    let rest = text.get(offset..).filter(|rest| !rest.is_empty())?;
    let is_end = |b: &u8| b.is_ascii_whitespace() || matches!(b, b';' | b'#' | b'"');
    let length = rest.iter().position(is_end).unwrap_or(rest.len());
    let (header, tail) = rest.split_at(length);
    let padding = tail.iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
    let tail = tail.get(padding..).unwrap_or_default();
    let mut quoted = false;
    let end = tail.iter().position(|byte| {
        quoted ^= *byte == b'"';
        *byte == b';' && !quoted
    });
    let value_offset = offset + length + padding;
    let end = end.unwrap_or(tail.len());
    let value = tail.get(..end).unwrap_or_default().trim_ascii();
    // A value without a header must not hold up the walk.
    let next = (value_offset + end).max(offset + 1);
    Some((SettingCommand { header, value, offset, value_offset }, next))
}

/// The full path of `header`, in capitals, after the path `before`.
pub(super) fn path(header: &str, before: &str) -> String {
    let header = header.to_ascii_uppercase();
    if let Some(rooted) = header.strip_prefix(':') {
        return rooted.to_owned();
    }
    match before.rsplit_once(':') {
        Some((stem, _)) => format!("{stem}:{header}"),
        None => header,
    }
}

/// A text value without its quotes.
pub(super) fn unquoted(value: &str) -> &str {
    value.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_continue_until_a_colon() {
        let text = b":HORIZONTAL:VIEW MAIN;MAIN:SCALE 5.0E-5;POSITION 0.0E0;:MATH:DEFINE \"a;b\";FFT:SCALE 1\n";
        let (mut at, mut before, mut found) = (0, String::new(), Vec::new());
        while let Some((command, next)) = command(text, at) {
            before = path(std::str::from_utf8(command.header).expect("text"), &before);
            found.push((before.clone(), String::from_utf8_lossy(command.value).into_owned()));
            at = next;
        }
        let wanted = [
            ("HORIZONTAL:VIEW", "MAIN"),
            ("HORIZONTAL:MAIN:SCALE", "5.0E-5"),
            ("HORIZONTAL:MAIN:POSITION", "0.0E0"),
            ("MATH:DEFINE", "\"a;b\""),
            ("MATH:FFT:SCALE", "1"),
        ];
        assert_eq!(found, wanted.map(|(path, value)| (path.to_owned(), value.to_owned())));
    }
}
