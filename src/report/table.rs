//! Cells and plain tables: numbers with their expanded uncertainty to two digits of it; columns as
//! wide as their widest cell, numbers to the right.

use unicode_width::UnicodeWidthStr;

use crate::quantity::{Uncertain, engineering};

/// Widest column: longer cells overflow it and make no other cell wider (characters).
const WIDEST: usize = 60;

/// Columns that `text` takes on a terminal.
pub(super) fn width(text: &str) -> usize {
    UnicodeWidthStr::width(text)
}

/// Rows under their heading.
pub fn titled<const N: usize>(
    heading: [&str; N],
    rows: impl IntoIterator<Item = Vec<String>>,
) -> Vec<Vec<String>> {
    std::iter::once(heading.map(str::to_owned).to_vec()).chain(rows).collect()
}

/// A number that may be unknown, in engineering notation with so many digits.
pub fn known(value: Option<f64>, unit: &str, digits: usize) -> String {
    value.map_or("-".to_owned(), |value| engineering(value, unit, digits))
}

/// A table with one row for each of a list of things, in parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowTable {
    /// Title and heading.
    pub head: Vec<String>,
    /// A line for each thing.
    pub rows: Vec<String>,
    /// Explanation of the table.
    pub foot: String,
}

/// Lines of a table whose first row is its heading. Columns named in `left` are flush left.
pub fn lines(rows: &[Vec<String>], left: &[usize]) -> Vec<String> {
    lines_apart(rows, left, "  ")
}

/// The same of many columns, with `gap` between them.
pub fn lines_apart(rows: &[Vec<String>], left: &[usize], gap: &str) -> Vec<String> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| self::width(cell)).filter(|width| *width <= WIDEST).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate();
        let padded = cells.map(|(column, (cell, width))| {
            let padding = " ".repeat(width.saturating_sub(self::width(cell)));
            if left.contains(&column) {
                format!("{cell}{padding}")
            } else {
                format!("{padding}{cell}")
            }
        });
        format!("  {}", padded.collect::<Vec<_>>().join(gap).trim_end())
    };
    rows.iter().map(line).collect()
}

/// Decimals that show two digits of `u`.
pub(super) fn decimals(u: f64) -> usize {
    (1.0 - u.log10().floor()).clamp(0.0, 12.0) as usize
}

/// A number in the given unit: `1.4601 ± 0.0023 GPa`.
pub(super) fn plus_minus(value: f64, expanded: f64, unit: &str) -> String {
    let decimals = decimals(expanded);
    let value = format!("{value:.decimals$}");
    // A zero of rounding has no sign.
    let is_zero = value.chars().all(|c| !('1'..='9').contains(&c));
    let value = if is_zero { value.trim_start_matches('-') } else { &value };
    format!("{value} ± {expanded:.decimals$} {unit}").trim_end().to_owned()
}

/// A share in percent with its sign: `+8.6 ± 1.2 %`.
pub fn signed_percent(share: Uncertain) -> String {
    let text = plus_minus(100.0 * share.value, 100.0 * share.expanded(), "%");
    if share.value >= 0.0 { format!("+{text}") } else { text }
}

/// In the prefix of the larger of the two: `319 ± 12 mN`, `0.9 ± 3.1 µs`.
pub fn with_expanded(value: f64, expanded: f64, unit: &str) -> String {
    let alone = engineering(value, unit, 4);
    if !(expanded.is_finite() && expanded > 0.0) {
        return alone;
    }
    let larger = value.abs().max(expanded);
    let shown = engineering(larger, unit, 6);
    let Some((number, prefixed)) = shown.split_once(' ') else { return alone };
    let Ok(mantissa) = number.parse::<f64>() else { return alone };
    let scale = 10f64.powf((mantissa / larger).log10().round());
    plus_minus(value * scale, expanded * scale, prefixed)
}

/// The same with its sign: `+89.3 ± 1.1 µs`. Where `expanded` is not known, the value alone.
pub fn signed_with_expanded(value: f64, expanded: Option<f64>, unit: &str) -> String {
    let sign = if value >= 0.0 { "+" } else { "" };
    format!("{sign}{}", with_expanded(value, expanded.unwrap_or(f64::NAN), unit))
}

/// The same notes in fewer lines: what is said of several channels in the same words is said once,
/// where it was said first.
pub(super) fn joined(notes: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut lines: Vec<(Option<String>, String)> = Vec::new();
    let is_channel = |name: &str| name == "MATH" || name.starts_with("CH") && !name.contains(' ');
    for note in notes {
        let (channel, words) = match note.split_once(": ") {
            Some((channel, words)) if is_channel(channel) => {
                (Some(channel.to_owned()), words.to_owned())
            }
            _ => (None, note),
        };
        let same = lines.iter_mut().find(|(channels, said)| channels.is_some() && *said == words);
        match (same, channel) {
            (Some((Some(channels), _)), Some(channel)) => {
                channels.push_str(", ");
                channels.push_str(&channel);
            }
            (_, channel) => lines.push((channel, words)),
        }
    }
    let line = |(channels, words): (Option<String>, String)| match channels {
        Some(channels) => format!("{channels}: {words}"),
        None => words,
    };
    lines.into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_several_channels_share_is_said_once() {
        let notes = ["CH1: cut", "no speeds", "CH2: cut", "CH2: noisy"].map(str::to_owned);
        assert_eq!(joined(notes), ["CH1, CH2: cut", "no speeds", "CH2: noisy"]);
        let notes = ["CH1: cut", "MATH: cut"].map(str::to_owned);
        assert_eq!(joined(notes), ["CH1, MATH: cut"]);
    }

    #[test]
    fn both_numbers_have_the_larger_prefix() {
        assert_eq!(with_expanded(0.319, 0.0123, "N"), "319 ± 12 mN");
        assert_eq!(with_expanded(904e-9, 3.074e-6, "s"), "0.9 ± 3.1 µs");
        assert_eq!(with_expanded(-1e-9, 3.074e-6, "s"), "0.0 ± 3.1 µs");
        assert_eq!(signed_with_expanded(904e-9, None, "s"), "+904.0 ns");
    }
}
