//! Tells apart the CSV dialects that go by the name of Tektronix, before a reader starts. Source:
//! the project's fact sheet on the TDS2000 family, section 4.3.

use super::dialect::Dialect;

use super::cells::{Cells, CsvRows};
use super::layout::RECORD_LENGTH;

/// Rows above the header that are searched for it.
const ROWS_ABOVE: usize = 3;

/// The dialect of a table that is certainly not native.
pub(super) fn foreign(table: &CsvRows<'_>) -> Option<Dialect> {
    let first = table.row(0);
    if first.text(0) == "Model" {
        return Some(Dialect::NewerModel);
    }
    if let Some(above) = rows_above(table) {
        let head = table.row(above);
        if head.text(2).contains(|c: char| c.is_ascii_alphabetic()) {
            return Some(Dialect::OpenChoice);
        }
        return match (changed(table, &head), above) {
            (true, _) => Some(Dialect::Spreadsheet),
            (false, 0) => None,
            (false, _) => Some(Dialect::HandHeader),
        };
    }
    if first.is_samples() {
        return Some(Dialect::Headerless);
    }
    table.row(1).is_samples().then_some(Dialect::HandHeader)
}

/// How many rows stand above the one that begins with `Record Length`.
pub(super) fn rows_above(table: &CsvRows<'_>) -> Option<usize> {
    (0..=ROWS_ABOVE).find(|index| table.row(*index).text(0) == RECORD_LENGTH)
}

/// Whether the first row of a native file lost its last comma or its digits, or has other
/// separators.
fn changed(table: &CsvRows<'_>, head: &Cells<'_>) -> bool {
    let digits = head.text(1);
    let shortened = head.maybe_number(1).is_some_and(|n| n.decimals != native_decimals(digits));
    table.separator != ',' || table.decimal_comma || head.len() == 5 || shortened
}

/// Decimals of a number that has six before its exponent; of others, none that a number has.
fn native_decimals(text: &str) -> i32 {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, ""));
    let six = mantissa.split_once('.').is_some_and(|(_, fraction)| fraction.len() == 6);
    exponent.parse::<i32>().ok().filter(|_| six).map_or(i32::MIN, |power| 6 - power)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dialect(text: &str) -> Option<Dialect> {
        foreign(&CsvRows::new("F.CSV", text).expect("a short table"))
    }

    #[test]
    fn first_lines_tell_the_dialect() {
        for (text, wanted) in [
            (
                "Record Length,2500,Points,-880.000006873E-6,0.0,,Record Length,2500,Points,-8E-6,0.0,\r\n",
                Dialect::OpenChoice,
            ),
            ("Record Length;2500;Points;-8,8E-4;0;;\r\n", Dialect::OpenChoice),
            ("Model,TBS1102C\nFirmware Version,v1.29.38\n", Dialect::NewerModel),
            ("Model;TBS1102C\nFirmware Version;v1.29.38\n", Dialect::NewerModel),
            (",,,x,y\nRecord Length,2.50E+03,,-0.0021,-0.0092\n", Dialect::Spreadsheet),
            ("Record Length,2.50E+03,,-0.0304,0\n", Dialect::Spreadsheet),
            ("Record Length,2.50E+03,,-0.0304,0,\n", Dialect::Spreadsheet),
            ("\u{feff}Record Length,2500,,-0.0304,0\n", Dialect::Spreadsheet),
            ("Record Length;2,50E+03;;-0,0304;0\n", Dialect::Spreadsheet),
            (
                "a,b,c,x,y,d\r\nRecord Length,2.500000e+03,,  -0.000001390000,  -1.00000,\r\n",
                Dialect::HandHeader,
            ),
            ("x,y\n-0.1,0.2\n", Dialect::HandHeader),
            ("-0.0004972,-1.2\r\n-0.0004968,-0.76\r\n", Dialect::Headerless),
            ("-0,0004972;-1,2\r\n-0,0004968;-0,76\r\n", Dialect::Headerless),
            (",,,-00.078200000000,   0.00712,\n", Dialect::Headerless),
        ] {
            assert_eq!(dialect(text), Some(wanted), "{text}");
        }
    }

    #[test]
    fn native_lines_are_left_to_the_reader() {
        for text in [
            "Record Length,2.500000e+03,,  -0.080000000000,   0.00664,\nSample Interval,1.000000e-04,,  -0.079900000000,   0.00720,\n",
            "Rekord Length,2.500000e+03,,  -0.080000000000,   0.00664,\nSample Interval,1.000000e-04,,  -0.079900000000,   0.00720,\n",
            "",
            "\n",
        ] {
            assert_eq!(dialect(text), None, "{text}");
        }
    }
}
