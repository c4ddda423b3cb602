//! Reads what stands beside the samples in the first rows: keys, values and unit words.
//! `OpenChoice` repeats this for each channel; spreadsheets and people leave it, with other digits,
//! one or a few rows lower.
//!
//! The keys are found by name, in any row of their column. A row whose time and value are
//! no numbers is passed over while no sample has been seen, and refused later.
//!
//! Reads a file that the desktop program `OpenChoice` saved: channels side by side, unit words in
//! the third column, and numbers that went through single precision: `19.9999996E-3` means 20 mV.
//! They are taken to six digits.
//!
//! Other than in a native file, the zero level stands in `Yzero` (V), and `Vertical Offset` is 0.
//! The instrument stands in `Note`, as `TDS 1002B - <time of day> <date>`; its firmware is not
//! told.

use super::abscissa::{self, Abscissa};
use super::cells::CsvRows;
use super::column::{SINGLE_PRECISION_DIGITS, SampleColumn, rounded};
use super::layout::{Domain, HeaderLayout};
use super::times::{EvenTimes, StatedTimeBase};
use super::unscaled_import::UnscaledImport;
use super::{layout, names};
use crate::recording::error::{RecordingError, excerpt};
use crate::recording::{Capture, InstrumentIdentity};
use crate::scope::{PointFormat, Source};

/// Rows above the header that are searched for it.
const ROWS_ABOVE: usize = 3;
/// Cells of a row as an instrument of the family writes it; in all other files there are fewer.
const NATIVE_CELLS: usize = 6;
/// Fewest cells of a row with a key, a time and a value.
const MIN_CELLS: usize = 5;
/// Rows that are searched for keys.
const HEADER_ROWS: usize = 24;
/// From a key to its time and to its value.
const TO_TIME: usize = 3;
const TO_VALUE: usize = 4;

/// One channel's columns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<'a, 't> {
    table: &'t CsvRows<'a>,
    /// Row of `Record Length`.
    head: usize,
    /// Column of the keys.
    column: usize,
}

/// The blocks (header and samples of one channel) of a table, from left to right; none for a table
/// whose header is not to the left of the samples.
pub(super) fn blocks<'a, 't>(table: &'t CsvRows<'a>) -> Vec<Block<'a, 't>> {
    let is_head = |index: &usize| table.row(*index).text(0) == layout::RECORD_LENGTH;
    let Some(head) = (0..=ROWS_ABOVE).find(is_head) else { return Vec::new() };
    let row = table.row(head);
    if row.len() < MIN_CELLS {
        return Vec::new();
    }
    let columns = row.texts().enumerate().filter(|(_, cell)| *cell == layout::RECORD_LENGTH);
    columns.map(|(column, _)| Block { table, head, column }).collect()
}

impl<'a> Block<'a, '_> {
    /// The text beside `key`, with the row and cell where it stands; `None` where there is no such
    /// key.
    pub(super) fn text(&self, key: &str) -> Option<(&'a str, usize)> {
        let rows = self.head..self.table.len().min(self.head + HEADER_ROWS);
        let mut found = rows.filter(|index| self.table.row(*index).text(self.column) == key);
        found.next().map(|index| (self.table.row(index).text(self.column + 1), index))
    }

    /// The number beside `key`; `None` where the file does not have it.
    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, RecordingError> {
        match self.text(key) {
            None | Some(("", _)) => Ok(None),
            Some((_, index)) => {
                let row = self.table.row(index);
                let number = row.maybe_number(self.column + 1);
                let wrong = || self.wrong(key, index, row.expected_number());
                number.map(|printed| Some(printed.value)).ok_or_else(wrong)
            }
        }
    }

    /// Everything but the zero level, which dialects put in different rows.
    pub(super) fn import(&self) -> Result<UnscaledImport, RecordingError> {
        let mut notes = Vec::new();
        let (times, values) = self.samples(&mut notes)?;
        let mut draft = UnscaledImport {
            times,
            values,
            are_levels: true,
            stated: StatedTimeBase {
                interval: self.number(layout::SAMPLE_INTERVAL)?,
                trigger_point: self.number(layout::TRIGGER_POINT)?,
            },
            source: self.source()?,
            scale: self.number(layout::VERTICAL_SCALE)?,
            horizontal_scale: self.number(layout::HORIZONTAL_SCALE)?,
            probe: self.number(layout::PROBE)?,
            x_unit: self.unit(layout::HORIZONTAL_UNITS),
            y_unit: self.unit(layout::VERTICAL_UNITS),
            point_format: self.point_format()?,
            instrument: self.instrument(),
            notes,
            ..UnscaledImport::default()
        };
        if !matches!(draft.x_unit.as_deref(), None | Some("s" | "Hz"))
            && let Some((_, index)) = self.text(layout::HORIZONTAL_UNITS)
        {
            return Err(self.wrong(layout::HORIZONTAL_UNITS, index, "s or Hz"));
        }
        draft.even = self.frequencies(&mut draft);
        draft.notes.extend(
            self.text(layout::SOURCE)
                .and_then(|(text, _)| layout::spelling_note(layout::source_of(text)?, text)),
        );
        let has_serial = draft.instrument.as_ref().is_some_and(|found| !found.serial.is_empty());
        if has_serial && draft.instrument.as_ref().is_some_and(|found| found.model.is_empty()) {
            draft.notes.push("the instrument's model is not given in the file".to_owned());
        }
        self.note_rows(&mut draft)?;
        note_time_base(&mut draft);
        if self.table.decimal_comma {
            draft.notes.push("numbers have a decimal comma".to_owned());
        }
        Ok(draft)
    }

    fn note_rows(&self, draft: &mut UnscaledImport) -> Result<(), RecordingError> {
        if self.head > 0 {
            let names: Vec<String> = (0..self.head)
                .map(|index| {
                    let row = self.table.row(index);
                    excerpt(&row.texts().collect::<Vec<_>>().join(","))
                })
                .collect();
            draft.notes.push(format!("passed over above the header: {}", names.join(", ")));
        }
        let found = draft.values.len();
        match self.number(layout::RECORD_LENGTH)? {
            None => draft.notes.push(format!("record length {found} taken from the rows")),
            Some(stated) if (stated - found as f64).abs() > 0.0 => {
                draft.notes.push(format!("found {found} points, the header says {stated}"));
            }
            Some(_) => {}
        }
        Ok(())
    }

    fn samples(
        &self,
        notes: &mut Vec<String>,
    ) -> Result<(SampleColumn, SampleColumn), RecordingError> {
        let (mut times, mut values) = (SampleColumn::default(), SampleColumn::default());
        let (time, value) = (self.column + TO_TIME, self.column + TO_VALUE);
        for index in self.head..self.table.len() {
            let row = self.table.row(index);
            let names = row.maybe_number(time).is_none() && row.maybe_number(value).is_none();
            if names && times.len() == 0 && index < self.head + HEADER_ROWS {
                continue;
            }
            let is_last = index + 1 == self.table.len() && times.len() > 1;
            let is_cut = row.maybe_number(time).is_none() || row.maybe_number(value).is_none();
            if is_last && (is_cut || row.len() < self.table.row(index - 1).len()) {
                notes.push(format!("line {}, the last one, is cut and left out", index + 1));
                break;
            }
            times.push(&row, time)?;
            values.push(&row, value)?;
        }
        Ok((times, values))
    }

    /// The frequencies of a spectrum, if they are those that the family prints: their interval
    /// follows from the sampling rate, and the printed one is cut to seven digits.
    fn frequencies(&self, draft: &mut UnscaledImport) -> Option<EvenTimes> {
        if draft.x_unit.as_deref() != Some("Hz") || draft.stated.trigger_point != Some(0.0) {
            return None;
        }
        let (text, _) = self.text(layout::SAMPLE_INTERVAL)?;
        let printed = draft.stated.interval?;
        let named = self.text(layout::MODEL).is_some();
        let column = Abscissa {
            domain: Domain::Frequency,
            layout: if named { HeaderLayout::Named } else { HeaderLayout::Old },
            interval: abscissa::exact_interval(Domain::Frequency, printed, text),
            trigger_point: 0.0,
        };
        let is_near = |(index, found): (u32, &f64)| {
            let expected = column.value(index);
            let tolerance = column.tolerance(expected).max(draft.times.tolerance(*found));
            (found - expected).abs() <= tolerance
        };
        let interval = column.interval;
        draft.notes.extend(layout::interval_note(interval, Domain::Frequency, text));
        let is_native = (0..).zip(&draft.times.values).all(is_near);
        is_native.then_some(EvenTimes { interval, trigger_point: 0.0 })
    }

    /// Notes rows below the header with something in the cells beside time and value.
    fn note_other_cells(&self, draft: &mut UnscaledImport) {
        let (time, value) = (self.column + TO_TIME, self.column + TO_VALUE);
        let is_odd = |index: &usize| {
            let row = self.table.row(*index);
            let mut others = (self.column..row.len()).filter(|cell| ![time, value].contains(cell));
            others.any(|cell| !row.text(cell).is_empty())
        };
        let mut odd = (self.head + HEADER_ROWS..self.table.len()).filter(is_odd);
        if let Some(first) = odd.next() {
            draft.notes.push(format!(
                "{} rows have something beside time and value, which is passed over; the first is line {}",
                1 + odd.count(),
                first + 1
            ));
        }
    }

    fn source(&self) -> Result<Option<Source>, RecordingError> {
        let Some((text, index)) = self.text(layout::SOURCE).filter(|(text, _)| !text.is_empty())
        else {
            return Ok(None);
        };
        names::source(text)
            .map(Some)
            .ok_or_else(|| self.wrong(layout::SOURCE, index, "CH1 to CH8, MATH or REFA to REFD"))
    }

    fn point_format(&self) -> Result<Option<PointFormat>, RecordingError> {
        match self.text(layout::POINT_FORMAT) {
            None | Some(("", _)) => Ok(None),
            Some(("Y", _)) => Ok(Some(PointFormat::Sample)),
            Some(("ENV", _)) => Ok(Some(PointFormat::Envelope)),
            Some((_, index)) => Err(self.wrong(layout::POINT_FORMAT, index, "Y or ENV")),
        }
    }

    fn wrong(&self, key: &str, index: usize, expected: &str) -> RecordingError {
        let row = self.table.row(index);
        let found = excerpt(row.text(self.column + 1));
        RecordingError::value(row.place(self.column + 1), key, found, expected)
    }

    fn unit(&self, key: &str) -> Option<String> {
        self.text(key).map(|(text, _)| text).filter(|text| !text.is_empty()).map(unit)
    }

    fn instrument(&self) -> Option<InstrumentIdentity> {
        let text = |key| self.text(key).map(|(text, _)| text.to_owned()).unwrap_or_default();
        let (model, serial) = (text(layout::MODEL), text(layout::SERIAL));
        let firmware = text(layout::FIRMWARE);
        let known = !(model.is_empty() && firmware.is_empty());
        known.then_some(InstrumentIdentity { model, serial, firmware })
    }
}

/// The unit as this program writes it.
pub(super) fn unit(text: &str) -> String {
    match text {
        "Volts" | "volts" | "Volt" | "v" => "V",
        "S" | "seconds" | "Seconds" => "s",
        "HZ" | "hz" => "Hz",
        other => other,
    }
    .to_owned()
}

const NOTE: &str = "Note";
/// Digits of single precision that the header's numbers keep.
const DIGITS: usize = 6;

/// The captures of the blocks; `has_end` says that the last line has an end.
pub(super) fn read(
    blocks: &[Block<'_, '_>],
    has_end: bool,
) -> Result<Vec<Capture>, RecordingError> {
    let one = |(channel, block): (u8, &Block<'_, '_>)| {
        // `OpenChoice` writes a unit behind the record length.
        let head = block.table.row(block.head);
        if head.text(block.column + 2).contains(|c: char| c.is_ascii_alphabetic()) {
            return capture(block.table, block, channel);
        }
        let mut draft = block.import()?;
        let key = match draft.y_unit.as_deref() {
            Some("dB") => layout::Y_ZERO,
            _ => layout::VERTICAL_OFFSET,
        };
        draft.zero = block.number(key)?;
        if let [only] = blocks {
            only.note_other_cells(&mut draft);
        }
        if head.len() == NATIVE_CELLS && !has_end {
            draft.notes.push("the last line has no end: its value may be cut".to_owned());
        }
        draft.capture(block.table.file, channel)
    };
    (1..).zip(blocks).map(one).collect()
}

fn capture(
    table: &CsvRows<'_>,
    block: &Block<'_, '_>,
    channel: u8,
) -> Result<Capture, RecordingError> {
    let mut draft = block.import()?;
    draft.times.limit_digits(SINGLE_PRECISION_DIGITS);
    draft.values.limit_digits(SINGLE_PRECISION_DIGITS);
    draft.zero = block.number(layout::Y_ZERO)?;
    for number in [
        &mut draft.stated.interval,
        &mut draft.stated.trigger_point,
        &mut draft.scale,
        &mut draft.zero,
        &mut draft.horizontal_scale,
        &mut draft.probe,
    ] {
        *number = number.map(|value| rounded(value, DIGITS));
    }
    let offset = block.number(layout::VERTICAL_OFFSET)?.unwrap_or_default();
    if offset.abs() > 0.0 {
        draft
            .notes
            .push(format!("Vertical Offset {offset} is not used: no file with one has been seen"));
    }
    note(&mut draft, block);
    draft.capture(table.file, channel)
}

/// Instrument and time as the program wrote them.
fn note(draft: &mut UnscaledImport, block: &Block<'_, '_>) {
    let Some((text, _)) = block.text(NOTE).filter(|(text, _)| !text.is_empty()) else { return };
    let model = text.split(" - ").next().unwrap_or_default().replace(' ', "");
    if draft.instrument.is_none() && !model.is_empty() {
        let (serial, firmware) = (String::new(), String::new());
        draft.instrument = Some(InstrumentIdentity { model, serial, firmware });
    }
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    draft.notes.push(format!("OpenChoice says: {text}"));
}

/// Notes a time base that is not that of the sample interval.
fn note_time_base(draft: &mut UnscaledImport) {
    const POINTS_PER_DIVISION: f64 = 250.0;
    let is_time = draft.x_unit.as_deref() != Some("Hz");
    let both = draft.stated.interval.zip(draft.horizontal_scale).filter(|_| is_time);
    if let Some((interval, scale)) = both
        && (scale / (POINTS_PER_DIVISION * interval) - 1.0).abs() > 1e-3
    {
        draft.notes.push(format!(
            "the header's time base, {scale:e} s/div, is not 250 sample intervals, {:e} s/div",
            POINTS_PER_DIVISION * interval
        ));
    }
}
