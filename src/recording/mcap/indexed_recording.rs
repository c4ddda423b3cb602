//! A recording with an index of its shots: the index is built chunk by chunk, and a shot is read on demand.
//!
//! The file may be finished, cut, or still growing: [`IndexedRecording::read_on`] takes what is whole and comes back later for the rest. In
//! memory are the places of the shots and what holds for all of them, never the shots.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use super::container::{self, MAGIC, McapRecord, RECORD_HEADER_BYTES};
use super::error::ReadError;
use super::read::Reader;
use crate::recording::{Shot, TraceSet};

/// Start and length of a part of the file (bytes).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ByteRange {
    start: u64,
    length: u64,
}

/// How far a recording has been read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReadState {
    /// There is more to read.
    More,
    /// Everything that is in the file so far was read; it has no end yet.
    Open,
    /// The recording was finished, and all of it was read.
    Finished,
}

/// A recording on disk.
pub struct IndexedRecording {
    path: PathBuf,
    file: File,
    offset: u64,
    reader: Reader,
    /// Number and place of each shot, in the order of the file.
    shots: Vec<(u32, Vec<ByteRange>)>,
    /// Place in `shots` of each number.
    known: BTreeMap<u32, usize>,
    end: ReadState,
}

impl IndexedRecording {
    /// Opens `path` and looks at its first bytes only.
    ///
    /// # Errors
    /// [`ReadError`] when it cannot be read or is no MCAP file.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let failed = |source| ReadError::File { file: path.to_owned(), source };
        let mut file = File::open(path).map_err(failed)?;
        let mut head = Vec::new();
        file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut head).map_err(failed)?;
        if head != MAGIC {
            let found = if head.is_empty() {
                "an empty file".to_owned()
            } else {
                head.escape_ascii().to_string()
            };
            return Err(ReadError::NotMcap { file: path.to_owned(), found });
        }
        Ok(Self {
            path: path.to_owned(),
            file,
            offset: MAGIC.len() as u64,
            reader: Reader::default(),
            shots: Vec::new(),
            known: BTreeMap::new(),
            end: ReadState::More,
        })
    }

    /// Takes the next record, if it is whole.
    ///
    /// # Errors
    /// [`ReadError::File`] where the file cannot be read any more.
    pub fn read_on(&mut self) -> Result<ReadState, ReadError> {
        if self.end == ReadState::Finished {
            return Ok(self.end);
        }
        let here = self.offset;
        let Some(record) = self.record_at(here)? else {
            self.end = ReadState::Open;
            return Ok(self.end);
        };
        let stretch = ByteRange { start: here, length: record.len() as u64 };
        self.offset += stretch.length;
        if is_end(&record) {
            self.end = ReadState::Finished;
            return Ok(self.end);
        }
        self.reader.take(&record, stretch.start);
        for number in self.reader.forget_shots() {
            self.note(number, stretch);
        }
        self.end = ReadState::More;
        Ok(self.end)
    }

    /// The bytes of the record at `offset`; none where it is not whole.
    fn record_at(&mut self, offset: u64) -> Result<Option<Vec<u8>>, ReadError> {
        let failed = |source| ReadError::File { file: self.path.clone(), source };
        let size = self.file.metadata().map_err(failed)?.len();
        let Some(left) =
            size.checked_sub(offset).filter(|left| *left >= RECORD_HEADER_BYTES as u64)
        else {
            return Ok(None);
        };
        let mut head = [0; RECORD_HEADER_BYTES];
        self.file.seek(SeekFrom::Start(offset)).map_err(failed)?;
        self.file.read_exact(&mut head).map_err(failed)?;
        let length = container::body_length(&head);
        if length > left - RECORD_HEADER_BYTES as u64 {
            return Ok(None);
        }
        let mut record = head.to_vec();
        self.file.by_ref().take(length).read_to_end(&mut record).map_err(failed)?;
        Ok((record.len() as u64 == RECORD_HEADER_BYTES as u64 + length).then_some(record))
    }

    fn note(&mut self, number: u32, stretch: ByteRange) {
        let place = *self.known.entry(number).or_insert_with(|| {
            self.shots.push((number, Vec::new()));
            self.shots.len() - 1
        });
        if let Some((_, stretches)) = self.shots.get_mut(place) {
            stretches.push(stretch);
        }
    }

    /// How far the recording has been read.
    pub fn end(&self) -> ReadState {
        self.end
    }

    /// How many shots were found so far. The last one counts when nothing follows it: until then it may not be whole.
    pub fn shots(&self) -> usize {
        let unfinished = usize::from(self.end == ReadState::More);
        self.shots.len().saturating_sub(unfinished)
    }

    /// Of how many pieces of the file the shot at `place` is made so far; more may come as long as the file grows.
    pub fn pieces(&self, place: usize) -> usize {
        self.shots.get(place).map_or(0, |(_, stretches)| stretches.len())
    }

    /// Contents found so far beside the shots: facts, attachments, log, problems.
    pub fn facts(&self) -> TraceSet {
        self.reader.facts()
    }

    /// Reads the shot at `place`, counted from 0; none beyond the last.
    ///
    /// # Errors
    /// [`ReadError::File`] where the file cannot be read any more.
    pub fn shot(&mut self, place: usize) -> Result<Option<Shot>, ReadError> {
        let Some((number, stretches)) = self.shots.get(place).cloned() else { return Ok(None) };
        let mut reader = self.reader.again();
        for stretch in stretches {
            if let Some(record) = self.record_at(stretch.start)? {
                reader.take(&record, stretch.start);
            }
        }
        Ok(reader.shot_of(number))
    }
}

/// Reads one record at a time, and keeps no shots.
impl Reader {
    /// Takes one record, whole with its head, from `offset` in the file.
    fn take(&mut self, record: &[u8], offset: u64) {
        let offset = usize::try_from(offset).unwrap_or(usize::MAX);
        let parsed =
            container::split(record).and_then(|(opcode, body, _)| container::parse(opcode, body));
        match parsed {
            Ok(McapRecord::Chunk(records)) => self.chunk(&records, offset),
            Ok(record) => self.record(record, offset),
            Err(error) => self.problem(format!("byte {offset}: {error}")),
        }
    }

    /// Numbers of the shots found since the last call; their data are dropped.
    fn forget_shots(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.shots).into_keys().collect()
    }

    /// One that knows this one's channels and has met no shot.
    fn again(&self) -> Self {
        let mut other = Self::default();
        other.schemas.clone_from(&self.schemas);
        other.channels.clone_from(&self.channels);
        other
    }

    /// The shot of a number, if it was met.
    fn shot_of(mut self, number: u32) -> Option<Shot> {
        self.shots.remove(&number)
    }

    /// Everything but the shots.
    fn facts(&self) -> TraceSet {
        self.set.clone()
    }
}

/// Whether `record` ends the data, so that nothing but a summary follows.
fn is_end(record: &[u8]) -> bool {
    let parsed =
        container::split(record).and_then(|(opcode, body, _)| container::parse(opcode, body));
    matches!(parsed, Ok(McapRecord::DataEnd(_)))
}
