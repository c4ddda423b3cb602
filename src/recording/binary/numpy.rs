//! `NumPy`: `.npy`, one array; `.npz`, several by name in an archive.

use miniz_oxide::inflate::decompress_to_vec_with_limit;

use super::bytes::{Bytes, Number};
use super::table::{BinaryColumn, BinaryTable};
use crate::recording::RecordingError;

/// Arrays of an archive, and fields of an array: more are no record of a scope.
const MAX_COLUMNS: usize = 64;
/// Largest array (bytes).
const MAX_BYTES: usize = 1 << 30;
const WHAT_IS_READ: &str = "numbers: np.save(file, array) with a column a channel, or fields";

/// One array.
pub fn array(data: &[u8], file: &str) -> Result<BinaryTable, RecordingError> {
    let columns = columns(data, file, "")?;
    Ok(BinaryTable { columns, ..BinaryTable::default() })
}

/// The arrays of an archive, which are as long as each other.
pub fn archive(data: &[u8], file: &str) -> Result<BinaryTable, RecordingError> {
    let mut table = BinaryTable::default();
    for (name, array) in members(data, file)? {
        let Some(name) = name.strip_suffix(".npy") else {
            let found = format!("`{name}` in an archive");
            return Err(RecordingError::found(file, found, "arrays of np.savez"));
        };
        table.columns.extend(columns(&array, &format!("{file}, {name}"), name)?);
    }
    Ok(table)
}

/// Names and contents of the files in a ZIP archive, by its directory at the end.
fn members(data: &[u8], file: &str) -> Result<Vec<(String, Vec<u8>)>, RecordingError> {
    const DIRECTORY_END: &[u8] = b"PK\x05\x06";
    const ENTRY: &[u8] = b"PK\x01\x02";
    let bytes = Bytes::new(data, file);
    let place = data.windows(DIRECTORY_END.len()).rposition(|window| window == DIRECTORY_END);
    let place = place.ok_or_else(|| bytes.wrong("no directory", "an archive: it is cut"))?;
    let mut end = bytes.from(place + 10);
    let count = end.count(2)?;
    end.take(4)?;
    let mut entry = bytes.from(end.count(4)?);
    if count > MAX_COLUMNS {
        return Err(end.wrong(format!("{count} files"), "at most 64 arrays of np.savez"));
    }
    let mut members = Vec::with_capacity(count);
    for _ in 0..count {
        if entry.take(4)? != ENTRY {
            return Err(entry.wrong("no entry of the directory", "one: the archive is damaged"));
        }
        entry.take(6)?;
        let method = entry.count(2)?;
        entry.take(4)?;
        let (checksum, packed, size) = (entry.count(4)?, entry.count(4)?, entry.count(4)?);
        let (name, extra, comment) = (entry.count(2)?, entry.count(2)?, entry.count(2)?);
        entry.take(8)?;
        let start = entry.count(4)?;
        let name = entry.text(name)?;
        entry.take(extra + comment)?;
        let mut local = bytes.from(start + 26);
        let before = local.count(2)? + local.count(2)?;
        local.take(before)?;
        let packed = local.take(packed)?;
        if size > MAX_BYTES {
            return Err(local.wrong(format!("{size} bytes in `{name}`"), "at most 1 GiB"));
        }
        let content = match method {
            0 => packed.to_vec(),
            8 => decompress_to_vec_with_limit(packed, size)
                .map_err(|error| local.wrong(format!("`{name}` damaged"), &error.to_string()))?,
            _ => return Err(local.wrong(format!("method {method}"), "np.savez_compressed")),
        };
        if crc32fast::hash(&content) as usize != checksum {
            return Err(local.wrong(format!("`{name}` with a wrong checksum"), "it whole"));
        }
        members.push((name, content));
    }
    Ok(members)
}

/// The columns of an array called `name`.
fn columns(data: &[u8], file: &str, name: &str) -> Result<Vec<BinaryColumn>, RecordingError> {
    let mut bytes = Bytes::new(data, file);
    if bytes.take(6)? != b"\x93NUMPY" {
        return Err(bytes.wrong("no array", "one of np.save"));
    }
    let version = bytes.count(1)?;
    bytes.take(1)?;
    let length = bytes.count(if version == 1 { 2 } else { 4 })?;
    let header = String::from_utf8_lossy(bytes.take(length)?).into_owned();
    let refuse = |bytes: &Bytes<'_>, found: String| bytes.wrong(found, WHAT_IS_READ);
    let shape = between(&header, "'shape':", "(", ")").unwrap_or_default();
    let shape: Vec<usize> = shape.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    let by_columns = header.contains("'fortran_order': True");
    let fields = fields(&header).ok_or_else(|| refuse(&bytes, header.trim().to_owned()))?;
    let (rows, width) = match shape.as_slice() {
        [rows] => (*rows, 1),
        [rows, width] => (*rows, *width),
        _ => return Err(refuse(&bytes, format!("an array of {} dimensions", shape.len()))),
    };
    let size: usize = fields.iter().map(|(_, number, _)| number.width()).sum();
    if rows.checked_mul(width).and_then(|n| n.checked_mul(size)).is_none_or(|n| n > bytes.left()) {
        return Err(refuse(&bytes, format!("{} bytes for {rows} x {width} values", bytes.left())));
    }
    if let [(_, number, big)] = fields.as_slice() {
        bytes.big = *big;
        let cells = (0..rows * width).map(|_| bytes.digits(*number));
        let cells = cells.collect::<Result<Vec<_>, _>>()?;
        // A row a channel, as acquisition programs have it, is turned.
        let turned = width > rows && rows <= MAX_COLUMNS;
        let (length, count) = if turned { (width, rows) } else { (rows, width) };
        if count > MAX_COLUMNS {
            return Err(refuse(&bytes, format!("{count} columns")));
        }
        let contiguous = turned != by_columns;
        let cell = |column: usize, row: usize| {
            let place = if contiguous { column * length + row } else { row * count + column };
            cells.get(place).copied().unwrap_or(f64::NAN)
        };
        let column = |column: usize| BinaryColumn {
            name: if count == 1 || name.is_empty() {
                name.to_owned()
            } else {
                format!("{name}{column}")
            },
            cells: (0..length).map(|row| cell(column, row)).collect(),
            ..BinaryColumn::default()
        };
        return Ok((0..count).map(column).collect());
    }
    let named = fields
        .iter()
        .map(|(name, ..)| BinaryColumn { name: name.clone(), ..BinaryColumn::default() });
    let mut columns: Vec<BinaryColumn> = named.collect();
    for _ in 0..rows * width {
        for ((_, number, big), column) in fields.iter().zip(&mut columns) {
            bytes.big = *big;
            column.cells.push(bytes.digits(*number)?);
        }
    }
    Ok(columns)
}

/// The text after `key` that `open` and `close` enclose.
fn between<'a>(text: &'a str, key: &str, open: &str, close: &str) -> Option<&'a str> {
    let rest = text.split_once(key)?.1.split_once(open)?.1;
    rest.split_once(close).map(|(inside, _)| inside)
}

/// Names, kinds and byte orders (most significant first) of the fields that `descr` lists, or of
/// the one kind that it is.
fn fields(header: &str) -> Option<Vec<(String, Number, bool)>> {
    let rest = header.split_once("'descr':")?.1.trim_start();
    if !rest.starts_with('[') {
        let (number, big) = kind(between(rest, "", "'", "'")?)?;
        return Some(vec![(String::new(), number, big)]);
    }
    let list = between(rest, "", "[", "]")?;
    let field = |entry: &str| {
        let mut words = entry.split('\'').skip(1).step_by(2);
        let (name, descr) = (words.next()?, words.next()?);
        let (number, big) = kind(descr)?;
        Some((name.to_owned(), number, big))
    };
    let entries: Vec<&str> = list.split('(').skip(1).collect();
    if entries.len() > MAX_COLUMNS {
        return None;
    }
    entries.into_iter().map(field).collect()
}

fn kind(descr: &str) -> Option<(Number, bool)> {
    let (order, rest) = descr.split_at_checked(1)?;
    let (letter, width) = rest.split_at_checked(1)?;
    let width: usize = width.parse().ok()?;
    let number = match (letter, width) {
        ("f", 4 | 8) => Number::Float(width),
        ("i", 1 | 2 | 4 | 8) => Number::Signed(width),
        ("u", 1 | 2 | 4 | 8) => Number::Unsigned(width),
        _ => return None,
    };
    matches!(order, "<" | ">" | "|").then_some((number, order == ">"))
}
