//! Plain tables: columns as wide as their widest cell, numbers to the right.

/// Widest column: longer cells stand out of it, and make nothing else wider (characters).
const WIDEST: usize = 60;

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
        cells.map(|c| c.chars().count()).filter(|width| *width <= WIDEST).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate();
        let padded = cells.map(|(column, (cell, width))| {
            if left.contains(&column) {
                format!("{cell:<width$}")
            } else {
                format!("{cell:>width$}")
            }
        });
        format!("  {}", padded.collect::<Vec<_>>().join(gap).trim_end())
    };
    rows.iter().map(line).collect()
}
