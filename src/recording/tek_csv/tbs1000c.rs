//! Reads a file of a newer model (TBS1000C and its kin, 2000 points and more): a header of its own, then
//! `TIME,CH1[,CH2...]` and the samples. A key's row has one value, or one for each channel.
//!
//! Volts are printed to six digits of a converter with more than 8 bits, or in levels of one with 8: `levels`
//! finds out which. `Vertical Offset` moves the screen, not the values: they are volts at the probe as they stand.

use super::cells::CsvRows;
use super::column::SampleColumn;
use super::error::place;
use super::error::{TekCsvError, excerpt};
use super::header_columns::unit;
use super::layout;
use super::times::StatedTimeBase;
use super::unscaled_import::UnscaledImport;
use crate::recording::{Capture, InstrumentIdentity};
use crate::scope::{PointFormat, Source};

/// Rows that are searched for the names of the columns.
const HEADER_ROWS: usize = 40;
const NAMES: &str = "TIME";

pub(super) fn read(table: &CsvRows<'_>) -> Result<Vec<Capture>, TekCsvError> {
    let header = Header::find(table)?;
    let names = table.row(header.names);
    let count = names.texts().skip(1).take_while(|name| !name.is_empty()).count();
    if count == 0 {
        return Err(names_missing(table, header.names));
    }
    let times = header.column(0)?;
    (1..)
        .zip(1..=count)
        .map(|(channel, cell)| header.import(&times, cell)?.capture(table.file, channel))
        .collect()
}

struct Header<'a, 't> {
    table: &'t CsvRows<'a>,
    /// Row of the columns' names.
    names: usize,
}

impl<'a, 't> Header<'a, 't> {
    fn find(table: &'t CsvRows<'a>) -> Result<Self, TekCsvError> {
        let mut rows = 0..table.len().min(HEADER_ROWS);
        rows.find(|index| table.row(*index).text(0) == NAMES)
            .map(|names| Self { table, names })
            .ok_or_else(|| names_missing(table, table.len().min(HEADER_ROWS)))
    }

    fn column(&self, cell: usize) -> Result<SampleColumn, TekCsvError> {
        let mut column = SampleColumn::default();
        for index in self.names + 1..self.table.len() {
            let row = self.table.row(index);
            if !row.is_blank() {
                column.push(&row, cell)?;
            }
        }
        Ok(column)
    }

    /// The row of `key` and the cell of its value for channel `cell`.
    fn cell(&self, key: &str, cell: usize) -> Option<(usize, usize)> {
        let index = (0..self.names).find(|index| self.table.row(*index).text(0) == key)?;
        let row = self.table.row(index);
        [cell, 1].into_iter().find(|cell| !row.text(*cell).is_empty()).map(|cell| (index, cell))
    }

    fn text(&self, key: &str, cell: usize) -> Option<&'a str> {
        self.cell(key, cell).map(|(index, cell)| self.table.row(index).text(cell))
    }

    fn number(&self, key: &str, cell: usize) -> Result<Option<f64>, TekCsvError> {
        let Some((index, cell)) = self.cell(key, cell) else { return Ok(None) };
        let row = self.table.row(index);
        match row.maybe_number(cell) {
            Some(printed) => Ok(Some(printed.value)),
            None => Err(TekCsvError::Entry {
                place: row.place(cell),
                key: key.to_owned(),
                found: excerpt(row.text(cell)),
                expected: "a number".to_owned(),
            }),
        }
    }

    fn import(&self, times: &SampleColumn, cell: usize) -> Result<UnscaledImport, TekCsvError> {
        let names = self.table.row(self.names);
        let source = Source::from_name(names.text(cell)).ok_or_else(|| TekCsvError::Field {
            place: names.place(cell),
            found: excerpt(names.text(cell)),
            expected: "CH1 to CH4, MATH or REFA to REFD",
        })?;
        let text = |key: &str| self.text(key, 1).unwrap_or_default().to_owned();
        let interval = self.number(layout::SAMPLE_INTERVAL, cell)?;
        let first = times.values.first().copied().unwrap_or_default();
        let mut draft = UnscaledImport {
            times: times.clone(),
            values: self.column(cell)?,
            // The header has no trigger point; time 0 is the trigger by definition, so this is no guess.
            stated: StatedTimeBase {
                interval,
                trigger_point: interval.map(|dt| (-first / dt).round()),
            },
            source: Some(source),
            scale: self.number(layout::VERTICAL_SCALE, cell)?,
            horizontal_scale: self.number(layout::HORIZONTAL_SCALE, cell)?,
            probe: self.number("Probe Attenuation", cell)?,
            x_unit: self.text(layout::HORIZONTAL_UNITS, cell).map(unit),
            y_unit: self.text(layout::VERTICAL_UNITS, cell).map(unit),
            point_format: match self.text("Point Format", cell) {
                Some("ENV") => Some(PointFormat::Envelope),
                _ => Some(PointFormat::Sample),
            },
            instrument: Some(InstrumentIdentity {
                model: text("Model"),
                serial: String::new(),
                firmware: text(layout::FIRMWARE),
            }),
            ..UnscaledImport::default()
        };
        self.notes(&mut draft, cell)?;
        Ok(draft)
    }

    fn notes(&self, draft: &mut UnscaledImport, cell: usize) -> Result<(), TekCsvError> {
        let offset = self.number(layout::VERTICAL_OFFSET, cell)?.unwrap_or_default();
        if offset.abs() > 0.0 {
            draft.notes.push(format!(
                "Vertical Offset {offset} V moves the screen and is not in the values"
            ));
        }
        let found = draft.values.len();
        match self.number(layout::RECORD_LENGTH, cell)? {
            #[allow(clippy::cast_precision_loss, reason = "at most a million rows")]
            Some(stated) if (stated - found as f64).abs() > 0.0 => {
                draft.notes.push(format!("found {found} points, the header says {stated}"));
            }
            _ => {}
        }
        if self.table.decimal_comma {
            draft.notes.push("numbers have a decimal comma".to_owned());
        }
        Ok(())
    }
}

fn names_missing(table: &CsvRows<'_>, index: usize) -> TekCsvError {
    let found = match table.row(index).texts().next() {
        Some(text) if index < table.len() => excerpt(text),
        _ => "the end of the file".to_owned(),
    };
    let place = place(table.file, index + 1, 1);
    TekCsvError::Header { place, found, expected: "`TIME,CH1`".to_owned() }
}
