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
use super::table_layout::{TableBody, TableLayout, unknown, without_times};
use super::times::{EvenTimes, StatedTimeBase};
use super::unscaled_import::UnscaledImport;
use crate::recording::error::{RecordingError, excerpt};
use crate::recording::{Capture, InstrumentIdentity};
use crate::scope::waveform::{HIGHEST_CODE, LEVELS_PER_DIVISION, LOWEST_CODE};
use crate::scope::{PointFormat, Source};

/// Up to this many rows, also a first column that does not rise is taken as times: the refusal then
/// says what is wrong with them.
const FEW_ROWS: usize = 2;
/// Channels of one file.
const MAX_CHANNELS: u8 = 8;

/// Reads the captures of a table; `given` says what the user knows of it.
pub(super) fn read(
    table: &CsvRows<'_>,
    given: &TableColumns,
) -> Result<Vec<Capture>, RecordingError> {
    let layout = TableLayout::find(table)?;
    let keys = TableKeys { table, rows: layout.keys_end(), beside: &layout.cells };
    if keys.text(keys::WAVEFORM_TYPE, KeyRequest::default()).is_some_and(|kind| kind == "DIGITAL") {
        return Err(unknown(table, "an analogue channel: it holds the lines of a logic analyser"));
    }
    let body = TableBody::read(table, &layout, !given.is_empty())?;
    let spacing = Spacing::of(&keys, given)?;
    let mut plan = if given.is_empty() {
        ColumnPlan::by_names(table, &layout, &body, spacing)?
    } else {
        ColumnPlan::given(table, &body, given, spacing)?
    };
    plan.resample = given.resample;
    plan.notes.extend(layout.note_rows_below(table));
    plan.find_sources(&keys);
    plan.number_in_order();
    plan.find_units(&keys)?;
    plan.allot_sources(table.file);
    plan.channels.iter().map(|channel| plan.capture(channel, &keys, &layout, &body)).collect()
}

/// How far apart the samples are, said by something else than their times.
#[derive(Debug, Clone, Copy, Default)]
struct Spacing {
    /// Sample interval (s).
    interval: Option<f64>,
    /// Time of the first sample (s).
    start: Option<f64>,
    /// Whether the user said it.
    is_given: bool,
}

impl Spacing {
    fn of(keys: &TableKeys<'_, '_>, given: &TableColumns) -> Result<Self, RecordingError> {
        let asked = KeyRequest::default();
        let interval = keys.quantity(keys::INTERVAL, "s", asked)?;
        let rate = keys.quantity(keys::RATE, "Hz", asked)?.map(|rate| 1.0 / rate);
        let start = keys.quantity(keys::START, "s", asked)?;
        let interval = given.interval.or(interval).or(rate);
        let interval = interval.filter(|interval| interval.is_finite() && *interval > 0.0);
        Ok(Self { interval, start, is_given: given.interval.is_some() })
    }

    fn even(&self) -> Option<EvenTimes> {
        let interval = self.interval?;
        Some(EvenTimes { interval, trigger_point: 0.0 - self.start.unwrap_or_default() / interval })
    }
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
    /// Unit of a key above the table.
    key_unit: Option<ColumnUnit>,
    /// Why it is no channel unless a key gives its unit.
    doubt: Option<&'static str>,
    /// The word for a channel, and its number, in its name.
    numbered: Option<(String, Option<u32>)>,
    asked: KeyRequest,
    notes: Vec<String>,
}

/// What becomes of each column.
struct ColumnPlan {
    channels: Vec<Channel>,
    notes: Vec<String>,
    /// Why columns are left out.
    refused: Vec<String>,
    /// Cells of such columns, with the words and numbers of their names.
    left_out: Vec<(usize, (String, Option<u32>))>,
    /// The spacing where no column holds times.
    spacing: Spacing,
    /// Whether the user said it.
    given: bool,
    /// Whether channels are numbered in the order of their columns.
    in_order: bool,
    resample: bool,
}

impl ColumnPlan {
    fn new(spacing: Spacing, given: bool) -> Self {
        Self {
            channels: Vec::new(),
            notes: Vec::new(),
            refused: Vec::new(),
            left_out: Vec::new(),
            spacing,
            given,
            in_order: false,
            resample: false,
        }
    }

    fn given(
        table: &CsvRows<'_>,
        body: &TableBody,
        given: &TableColumns,
        spacing: Spacing,
    ) -> Result<Self, RecordingError> {
        let beyond = given
            .columns
            .iter()
            .find(|column| column.index >= body.columns.len().max(table.width()));
        if let Some(column) = beyond {
            return Err(unknown(table, &format!("a column {}", column.index + 1)));
        }
        let time = given.time();
        if time.is_none() && spacing.interval.is_none() {
            return Err(without_times(table));
        }
        let time_unit = time.map(|time| time.unit.clone());
        let channels = given.sources().into_iter().map(|(column, source)| Channel {
            time: time.map(|time| time.index),
            cell: column.index,
            source,
            unit: Some(column.unit.clone()),
            time_unit: time_unit.clone(),
            key_unit: None,
            doubt: None,
            numbered: None,
            asked: KeyRequest::default(),
            notes: match source {
                None => vec![format!("column {} is {}", column.index + 1, column.label)],
                Some(_) => Vec::new(),
            },
        });
        Ok(Self { channels: channels.collect(), ..Self::new(spacing, true) })
    }

    fn by_names(
        table: &CsvRows<'_>,
        layout: &TableLayout,
        body: &TableBody,
        spacing: Spacing,
    ) -> Result<Self, RecordingError> {
        let names: Vec<ColumnName> =
            layout.cells.iter().map(|cell| layout.name(table, *cell)).collect();
        let times = times(table, layout, body, &names, spacing)?;
        let mut plan = Self::new(spacing, false);
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
            if (counts && !has_channel && name.unit.is_none() && name.unknown_unit.is_none())
                || name.role == ColumnRole::Index && column.counts()
            {
                plan.notes.push(format!("{place} counts rows and is left out"));
                continue;
            }
            let unit = column.own_unit.clone().or_else(|| name.unit.clone());
            // `col 2` of a spreadsheet.
            let text = layout.names.map_or("", |names| table.row(names).text(*cell));
            let is_placeholder = name.role == ColumnRole::Nameless
                && !text.is_empty()
                && !text.to_ascii_lowercase().starts_with("unnamed");
            match (&name.role, &name.unknown_unit) {
                (ColumnRole::Extra, _) => {
                    plan.notes.push(format!("{place} is no channel and is left out"));
                }
                (_, Some(unit)) => {
                    plan.left_out.extend(name.numbered.clone().map(|numbered| (*cell, numbered)));
                    plan.refused.push(format!("{place} is in `{unit}`, a unit that is not known"));
                }
                (_, None) if unit.is_none() && column.is_logic() => {
                    plan.refused.push(format!("{place} holds 0 and 1 only, as a logic line"));
                }
                (ColumnRole::Nameless | ColumnRole::Abscissa | ColumnRole::Index, None)
                    if layout.names.is_some() && unit.is_none() && !is_placeholder =>
                {
                    plan.refused.push(format!("{place} has no name that is known"));
                }
                (role, None) => {
                    let left = times.iter().rev().find(|time| *time < cell).or(times.first());
                    let time_name = left.map(|time| layout.name(table, *time));
                    let is_doubtful = *role == ColumnRole::OtherQuantity && unit.is_none();
                    plan.channels.push(Channel {
                        time: left.copied(),
                        cell: *cell,
                        source: if let ColumnRole::Values(source) = role { *source } else { None },
                        unit,
                        time_unit: left
                            .and_then(|time| body.column(layout, *time).own_unit)
                            .or_else(|| time_name.and_then(|name| name.unit)),
                        key_unit: None,
                        doubt: is_doubtful.then_some("has no unit and is no voltage"),
                        numbered: name.numbered.clone(),
                        asked: KeyRequest::default(),
                        notes: Vec::new(),
                    });
                }
            }
        }
        plan.note_texts(table, layout);
        plan.check_number(table)?;
        Ok(plan)
    }

    /// Refuses a table without channels, or with too many.
    fn check_number(&self, table: &CsvRows<'_>) -> Result<(), RecordingError> {
        if (1..=usize::from(MAX_CHANNELS)).contains(&self.channels.len()) {
            return Ok(());
        }
        let reasons = if self.refused.is_empty() { &self.notes } else { &self.refused };
        let why = match reasons.as_slice() {
            [] => "1 to 8 channels".to_owned(),
            reasons => format!("1 to 8 channels: {}", reasons.join("; ")),
        };
        Err(unknown(table, &why))
    }

    /// Numbers channels in the order of their columns where a file counts them from 0, or leaves
    /// the first without a number.
    fn number_in_order(&mut self) {
        let of_channels = self.channels.iter().filter_map(|channel| {
            channel.numbered.as_ref().map(|numbered| (channel.cell, numbered.clone()))
        });
        let mut named: Vec<(usize, (String, Option<u32>))> =
            of_channels.chain(self.left_out.iter().cloned()).collect();
        let is_odd = |(_, (word, number)): &(usize, (String, Option<u32>))| match number {
            Some(number) => *number == 0,
            None => named.iter().any(|(_, (other, number))| other == word && *number == Some(1)),
        };
        if self.given || !named.iter().any(is_odd) {
            return;
        }
        named.extend(
            self.channels
                .iter()
                .filter(|c| c.numbered.is_none())
                .map(|channel| (channel.cell, (String::new(), None))),
        );
        named.sort_by_key(|(cell, _)| *cell);
        for channel in &mut self.channels {
            if matches!(channel.source, None | Some(Source::Channel(_))) {
                let place = named.iter().position(|(cell, _)| *cell == channel.cell);
                let number = place.and_then(|place| u8::try_from(place + 1).ok());
                channel.source = number.map(Source::Channel);
            }
        }
        self.in_order = true;
        self.notes.push(
            "the file does not count its channels from 1: they are numbered from CH1 in the order of their columns"
                .to_owned(),
        );
    }

    /// Looks up units that are not in the columns' names in the keys above the table. Channels of
    /// unknown units are left out.
    fn find_units(&mut self, keys: &TableKeys<'_, '_>) -> Result<(), RecordingError> {
        for index in 0..self.channels.len() {
            let Some(channel) = self.channels.get(index) else { continue };
            let asked = self.request(channel);
            let text = keys.text(keys::VERTICAL_UNITS, asked).filter(|text| !text.is_empty());
            if let Some(channel) = self.channels.get_mut(index) {
                channel.asked = asked;
                channel.key_unit = text.and_then(names::unit_in_row);
                if channel.unit.is_none() && channel.key_unit.is_none() && text.is_some() {
                    channel.doubt = Some("has a unit that is not known");
                } else if channel.key_unit.is_some() {
                    channel.doubt = None;
                }
            }
        }
        let channels = std::mem::take(&mut self.channels);
        for channel in channels {
            let of_times = channel
                .time_unit
                .clone()
                .or_else(|| keys.text(keys::HORIZONTAL_UNITS, channel.asked).and_then(unit));
            let is_spectrum = of_times.is_some_and(|unit| unit.text == "Hz");
            let of_values = channel.unit.as_ref().or(channel.key_unit.as_ref());
            let doubt = channel.doubt.or_else(|| {
                let is_level = of_values.is_some_and(|unit| unit.text == "dB");
                (is_spectrum && !is_level).then_some(
                    "is a spectrum, values over frequencies, and no record of a scope; a spectrum in dB is read",
                )
            });
            match doubt {
                Some(doubt) => {
                    let unit = keys.text(keys::VERTICAL_UNITS, channel.asked).unwrap_or_default();
                    let unit = if unit.is_empty() || is_spectrum {
                        String::new()
                    } else {
                        format!(", {}", excerpt(unit))
                    };
                    self.refused.push(format!("column {} {doubt}{unit}", channel.cell + 1));
                }
                None => self.channels.push(channel),
            }
        }
        self.check_number(keys.table)?;
        let refused = std::mem::take(&mut self.refused);
        self.notes.extend(refused.into_iter().map(|what| format!("{what}; it is left out")));
        Ok(())
    }

    /// Notes columns of words.
    fn note_texts(&mut self, table: &CsvRows<'_>, layout: &TableLayout) {
        let row = table.row(layout.first);
        for (cell, text) in row.texts().enumerate() {
            if !text.is_empty() && !layout.cells.contains(&cell) && !layout.is_unit(cell) {
                let name = layout.names.map_or("", |names| table.row(names).text(cell));
                let numbered = ColumnName::of(name, None).numbered;
                self.left_out.extend(numbered.map(|numbered| (cell, numbered)));
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
            let named = keys.text(keys::SOURCE, self.request(channel)).and_then(names::source);
            if let Some(channel) = self.channels.get_mut(index) {
                channel.source = named;
            }
        }
    }

    fn request(&self, channel: &Channel) -> KeyRequest {
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
                None if own.is_none() && !self.given && !self.in_order => {
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
        let asked = channel.asked;
        if let Some(frames) = keys.number(keys::FRAMES, asked)?.filter(|frames| *frames > 1.0) {
            return Err(unknown(
                table,
                &format!(
                    "one record: it holds {frames} frames one after the other; save each by itself"
                ),
            ));
        }
        // What the name does not tell, a key may.
        let time_unit = match &channel.time_unit {
            Some(unit) => Some(unit.clone()),
            None => stated_unit(keys, keys::HORIZONTAL_UNITS, asked)?,
        };
        let value_unit = channel.unit.as_ref().or(channel.key_unit.as_ref());
        let mut draft = UnscaledImport {
            source: channel.source,
            y_unit: value_unit.map(|unit| unit.text.to_owned()),
            resample: self.resample,
            ..UnscaledImport::default()
        };
        let values = body.column(layout, channel.cell);
        if let Some(time) = channel.time {
            let times = body.column(layout, time);
            let (times, values) = both(times, values, &mut draft.notes)?;
            draft.times = scaled(times, time_unit.as_ref());
            draft.values = scaled(values, value_unit);
            draft.x_unit = time_unit.as_ref().map(|unit| unit.text.to_owned());
        } else {
            self.space(&mut draft, layout, values.before, channel)?;
            draft.values = scaled(values, value_unit);
        }
        use_keys(&mut draft, keys, channel, self.spacing.is_given)?;
        // A scale beside times in a unit of the same row may be in either.
        let is_prefixed = |unit: &ColumnUnit| unit.power != 0 || unit.has_factor();
        if channel.unit.is_none() && value_unit.is_some_and(is_prefixed) {
            draft.scale = None;
        }
        if channel.time_unit.is_none() && time_unit.as_ref().is_some_and(is_prefixed) {
            draft.horizontal_scale = None;
        }
        use_raw_levels(&mut draft, table, layout);
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

    /// Spaces values without times; `before` rows have none.
    fn space(
        &self,
        draft: &mut UnscaledImport,
        layout: &TableLayout,
        before: usize,
        channel: &Channel,
    ) -> Result<(), RecordingError> {
        let stated = layout
            .even
            .map(|(start, step)| EvenTimes { interval: step, trigger_point: 0.0 - start / step });
        let even = stated.or_else(|| self.spacing.even());
        let Some(even) = even else {
            let what = format!("column {} has no times", channel.cell + 1);
            return Err(RecordingError::new("", what));
        };
        let trigger_point = even.trigger_point - before as f64;
        draft.even = Some(EvenTimes { trigger_point, ..even });
        draft.x_unit = Some("s".to_owned());
        if stated.is_none() {
            let who = if self.spacing.is_given { "the user" } else { "the header" };
            let start = match self.spacing.start {
                Some(_) => "",
                None => "; the first sample is taken as time 0",
            };
            draft.notes.push(format!(
                "the file has no times: sample interval {:e} s by {who}{start}",
                even.interval
            ));
        }
        Ok(())
    }
}

/// Times and values of the rows that have both; notes rows at the ends without a value.
fn both(
    times: SampleColumn,
    values: SampleColumn,
    notes: &mut Vec<String>,
) -> Result<(SampleColumn, SampleColumn), RecordingError> {
    let rows = |column: &SampleColumn| column.before..column.before + column.len();
    let (of_times, of_values) = (rows(&times), rows(&values));
    let outside = if of_values.start < of_times.start {
        Some(0)
    } else {
        (of_values.end > of_times.end).then(|| of_times.end.saturating_sub(of_values.start))
    };
    if let Some(index) = outside {
        let (found, expected) = ("a value without a time", "both in every row");
        return Err(RecordingError::found(values.place(index), found, expected));
    }
    let (start, end) = (of_values.start - of_times.start, of_times.end - of_values.end);
    for (count, place) in [(start, "first"), (end, "last")] {
        if count > 0 {
            notes.push(format!("the {place} {count} rows have no value and are left out"));
        }
    }
    Ok((times.of_rows(of_values), values))
}

/// Turns the levels of an Instek file into volts: 25 a division (GDS-1000A manual).
fn use_raw_levels(draft: &mut UnscaledImport, table: &CsvRows<'_>, layout: &TableLayout) {
    let is_raw = layout.names.is_some_and(|names| {
        table.row(names).texts().any(|text| text.eq_ignore_ascii_case("waveform data"))
    });
    let range = (f64::from(LOWEST_CODE), f64::from(HIGHEST_CODE));
    let Some(scale) = draft.scale.filter(|_| is_raw && draft.values.are_whole(range)) else {
        return;
    };
    draft.values.multiply(scale / LEVELS_PER_DIVISION);
    draft.notes.push("levels of the digitiser, 25 a division, are turned into volts".to_owned());
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
    channel: &Channel,
    is_spaced: bool,
) -> Result<(), RecordingError> {
    let asked = channel.asked;
    let interval = keys.quantity(keys::INTERVAL, "s", asked)?.filter(|_| !is_spaced);
    draft.stated = StatedTimeBase { interval, trigger_point: None };
    // Scales are in the units that stand above the table.
    let vertical = channel.key_unit.as_ref().map_or(1.0, ColumnUnit::size);
    let horizontal = keys.text(keys::HORIZONTAL_UNITS, asked).and_then(unit);
    let horizontal = horizontal.map_or(1.0, |unit| unit.size());
    draft.scale = keys.number(keys::VERTICAL_SCALE, asked)?.map(|scale| scale * vertical);
    draft.horizontal_scale =
        keys.number(keys::HORIZONTAL_SCALE, asked)?.map(|scale| scale * horizontal);
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
    let offset = keys.number(keys::VERTICAL_OFFSET, asked)?.unwrap_or_default() * vertical;
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

/// The cells of the columns of times: by their names, else the only one that is evenly spaced; none
/// where the samples' spacing is said.
fn times(
    table: &CsvRows<'_>,
    layout: &TableLayout,
    body: &TableBody,
    names: &[ColumnName],
    spacing: Spacing,
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
    // A column with any other name is no column of times.
    let may_be = |name: &ColumnName| name.role == ColumnRole::Nameless && name.unit.is_none();
    let possible = || all().filter(|((_, name), column)| may_be(name) && column.own_unit.is_none());
    let counts = |column: &SampleColumn| column.steps_by_one() && column.len() > 2;
    let even: Vec<usize> = possible()
        .filter(|(_, column)| EvenTimes::explain(column) && !(spacing.is_given && counts(column)))
        .map(|((cell, _), _)| cell)
        .collect();
    let is_counter = |cell: usize| all().any(|((at, _), column)| at == cell && counts(column));
    match even.as_slice() {
        // Numbers of rows, and how far apart they are.
        [only] if spacing.interval.is_some() && is_counter(*only) => Ok(Vec::new()),
        [only] if is_counter(*only) => {
            let what = format!("column {} counts rows", only + 1);
            Err(unknown(
                table,
                &format!(
                    "a sample interval: {what}; give it with {}",
                    super::columns::INTERVAL_EXAMPLE
                ),
            ))
        }
        [only] => Ok(vec![*only]),
        [] if spacing.interval.is_some() => Ok(Vec::new()),
        // The error of the first one tells which row is not even.
        [] => match possible().find(|(_, column)| {
            column.rises() || (column.len() <= FEW_ROWS && layout.cells.len() > 1)
        }) {
            Some(((cell, _), _)) => Ok(vec![cell]),
            None => Err(without_times(table)),
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
        if unit.has_factor() {
            column.multiply(unit.factor);
        }
    }
    column
}

/// The channel in a name that an instrument gave: `F0001CH2.CSV`, `shot_Ch1.csv`, `C2Trace00003`.
fn channel_in(file: &str) -> Option<Source> {
    let name = file.rsplit(['/', '\\']).next().unwrap_or_default().to_ascii_uppercase();
    let (stem, _) = name.rsplit_once('.')?;
    let number = |(before, rest): (&str, &str)| {
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let (digits, behind) = rest.split_at_checked(digits)?;
        let is_apart = !before.ends_with(|c: char| c.is_ascii_alphabetic())
            && !behind.starts_with(|c: char| c.is_ascii_alphanumeric());
        is_apart.then(|| Source::from_name(&format!("CH{digits}"))).flatten()
    };
    if let Some(found) = stem.rsplit_once("CH").and_then(number) {
        return Some(found);
    }
    let (digits, behind) = stem.strip_prefix('C')?.split_at_checked(1)?;
    let is_trace = behind.starts_with("TRACE") || behind.starts_with("--");
    is_trace.then(|| Source::from_name(&format!("CH{digits}"))).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_in_file_names() {
        assert_eq!(channel_in("lab/ALL0001/F0001CH2.CSV"), Some(Source::Channel(2)));
        assert_eq!(channel_in("lab/CH2/TEK0001.CSV"), None);
        assert_eq!(channel_in("march.csv"), None);
        assert_eq!(channel_in("march3.csv"), None);
        assert_eq!(channel_in("shot 7_Ch1.csv"), Some(Source::Channel(1)));
        assert_eq!(channel_in("CH4_run.csv"), Some(Source::Channel(4)));
        assert_eq!(channel_in("C2Trace00003.csv"), Some(Source::Channel(2)));
        assert_eq!(channel_in("C3--impact--00000.txt"), Some(Source::Channel(3)));
    }
}
