//! Tells apart the CSV dialects that go by the name of Tektronix, before the reader starts. Source: the
//! project's fact sheet on the TDS2000 family, section 4.3.

use std::fmt;

/// A CSV dialect that is recognised and not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Dialect {
    /// Saved by the `OpenChoice` desktop program: unit words in the third column.
    OpenChoice,
    /// Saved by a newer model such as the TBS1000C: the header stands above the samples.
    NewerModel,
    /// A native file re-saved by a spreadsheet: shortened numbers, no comma at the end of a row.
    Spreadsheet,
    /// Column names, such as `x,y`, put above the samples by hand.
    HandHeader,
    /// Only samples; the header was cut away.
    Headerless,
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OpenChoice => "a file of OpenChoice Desktop",
            Self::NewerModel => "a file of a newer model (TBS1000C)",
            Self::Spreadsheet => "a file re-saved by a spreadsheet",
            Self::HandHeader => "a file with column names put in by hand",
            Self::Headerless => "a file without its header",
        })
    }
}

/// The dialect of a text that is certainly not native, and the number of the line that tells.
pub(super) fn foreign(text: &str) -> Option<(Dialect, usize)> {
    let mut lines = text.lines();
    let first = lines.next().unwrap_or_default();
    let second = lines.next().unwrap_or_default();
    if first.starts_with("Model,") {
        return Some((Dialect::NewerModel, 1));
    }
    if is_record_length(first) {
        let commas = first.starts_with("Record Length,");
        let unit = first.split(',').nth(2).unwrap_or_default();
        if unit.contains(|c: char| c.is_ascii_alphabetic()) && commas {
            return Some((Dialect::OpenChoice, 1));
        }
        return lacks_last_comma(first).then_some((Dialect::Spreadsheet, 1));
    }
    if is_record_length(second) {
        let dialect =
            if lacks_last_comma(second) { Dialect::Spreadsheet } else { Dialect::HandHeader };
        return Some((dialect, 1));
    }
    if is_samples(first) {
        return Some((Dialect::Headerless, 1));
    }
    is_samples(second).then_some((Dialect::HandHeader, 1))
}

fn is_record_length(line: &str) -> bool {
    line.strip_prefix("Record Length").is_some_and(|rest| rest.starts_with([',', ';', '\t']))
}

/// Whether a first row of a native file lost its last comma, or has other separators.
fn lacks_last_comma(line: &str) -> bool {
    !line.starts_with("Record Length,") || line.split(',').count() == 5
}

/// Whether a line holds nothing but two or more numbers.
fn is_samples(line: &str) -> bool {
    let mut filled = line.split(',').map(str::trim).filter(|field| !field.is_empty());
    let numbers = filled.clone().filter(|field| field.parse::<f64>().is_ok()).count();
    numbers >= 2 && filled.all(|field| field.parse::<f64>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_lines_tell_the_dialect() {
        for (text, dialect) in [
            (
                "Record Length,2500,Points,-880.000006873E-6,0.0,,Record Length,2500,Points,-8E-6,0.0,\r\n",
                Dialect::OpenChoice,
            ),
            ("Model,TBS1102C\nFirmware Version,v1.29.38\n", Dialect::NewerModel),
            (",,,x,y\nRecord Length,2.50E+03,,-0.0021,-0.0092\n", Dialect::Spreadsheet),
            ("Record Length,2.50E+03,,-0.0304,0\n", Dialect::Spreadsheet),
            ("Record Length;2,50E+03;;-0,0304;0\n", Dialect::Spreadsheet),
            (
                "a,b,c,x,y,d\r\nRecord Length,2.500000e+03,,  -0.000001390000,  -1.00000,\r\n",
                Dialect::HandHeader,
            ),
            ("x,y\n-0.1,0.2\n", Dialect::HandHeader),
            ("-0.0004972,-1.2\r\n-0.0004968,-0.76\r\n", Dialect::Headerless),
            (",,,-00.078200000000,   0.00712,\n", Dialect::Headerless),
        ] {
            assert_eq!(foreign(text), Some((dialect, 1)), "{text}");
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
            assert_eq!(foreign(text), None, "{text}");
        }
    }
}
