//! Keys and values that an instrument writes above the columns of a table: one value, one for each
//! channel, or the whole list again for a table to the right.

use super::cells::CsvRows;
use super::names;
use crate::recording::error::{RecordingError, excerpt};
use crate::scope::Source;

/// Words of different makers for the same.
pub(super) const INTERVAL: &[&str] = &["sample interval", "sampling period", "sampleinterval"];
pub(super) const RECORD_LENGTH: &[&str] = &["record length", "memory length"];
pub(super) const VERTICAL_SCALE: &[&str] = &["vertical scale"];
pub(super) const VERTICAL_OFFSET: &[&str] = &["vertical offset"];
pub(super) const VERTICAL_POSITION: &[&str] = &["vertical position"];
pub(super) const VERTICAL_UNITS: &[&str] = &["vertical units"];
pub(super) const HORIZONTAL_UNITS: &[&str] = &["horizontal units"];
pub(super) const HORIZONTAL_SCALE: &[&str] = &["horizontal scale"];
pub(super) const PROBE: &[&str] = &["probe attenuation", "probe atten", "probe ratio"];
pub(super) const POINT_FORMAT: &[&str] = &["point format", "pt fmt"];
pub(super) const SOURCE: &[&str] = &["source"];
pub(super) const MODEL: &[&str] = &["model", "model number"];
pub(super) const SERIAL: &[&str] = &["serial number"];
pub(super) const FIRMWARE: &[&str] = &["firmware version", "software version", "firmware"];
pub(super) const FRAMES: &[&str] = &["fastframe count", "number of frames", "segments"];

/// Rows that are searched.
const MAX_KEY_ROWS: usize = 64;

/// The rows above a table's samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct TableKeys<'a, 't> {
    pub(super) table: &'t CsvRows<'a>,
    /// Rows from 0 to before this one.
    pub(super) rows: usize,
}

/// Which column a value is asked for.
#[derive(Debug, Clone, Copy)]
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
        (0..self.rows.min(MAX_KEY_ROWS)).find_map(|index| {
            let row = self.table.row(index);
            let is_key = |cell: &&str| {
                let cell = cell.trim_end_matches(':').trim();
                keys.iter().any(|key| key.eq_ignore_ascii_case(cell))
            };
            let places: Vec<usize> =
                row.texts().enumerate().filter(|(_, c)| is_key(c)).map(|(at, _)| at).collect();
            let first = *places.first()?;
            let key = places.iter().rev().find(|at| **at <= asked.cell).copied().unwrap_or(first);
            let end = places.iter().find(|at| **at > key).copied().unwrap_or(row.len());
            let filled: Vec<usize> =
                (key + 1..end).filter(|at| !row.text(*at).is_empty()).collect();
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
            let bare = text.split_once(':').filter(|(name, _)| {
                names::source(name).is_some() || name.eq_ignore_ascii_case("analog")
            });
            Some((index, at, bare.map_or(text, |(_, value)| value.trim())))
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
        let Some((row, cell, text)) = self.find(keys, asked) else { return Ok(None) };
        let row = self.table.row(row);
        let printed = row.parse(text).ok_or_else(|| {
            let key = row.texts().next().unwrap_or_default();
            RecordingError::value(row.place(cell), key, excerpt(text), "a number")
        })?;
        Ok(Some(printed.value))
    }
}
