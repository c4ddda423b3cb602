//! A column of printed numbers, and how far each may lie from the true one. Shared by `times` and
//! `levels`.
//!
//! A program prints either a fixed number of decimals or a fixed number of digits, and may drop
//! zeros at the end. The longest number of the column tells how many; the larger of the two errors
//! bounds the true one: `max(10^-D / 2, 10^(m + 1 - S) / 2)` with the most decimals `D` and the
//! most digits `S` of the column and the number's magnitude `m = floor(log10 |v|)`.

use super::cells::{Cells, LARGEST, PrintedNumber};
use super::names::ColumnUnit;
use crate::recording::error::{FileLocation, RecordingError, excerpt};

/// Digits of single precision that can be relied on; numbers that went through it are printed with
/// more.
pub(super) const SINGLE_PRECISION_DIGITS: i32 = 6;
/// Digits beyond which double precision is the limit.
const MAX_DIGITS: i32 = 15;

/// One column of samples.
#[derive(Debug, Clone, Default)]
pub(super) struct SampleColumn {
    /// The numbers (unit).
    pub(super) values: Vec<f64>,
    file: String,
    /// Line and column of each.
    spots: Vec<(u32, u32)>,
    decimals: i32,
    digits: i32,
    /// Factor of units that are no power of ten of the SI unit, e.g. 60 for minutes; 0 means none.
    factor: f64,
    /// Rows without a value before the first.
    pub(super) before: usize,
    /// Places of samples beyond the instrument's range, and whether they are above it.
    pub(super) beyond: Vec<(usize, bool)>,
    /// The unit that stands behind the numbers.
    pub(super) own_unit: Option<ColumnUnit>,
    /// Whether a number was printed with a decimal point.
    fractions: bool,
}

impl SampleColumn {
    /// Adds cell `index` of `row`; a sample beyond the instrument's range has the value before it
    /// until the range is known.
    pub(super) fn push(&mut self, row: &Cells<'_>, index: usize) -> Result<(), RecordingError> {
        let found = row.maybe_number(index).filter(|found| found.value.abs() < LARGEST);
        let beyond = if found.is_some() { None } else { row.mark(index) };
        if let Some(is_above) = beyond {
            self.beyond.push((self.values.len(), is_above));
            self.values.push(self.values.last().copied().unwrap_or_default());
        } else {
            let found = found.map_or_else(|| row.number(index), Ok)?;
            self.push_number(row, index, found)?;
        }
        let (line, column) = row.spot(index);
        let number = |place: usize| u32::try_from(place).unwrap_or(u32::MAX);
        self.spots.push((number(line), number(column)));
        if self.file.is_empty() {
            row.file().clone_into(&mut self.file);
        }
        Ok(())
    }

    fn push_number(
        &mut self,
        row: &Cells<'_>,
        index: usize,
        PrintedNumber { value, decimals, digits }: PrintedNumber,
    ) -> Result<(), RecordingError> {
        let unit = row.own_unit(index);
        let first = self.values.len() == self.beyond.len();
        match (&self.own_unit, &unit) {
            (Some(known), Some(unit)) if known == unit => {}
            (None, None) => {}
            (None, Some(_)) if first => self.own_unit = unit,
            _ => {
                let known = self.own_unit.as_ref().map_or("no unit", |unit| unit.text);
                let expected = format!("the unit of the rows above, {known}, and its prefix");
                let found = excerpt(row.text(index));
                return Err(RecordingError::found(row.place(index), found, expected));
            }
        }
        self.decimals = if first { decimals } else { self.decimals.max(decimals) };
        self.digits = self.digits.max(digits);
        self.fractions |= row.text(index).contains(['.', ',']);
        self.values.push(value);
        Ok(())
    }

    /// Counts a row without a value, before the first one.
    pub(super) fn skip_row(&mut self) {
        self.before += usize::from(self.values.is_empty());
    }

    /// The values of `rows`, counted from the table's first.
    pub(super) fn of_rows(self, rows: std::ops::Range<usize>) -> Self {
        if rows == (self.before..self.before + self.len()) {
            return self;
        }
        let from = rows.start.saturating_sub(self.before);
        let to = rows.end.saturating_sub(self.before).min(self.len());
        let beyond = self.beyond.iter().filter(|(place, _)| (from..to).contains(place));
        Self {
            values: self.values.get(from..to).unwrap_or_default().to_vec(),
            spots: self.spots.get(from..to).unwrap_or_default().to_vec(),
            beyond: beyond.map(|(place, above)| (place - from, *above)).collect(),
            before: rows.start,
            ..self
        }
    }

    /// Whether no number is smaller than the one before, and the last larger than the first.
    pub(super) fn rises(&self) -> bool {
        let ends = self.values.first().zip(self.values.last());
        self.values.is_sorted() && ends.is_some_and(|(first, last)| first < last)
    }

    /// Whether the numbers are 0 and 1 only, printed without a decimal point.
    pub(super) fn is_logic(&self) -> bool {
        const FEWEST: usize = 8;
        let is_bit = |value: &f64| [0.0, 1.0].map(f64::to_bits).contains(&value.to_bits());
        !self.fractions && self.len() >= FEWEST && self.values.iter().all(is_bit)
    }

    /// Whether all numbers are printed whole and lie in `range`.
    pub(super) fn are_whole(&self, (low, high): (f64, f64)) -> bool {
        !self.fractions && self.values.iter().all(|value| (low..=high).contains(value))
    }

    /// Whether the numbers count rows: whole ones, each by one larger, from 0 or 1.
    pub(super) fn counts(&self) -> bool {
        let starts = self
            .values
            .first()
            .is_some_and(|first| [0.0, 1.0].map(f64::to_bits).contains(&first.abs().to_bits()));
        starts && self.steps_by_one()
    }

    /// Whether each number is printed whole and by one larger than the one before.
    pub(super) fn steps_by_one(&self) -> bool {
        let by_one = |pair: &[f64]| matches!(pair, [a, b] if (b - a - 1.0).abs() < f64::EPSILON);
        !self.fractions && self.values.windows(2).all(by_one)
    }

    /// Multiplies every number, as a unit such as `ms` wants it; `power` is that of ten.
    pub(super) fn scale(&mut self, power: i32) {
        for value in &mut self.values {
            *value = shifted(*value, self.decimals, power);
        }
        self.decimals = self.decimals.saturating_sub(power);
    }

    /// Multiplies every number by what is no power of ten.
    pub(super) fn multiply(&mut self, factor: f64) {
        self.values.iter_mut().for_each(|value| *value *= factor);
        self.factor = factor;
    }

    /// Puts computed numbers in the place of the printed ones, with two decimals more.
    pub(super) fn replace(&mut self, values: Vec<f64>) {
        self.values = values;
        self.decimals += 2;
        self.digits = MAX_DIGITS;
    }

    pub(super) fn limit_digits(&mut self, digits: i32) {
        self.digits = self.digits.min(digits);
    }

    pub(super) fn len(&self) -> usize {
        self.values.len()
    }

    /// `value` with the decimals of the column.
    pub(super) fn printed(&self, value: f64) -> String {
        match usize::try_from(self.decimals) {
            Ok(decimals) if decimals <= 15 && self.factor == 0.0 => format!("{value:.decimals$}"),
            _ => value.to_string(),
        }
    }

    /// Where number `index` stands.
    pub(super) fn place(&self, index: usize) -> FileLocation {
        let (line, column) = self.spots.get(index).copied().unwrap_or_default();
        FileLocation { file: self.file.clone(), line: line as usize, column: column as usize }
    }

    /// The most digits that a number of the column has.
    pub(super) fn digits(&self) -> i32 {
        self.digits
    }

    /// Last place of the column's longest number.
    pub(super) fn decimals(&self) -> i32 {
        self.decimals
    }

    /// The last printed digit, where the number of decimals is fixed (unit).
    pub(super) fn digit(&self) -> f64 {
        ten_to(-self.decimals) * if self.factor == 0.0 { 1.0 } else { self.factor }
    }

    /// Half the last digit of `value`, and the round-off of double precision (unit).
    pub(super) fn tolerance(&self, value: f64) -> f64 {
        let factor = if self.factor == 0.0 { 1.0 } else { self.factor };
        factor * self.printed_tolerance(value / factor)
    }

    fn printed_tolerance(&self, value: f64) -> f64 {
        let fixed = 0.5 * ten_to(-self.decimals);
        let digits = self.digits.clamp(1, MAX_DIGITS);
        let floating = match value.abs() {
            0.0 => 0.0,
            size => 0.5 * ten_to(size.log10().floor() as i32 + 1 - digits),
        };
        fixed.max(floating) * (1.0 + 1e-6) + 4.0 * f64::EPSILON * value.abs()
    }

    /// How many last digits make up `step`, if multiples of it are printed without rounding: a
    /// fixed number of decimals, in which also the largest value has all of them, and a step that
    /// is a whole number of last digits.
    pub(super) fn digits_of(&self, step: f64) -> Option<f64> {
        let (low, high) = self.range();
        let largest = low.abs().max(high.abs()).max(f64::MIN_POSITIVE);
        let magnitude = largest.log10().floor() as i32;
        let fixed = self.decimals <= self.digits.min(MAX_DIGITS) - 1 - magnitude;
        let count = step / ten_to(-self.decimals);
        let is_whole = count >= 0.5 && (count - count.round()).abs() <= 1e-6;
        (fixed && is_whole).then(|| count.round())
    }

    /// The largest tolerance of the column (unit).
    pub(super) fn largest_tolerance(&self) -> f64 {
        self.values.iter().map(|value| self.tolerance(*value)).fold(0.0, f64::max)
    }

    /// Lowest and highest value (unit).
    pub(super) fn range(&self) -> (f64, f64) {
        let fold = |f: fn(f64, f64) -> f64, start| self.values.iter().copied().fold(start, f);
        (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY))
    }
}

/// The number that `value`, printed with up to `decimals` decimals, is with its decimal point
/// `power` places to the right.
fn shifted(value: f64, decimals: i32, power: i32) -> f64 {
    // Whole numbers below this, and powers of ten up to this, are exact, and so is one rounding.
    const EXACT: (f64, i32) = (4e15, 22);
    let places = decimals.max(0);
    if places <= EXACT.1 && (0..=EXACT.1).contains(&(places - power)) {
        let whole = (value * ten_to(places)).round();
        let is_whole =
            whole.abs() < EXACT.0 && (whole / ten_to(places)).to_bits() == value.to_bits();
        if is_whole {
            return whole / ten_to(places - power);
        }
    }
    let text = format!("{value:e}");
    let parts = text.split_once('e');
    let moved = parts.and_then(|(digits, exponent)| {
        let exponent = exponent.parse::<i32>().ok()?.checked_add(power)?;
        format!("{digits}e{exponent}").parse().ok()
    });
    moved.unwrap_or(value)
}

/// A power of ten, as a decimal literal would give it (1).
pub(super) fn ten_to(power: i32) -> f64 {
    // Exact powers, and so correctly rounded quotients.
    const EXACT: i32 = 22;
    if power.abs() <= EXACT {
        let exact = 10f64.powi(power.abs());
        return if power < 0 { 1.0 / exact } else { exact };
    }
    format!("1e{power}").parse().unwrap_or(f64::NAN)
}

/// `value` rounded to `digits` significant digits (unit).
pub(super) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// The step 1, 2 or 5 times a power of ten within `tolerance`, relative, of `value` (unit).
pub(super) fn one_two_five(value: f64, tolerance: f64) -> Option<f64> {
    let nearest = rounded(value, 1);
    let first = format!("{nearest:e}").chars().next();
    let near = (value - nearest).abs() <= tolerance * nearest.abs();
    (near && matches!(first, Some('1' | '2' | '5'))).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::tek_csv::cells::CsvRows;

    fn column(text: &str) -> SampleColumn {
        let table = CsvRows::new("a.csv", text).expect("short");
        let mut column = SampleColumn::default();
        for index in 0..table.len() {
            column.push(&table.row(index), 0).expect("numbers");
        }
        column
    }

    #[test]
    fn the_longest_number_tells_the_precision() {
        // Two decimals, zeros dropped: -1 means -1.00.
        let fixed = column("-1.32\n-0.4\n-1\n");
        assert!((fixed.tolerance(-1.0) - 0.005).abs() < 1e-7);
        // Six digits: 1.20479 is good to 5e-6, 0.000253912 to 5e-10.
        let floating = column("1.20479\n0.000253912\n");
        assert!((floating.tolerance(1.20479) - 5e-6).abs() < 1e-10);
        assert!((floating.tolerance(0.000_253_912) - 5e-10).abs() < 1e-14);
    }

    #[test]
    fn steps_of_one_two_five() {
        assert_eq!(one_two_five(0.999_999_9, 1e-6), Some(1.0));
        assert_eq!(one_two_five(0.02, 1e-6), Some(0.02));
        assert_eq!(one_two_five(0.03, 1e-6), None);
    }
}
