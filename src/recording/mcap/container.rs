//! The container's records, read defensively: every length is checked against what is there before
//! anything is allocated, and one bad chunk costs only itself.
//!
//! The container's own library allocates what a damaged file asks for and panics on attachments
//! shorter than their checksum, so the few records that matter are taken apart here. Source: MCAP
//! specification 0x00.

use std::collections::BTreeMap;

/// First and last bytes of every file.
pub const MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', 0x30, b'\r', b'\n'];
/// Length of what stands before a record's body: its opcode and the body's length (bytes).
pub const RECORD_HEADER_BYTES: usize = 9;
/// Length of the body of the record that ends the data (bytes).
pub const DATA_END_BYTES: u64 = 4;
/// Largest uncompressed chunk that is unpacked: a thousand times what this program writes.
const MAX_CHUNK_BYTES: u64 = 256 * 1024 * 1024;

/// A record that matters.
#[derive(Debug)]
pub enum McapRecord<'a> {
    /// Opcode 0x03: id, name.
    Schema(u16, String),
    /// Opcode 0x04.
    Channel {
        /// Identifier in messages.
        id: u16,
        /// Schema identifier.
        schema: u16,
        /// Topic.
        topic: String,
        /// Encoding of the messages.
        encoding: String,
    },
    /// Opcode 0x05.
    Message {
        /// Channel identifier.
        channel: u16,
        /// Nanoseconds since 1970.
        log_time: u64,
        /// Encoded message.
        data: &'a [u8],
    },
    /// Opcode 0x06: the records inside, unpacked.
    Chunk(Vec<u8>),
    /// Opcode 0x09: name, media type, content.
    Attachment(String, String, &'a [u8]),
    /// Opcode 0x0C.
    Metadata(String, BTreeMap<String, String>),
    /// Opcode 0x0F: checksum of everything before, 0 if there is none. The summary follows, which
    /// repeats what is known.
    DataEnd(u32),
    /// Everything else.
    Other,
}

/// A cursor over bytes that never reads beyond them.
struct Cursor<'a> {
    rest: &'a [u8],
}

impl<'a> Cursor<'a> {
    fn take(&mut self, length: u64) -> Result<&'a [u8], String> {
        let available = self.rest.len();
        let wanted = usize::try_from(length).ok().filter(|wanted| *wanted <= available);
        let Some((head, tail)) = wanted.and_then(|wanted| self.rest.split_at_checked(wanted))
        else {
            return Err(format!("found {available} bytes, expected {length}"));
        };
        self.rest = tail;
        Ok(head)
    }

    fn number<const N: usize>(&mut self) -> Result<[u8; N], String> {
        self.take(N as u64)?.try_into().map_err(|_| "found too few bytes for a number".to_owned())
    }

    fn u16(&mut self) -> Result<u16, String> {
        self.number().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Result<u32, String> {
        self.number().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, String> {
        self.number().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Result<String, String> {
        let length = self.u32()?;
        let bytes = self.take(u64::from(length))?;
        String::from_utf8(bytes.to_vec()).map_err(|_| "found text that is no UTF-8".to_owned())
    }
}

/// Whether [`parse`] reads records of this opcode.
pub fn is_known(opcode: u8) -> bool {
    matches!(opcode, 0x03..=0x06 | 0x09 | 0x0C | 0x0F)
}

/// Length of the body that follows `head`, the first bytes of a record (bytes).
pub fn body_length(head: &[u8; RECORD_HEADER_BYTES]) -> u64 {
    let [_, length @ ..] = *head;
    u64::from_le_bytes(length)
}

/// Takes the record at the start of `bytes`; returns its opcode, body and what follows.
///
/// # Errors
/// The missing part of an incomplete record.
pub fn split(bytes: &[u8]) -> Result<(u8, &[u8], &[u8]), String> {
    let mut cursor = Cursor { rest: bytes };
    let [opcode] = cursor.number::<1>()?;
    let length = cursor.u64()?;
    let body = cursor.take(length)?;
    Ok((opcode, body, cursor.rest))
}

/// Reads one record's body.
///
/// # Errors
/// The problem, as a message.
pub fn parse(opcode: u8, body: &[u8]) -> Result<McapRecord<'_>, String> {
    let mut cursor = Cursor { rest: body };
    match opcode {
        0x03 => Ok(McapRecord::Schema(cursor.u16()?, cursor.text()?)),
        0x04 => {
            let (id, schema) = (cursor.u16()?, cursor.u16()?);
            let (topic, encoding) = (cursor.text()?, cursor.text()?);
            Ok(McapRecord::Channel { id, schema, topic, encoding })
        }
        0x05 => {
            let channel = cursor.u16()?;
            let _sequence = cursor.u32()?;
            let log_time = cursor.u64()?;
            let _publish_time = cursor.u64()?;
            Ok(McapRecord::Message { channel, log_time, data: cursor.rest })
        }
        0x06 => chunk(cursor).map(McapRecord::Chunk),
        0x09 => attachment(body, cursor),
        0x0C => {
            let name = cursor.text()?;
            let length = cursor.u32()?;
            let mut pairs = Cursor { rest: cursor.take(u64::from(length))? };
            let mut facts = BTreeMap::new();
            while !pairs.rest.is_empty() {
                facts.insert(pairs.text()?, pairs.text()?);
            }
            Ok(McapRecord::Metadata(name, facts))
        }
        0x0F => cursor.u32().map(McapRecord::DataEnd),
        _ => Ok(McapRecord::Other),
    }
}

fn chunk(mut cursor: Cursor<'_>) -> Result<Vec<u8>, String> {
    let _times = (cursor.u64()?, cursor.u64()?);
    let uncompressed_size = cursor.u64()?;
    let checksum = cursor.u32()?;
    let compression = cursor.text()?;
    let length = cursor.u64()?;
    let packed = cursor.take(length)?;
    if uncompressed_size > MAX_CHUNK_BYTES {
        return Err(format!(
            "found a chunk of {uncompressed_size} bytes, expected at most {MAX_CHUNK_BYTES}"
        ));
    }
    let capacity = usize::try_from(uncompressed_size).map_err(|e| e.to_string())?;
    let bytes = match compression.as_str() {
        "" => packed.to_vec(),
        "zstd" => zstd::bulk::decompress(packed, capacity)
            .map_err(|error| format!("found a chunk that does not unpack ({error})"))?,
        other => {
            return Err(format!("found compression `{other}`, expected zstd or none"));
        }
    };
    if bytes.len() != capacity {
        return Err(format!("found a chunk of {} bytes, expected {capacity}", bytes.len()));
    }
    let found = crc32fast::hash(&bytes);
    if checksum != 0 && checksum != found {
        return Err(format!("found checksum {found:08x}, expected {checksum:08x}"));
    }
    Ok(bytes)
}

fn attachment<'a>(body: &[u8], mut cursor: Cursor<'a>) -> Result<McapRecord<'a>, String> {
    let _times = (cursor.u64()?, cursor.u64()?);
    let (name, media_type) = (cursor.text()?, cursor.text()?);
    let length = cursor.u64()?;
    let data = cursor.take(length)?;
    let covered = body.len() - cursor.rest.len();
    let checksum = cursor.u32()?;
    let found = crc32fast::hash(body.get(..covered).unwrap_or_default());
    if checksum != 0 && checksum != found {
        return Err(format!(
            "found checksum {found:08x} in attachment {name}, expected {checksum:08x}"
        ));
    }
    Ok(McapRecord::Attachment(name, media_type, data))
}
