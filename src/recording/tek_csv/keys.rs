//! Keys and values that an instrument writes above the columns of a table, in remarks, or beside
//! the first samples: one value, one for each channel, or the whole list again for a table to the
//! right.

use super::cells::{Cells, CsvRows};
use super::names::{self, unit};
use crate::recording::error::{RecordingError, excerpt};
use crate::scope::Source;

/// Words of different makers for the same.
pub(super) const INTERVAL: &[&str] = &[
    "sample interval",
    "sampling period",
    "sampleinterval",
    "sampling interval",
    "sample period",
    "time interval",
    "delta_x",
    "delta t",
    "xincrement",
    "x increment",
    "dt",
];
pub(super) const RATE: &[&str] =
    &["sample rate", "sampling rate", "samplerate", "sample frequency", "sampling frequency", "fs"];
pub(super) const START: &[&str] = &["x0", "start time", "xorigin", "x origin"];
pub(super) const RECORD_LENGTH: &[&str] =
    &["record length", "memory length", "sample count", "samples", "number of samples", "points"];
pub(super) const VERTICAL_SCALE: &[&str] = &["vertical scale"];
pub(super) const VERTICAL_OFFSET: &[&str] = &["vertical offset"];
pub(super) const VERTICAL_POSITION: &[&str] = &["vertical position"];
pub(super) const VERTICAL_UNITS: &[&str] = &["vertical units", "y_unit_label", "vertical unit"];
pub(super) const HORIZONTAL_UNITS: &[&str] = &["horizontal units", "horizontal unit"];
pub(super) const HORIZONTAL_SCALE: &[&str] = &["horizontal scale"];
pub(super) const PROBE: &[&str] = &["probe attenuation", "probe atten", "probe ratio", "probe"];
pub(super) const POINT_FORMAT: &[&str] = &["point format", "pt fmt"];
pub(super) const SOURCE: &[&str] = &["source"];
pub(super) const MODEL: &[&str] = &["model", "model number"];
pub(super) const SERIAL: &[&str] = &["serial number"];
pub(super) const FIRMWARE: &[&str] = &["firmware version", "software version", "firmware"];
pub(super) const FRAMES: &[&str] = &["fastframe count", "number of frames", "segments"];
pub(super) const WAVEFORM_TYPE: &[&str] = &["waveform type"];

/// Rows that are searched above the samples, and as many beside them.
const MAX_KEY_ROWS: usize = 64;

/// Where keys (settings by name) can be: in the rows above a table's samples, and to the right of
/// its first samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct TableKeys<'a, 't> {
    pub(super) table: &'t CsvRows<'a>,
    /// Rows from 0 to before this one.
    pub(super) rows: usize,
    /// Columns that hold samples: keys are looked for in the others.
    pub(super) beside: &'t [usize],
}

/// Which column a value is asked for.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct KeyRequest {
    pub(super) cell: usize,
    /// Column of its times.
    pub(super) time: usize,
    /// Its number among the channels of its table, and how many those are.
    pub(super) ordinal: usize,
    pub(super) channels: usize,
    pub(super) source: Option<Source>,
}

impl<'a> TableKeys<'a, '_> {
    /// Row and cell of the value of a key, and its text.
    fn find(&self, keys: &[&str], asked: KeyRequest) -> Option<(usize, usize, &'a str)> {
        let above = (0..self.rows.min(MAX_KEY_ROWS))
            .find_map(|index| in_cells(&self.table.row(index), keys, asked, index));
        above.or_else(|| self.in_remarks(keys)).or_else(|| self.beside_samples(keys))
    }

    /// In a remark above the samples: `; Sample rate: 1 MHz`.
    fn in_remarks(&self, keys: &[&str]) -> Option<(usize, usize, &'a str)> {
        (0..self.rows.min(MAX_KEY_ROWS)).find_map(|index| {
            let line = self.table.line(index).trim_start_matches(['#', ';', '%', '/', ' ', '"']);
            let (key, value) = line.split_once([':', '='])?;
            let value = value.trim_matches([' ', '"', ',', ';', '\t']);
            (is_key(key, keys) && !value.is_empty()).then_some((index, 0, value))
        })
    }

    /// To the right of the first samples, as spreadsheets put them.
    fn beside_samples(&self, keys: &[&str]) -> Option<(usize, usize, &'a str)> {
        let last = self.beside.last()?;
        let from = self.rows.saturating_sub(1);
        (from..self.table.len().min(self.rows + MAX_KEY_ROWS)).find_map(|index| {
            let row = self.table.row(index);
            let cell = (last + 1..row.len()).find(|cell| is_key(row.text(*cell), keys))?;
            let value = row.text(cell + 1);
            (!value.is_empty()).then_some((index, cell + 1, value))
        })
    }

    pub(super) fn text(&self, keys: &[&str], asked: KeyRequest) -> Option<&'a str> {
        self.find(keys, asked).map(|(_, _, text)| text)
    }

    /// A number; none where the file has no such key or nothing beside it.
    pub(super) fn number(
        &self,
        keys: &[&str],
        asked: KeyRequest,
    ) -> Result<Option<f64>, RecordingError> {
        let Some((row, cell, text)) = self.find(keys, asked).filter(is_quantity) else {
            return Ok(None);
        };
        let row = self.table.row(row);
        // A probe of `1.0X`.
        let bare = text.strip_suffix(['X', 'x']).unwrap_or(text);
        let printed = row.parse_any(text).or_else(|| row.parse_any(bare)).ok_or_else(|| {
            let key = keys.first().copied().unwrap_or_default();
            RecordingError::value(row.place(cell), key, excerpt(text), "a number")
        })?;
        Ok(Some(printed.value))
    }

    /// A number with a unit of `dimension` or none (s or Hz).
    pub(super) fn quantity(
        &self,
        keys: &[&str],
        dimension: &str,
        asked: KeyRequest,
    ) -> Result<Option<f64>, RecordingError> {
        let Some((index, cell, text)) = self.find(keys, asked).filter(is_quantity) else {
            return Ok(None);
        };
        let row = self.table.row(index);
        let wrong = || {
            let key = keys.first().copied().unwrap_or_default();
            let expected = format!("a number in {dimension}");
            RecordingError::value(row.place(cell), key, excerpt(text), expected)
        };
        if let Some(plain) = row.parse_any(text) {
            return Ok(Some(plain.value));
        }
        let is_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | '-' | '+');
        // The E of an exponent stands before a digit or a sign.
        let end = text.rfind(is_number).map_or(0, |at| at + 1);
        let (number, written) = text.split_at_checked(end).unwrap_or((text, ""));
        let number = row.parse_any(number.trim()).ok_or_else(wrong)?;
        let written = written.trim().trim_end_matches("/s");
        let unit = match (dimension, written) {
            // Samples a second.
            ("Hz", "Sa" | "S") => 1.0,
            ("Hz", "kSa" | "kS") => 1e3,
            ("Hz", "MSa" | "MS") => 1e6,
            ("Hz", "GSa" | "GS") => 1e9,
            _ => unit(written).filter(|unit| unit.text == dimension).ok_or_else(wrong)?.size(),
        };
        Ok(Some(number.value * unit))
    }
}

/// Whether what was found can be a number: behind a colon, remarks have words as well.
fn is_quantity((_, cell, text): &(usize, usize, &str)) -> bool {
    *cell > 0 || text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | '+' | '-'))
}

fn is_key(cell: &str, keys: &[&str]) -> bool {
    let cell = cell.trim_start_matches(['#', ';', '%', ' ']).trim_end_matches(':').trim();
    keys.iter().any(|key| key.eq_ignore_ascii_case(cell))
}

/// The value behind a key in the cells of a row.
fn in_cells<'a>(
    row: &Cells<'a>,
    keys: &[&str],
    asked: KeyRequest,
    index: usize,
) -> Option<(usize, usize, &'a str)> {
    let places: Vec<usize> =
        row.texts().enumerate().filter(|(_, c)| is_key(c, keys)).map(|(at, _)| at).collect();
    let first = *places.first()?;
    let key = places.iter().rev().find(|at| **at <= asked.cell).copied().unwrap_or(first);
    let end = places.iter().find(|at| **at > key).copied().unwrap_or(row.len());
    let filled: Vec<usize> = (key + 1..end).filter(|at| !row.text(*at).is_empty()).collect();
    let named = |at: &usize| {
        let (name, _) = row.text(*at).split_once(':')?;
        names::source(name).filter(|found| Some(*found) == asked.source)
    };
    let by_column = key + asked.cell.saturating_sub(asked.time);
    let at = match filled.as_slice() {
        [] => return None,
        several if several.iter().any(|at| named(at).is_some()) => {
            several.iter().find(|at| named(at).is_some()).copied()
        }
        [only] => Some(*only),
        each if each.len() == asked.channels => each.get(asked.ordinal).copied(),
        each => each.iter().find(|at| **at == by_column).or(each.first()).copied(),
    }?;
    let text = row.text(at);
    // Siglent writes `CH1:1.00` and `Analog:7000`.
    let bare = text
        .split_once(':')
        .filter(|(name, _)| names::source(name).is_some() || name.eq_ignore_ascii_case("analog"));
    Some((index, at, bare.map_or(text, |(_, value)| value.trim())))
}
