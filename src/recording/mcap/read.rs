//! Reads recordings, finished, unfinished or damaged: what is sound is kept, what is not is named.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use prost::Message as _;

use super::container::{self, MAGIC, Record};
use super::decode::capture;
use super::message;
use super::schema::Schema;
use crate::recording::{Attachment, Origin, Shot, TraceSet};
use crate::trace::Trace;

/// Largest file that is read into memory.
pub const LARGEST_FILE: u64 = 4 * 1024 * 1024 * 1024;
/// More problems than this are counted but not listed.
const MOST_PROBLEMS: usize = 100;

/// Why a file is no recording at all.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be read.
    #[error("{file}: {source}")]
    File {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is too large to be held in memory.
    #[error("{file}: found {bytes} bytes, expected at most {LARGEST_FILE}")]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// It does not begin like MCAP.
    #[error("{file}: found {found}, expected an MCAP file, which begins with \\x89MCAP0\\r\\n")]
    NotMcap {
        /// The file.
        file: PathBuf,
        /// Its first bytes, escaped.
        found: String,
    },
    /// MCAP, but nothing of ours in it.
    #[error("{file}: found an MCAP file without a single readable capture, series or fact{}, expected a recording", because(.first.as_ref()))]
    Empty {
        /// The file.
        file: PathBuf,
        /// The first problem met.
        first: Option<String>,
    },
}

fn because(problem: Option<&String>) -> String {
    problem.map(|p| format!(" ({p})")).unwrap_or_default()
}

/// Reads `file`.
///
/// # Errors
/// [`ReadError`] when nothing can be had from it; lesser damage is listed in [`TraceSet::problems`].
pub fn read(file: &Path) -> Result<TraceSet, ReadError> {
    let path = || file.to_owned();
    let size =
        std::fs::metadata(file).map_err(|source| ReadError::File { file: path(), source })?;
    if size.len() > LARGEST_FILE {
        return Err(ReadError::TooLarge { file: path(), bytes: size.len() });
    }
    let bytes = std::fs::read(file).map_err(|source| ReadError::File { file: path(), source })?;
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
    let mut reader = Reader::default();
    reader.data_section(records);
    let set = reader.finish();
    if set.shots.is_empty() && set.metadata.is_empty() && set.attachments.is_empty() {
        let first = set.problems.into_iter().next();
        return Err(ReadError::Empty { file: file.to_owned(), first });
    }
    Ok(set)
}

#[derive(Default)]
struct Reader {
    set: TraceSet,
    schemas: BTreeMap<u16, String>,
    /// Topic and schema name by channel.
    channels: BTreeMap<u16, (String, String)>,
    shots: BTreeMap<u32, Shot>,
    unlisted: usize,
}

impl Reader {
    fn problem(&mut self, text: String) {
        if self.set.problems.len() < MOST_PROBLEMS {
            self.set.problems.push(text);
        } else {
            self.unlisted += 1;
        }
    }

    /// Goes through the data section; the summary behind it only repeats.
    fn data_section(&mut self, mut rest: &[u8]) {
        let whole = rest.len();
        let mut ended = false;
        while !rest.is_empty() && !rest.starts_with(&MAGIC) {
            let offset = whole - rest.len() + MAGIC.len();
            let (opcode, body, tail) = match container::split(rest) {
                Ok(parts) => parts,
                Err(error) => {
                    self.problem(format!("byte {offset}: the file breaks off: {error}"));
                    return;
                }
            };
            rest = tail;
            match container::parse(opcode, body) {
                Ok(Record::Chunk(records)) => self.chunk(&records, offset),
                Ok(Record::DataEnd) => {
                    ended = true;
                    break;
                }
                Ok(record) => self.record(record, offset),
                Err(error) => self.problem(format!("byte {offset}: {error}")),
            }
        }
        if !ended {
            self.problem("the file has no end: it was not finished, or cut".to_owned());
        }
    }

    fn chunk(&mut self, mut rest: &[u8], offset: usize) {
        while !rest.is_empty() {
            match container::split(rest) {
                Ok((opcode, body, tail)) => {
                    rest = tail;
                    match container::parse(opcode, body) {
                        // A chunk in a chunk is not allowed, and could nest without end.
                        Ok(Record::Chunk(_)) => {
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

    fn record(&mut self, record: Record<'_>, offset: usize) {
        match record {
            Record::Schema(id, name) => {
                self.schemas.insert(id, name);
            }
            Record::Channel { id, schema, topic, encoding } => {
                let name = self.schemas.get(&schema).cloned().unwrap_or_default();
                if encoding == "protobuf" {
                    self.channels.insert(id, (topic, name));
                } else {
                    self.problem(format!(
                        "{topic}: found encoding `{encoding}`, expected protobuf"
                    ));
                }
            }
            Record::Message { channel, log_time, data } => {
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
            Record::Attachment(name, media_type, data) => {
                self.set.attachments.push(Attachment { name, media_type, data: data.to_vec() });
            }
            Record::Metadata(name, facts) => {
                self.set.metadata.insert(name, facts);
            }
            Record::Chunk(_) | Record::DataEnd | Record::Other => {}
        }
    }

    fn message(&mut self, schema: &str, log_time: u64, data: &[u8]) -> Result<(), String> {
        let undecodable =
            |error: prost::DecodeError| format!("found a message that is no {schema} ({error})");
        if schema == Schema::Capture.name() {
            let message = message::Capture::decode(data).map_err(undecodable)?;
            let capture = capture(&message)?;
            let shot = self.shot(message.shot, log_time);
            shot.origin =
                if message.origin == "measured" { Origin::Measured } else { Origin::Simulated };
            shot.trigger_time = message.trigger_time_s;
            shot.captures.push(capture);
        } else if schema == Schema::Series.name() {
            let message = message::Series::decode(data).map_err(undecodable)?;
            if !(message.t0_s.is_finite() && message.dt_s.is_finite() && message.dt_s > 0.0) {
                return Err(format!(
                    "found times {} + i * {} s, expected finite, increasing ones",
                    message.t0_s, message.dt_s
                ));
            }
            let shot = self.shot(message.shot, log_time);
            shot.truth.push(Trace {
                name: message.name,
                unit: message.unit,
                start: message.t0_s,
                interval: message.dt_s,
                values: message.values,
            });
        } else if schema == Schema::Log.name() {
            let message = message::Log::decode(data).map_err(undecodable)?;
            self.set.log.push(message.message);
        }
        Ok(())
    }

    fn shot(&mut self, number: u32, timestamp_ns: u64) -> &mut Shot {
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
