//! Reads recordings, finished, unfinished or damaged: what is sound is kept, what is not is named.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::Path;

use prost::Message as _;

use super::container::{self, MAGIC, McapRecord};
use super::decode;
use super::error::{LARGEST_FILE, ReadError};
use super::message;
use super::message::ShotNotes;
use super::schema::Schema;
use crate::recording::{Attachment, Origin, Shot, TraceSet};

/// More problems than this are counted but not listed.
const MAX_LISTED_PROBLEMS: usize = 100;
/// All that is kept of a file may take this and [`MAX_EXPANSION`] times the file's size (bytes).
pub(super) const MAX_UNPACKED_BYTES: u64 = 256 * 1024 * 1024;
/// What an object takes beside its content, as a message, a fact or a line of the log does (bytes).
const OBJECT_BYTES: u64 = 128;
/// Recordings shrink to a third or so; on the whole only a bomb shrinks to a hundredth (1).
const MAX_EXPANSION: u64 = 100;

/// Reads `file`.
///
/// # Errors
/// [`ReadError`] when nothing can be had from it; lesser damage is listed in
/// [`TraceSet::problems`].
pub fn read(file: &Path) -> Result<TraceSet, ReadError> {
    let path = || file.to_owned();
    let failed = |source| ReadError::File { file: path(), source };
    let opened = std::fs::File::open(file).map_err(failed)?;
    let size = opened.metadata().map_err(failed)?.len();
    if size > LARGEST_FILE {
        return Err(ReadError::TooLarge { file: path(), bytes: size });
    }
    // A device tells no size, and may have no end.
    let mut bytes = Vec::new();
    opened.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(ReadError::TooLarge { file: path(), bytes: bytes.len() as u64 });
    }
    read_bytes(&bytes, file)
}

/// Reads a recording from memory; `file` is its name in errors.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8], file: &Path) -> Result<TraceSet, ReadError> {
    let Some(records) = bytes.strip_prefix(&MAGIC) else {
        let head = bytes.get(..bytes.len().min(MAGIC.len())).unwrap_or_default();
        let found = if head.is_empty() {
            "an empty file".to_owned()
        } else {
            head.escape_ascii().to_string()
        };
        return Err(ReadError::NotMcap { file: file.to_owned(), found });
    };
    let budget = MAX_UNPACKED_BYTES + MAX_EXPANSION * bytes.len() as u64;
    let mut reader = Reader { budget, ..Reader::default() };
    reader.data_section(records);
    let set = reader.finish();
    if set == (TraceSet { problems: set.problems.clone(), ..TraceSet::default() }) {
        let first = set.problems.into_iter().next();
        return Err(ReadError::Empty { file: file.to_owned(), first });
    }
    Ok(set)
}

/// Puts records together to a recording.
#[derive(Default)]
pub(super) struct Reader {
    pub(super) set: TraceSet,
    pub(super) schemas: BTreeMap<u16, String>,
    /// Topic and schema name by channel.
    pub(super) channels: BTreeMap<u16, (String, String)>,
    pub(super) shots: BTreeMap<u32, Shot>,
    /// The shot whose messages are being read: lines of the log belong to it.
    current: u32,
    /// Bytes that may still be unpacked and kept.
    pub(super) budget: u64,
    unlisted: usize,
    /// Whether something was passed over for want of room.
    is_full: bool,
}

impl Reader {
    pub(super) fn problem(&mut self, text: String) {
        if self.set.problems.len() < MAX_LISTED_PROBLEMS {
            self.set.problems.push(text);
        } else {
            self.unlisted += 1;
        }
    }

    /// Goes through the data section; the summary behind it only repeats.
    fn data_section(&mut self, records: &[u8]) {
        let mut rest = records;
        while !rest.is_empty() && !rest.starts_with(&MAGIC) {
            let start = records.len() - rest.len();
            let offset = start + MAGIC.len();
            let (opcode, body, tail) = match container::split(rest) {
                Ok(parts) => parts,
                Err(error) => {
                    self.problem(format!("byte {offset}: the file breaks off: {error}"));
                    return;
                }
            };
            rest = tail;
            match container::parse(opcode, body) {
                Ok(McapRecord::Chunk(records)) => {
                    if !self.spend(records.len() as u64) {
                        self.problem(format!(
                            "byte {offset}: found chunks that unpack to more than {MAX_EXPANSION} times the file, expected a recording"
                        ));
                        return;
                    }
                    self.chunk(&records, offset);
                }
                Ok(McapRecord::DataEnd(checksum)) => {
                    self.end(checksum, records.get(..start).unwrap_or_default(), tail);
                    return;
                }
                Ok(record) => self.record(record, offset),
                Err(error) => self.problem(format!("byte {offset}: {error}")),
            }
        }
        self.problem("the file has no end: it was not finished, or cut".to_owned());
    }

    /// Holds the data section against its checksum, and looks whether the file goes on to its end.
    fn end(&mut self, checksum: u32, records: &[u8], summary: &[u8]) {
        let mut hasher = crc32fast::Hasher::new();
        hasher.update(&MAGIC);
        hasher.update(records);
        let found = hasher.finalize();
        if checksum != 0 && checksum != found {
            self.problem(format!(
                "found checksum {found:08x} of all data, expected {checksum:08x}: something was changed"
            ));
        }
        if !summary.ends_with(&MAGIC) {
            self.problem("the file is cut behind its data, which are whole".to_owned());
        }
    }

    pub(super) fn chunk(&mut self, mut rest: &[u8], offset: usize) {
        while !rest.is_empty() {
            match container::split(rest) {
                Ok((opcode, body, tail)) => {
                    rest = tail;
                    match container::parse(opcode, body) {
                        // A chunk in a chunk is not allowed, and could nest without end.
                        Ok(McapRecord::Chunk(_)) => {
                            self.problem(format!("byte {offset}: found a chunk inside a chunk"));
                        }
                        Ok(record) => self.record(record, offset),
                        Err(error) => self.problem(format!("chunk at byte {offset}: {error}")),
                    }
                }
                Err(error) => {
                    self.problem(format!("chunk at byte {offset}: {error}"));
                    return;
                }
            }
        }
    }

    /// Takes what is needed from the budget; false, and nothing taken, where there is less left.
    fn spend(&mut self, bytes: u64) -> bool {
        let left = self.budget.checked_sub(bytes);
        self.budget = left.unwrap_or(self.budget);
        left.is_some()
    }

    /// Whether there is room for the objects of a record; its bytes are counted where they are
    /// unpacked.
    fn has_room(&mut self, record: &McapRecord<'_>) -> bool {
        let objects = match record {
            McapRecord::Schema(..) => 1,
            McapRecord::Channel { .. } | McapRecord::Message { .. } => 2,
            McapRecord::Attachment(..) => 3,
            McapRecord::Metadata(_, facts) => 1 + 2 * facts.len(),
            McapRecord::Chunk(_) | McapRecord::DataEnd(_) | McapRecord::Other => 0,
        };
        self.spend(OBJECT_BYTES * objects as u64)
    }

    pub(super) fn record(&mut self, record: McapRecord<'_>, offset: usize) {
        if !self.has_room(&record) {
            if !self.is_full {
                self.is_full = true;
                self.problem(format!(
                    "byte {offset}: found more than a recording of this size holds: what follows is passed over"
                ));
            }
            return;
        }
        match record {
            McapRecord::Schema(id, name) => {
                self.schemas.insert(id, name);
            }
            McapRecord::Channel { id, schema, topic, encoding } => {
                self.channel(id, schema, topic, &encoding);
            }
            McapRecord::Message { channel, log_time, data } => {
                let Some((topic, schema)) = self.channels.get(&channel).cloned() else {
                    self.problem(format!(
                        "byte {offset}: found a message on the undeclared channel {channel}"
                    ));
                    return;
                };
                if let Err(error) = self.message(&schema, log_time, data) {
                    self.problem(format!("{topic}: {error}"));
                }
            }
            McapRecord::Attachment(name, media_type, data) => {
                self.set.attachments.push(Attachment { name, media_type, data: data.to_vec() });
            }
            McapRecord::Metadata(name, facts) => {
                self.set.metadata.insert(name, facts);
            }
            McapRecord::Chunk(_) | McapRecord::DataEnd(_) | McapRecord::Other => {}
        }
    }

    fn channel(&mut self, id: u16, schema: u16, topic: String, encoding: &str) {
        let name = self.schemas.get(&schema).cloned().unwrap_or_default();
        let declared = (topic, name);
        if self.channels.get(&id) == Some(&declared) {
            return;
        }
        let (topic, name) = &declared;
        if encoding != "protobuf" {
            self.problem(format!("{topic}: found encoding `{encoding}`, expected protobuf"));
            return;
        }
        if !Schema::ALL.iter().any(|schema| schema.name() == name) {
            self.problem(format!("{topic}: found messages of the kind `{name}`, expected one of hertzscope's: they are passed over"));
        }
        self.channels.insert(id, declared);
    }

    fn message(&mut self, schema: &str, log_time: u64, data: &[u8]) -> Result<(), String> {
        let undecodable =
            |error: prost::DecodeError| format!("found a message that is no {schema} ({error})");
        if schema == Schema::Capture.name() {
            let message = message::CaptureMessage::decode(data).map_err(undecodable)?;
            let capture = decode::capture(&message)?;
            let shot = self.shot(message.shot, log_time);
            let source = capture.waveform.source;
            if shot.captures.iter().any(|other| other.waveform.source == source) {
                return Err(format!("found a second capture of {source} in shot {}", shot.number));
            }
            shot.origin =
                if message.origin == "measured" { Origin::Measured } else { Origin::Simulated };
            shot.trigger_time = message.trigger_time_s;
            shot.captures.push(capture);
        } else if schema == Schema::Series.name() {
            let message = message::SeriesMessage::decode(data).map_err(undecodable)?;
            let number = message.shot;
            let trace = decode::series(message)?;
            self.shot(number, log_time).truth.push(trace);
        } else if schema == Schema::Setup.name() {
            let message = message::SetupMessage::decode(data).map_err(undecodable)?;
            let _ = self.shot(message.shot, log_time);
            self.notes().set_up = message.set;
        } else if schema == Schema::Energy.name() {
            let message = message::EnergyMessage::decode(data).map_err(undecodable)?;
            if !message.is_finite() {
                return Err("found an energy that is no finite number, expected one".to_owned());
            }
            let _ = self.shot(message.shot, log_time);
            self.notes().energy = Some(message);
        } else if schema == Schema::Log.name() {
            let message = message::LogMessage::decode(data).map_err(undecodable)?;
            self.set.log.push(message.message.clone());
            self.notes().log.push((message.level >= message::WARNING, message.message));
        } else if schema == Schema::ScpiLine.name() {
            let message = message::ScpiLineMessage::decode(data).map_err(undecodable)?;
            self.set.lines.push(decode::line(message, log_time)?);
        }
        Ok(())
    }

    fn notes(&mut self) -> &mut ShotNotes {
        self.set.notes.entry(self.current).or_default()
    }

    fn shot(&mut self, number: u32, timestamp_ns: u64) -> &mut Shot {
        self.current = number;
        self.shots.entry(number).or_insert_with(|| Shot {
            number,
            origin: Origin::Simulated,
            timestamp_ns,
            captures: Vec::new(),
            truth: Vec::new(),
            trigger_time: None,
        })
    }

    fn finish(mut self) -> TraceSet {
        if self.unlisted > 0 {
            self.set.problems.push(format!("and {} more problems", self.unlisted));
        }
        self.set.shots = self.shots.into_values().collect();
        self.set.shots.sort_by_key(|shot| (shot.timestamp_ns, shot.number));
        self.set
    }
}
