//! Tables of known texts: read, and written as a table, they give the digits that were read.

use std::fmt::Write as _;

use hertzscope::recording::tek_csv::read_all;

use super::{printed, temporary};
use crate::tek_csv::Draws;

/// How many tables.
const TABLES: u64 = 50;
/// Columns of each.
const COLUMNS: usize = 8;
/// Rows of each.
const ROWS: usize = 60;
/// Digits that a double always returns (IEEE 754).
const SAFE_DIGITS: usize = 15;

/// A number without sign of zero, leading and trailing zeros, and decimal point: digits and the
/// power of ten of the last one.
fn normal(text: &str) -> (bool, String, i32) {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (is_negative, mantissa) =
        mantissa.strip_prefix('-').map_or((false, mantissa), |rest| (true, rest));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}");
    let kept = digits.trim_end_matches('0');
    let power = exponent.parse::<i32>().expect("an exponent") - fraction.len() as i32
        + (digits.len() - kept.len()) as i32;
    match kept.trim_start_matches('0') {
        "" => (false, "0".to_owned(), 0),
        kept => (is_negative, kept.to_owned(), power),
    }
}

/// A number of up to `digits` digits, with `decimals` of them behind the point, as fixed text or
/// with an exponent.
fn text(draws: &mut Draws, digits: usize, decimals: usize, has_exponent: bool) -> String {
    let sign = if draws.chance(40) { "-" } else { "" };
    if digits > SAFE_DIGITS {
        // What a program prints of a double, with all digits.
        let value = (draws.below(1 << 30) as f64 / 7.0 - 1e7) * 10f64.powi(-(decimals as i32));
        return format!("{value:.*e}", digits - 1);
    }
    let number = draws.below(10usize.pow(digits as u32));
    if has_exponent {
        let text = format!("{number:0digits$}");
        let (first, rest) = text.split_at(1);
        let point = if rest.is_empty() { "" } else { "." };
        return format!("{sign}{first}{point}{rest}e-{decimals:02}");
    }
    let text = format!("{number:0width$}", width = decimals + 1);
    let (whole, fraction) = text.split_at(text.len() - decimals);
    let point = if fraction.is_empty() { "" } else { "." };
    format!("{sign}{whole}{point}{fraction}")
}

/// The digits are those of the text, the power of ten that of the unit's prefix; beyond 15 digits
/// the double is the same, or with a prefix its neighbour.
#[test]
fn values_have_the_digits_of_their_texts() {
    let folder = temporary();
    let path = folder.path();
    for seed in 0..TABLES {
        let draws = &mut Draws(seed);
        let columns: Vec<(usize, i32, &str, Vec<String>)> = (0..COLUMNS)
            .map(|column| {
                let digits = 1 + (seed as usize * COLUMNS + column) % 17;
                let (decimals, has_exponent) = (draws.below(10), draws.chance(40));
                let (prefix, power) =
                    *draws.of(&[("", 0), ("", 0), ("m", -3), ("u", -6), ("k", 3)]);
                let texts = (0..ROWS).map(|_| text(draws, digits, decimals, has_exponent));
                (digits, power, prefix, texts.collect())
            })
            .collect();
        let mut table = "Time (us)".to_owned();
        for (.., prefix, _) in &columns {
            let _ = write!(table, ",signal ({prefix}N)");
        }
        for row in 0..ROWS {
            let _ = write!(table, "\n{row}.5");
            for (.., texts) in &columns {
                let _ = write!(table, ",{}", texts[row]);
            }
        }
        std::fs::write(path.join("in.csv"), table).expect("a file");
        // By way of a recording, too.
        printed(path, &["convert", "-q", "--force", "in.csv", "in.mcap"]);
        for input in ["in.csv", "in.mcap"] {
            printed(path, &["convert", "-q", "--force", input, "out.csv"]);
            let out = std::fs::read_to_string(path.join("out.csv")).expect("a table");
            assert_eq!(out.lines().count(), ROWS + 1);
            for (row, line) in out.lines().skip(1).enumerate() {
                let cells: Vec<&str> = line.split(',').collect();
                assert_eq!(normal(cells[0]), normal(&format!("{row}.5e-6")), "table {seed}");
                for ((digits, power, prefix, texts), found) in columns.iter().zip(&cells[1..]) {
                    check(
                        &texts[row],
                        (*digits, *power),
                        found,
                        &format!("table {seed}, {prefix}N"),
                    );
                }
            }
        }
    }
}

/// Checks that a cell has the number of `text` in a unit of this power of ten.
fn check(text: &str, (digits, power): (usize, i32), found: &str, what: &str) {
    let (is_negative, kept, last) = normal(text);
    if digits <= SAFE_DIGITS {
        let wanted = if kept == "0" { normal("0") } else { (is_negative, kept, last + power) };
        assert_eq!(normal(found), wanted, "{what}: {text} as {found}");
        return;
    }
    let sign = if is_negative { "-" } else { "" };
    let same = format!("{sign}{kept}e{}", last + power).parse::<f64>();
    let (found, same) = (found.parse::<f64>().expect("a number"), same.expect("a number"));
    // Of a prefix, the last of 17 digits may be another one.
    let allowed = if power == 0 { 0.0 } else { f64::EPSILON * same.abs() };
    assert!((found - same).abs() <= allowed, "{what}: {text} as {found}");
}

#[test]
fn numbers_below_the_normal_range_of_a_double_are_read() {
    let found =
        read_all(b"Time (us),V\n0,0\n1,5e-324\n2,1\n3,-2.5e-310\n", "table.csv").expect("a table");
    let values: Vec<f64> = found[0].waveform.values().collect();
    assert_eq!(values, [0.0, 5e-324, 1.0, -2.5e-310]);
}
