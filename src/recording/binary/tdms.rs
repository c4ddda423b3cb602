//! National Instruments TDMS: segments, each with descriptions of channels and their raw values.

use std::collections::BTreeMap;

use super::bytes::{Bytes, Number};
use super::table::{BinaryColumn, BinaryTable};
use crate::recording::RecordingError;

/// What a segment holds, in the bits behind its mark.
const META: usize = 1 << 1;
const NEW_LIST: usize = 1 << 2;
const RAW: usize = 1 << 3;
const INTERLEAVED: usize = 1 << 5;
const BIG_ENDIAN: usize = 1 << 6;
const DAQMX: usize = 1 << 7;
/// Bytes of a segment's mark, bits, version and two lengths.
const LEAD_IN: usize = 28;
/// Channels without raw values here, and with the same as before.
const NO_VALUES: usize = 0xFFFF_FFFF;
const AS_BEFORE: usize = 0;
/// Channels, groups and the file itself.
const MAX_CHANNELS: usize = 1000;
/// Types that are no numbers.
const TEXT: usize = 0x20;
const TIME: usize = 0x44;
const BOOLEAN: usize = 0x21;

/// One channel, by its path `/'group'/'channel'`.
#[derive(Debug, Default, Clone)]
struct Channel {
    /// Kind and count of its values in a chunk; none without values.
    values: Option<(Number, usize)>,
    unit: String,
    interval: Option<f64>,
    start: f64,
    cells: Vec<f64>,
}

pub fn read(data: &[u8], file: &str) -> Result<BinaryTable, RecordingError> {
    let mut channels: BTreeMap<String, Channel> = BTreeMap::new();
    // Paths in the order in which their values stand, and in which they came first.
    let (mut list, mut order): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    let mut bytes = Bytes::new(data, file);
    while bytes.left() >= LEAD_IN {
        let start = bytes.at;
        if bytes.take(4)? != b"TDSm" {
            return Err(bytes.wrong("no segment", "TDSm: the file is damaged"));
        }
        let contents = bytes.count(4)?;
        bytes.big = contents & BIG_ENDIAN != 0;
        bytes.take(4)?;
        let mut raw = bytes.from(start + 20);
        let next = bytes.count(8)?;
        let raw_at = (start + LEAD_IN).saturating_add(raw.count(8)?);
        // A writer that was cut off does not know the length of its last segment.
        let end = start.saturating_add(LEAD_IN).saturating_add(next).min(data.len());
        bytes.take(8)?;
        if contents & DAQMX != 0 {
            let expected = "values as channels have them: convert the file once in LabVIEW";
            return Err(bytes.wrong("raw data of DAQmx", expected));
        }
        if contents & META != 0 {
            if contents & NEW_LIST != 0 {
                list.clear();
            }
            for _ in 0..bytes.count(4)? {
                let path = object(&mut bytes, &mut channels)?;
                if channels.len() > MAX_CHANNELS {
                    let expected = "at most 1000: save one group";
                    return Err(bytes.wrong("more channels and groups", expected));
                }
                if !order.contains(&path) {
                    order.push(path.clone());
                }
                if !list.contains(&path) {
                    list.push(path);
                }
            }
        }
        if contents & RAW != 0 {
            let mut raw = bytes.from(raw_at);
            let interleaved = contents & INTERLEAVED != 0;
            chunks(&mut raw, end, &list, &mut channels, interleaved)?;
        }
        if end <= start + LEAD_IN {
            break;
        }
        bytes = bytes.from(end);
        bytes.big = false;
    }
    table(&bytes, &order, channels)
}

/// Reads the description of one object, whose path it returns.
fn object(
    bytes: &mut Bytes<'_>,
    channels: &mut BTreeMap<String, Channel>,
) -> Result<String, RecordingError> {
    let length = bytes.count(4)?;
    let path = bytes.text(length)?;
    let channel = channels.entry(path.clone()).or_default();
    match bytes.count(4)? {
        NO_VALUES => channel.values = None,
        AS_BEFORE => (),
        _ => {
            let kind = bytes.count(4)?;
            bytes.take(4)?;
            let count = bytes.count(8)?;
            let Some(number) = number(kind) else {
                let found = format!("{path} with values of type {kind:#x}");
                return Err(bytes.wrong(found, "channels of numbers"));
            };
            channel.values = Some((number, count));
        }
    }
    for _ in 0..bytes.count(4)? {
        let length = bytes.count(4)?;
        let name = bytes.text(length)?;
        let kind = bytes.count(4)?;
        match (name.as_str(), number(kind)) {
            (_, None) if kind == TEXT => {
                let length = bytes.count(4)?;
                let text = bytes.text(length)?;
                if name == "unit_string" {
                    channel.unit = text;
                }
            }
            (_, None) if kind == TIME => {
                bytes.take(16)?;
            }
            (_, None) if kind == BOOLEAN => {
                bytes.take(1)?;
            }
            (_, None) => {
                let found = format!("a property `{name}` of type {kind:#x}");
                return Err(bytes.wrong(found, "numbers, texts and times"));
            }
            ("wf_increment", Some(kind)) => channel.interval = Some(bytes.number(kind)?),
            ("wf_start_offset", Some(kind)) => channel.start = bytes.number(kind)?,
            (_, Some(kind)) => {
                bytes.take(kind.width())?;
            }
        }
    }
    Ok(path)
}

/// Kinds of numbers by their type.
fn number(kind: usize) -> Option<Number> {
    Some(match kind {
        1..=4 => Number::Signed(1 << (kind - 1)),
        5..=8 => Number::Unsigned(1 << (kind - 5)),
        9 | 0x19 => Number::Float(4),
        10 | 0x1A => Number::Float(8),
        _ => return None,
    })
}

/// Reads a segment's chunks, which follow each other up to `end`.
fn chunks(
    raw: &mut Bytes<'_>,
    end: usize,
    list: &[String],
    channels: &mut BTreeMap<String, Channel>,
    interleaved: bool,
) -> Result<(), RecordingError> {
    let values = |channels: &BTreeMap<String, Channel>, path: &String| channels.get(path)?.values;
    let present: Vec<_> =
        list.iter().filter_map(|path| Some((path, values(channels, path)?))).collect();
    let size = present.iter().fold(0, |size: usize, (_, (number, count))| {
        size.saturating_add(number.width().saturating_mul(*count))
    });
    if size == 0 {
        return Ok(());
    }
    while raw.at.saturating_add(size) <= end {
        let rows = present.iter().map(|(_, (_, count))| *count).max().unwrap_or(0);
        let (turns, run) = if interleaved { (rows, 1) } else { (1, usize::MAX) };
        for _ in 0..turns {
            for (path, (number, count)) in &present {
                let Some(channel) = channels.get_mut(*path) else { continue };
                for _ in 0..run.min(*count) {
                    channel.cells.push(raw.digits(*number)?);
                }
            }
        }
    }
    Ok(())
}

fn table(
    bytes: &Bytes<'_>,
    order: &[String],
    mut channels: BTreeMap<String, Channel>,
) -> Result<BinaryTable, RecordingError> {
    let mut table = BinaryTable::default();
    for path in order {
        let Some(channel) = channels.remove(path).filter(|c| !c.cells.is_empty()) else { continue };
        let name = path.rsplit("/'").next().unwrap_or(path).trim_end_matches('\'');
        if let Some(interval) = channel.interval.filter(|interval| *interval > 0.0) {
            let grid = (channel.start, interval);
            if *table.grid.get_or_insert(grid) != grid {
                let expected = "channels on one grid: save groups one by one";
                return Err(bytes.wrong(format!("{name} on another grid of times"), expected));
            }
        }
        let (name, unit) = (name.replace("''", "'"), channel.unit);
        table.columns.push(BinaryColumn { name, unit, cells: channel.cells });
    }
    Ok(table)
}
