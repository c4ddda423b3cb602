//! Reads the header rows of a native CSV file: every key in its place, every number as the
//! instrument prints it. Comes before the samples in `read`; keys and rules are in `layout`.

use super::abscissa;
use super::cells::RowFields;
use super::layout::{self, Domain, HeaderLayout, Numbers};
use crate::quantity::c_exponential;
use crate::recording::InstrumentIdentity;
use crate::recording::error::{FileLocation, RecordingError, excerpt, place};
use crate::scope::{PointFormat, Source};

/// Fields in every row.
const FIELDS: usize = 6;

/// One row of a file, split at its commas.
#[derive(Debug, Clone, Copy)]
pub(super) struct HeaderRow<'a> {
    file: &'a str,
    line: usize,
    /// Key, value, nothing, abscissa, ordinate, nothing.
    pub(super) fields: [&'a str; FIELDS],
}

impl<'a> HeaderRow<'a> {
    /// Splits line number `line`, counted from 1.
    pub(super) fn split(file: &'a str, line: usize, text: &'a str) -> Result<Self, RecordingError> {
        let mut fields = [""; FIELDS];
        let mut found = 0;
        for (field, _) in RowFields::of(text, ',', false) {
            if let Some(slot) = fields.get_mut(found) {
                *slot = field;
            }
            found += 1;
        }
        if found == FIELDS {
            Ok(Self { file, line, fields })
        } else {
            let column = text.chars().count() + 1;
            let expected = format!("{FIELDS}, the last one empty");
            Err(RecordingError::found(
                place(file, line, column),
                format!("{found} fields"),
                expected,
            ))
        }
    }

    /// Where field `index`, counted from 0, begins.
    pub(super) fn place(&self, index: usize) -> FileLocation {
        let before = self.fields.iter().take(index);
        let column = 1 + before.map(|field| field.chars().count() + 1).sum::<usize>();
        place(self.file, self.line, column)
    }

    /// Refuses the row if field `index` has something in it.
    pub(super) fn expect_empty(&self, index: usize) -> Result<(), RecordingError> {
        match self.fields.get(index) {
            None | Some(&"") => Ok(()),
            Some(field) => {
                Err(RecordingError::found(self.place(index), excerpt(field), "an empty field"))
            }
        }
    }

    fn key(&self) -> &'a str {
        let [key, ..] = self.fields;
        key
    }

    fn value(&self) -> &'a str {
        let [_, value, ..] = self.fields;
        value
    }
}

/// The values of a header.
#[derive(Debug, Clone)]
pub(super) struct CsvHeader {
    pub(super) layout: HeaderLayout,
    pub(super) domain: Domain,
    pub(super) numbers: Numbers,
    pub(super) source: Source,
    /// The note that keeps another spelling of the source.
    pub(super) spelling: Option<String>,
    pub(super) point_format: PointFormat,
    pub(super) instrument: InstrumentIdentity,
}

impl CsvHeader {
    /// Reads the header from a file's lines, of which there may be too few.
    pub(super) fn read(file: &str, lines: &[&str]) -> Result<Self, RecordingError> {
        let layout = match lines.get(HeaderLayout::Old.keys().len() - 1) {
            Some(line) if line.starts_with(layout::FIRMWARE) => HeaderLayout::Old,
            _ => HeaderLayout::Named,
        };
        let rows = Rows::read(file, lines, layout)?;
        let x_unit = rows.text(layout::HORIZONTAL_UNITS)?;
        let y_unit = rows.text(layout::VERTICAL_UNITS)?;
        let domain = Domain::from_units(y_unit, x_unit).ok_or_else(|| {
            let expected = format!("`V` over `s` or `dB` over `Hz`, not over {}", excerpt(x_unit));
            rows.wrong(layout::VERTICAL_UNITS, expected)
        })?;
        rows.record_length(domain)?;
        let numbers = rows.numbers(domain)?;
        if let Some(violation) = numbers.violation(domain) {
            return Err(rows.wrong(violation.key, violation.expected));
        }
        let (source, spelling) = rows.source()?;
        Ok(Self {
            layout,
            domain,
            numbers,
            source,
            spelling,
            point_format: rows.point_format()?,
            instrument: rows.instrument(layout)?,
        })
    }
}

/// The rows of a header, keys checked.
struct Rows<'a> {
    file: &'a str,
    rows: Vec<HeaderRow<'a>>,
}

impl<'a> Rows<'a> {
    fn read(
        file: &'a str,
        lines: &[&'a str],
        layout: HeaderLayout,
    ) -> Result<Self, RecordingError> {
        let mut rows = Vec::with_capacity(layout.keys().len());
        for (index, key) in layout.keys().iter().enumerate() {
            let number = index + 1;
            let Some(line) = lines.get(index) else {
                return Err(wrong_key(file, number, "the end of the file".to_owned(), key));
            };
            if line.split(',').next() != Some(key) {
                let found = line.split(',').next().map(excerpt).unwrap_or_default();
                return Err(wrong_key(file, number, found, key));
            }
            let row = HeaderRow::split(file, number, line)?;
            if key.is_empty() {
                row.expect_empty(1)?;
            }
            rows.push(row);
        }
        Ok(Self { file, rows })
    }

    fn row(&self, key: &'static str) -> Result<&HeaderRow<'a>, RecordingError> {
        let missing = || wrong_key(self.file, self.rows.len(), "no such row".to_owned(), key);
        self.rows.iter().find(|row| row.key() == key).ok_or_else(missing)
    }

    fn text(&self, key: &'static str) -> Result<&'a str, RecordingError> {
        self.row(key).map(HeaderRow::value)
    }

    /// The error that `key`'s value is not what was `expected`.
    fn wrong(&self, key: &'static str, expected: String) -> RecordingError {
        match self.row(key) {
            Ok(row) => RecordingError::value(row.place(1), key, excerpt(row.value()), expected),
            Err(error) => error,
        }
    }

    /// A number exactly as C prints it with `%.{decimals}e`.
    fn number(&self, key: &'static str, decimals: usize) -> Result<f64, RecordingError> {
        let text = self.text(key)?;
        text.parse()
            .ok()
            .filter(|value: &f64| value.is_finite() && c_exponential(*value, decimals) == text)
            .ok_or_else(|| {
                self.wrong(key, format!("a number with {decimals} decimals and exponent"))
            })
    }

    fn record_length(&self, domain: Domain) -> Result<(), RecordingError> {
        let expected = c_exponential(f64::from(domain.record_length()), layout::DECIMALS);
        if self.text(layout::RECORD_LENGTH)? == expected {
            Ok(())
        } else {
            let unit = domain.y_unit();
            Err(self.wrong(layout::RECORD_LENGTH, format!("`{expected}` for a record in {unit}")))
        }
    }

    fn numbers(&self, domain: Domain) -> Result<Numbers, RecordingError> {
        let number = |key| self.number(key, layout::DECIMALS);
        let printed = number(layout::SAMPLE_INTERVAL)?;
        let text = self.text(layout::SAMPLE_INTERVAL)?;
        Ok(Numbers {
            interval: abscissa::exact_interval(domain, printed, text),
            trigger_point: self.number(layout::TRIGGER_POINT, layout::TRIGGER_POINT_DECIMALS)?,
            scale: number(layout::VERTICAL_SCALE)?,
            offset: number(layout::VERTICAL_OFFSET)?,
            horizontal_scale: number(layout::HORIZONTAL_SCALE)?,
            y_zero: number(layout::Y_ZERO)?,
            probe: number(layout::PROBE)?,
        })
    }

    /// The source, and a note of its spelling where that is not the usual one.
    fn source(&self) -> Result<(Source, Option<String>), RecordingError> {
        let text = self.text(layout::SOURCE)?;
        let source = layout::source_of(text).ok_or_else(|| {
            self.wrong(layout::SOURCE, "CH1 to CH4, MATH or REFA to REFD".to_owned())
        })?;
        Ok((source, layout::spelling_note(source, text)))
    }

    fn point_format(&self) -> Result<PointFormat, RecordingError> {
        let text = self.text(layout::POINT_FORMAT)?;
        [PointFormat::Sample, PointFormat::Envelope]
            .into_iter()
            .find(|format| format.to_string() == text)
            .ok_or_else(|| self.wrong(layout::POINT_FORMAT, "Y or ENV".to_owned()))
    }

    fn instrument(&self, layout: HeaderLayout) -> Result<InstrumentIdentity, RecordingError> {
        let (model, serial) = match layout {
            HeaderLayout::Named => (self.name(layout::MODEL)?, self.printable(layout::SERIAL)?),
            HeaderLayout::Old => (String::new(), String::new()),
        };
        Ok(InstrumentIdentity { model, serial, firmware: self.printable(layout::FIRMWARE)? })
    }

    /// A text that is not empty.
    fn name(&self, key: &'static str) -> Result<String, RecordingError> {
        let text = self.printable(key)?;
        if text.is_empty() {
            return Err(self.wrong(key, "a name".to_owned()));
        }
        Ok(text)
    }

    /// A text without control characters.
    fn printable(&self, key: &'static str) -> Result<String, RecordingError> {
        let text = self.text(key)?;
        if text.chars().any(char::is_control) {
            return Err(self.wrong(key, "text without control characters".to_owned()));
        }
        Ok(text.to_owned())
    }
}

fn wrong_key(file: &str, line: usize, found: String, key: &str) -> RecordingError {
    let expected = if key.is_empty() { "an empty field".to_owned() } else { format!("`{key}`") };
    RecordingError::found(place(file, line, 1), found, expected)
}
