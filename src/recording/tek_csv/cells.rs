//! Splits a CSV file into rows and cells: whatever separator, decimal mark, quotes and line ends a
//! program put there. Comes before all readers.
//!
//! A number is kept with the digits it was printed with, because they bound how far it may lie from
//! the true one.

use std::borrow::Cow;

use super::names::{ColumnUnit, unit};
use super::text::BYTE_ORDER_MARK;
use crate::recording::error::{FileLocation, RecordingError, excerpt, place};

/// Most rows that are read.
pub(super) const MAX_ROWS: usize = 2_000_000;
/// Cells of a row that are looked at: 4 channels of `OpenChoice` take 24.
const MAX_CELLS: usize = 32;
/// From this on, a number says that the instrument's range was left (SCPI-99, 7.2.1.4).
pub(super) const LARGEST: f64 = 9.9e37;
/// Rows that are looked at to find the separator.
const SAMPLED_ROWS: usize = 16;

/// A number and its digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PrintedNumber {
    /// The number (unit).
    pub(super) value: f64,
    /// Place of the last digit: 2 for `0.04`, -1 for `1.2E2`.
    pub(super) decimals: i32,
    /// Digits from the first that is not zero.
    pub(super) digits: i32,
}

/// A file's rows, not yet split.
#[derive(Debug, Clone)]
pub(super) struct CsvRows<'a> {
    pub(super) file: &'a str,
    lines: Vec<&'a str>,
    pub(super) separator: char,
    /// Whether numbers have a comma where others have a point.
    pub(super) decimal_comma: bool,
    /// Whether units stand behind the numbers, in their cells.
    has_units: bool,
}

/// One row of a table.
#[derive(Debug, Clone)]
pub(super) struct Cells<'a> {
    file: &'a str,
    line: usize,
    /// Content without quotes and padding, and the column where the cell begins, counted from 1.
    parts: Vec<(&'a str, usize)>,
    decimal_comma: bool,
    has_units: bool,
}

impl<'a> CsvRows<'a> {
    /// Finds the separator and the decimal mark of `text`.
    pub(super) fn new(file: &'a str, text: &'a str) -> Result<Self, RecordingError> {
        let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
        let found = text.bytes().filter(|byte| *byte == b'\n').count();
        if found > MAX_ROWS {
            let problem = format!("{found} rows are more than the {MAX_ROWS} that are read");
            let advice = "cut the record, or save fewer points";
            return Err(RecordingError::new(file, format_args!("{problem}: {advice}")));
        }
        let mut lines: Vec<&str> = text.lines().collect();
        while lines.last().is_some_and(|line| line.trim().is_empty()) {
            lines.pop();
        }
        let separator = separator(&lines);
        let mut table = Self { file, lines, separator, decimal_comma: false, has_units: false };
        table.has_units = table.finds_units();
        table.decimal_comma = (0..table.len()).any(|index| table.has_decimal_comma(index));
        Ok(table)
    }

    /// Rows up to the last that is not blank.
    pub(super) fn len(&self) -> usize {
        self.lines.len()
    }

    /// Line `index`, not split.
    pub(super) fn line(&self, index: usize) -> &'a str {
        self.lines.get(index).copied().unwrap_or_default()
    }

    /// Cells of the widest of the first rows.
    pub(super) fn width(&self) -> usize {
        (0..self.len().min(SAMPLED_ROWS)).map(|index| self.row(index).len()).max().unwrap_or(0)
    }

    /// Row `index`, counted from 0; without cells beyond the last.
    pub(super) fn row(&self, index: usize) -> Cells<'a> {
        let line = self.lines.get(index).copied().unwrap_or_default();
        Cells {
            file: self.file,
            line: index + 1,
            parts: split(line, self.separator),
            decimal_comma: self.decimal_comma,
            has_units: self.has_units,
        }
    }

    /// Whether a third of the rows, of which some are looked at, have a unit behind a number.
    fn finds_units(&self) -> bool {
        let step = (self.len() / (4 * SAMPLED_ROWS)).max(1);
        let last = (0..self.len()).rev().step_by(step).take(4 * SAMPLED_ROWS);
        let (mut rows, mut with_units) = (0, 0);
        for index in last {
            let row = self.row(index);
            rows += 1;
            let found = row.texts().any(|cell| {
                parted(cell).is_some_and(|(number, _)| {
                    printed(number, false).is_some() || printed(number, true).is_some()
                })
            });
            with_units += usize::from(found);
        }
        3 * with_units > rows
    }

    fn has_decimal_comma(&self, index: usize) -> bool {
        let line = self.lines.get(index).copied().unwrap_or_default();
        if !line.contains(',') || (self.separator == ',' && !line.contains('"')) {
            return false;
        }
        let row = self.row(index);
        row.parts.iter().any(|(cell, _)| cell.contains(',') && printed(cell, true).is_some())
    }
}

impl<'a> Cells<'a> {
    /// Cell `index`, empty beyond the last.
    pub(super) fn text(&self, index: usize) -> &'a str {
        self.parts.get(index).map(|(cell, _)| *cell).unwrap_or_default()
    }

    pub(super) fn texts(&self) -> impl Iterator<Item = &'a str> + Clone + '_ {
        self.parts.iter().map(|(cell, _)| *cell)
    }

    pub(super) fn len(&self) -> usize {
        self.parts.len()
    }

    pub(super) fn is_blank(&self) -> bool {
        self.texts().all(str::is_empty)
    }

    /// Whether both rows hold at least two numbers, in the same cells, and the same texts beside
    /// them.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let is_number = |row: &Self, cell: usize| row.maybe_number(cell).is_some();
        let cells = 0..self.len().max(other.len());
        let numbers = cells.clone().filter(|cell| is_number(self, *cell)).count();
        numbers > 1
            && cells.into_iter().all(|cell| match (is_number(self, cell), is_number(other, cell)) {
                (true, true) => true,
                (false, false) => self.text(cell) == other.text(cell),
                _ => false,
            })
    }

    /// Whether no cell holds a number.
    pub(super) fn has_no_number(&self) -> bool {
        self.texts().all(|cell| self.parse(cell).is_none())
    }

    pub(super) fn maybe_number(&self, index: usize) -> Option<PrintedNumber> {
        self.parse(self.text(index))
    }

    /// Whether a cell says that the value was above (true) or below (false) the instrument's range:
    /// infinity, or the number that SCPI has for it (SCPI-99, 7.2.1.4).
    pub(super) fn mark(&self, index: usize) -> Option<bool> {
        const ABOVE: [&str; 5] = ["inf", "infinity", "∞", "over", "overrange"];
        const BELOW: [&str; 2] = ["under", "underrange"];
        let text = self.text(index).to_lowercase();
        let (bare, is_negative) = match text.strip_prefix('-') {
            Some(bare) => (bare, true),
            None => (text.strip_prefix('+').unwrap_or(&text), false),
        };
        let number = || self.maybe_number(index).filter(|found| found.value.abs() >= LARGEST);
        match bare {
            _ if ABOVE.contains(&bare) || number().is_some() => Some(!is_negative),
            _ if BELOW.contains(&bare) => Some(false),
            _ => None,
        }
    }

    /// A number with either decimal mark.
    pub(super) fn parse_any(&self, text: &str) -> Option<PrintedNumber> {
        self.parse(text).or_else(|| printed(text, !self.decimal_comma))
    }

    /// The unit behind the number in a cell, where values have units of their own.
    pub(super) fn own_unit(&self, index: usize) -> Option<ColumnUnit> {
        self.has_units.then(|| parted(self.text(index))).flatten().map(|(_, unit)| unit)
    }

    pub(super) fn number(&self, index: usize) -> Result<PrintedNumber, RecordingError> {
        self.maybe_number(index).ok_or_else(|| {
            let found = excerpt(self.text(index));
            RecordingError::found(self.place(index), found, self.expected_number())
        })
    }

    /// What is expected where a cell holds no number.
    pub(super) fn expected_number(&self) -> &'static str {
        if self.decimal_comma {
            "a number with a decimal comma, as elsewhere in the file"
        } else {
            "a number"
        }
    }

    /// The error that a cell has something in it below an empty one.
    pub(super) fn empty_above(&self, index: usize) -> RecordingError {
        let found = excerpt(self.text(index));
        RecordingError::found(self.place(index), found, "no number below an empty cell")
    }

    pub(super) fn file(&self) -> &'a str {
        self.file
    }

    /// Line and column of cell `index`.
    pub(super) fn spot(&self, index: usize) -> (usize, usize) {
        let column = match (self.parts.get(index), self.parts.last()) {
            (Some((_, column)), _) => *column,
            (None, Some((cell, column))) => column + cell.chars().count(),
            (None, None) => 1,
        };
        (self.line, column)
    }

    pub(super) fn place(&self, index: usize) -> FileLocation {
        let (line, column) = self.spot(index);
        place(self.file, line, column)
    }

    pub(super) fn parse(&self, cell: &str) -> Option<PrintedNumber> {
        let plain = printed(cell, self.decimal_comma);
        plain.or_else(|| {
            printed(self.has_units.then(|| parted(cell)).flatten()?.0, self.decimal_comma)
        })
    }
}

/// What stands between cells: the mark that splits most of the sampled rows into numbers; a space
/// stands for any run of blanks. Without numbers, a semicolon or a tab where there is one in the
/// first rows, else a comma.
fn separator(lines: &[&str]) -> char {
    let filled = lines.iter().rev().filter(|line| !line.trim().is_empty()).take(SAMPLED_ROWS);
    // Rows of nothing but numbers count twice.
    let splits = |mark: char| {
        let rows = filled.clone().map(|line| {
            let cells = split(line, mark);
            let cells = cells.iter().map(|(cell, _)| *cell).filter(|cell| !cell.is_empty());
            let is_number = |cell: &&str| {
                printed(cell, false).is_some() || (mark != ',' && printed(cell, true).is_some())
            };
            let (all, numbers) = (cells.clone().count(), cells.filter(is_number).count());
            match (numbers, all == numbers) {
                (2.., true) => 2,
                (2.., false) if mark != ' ' => 1,
                _ => 0,
            }
        });
        rows.sum::<u32>()
    };
    let marks = [';', '\t', ',', ' '];
    let best = marks.map(splits).into_iter().max().unwrap_or_default();
    if let Some(mark) = marks.into_iter().find(|mark| best > 0 && splits(*mark) == best) {
        return mark;
    }
    let head = || lines.iter().take(4);
    [';', '\t'].into_iter().find(|mark| head().any(|line| line.contains(*mark))).unwrap_or(',')
}

/// The fields of a line between separators, each with the column where it begins, counted from 1;
/// separators between quotes belong to a field.
#[derive(Debug, Clone)]
struct RowFields<'a> {
    rest: Option<&'a str>,
    column: usize,
    separator: char,
}

impl<'a> RowFields<'a> {
    fn of(line: &'a str, separator: char) -> Self {
        Self { rest: Some(line), column: 1, separator }
    }
}

impl<'a> Iterator for RowFields<'a> {
    type Item = (&'a str, usize);

    fn next(&mut self) -> Option<Self::Item> {
        let (line, column) = (self.rest?, self.column);
        let mut quoted = false;
        let ends = |character: char| {
            quoted ^= character == '"';
            character == self.separator && !quoted
        };
        let Some(end) = line.find(ends) else {
            self.rest = None;
            return Some((line, column));
        };
        let (field, rest) = line.split_at(end);
        self.rest = rest.get(self.separator.len_utf8()..);
        let width = if field.is_ascii() { field.len() } else { field.chars().count() };
        self.column += width + 1;
        Some((field, column))
    }
}

fn split(line: &str, separator: char) -> Vec<(&str, usize)> {
    let fields = RowFields::of(line, separator).map(|(cell, column)| (bare(Some(cell)), column));
    if separator == ' ' {
        let filled = fields.flat_map(|(cell, column)| {
            cell.split('\t').filter(|part| !part.is_empty()).map(move |part| (part, column))
        });
        // The mark of a remark stands apart from the first name.
        let is_mark =
            |(part, column): &(&str, usize)| *column == 1 && matches!(*part, "#" | "%" | ";");
        let cells = filled.filter(|cell| !is_mark(cell)).take(MAX_CELLS).collect();
        return with_units(line, cells);
    }
    fields.take(MAX_CELLS).collect()
}

/// The cells of `line` that blanks separate, with units in brackets joined to the names before
/// them: `t [s] a [g]` are two.
fn with_units<'a>(line: &'a str, cells: Vec<(&'a str, usize)>) -> Vec<(&'a str, usize)> {
    let is_unit = |cell: &str| cell.starts_with(['(', '[']) && cell.ends_with([')', ']']);
    if !cells.iter().skip(1).any(|(cell, _)| is_unit(cell)) {
        return cells;
    }
    // Cells are parts of the line.
    let place = |cell: &str| (cell.as_ptr() as usize).saturating_sub(line.as_ptr() as usize);
    let mut joined: Vec<(&str, usize)> = Vec::with_capacity(cells.len());
    for (cell, column) in cells {
        let name =
            joined.last_mut().filter(|(name, _)| is_unit(cell) && !name.ends_with([')', ']']));
        match name {
            Some((name, _)) => {
                *name = line.get(place(name)..place(cell) + cell.len()).unwrap_or(name);
            }
            None => joined.push((cell, column)),
        }
    }
    joined
}

/// A number and the unit behind it: `1.2V`, `400 mV`.
fn parted(cell: &str) -> Option<(&str, ColumnUnit)> {
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | '+' | '-' | 'e' | 'E');
    let at = cell.find(|c: char| !is_part(c))?;
    let (number, text) = cell.split_at_checked(at)?;
    Some((number, unit(text)?)).filter(|_| !number.is_empty())
}

fn bare(cell: Option<&str>) -> &str {
    let cell = cell.unwrap_or_default().trim();
    cell.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(cell).trim()
}

/// Reads a finite decimal number with its digits.
fn printed(cell: &str, decimal_comma: bool) -> Option<PrintedNumber> {
    const LONGEST: usize = 40;
    // A double has exponents from -324, where its last digits are lost, to 308.
    const EXPONENTS: std::ops::RangeInclusive<i32> = -350..=300;
    const MOST_DECIMALS: i32 = 300;
    let allowed = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | 'e' | 'E' | '.' | ',');
    if cell.len() > LONGEST || !cell.chars().all(allowed) {
        return None;
    }
    let text = match (decimal_comma, cell.contains(','), cell.contains('.')) {
        (_, true, _) if cell.ends_with(',') || cell.starts_with(',') => return None,
        (true, true, false) => Cow::Owned(cell.replace(',', ".")),
        (_, false, false) | (false, false, true) => Cow::Borrowed(cell),
        _ => return None,
    };
    let value = text.parse().ok().filter(|value: &f64| value.is_finite())?;
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text.as_ref(), "0"));
    let exponent: i32 = exponent.parse().ok().filter(|e| EXPONENTS.contains(e))?;
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let figures = || whole.chars().chain(fraction.chars()).filter(char::is_ascii_digit);
    let digits = i32::try_from(figures().skip_while(|c| *c == '0').count()).ok()?;
    let decimals = i32::try_from(fraction.len()).ok()?.checked_sub(exponent)?;
    let decimals = decimals.min(MOST_DECIMALS);
    Some(PrintedNumber { value, decimals, digits })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits() {
        for (text, value, decimals, digits) in [
            ("0.04", 0.04, 2, 1),
            ("-1.2", -1.2, 1, 2),
            ("2.50E+03", 2500.0, -1, 3),
            ("79.999998212E-3", 79.999_998_212e-3, 12, 11),
            ("0", 0.0, 0, 0),
            ("5e-324", 5e-324, 300, 1),
        ] {
            assert_eq!(
                printed(text, false),
                Some(PrintedNumber { value, decimals, digits }),
                "{text}"
            );
        }
        assert_eq!(printed("-0,04", true).map(|p| p.value), Some(-0.04));
        for text in ["", "nan", "inf", "1e999", "1,5", "0x1", "1.5.2", "-"] {
            assert_eq!(printed(text, false), None, "{text}");
        }
        assert_eq!(printed("1.234,5", true), None);
    }

    #[test]
    fn quotes_hold_separators() {
        let table = CsvRows::new("a.csv", "\u{feff}\"-0,03\",\"0,5\"\r\n\"-0,02\",\"1\"\r\n\r\n");
        let table = table.expect("short");
        assert_eq!((table.len(), table.separator, table.decimal_comma), (2, ',', true));
        assert_eq!(table.row(0).maybe_number(1).map(|p| p.value), Some(0.5));
    }
}
