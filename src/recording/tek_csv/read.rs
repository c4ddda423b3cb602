//! Reads a native CSV file into a capture: header first, then the digitiser level behind every
//! printed value. Nothing is repaired: what disagrees is an error with its line and column.
//! Equations and sources: the module above.

use super::abscissa::Abscissa;
use super::cells::CsvRows;
use super::columns::TableColumns;
use super::detection;
use super::dialect::Dialect;
use super::header::{CsvHeader, HeaderRow};
use super::layout::{Domain, Numbers, PRINTING_ERROR};
use super::text::{DecodedText, decode};
use super::{header_columns, table};
use crate::recording::Capture;
use crate::recording::error::{RecordingError, excerpt, place};
use crate::scope::waveform::{HIGHEST_CODE, LEVELS_PER_DIVISION, LOWEST_CODE};
use crate::scope::{Preamble, VerticalSetup, Waveform};

/// Larger files are refused unread; the family's own have less than 100 000 bytes, two million rows
/// of two channels less than this.
pub const MAXIMUM_BYTES: usize = 64 << 20;

/// Field of the time or frequency in a row.
const ABSCISSA: usize = 3;
/// Field of the voltage or level in a row.
const ORDINATE: usize = 4;

/// Reads the `bytes` of a native CSV file; `file_name` is for messages.
///
/// # Errors
/// [`RecordingError`] when the file is too large, empty, no text, of another dialect, or when any
/// field of it disagrees with the format or with the file's own header.
pub fn read(bytes: &[u8], file_name: &str) -> Result<Capture, RecordingError> {
    let text = checked_text(bytes, file_name)?;
    if let Some(dialect) = detection::foreign(&CsvRows::new(file_name, text)?) {
        let first = excerpt(text.lines().next().unwrap_or_default());
        let problem = format!("found {first}, which looks like {dialect}");
        return Err(RecordingError::new(
            format_args!("{file_name}, line 1"),
            format_args!("{problem}; expected the native CSV of a TDS1000/2000"),
        ));
    }
    native(text, file_name)
}

/// Reads the `bytes` of a CSV file of any [`Dialect`] or of none; one capture for each channel in
/// it. What had to be guessed stands in their notes.
///
/// # Errors
/// As [`read`]; for other dialects also [`RecordingError`] if a cell holds no number, if the times
/// are not evenly spaced, or if the roles of the columns are unclear.
pub fn read_all(bytes: &[u8], file_name: &str) -> Result<Vec<Capture>, RecordingError> {
    read_columns(bytes, file_name, &TableColumns::default())
}

/// The same for a table whose columns the user names; [`TableColumns::default`] leaves them to the
/// file.
///
/// # Errors
/// As [`read_all`].
pub fn read_columns(
    bytes: &[u8],
    file_name: &str,
    columns: &TableColumns,
) -> Result<Vec<Capture>, RecordingError> {
    check_size(bytes, file_name)?;
    let DecodedText { text, notes } = decode(bytes, file_name)?;
    let table = CsvRows::new(file_name, &text)?;
    let beside = detection::rows_above(&table).is_some_and(|above| table.row(above).len() >= 5);
    let mut captures = match detection::foreign(&table) {
        _ if !columns.is_empty() || !beside => table::read(&table, columns)?,
        None => vec![native(&text, file_name)?],
        Some(Dialect::OpenChoice) => header_columns::read_openchoice(&table)?,
        Some(_) => header_columns::read_spreadsheet(&table)?,
    };
    for capture in &mut captures {
        capture.notes.extend(notes.iter().cloned());
    }
    Ok(captures)
}

fn native(text: &str, file_name: &str) -> Result<Capture, RecordingError> {
    let longest = usize::from(Domain::Time.record_length());
    let lines: Vec<&str> = text
        .split_terminator('\n')
        .take(longest)
        .map(|line| line.strip_suffix('\r').unwrap_or(line))
        .collect();
    let header = CsvHeader::read(file_name, &lines)?;
    let samples = Samples::new(file_name, &header);
    let record = lines.iter().take(usize::from(header.domain.record_length()));
    let codes = (0_u32..)
        .zip(record)
        .map(|(index, line)| samples.code(index, line))
        .collect::<Result<Vec<i16>, RecordingError>>()?;
    check_end(text, file_name, header.domain)?;
    Ok(capture(header, codes))
}

fn checked_text<'a>(bytes: &'a [u8], file_name: &str) -> Result<&'a str, RecordingError> {
    check_size(bytes, file_name)?;
    std::str::from_utf8(bytes).map_err(|error| {
        let (good, bad) = bytes.split_at(error.valid_up_to());
        let before = String::from_utf8_lossy(good);
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        let found = format!("byte 0x{:02X}", bad.first().copied().unwrap_or_default());
        RecordingError::found(place(file_name, line, column), found, "UTF-8 text")
    })
}

fn check_size(bytes: &[u8], file_name: &str) -> Result<(), RecordingError> {
    if bytes.is_empty() {
        return Err(RecordingError::found(file_name, "no bytes", "a Tektronix CSV file"));
    }
    if bytes.len() > MAXIMUM_BYTES {
        let (found, limit) = (bytes.len() as u64, MAXIMUM_BYTES as u64);
        return Err(RecordingError::too_large(file_name, found, limit));
    }
    Ok(())
}

/// Refuses a file with too few or too many rows, or with its last row cut.
fn check_end(text: &str, file_name: &str, domain: Domain) -> Result<(), RecordingError> {
    let expected = usize::from(domain.record_length());
    let found = text.split_terminator('\n').count();
    if found != expected {
        let expected = format!("{expected} by its Record Length");
        return Err(RecordingError::found(file_name, format!("{found} rows"), expected));
    }
    if !text.ends_with('\n') {
        let last = text.lines().last().unwrap_or_default();
        let place = place(file_name, found, last.chars().count() + 1);
        return Err(RecordingError::found(place, "the end of the file", "a line end"));
    }
    Ok(())
}

/// Conversion of a row's number to its level.
struct Samples<'a> {
    file: &'a str,
    abscissa: Abscissa,
    /// Volts or decibels of a level.
    level: f64,
    /// Level of zero volts.
    zero_level: f64,
    /// Value of that level.
    y_zero: f64,
    /// Rows with a key and a value.
    header_rows: u32,
}

impl<'a> Samples<'a> {
    fn new(file: &'a str, header: &CsvHeader) -> Self {
        let numbers = &header.numbers;
        Self {
            file,
            abscissa: Abscissa {
                domain: header.domain,
                layout: header.layout,
                interval: numbers.interval,
                trigger_point: numbers.trigger_point,
            },
            level: numbers.level(),
            zero_level: zero_level(numbers),
            y_zero: numbers.y_zero,
            header_rows: header.layout.rows(),
        }
    }

    /// The digitiser level of row `index`, counted from 0.
    fn code(&self, index: u32, line: &str) -> Result<i16, RecordingError> {
        let number = usize::try_from(index).unwrap_or(usize::MAX).saturating_add(1);
        let row = HeaderRow::split(self.file, number, line)?;
        if index >= self.header_rows {
            row.expect_empty(0)?;
            row.expect_empty(1)?;
        }
        row.expect_empty(2)?;
        self.check_abscissa(index, &row)?;
        let code = self.level_of(&row)?;
        row.expect_empty(5)?;
        Ok(code)
    }

    fn check_abscissa(&self, index: u32, row: &HeaderRow) -> Result<(), RecordingError> {
        let found = number(row, ABSCISSA)?;
        let expected = self.abscissa.value(index);
        // A difference that is not a number is refused too.
        if (found - expected).abs() <= self.abscissa.tolerance(expected) {
            return Ok(());
        }
        let (text, unit) = (self.abscissa.text(index), self.abscissa.domain.x_unit());
        let expected = format!("{} {unit} by sample interval and trigger point", text.trim());
        Err(RecordingError::found(row.place(ABSCISSA), field(row, ABSCISSA), expected))
    }

    fn level_of(&self, row: &HeaderRow) -> Result<i16, RecordingError> {
        let domain = self.abscissa.domain;
        let found = number(row, ORDINATE)?;
        let steps = (found - self.y_zero) / self.level + self.zero_level;
        let nearest = steps.round().clamp(f64::from(LOWEST_CODE), f64::from(HIGHEST_CODE));
        let value = (nearest - self.zero_level) * self.level + self.y_zero;
        if (found - value).abs() <= domain.ordinate_tolerance(value) {
            return Ok(nearest as i16);
        }
        let expected = format!("a digitiser level, the nearest is {value:.5} {}", domain.y_unit());
        Err(RecordingError::found(row.place(ORDINATE), field(row, ORDINATE), expected))
    }
}

fn field(row: &HeaderRow, index: usize) -> String {
    row.fields.get(index).map(|text| excerpt(text)).unwrap_or_default()
}

/// A decimal number, padded with spaces or not.
fn number(row: &HeaderRow, index: usize) -> Result<f64, RecordingError> {
    let text = row.fields.get(index).map(|text| text.trim_matches(' ')).unwrap_or_default();
    text.parse()
        .ok()
        .filter(|value: &f64| value.is_finite())
        .ok_or_else(|| RecordingError::found(row.place(index), field(row, index), "a number"))
}

/// The level of zero volts: a whole number where the printed offset allows one, since the family
/// moves a trace in steps of one level.
fn zero_level(numbers: &Numbers) -> f64 {
    let levels = numbers.offset / numbers.level();
    let whole = levels.round();
    if (whole - levels).abs() <= PRINTING_ERROR * levels.abs() { whole } else { levels }
}

fn capture(header: CsvHeader, codes: Vec<i16>) -> Capture {
    let numbers = header.numbers;
    let y_off = zero_level(&numbers);
    Capture {
        waveform: Waveform {
            source: header.source,
            codes,
            preamble: Preamble {
                x_zero: (0.0 - numbers.trigger_point) * numbers.interval,
                x_incr: numbers.interval,
                pt_off: 0,
                x_unit: header.domain.x_unit().to_owned(),
                y_mult: numbers.level(),
                y_zero: numbers.y_zero,
                y_off,
                y_unit: header.domain.y_unit().to_owned(),
                pt_fmt: header.point_format,
            },
            vertical: VerticalSetup {
                scale: numbers.scale,
                position: y_off / LEVELS_PER_DIVISION,
                coupling: None,
                bandwidth_limited: None,
                inverted: None,
                probe: numbers.probe,
            },
            horizontal_scale: numbers.horizontal_scale,
            trigger_point: numbers.trigger_point,
        },
        instrument: Some(header.instrument),
        notes: header.spelling.into_iter().collect(),
    }
}
