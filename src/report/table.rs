//! Plain tables: columns as wide as their widest cell, numbers to the right.

use unicode_width::UnicodeWidthStr;

use crate::quantity::engineering;

/// Widest column: longer cells stand out of it, and make nothing else wider (characters).
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
