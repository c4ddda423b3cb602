//! Reads a table: a column of times and one column for each channel, below whatever an instrument,
//! a program or a person wrote above them. Newer Tektronix models (`Model`, `TIME,CH1`), Keysight,
//! Rigol, Siglent, R&S, Instek, `LeCroy`, `PicoScope` and Digilent save such tables, and so do
//! pandas and spreadsheets.
//!
//! The rows of samples are those in which the same cells hold numbers to the end of the file. Above
//! them stand names, units, and keys with values. Where names do not tell which column holds times,
//! values must: exactly one column may be evenly spaced. A column of times is never a channel; a
//! column of unknown role is refused; `--columns` gives its role.

use super::cells::CsvRows;
use super::column::SampleColumn;
use super::columns::TableColumns;
use super::keys::{self, KeyRequest, TableKeys};
use super::names::{self, ColumnName, ColumnRole, ColumnUnit, unit};
use super::table_layout::{TableBody, TableLayout, unknown};
use super::times::{EvenTimes, StatedTimeBase};
use super::unscaled_import::UnscaledImport;
use crate::recording::error::{RecordingError, excerpt};
use crate::recording::{Capture, InstrumentIdentity};
use crate::scope::{PointFormat, Source};

/// Channels of one file.
const MAX_CHANNELS: u8 = 8;

/// Reads the captures of a table; `given` says what its columns are where the user knows.
pub(super) fn read(
    table: &CsvRows<'_>,
    given: &TableColumns,
) -> Result<Vec<Capture>, RecordingError> {
    let layout = TableLayout::find(table)?;
    let body = TableBody::read(table, &layout, !given.is_empty())?;
    let mut plan = if given.is_empty() {
        ColumnPlan::by_names(table, &layout, &body)?
    } else {
        ColumnPlan::given(table, &body, given)?
    };
    let keys = TableKeys { table, rows: layout.keys_end() };
    plan.find_sources(&keys);
    plan.allot_sources(table.file);
    plan.channels.iter().map(|channel| plan.capture(channel, &keys, &layout, &body)).collect()
}

/// One channel's cells.
#[derive(Debug, Clone)]
struct Channel {
    /// Cell of its times; none where start and increment tell them.
    time: Option<usize>,
    cell: usize,
    source: Option<Source>,
    unit: Option<ColumnUnit>,
    time_unit: Option<ColumnUnit>,
    notes: Vec<String>,
}

/// What becomes of each column.
struct ColumnPlan {
    channels: Vec<Channel>,
    notes: Vec<String>,
    /// Whether the user said it.
    given: bool,
}

impl ColumnPlan {
    fn given(
        table: &CsvRows<'_>,
        body: &TableBody,
        given: &TableColumns,
    ) -> Result<Self, RecordingError> {
        let beyond = given
            .columns
            .iter()
            .find(|column| column.index >= body.columns.len().max(table.width()));
        if let Some(column) = beyond {
            return Err(unknown(table, &format!("a column {}", column.index + 1)));
        }
        let time = given.columns.iter().find(|column| TableColumns::is_time(&column.label));
        let time_unit = time.map(|time| time.unit.clone());
        let channels = given.sources().into_iter().map(|(column, source)| Channel {
            time: time.map(|time| time.index),
            cell: column.index,
            source,
            unit: Some(column.unit.clone()),
            time_unit: time_unit.clone(),
            notes: match source {
                None => vec![format!("column {} is {}", column.index + 1, column.label)],
                Some(_) => Vec::new(),
            },
        });
        Ok(Self { channels: channels.collect(), notes: Vec::new(), given: true })
    }

    fn by_names(
        table: &CsvRows<'_>,
        layout: &TableLayout,
        body: &TableBody,
    ) -> Result<Self, RecordingError> {
        let names: Vec<ColumnName> =
            layout.cells.iter().map(|cell| layout.name(table, *cell)).collect();
        let times = times(table, layout, body, &names)?;
        let mut plan = Self { channels: Vec::new(), notes: Vec::new(), given: false };
        let mut refused = Vec::new();
        for ((cell, name), column) in layout.cells.iter().zip(&names).zip(&body.columns) {
            let shown = excerpt(layout.names.map_or("", |names| table.row(names).text(*cell)));
            let place = format!("column {} {shown}", cell + 1);
            if times.contains(cell) {
                if times.contains(&(cell + 1)) {
                    plan.notes.push(format!("{place} holds times of no channel and is left out"));
                }
                continue;
            }
            let counts = column.steps_by_one() && column.len() > 2;
            let has_channel = matches!(name.role, ColumnRole::Values(Some(_)));
            if (counts && !has_channel && name.unit.is_none())
                || name.role == ColumnRole::Index && column.counts()
            {
                plan.notes.push(format!("{place} counts rows and is left out"));
                continue;
            }
            match (&name.role, &name.unknown_unit) {
                (ColumnRole::Extra, _) => {
                    plan.notes.push(format!("{place} is no channel and is left out"));
                }
                (_, Some(unit)) => {
                    refused.push(format!("{place} is in `{unit}`, a unit that is not known"));
                }
                (ColumnRole::OtherQuantity, _) => {
                    refused.push(format!("{place} has no unit and is no voltage"));
                }
                (ColumnRole::Nameless | ColumnRole::Abscissa | ColumnRole::Index, None)
                    if layout.names.is_some() =>
                {
                    refused.push(format!("{place} has no name that is known"));
                }
                (role, None) => {
                    let left = times.iter().rev().find(|time| *time < cell).or(times.first());
                    let time_name = left.map(|time| layout.name(table, *time));
                    plan.channels.push(Channel {
                        time: left.copied(),
                        cell: *cell,
                        source: if let ColumnRole::Values(source) = role { *source } else { None },
                        unit: name.unit.clone(),
                        time_unit: time_name.and_then(|name| name.unit),
                        notes: Vec::new(),
                    });
                }
            }
        }
        if plan.channels.is_empty() || plan.channels.len() > usize::from(MAX_CHANNELS) {
            let reasons = if refused.is_empty() { plan.notes } else { refused };
            let why = match reasons.as_slice() {
                [] => "1 to 8 channels".to_owned(),
                reasons => format!("1 to 8 channels: {}", reasons.join("; ")),
            };
            return Err(unknown(table, &why));
        }
        plan.notes.extend(refused.into_iter().map(|what| format!("{what}; it is left out")));
        plan.note_texts(table, layout);
        Ok(plan)
    }

    /// Notes columns of words.
    fn note_texts(&mut self, table: &CsvRows<'_>, layout: &TableLayout) {
        let row = table.row(layout.first);
        for (cell, text) in row.texts().enumerate() {
            if !text.is_empty() && !layout.cells.contains(&cell) {
                let name = layout.names.map_or("", |names| table.row(names).text(cell));
                self.notes.push(format!(
                    "column {} {} holds text and is left out",
                    cell + 1,
                    excerpt(name)
                ));
            }
        }
    }

    /// Where a channel's name does not tell its source, a key above the table may.
    fn find_sources(&mut self, keys: &TableKeys<'_, '_>) {
        for index in 0..self.channels.len() {
            let Some(channel) = self.channels.get(index).filter(|c| c.source.is_none()) else {
                continue;
            };
            let named = keys.text(keys::SOURCE, self.asked(channel)).and_then(names::source);
            if let Some(channel) = self.channels.get_mut(index) {
                channel.source = named;
            }
        }
    }

    fn asked(&self, channel: &Channel) -> KeyRequest {
        let beside: Vec<&Channel> =
            self.channels.iter().filter(|other| other.time == channel.time).collect();
        KeyRequest {
            cell: channel.cell,
            time: channel.time.unwrap_or_default(),
            ordinal: beside.iter().position(|other| other.cell == channel.cell).unwrap_or_default(),
            channels: beside.len(),
            source: channel.source,
        }
    }

    /// Gives each channel a source of its own: by its name, else by a single column's file name,
    /// else the first that is free.
    fn allot_sources(&mut self, file: &str) {
        let own = Some(channel_in(file)).filter(|_| self.channels.len() == 1).flatten();
        let mut taken: Vec<Source> = Vec::new();
        let named: Vec<Source> =
            self.channels.iter().filter_map(|channel| channel.source).collect();
        for channel in &mut self.channels {
            let free = |source: &Source| !taken.contains(source) && !named.contains(source);
            let wanted = channel.source;
            let source = match (wanted, own) {
                (Some(source), _) if !taken.contains(&source) => source,
                (None, Some(source)) => {
                    channel.notes.push(format!("source taken as {source} from the file's name"));
                    source
                }
                _ => (1..=u8::MAX).map(Source::Channel).find(free).unwrap_or(Source::Channel(1)),
            };
            match wanted {
                Some(wanted) if wanted != source => {
                    channel.notes.push(format!("a second {wanted} taken as {source}"));
                }
                None if own.is_none() && !self.given => {
                    channel.notes.push(format!("source taken as {source}: not given in the file"));
                }
                _ => {}
            }
            taken.push(source);
            channel.source = Some(source);
        }
    }

    fn capture(
        &self,
        channel: &Channel,
        keys: &TableKeys<'_, '_>,
        layout: &TableLayout,
        body: &TableBody,
    ) -> Result<Capture, RecordingError> {
        let table = keys.table;
        let asked = self.asked(channel);
        if let Some(frames) = keys.number(keys::FRAMES, asked)?.filter(|frames| *frames > 1.0) {
            return Err(unknown(
                table,
                &format!(
                    "one record: it holds {frames} frames one after the other; save each by itself"
                ),
            ));
        }
        // What the name does not tell, a key may.
        let of_key = |known: &Option<ColumnUnit>, key| match known {
            Some(unit) => Ok(Some(unit.clone())),
            None => stated_unit(keys, key, asked),
        };
        let time_unit = of_key(&channel.time_unit, keys::HORIZONTAL_UNITS)?;
        let value_unit = of_key(&channel.unit, keys::VERTICAL_UNITS)?;
        let mut draft = UnscaledImport {
            values: scaled(body.column(layout, channel.cell), value_unit.as_ref()),
            source: channel.source,
            y_unit: value_unit.as_ref().map(|unit| unit.text.to_owned()),
            ..UnscaledImport::default()
        };
        if let Some(time) = channel.time {
            draft.times = scaled(body.column(layout, time), time_unit.as_ref());
            draft.x_unit = time_unit.as_ref().map(|unit| unit.text.to_owned());
        } else {
            draft.even = layout
                .even
                .map(|(start, step)| EvenTimes { interval: step, trigger_point: -start / step });
            draft.x_unit = Some("s".to_owned());
        }
        if draft.even.is_none() && draft.times.len() != draft.values.len() {
            let short = draft.times.len().min(draft.values.len());
            let longer = if draft.times.len() > short { &draft.times } else { &draft.values };
            let (found, expected) = ("a time or a value alone", "both in every row");
            return Err(RecordingError::found(longer.place(short), found, expected));
        }
        use_keys(&mut draft, keys, asked)?;
        // A scale beside values in millivolts may be in either unit.
        let is_prefixed = |unit: &ColumnUnit| unit.power != 0 || unit.is_minutes();
        if channel.unit.is_none() && value_unit.as_ref().is_some_and(is_prefixed) {
            draft.scale = None;
        }
        if channel.time_unit.is_none() && time_unit.as_ref().is_some_and(is_prefixed) {
            draft.horizontal_scale = None;
        }
        draft.notes.extend(self.notes.iter().chain(&channel.notes).cloned());
        if table.decimal_comma {
            draft.notes.push("numbers have a decimal comma".to_owned());
        }
        if draft.instrument.is_none() && !self.given {
            let names = layout.names.map(|names| {
                let shown = table.row(names).texts().collect::<Vec<_>>().join(",");
                format!("the file has no header but {}", excerpt(shown.trim_end_matches(',')))
            });
            let note = names.unwrap_or_else(|| "the file has no header".to_owned());
            draft.notes.insert(0, note);
        }
        draft.capture(table.file, 1)
    }
}

/// The unit that a key states; none where there is no such key.
fn stated_unit(
    keys: &TableKeys<'_, '_>,
    key: &[&str],
    asked: KeyRequest,
) -> Result<Option<ColumnUnit>, RecordingError> {
    let Some(text) = keys.text(key, asked) else { return Ok(None) };
    let refused = || unknown(keys.table, &format!("a unit that is known, not {}", excerpt(text)));
    unit(text).map(Some).ok_or_else(refused)
}

/// What the rows above the table say of a channel.
fn use_keys(
    draft: &mut UnscaledImport,
    keys: &TableKeys<'_, '_>,
    asked: KeyRequest,
) -> Result<(), RecordingError> {
    let interval = keys.number(keys::INTERVAL, asked)?;
    draft.stated = StatedTimeBase { interval, trigger_point: None };
    draft.scale = keys.number(keys::VERTICAL_SCALE, asked)?;
    draft.horizontal_scale = keys.number(keys::HORIZONTAL_SCALE, asked)?;
    draft.probe = keys.number(keys::PROBE, asked)?;
    draft.point_format = match keys.text(keys::POINT_FORMAT, asked) {
        Some("ENV") => Some(PointFormat::Envelope),
        _ => Some(PointFormat::Sample),
    };
    let text = |key| keys.text(key, asked).unwrap_or_default().to_owned();
    let (model, firmware) = (text(keys::MODEL), text(keys::FIRMWARE));
    if !(model.is_empty() && firmware.is_empty()) {
        draft.instrument = Some(InstrumentIdentity { model, serial: text(keys::SERIAL), firmware });
    }
    let offset = keys.number(keys::VERTICAL_OFFSET, asked)?.unwrap_or_default();
    let position = keys.number(keys::VERTICAL_POSITION, asked)?;
    // Divisions from the centre, in which the trace's level `offset` stands.
    draft.zero = position.zip(draft.scale).map(|(position, scale)| position * scale - offset);
    if offset.abs() > 0.0 && draft.zero.is_none() {
        draft
            .notes
            .push(format!("Vertical Offset {offset} V moves the screen and is not in the values"));
    }
    let found = draft.values.len();
    match keys.number(keys::RECORD_LENGTH, asked)? {
        Some(stated) if (stated - found as f64).abs() > 0.0 => {
            draft.notes.push(format!("found {found} points, the header says {stated}"));
        }
        _ => {}
    }
    Ok(())
}

/// The cells of the columns of times: by their names, else the only one that is evenly spaced.
fn times(
    table: &CsvRows<'_>,
    layout: &TableLayout,
    body: &TableBody,
    names: &[ColumnName],
) -> Result<Vec<usize>, RecordingError> {
    let all = || layout.cells.iter().copied().zip(names).zip(&body.columns);
    if layout.even.is_some() {
        // Beside start and increment, the first column may count rows; nothing is a time.
        return Ok(Vec::new());
    }
    let named: Vec<usize> = all()
        .filter(|((_, name), _)| name.role == ColumnRole::Abscissa && name.unknown_unit.is_none())
        .map(|((cell, _), _)| cell)
        .collect();
    if !named.is_empty() {
        // Times in two units beside each other are one column of times.
        return Ok(named);
    }
    let unknown_unit =
        |name: &&ColumnName| name.role == ColumnRole::Abscissa && name.unknown_unit.is_some();
    if let Some(unit) = names.iter().find(unknown_unit).and_then(|name| name.unknown_unit.as_ref())
    {
        return Err(unknown(table, &format!("a unit of times that is known, not `{unit}`")));
    }
    let may_be = |name: &ColumnName| {
        let is_channel = matches!(
            name.role,
            ColumnRole::Values(Some(_)) | ColumnRole::Extra | ColumnRole::Index
        );
        !is_channel && name.unit.is_none() && name.unknown_unit.is_none()
    };
    let possible = || all().filter(|((_, name), _)| may_be(name));
    let even: Vec<usize> = possible()
        .filter(|(_, column)| EvenTimes::explain(column))
        .map(|((cell, _), _)| cell)
        .collect();
    match even.as_slice() {
        [only] => Ok(vec![*only]),
        // The error of the first one tells which row is not even.
        [] => match possible().next() {
            Some(((cell, _), _)) => Ok(vec![cell]),
            None => Err(unknown(table, "a column of times")),
        },
        several => {
            let columns: Vec<String> = several.iter().map(|cell| (cell + 1).to_string()).collect();
            Err(unknown(
                table,
                &format!("a name of times: columns {} are evenly spaced", columns.join(" and ")),
            ))
        }
    }
}

fn scaled(mut column: SampleColumn, unit: Option<&ColumnUnit>) -> SampleColumn {
    if let Some(unit) = unit {
        if unit.power != 0 {
            column.scale(unit.power);
        }
        if unit.is_minutes() {
            column.multiply(unit.factor);
        }
    }
    column
}

/// The channel in a name that the instrument gave, `F0001CH2.CSV`.
fn channel_in(file: &str) -> Option<Source> {
    let name = file.rsplit(['/', '\\']).next().unwrap_or_default().to_ascii_uppercase();
    let (_, rest) = name.rsplit_once("CH")?;
    let number = rest.strip_suffix(".CSV")?;
    Source::from_name(&format!("CH{number}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_in_file_names() {
        assert_eq!(channel_in("lab/ALL0001/F0001CH2.CSV"), Some(Source::Channel(2)));
        assert_eq!(channel_in("lab/CH2/TEK0001.CSV"), None);
        assert_eq!(channel_in("march.csv"), None);
    }
}
