//! A recording with an index of its shots: the index is built chunk by chunk, and a shot is read on
//! demand.
//!
//! The file may be finished, cut, or still growing: [`IndexedRecording::read_on`] takes what is
//! whole and comes back later for the rest. In memory are the places of the shots and what holds
//! for all of them, never the shots.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use super::container::{self, MAGIC, McapRecord, RECORD_HEADER_BYTES};
use super::error::ReadError;
use super::message::ShotNotes;
use super::read::{MAX_UNPACKED_BYTES, Reader};
use crate::recording::{Direction, ScpiLine, Shot, TraceSet};

/// What is said of a recording that may still grow.
const NO_END: &str = "the file has no end: it was not finished, or cut";
/// Lines of the log that are kept: of a session that goes on for days, the last ones.
const LOG_LINES: usize = 1000;
/// Messages of the remote interface that are read with a shot, before it and after it each.
const NEIGHBOURING_LINES: usize = 500;
/// Connections that are told apart.
const MOST_PEERS: usize = 1000;

/// What went over the remote interface: how much, not what.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Traffic {
    /// Commands.
    pub commands: usize,
    /// Replies.
    pub replies: usize,
    /// Clients, a thousand at most.
    pub peers: BTreeSet<String>,
}

impl Traffic {
    /// Counts a line.
    pub fn count(&mut self, line: &ScpiLine) {
        match line.direction {
            Direction::Command => self.commands += 1,
            Direction::Reply => self.replies += 1,
        }
        if self.peers.len() < MOST_PEERS {
            self.peers.insert(line.peer.clone());
        }
    }
}

/// Start and length of a part of the file (bytes).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ByteRange {
    start: u64,
    length: u64,
}

/// A part of the file with messages of the remote interface, and the times of its first and last
/// one (ns since 1970).
#[derive(Debug, Clone, Copy)]
struct LineRange {
    first_ns: u64,
    last_ns: u64,
    range: ByteRange,
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
    /// When each shot of `known` was taken (ns since 1970).
    times: BTreeMap<u32, u64>,
    lines: Vec<LineRange>,
    end: ReadState,
    traffic: Traffic,
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
            times: BTreeMap::new(),
            lines: Vec::new(),
            end: ReadState::More,
            traffic: Traffic::default(),
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
        let times = self.reader.shots.values().map(|shot| (shot.number, shot.timestamp_ns));
        self.times.extend(times);
        for number in self.reader.forget_shots() {
            self.note(number, stretch);
        }
        let lines = self.reader.forget_traffic();
        let times = || lines.iter().map(|line| line.timestamp_ns);
        if let (Some(first_ns), Some(last_ns)) = (times().min(), times().max()) {
            self.lines.push(LineRange { first_ns, last_ns, range: stretch });
        }
        for line in &lines {
            self.traffic.count(line);
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

    /// How many shots were found so far. The last one counts when nothing follows it: until then it
    /// may not be whole.
    pub fn shots(&self) -> usize {
        let unfinished = usize::from(self.end == ReadState::More);
        self.shots.len().saturating_sub(unfinished)
    }

    /// Where the shot of a number stands.
    pub fn place_of(&self, number: u32) -> Option<usize> {
        self.known.get(&number).copied()
    }

    /// Of how many pieces of the file the shot at `place` is made so far; more may come as long as
    /// the file grows.
    pub fn pieces(&self, place: usize) -> usize {
        self.shots.get(place).map_or(0, |(_, stretches)| stretches.len())
    }

    /// Parts of the file found so far with messages of the remote interface around the shot at
    /// `place`.
    pub fn line_pieces(&self, place: usize) -> usize {
        self.line_ranges(place).count()
    }

    fn line_ranges(&self, place: usize) -> impl Iterator<Item = ByteRange> {
        let (from, to) = self.span_of(place);
        let inside = move |part: &&LineRange| part.last_ns >= from && part.first_ns <= to;
        self.lines.iter().filter(inside).map(|part| part.range)
    }

    /// From the shot before the one at `place` to the one after it (ns since 1970).
    fn span_of(&self, place: usize) -> (u64, u64) {
        let time = |place: usize| self.times.get(&self.shots.get(place)?.0).copied();
        let before = place.checked_sub(1).and_then(time);
        (before.map_or(0, |at| at + 1), time(place + 1).unwrap_or(u64::MAX))
    }

    /// Reads the messages of the remote interface from the shot before the one at `place` to the
    /// shot after it, in order; of many the nearest.
    ///
    /// # Errors
    /// [`ReadError::File`] where the file cannot be read any more.
    pub fn lines_around(&mut self, place: usize) -> Result<Vec<ScpiLine>, ReadError> {
        let (from, to) = self.span_of(place);
        let mut reader = self.reader.again();
        for range in self.line_ranges(place).collect::<Vec<ByteRange>>() {
            if let Some(record) = self.record_at(range.start)? {
                reader.take(&record, range.start);
            }
            reader.shots.clear();
        }
        let mut lines = std::mem::take(&mut reader.set.lines);
        lines.retain(|line| (from..=to).contains(&line.timestamp_ns));
        let shot = self.shots.get(place).and_then(|(number, _)| self.times.get(number));
        let before = lines.partition_point(|line| Some(&line.timestamp_ns) <= shot);
        lines.truncate(before + NEIGHBOURING_LINES);
        Ok(lines.split_off(before.saturating_sub(NEIGHBOURING_LINES)))
    }

    /// What was found so far beside the shots: facts, attachments, the end of the log, problems.
    pub fn facts(&self) -> TraceSet {
        let mut facts = self.reader.facts();
        if self.end == ReadState::Open {
            facts.problems.push(NO_END.to_owned());
        }
        facts
    }

    /// What went over the remote interface so far.
    pub fn traffic(&self) -> &Traffic {
        &self.traffic
    }

    /// Reads the shot at `place`, counted from 0, with what is kept of it beside captures and
    /// truth; none where there is none.
    ///
    /// # Errors
    /// [`ReadError::File`] where the file cannot be read any more.
    pub fn shot_and_notes(&mut self, place: usize) -> Result<Option<(Shot, ShotNotes)>, ReadError> {
        let Some(mut reader) = self.read_again(place)? else { return Ok(None) };
        let Some((number, _)) = self.shots.get(place) else { return Ok(None) };
        let notes = reader.set.notes.remove(number).unwrap_or_default();
        Ok(reader.shot_of(*number).map(|shot| (shot, notes)))
    }

    /// Reads the shot at `place`, counted from 0; none beyond the last.
    ///
    /// # Errors
    /// [`ReadError::File`] where the file cannot be read any more.
    pub fn shot(&mut self, place: usize) -> Result<Option<Shot>, ReadError> {
        Ok(self.shot_and_notes(place)?.map(|(shot, _)| shot))
    }

    fn read_again(&mut self, place: usize) -> Result<Option<Reader>, ReadError> {
        let Some((_, stretches)) = self.shots.get(place).cloned() else { return Ok(None) };
        let mut reader = self.reader.again();
        for stretch in stretches {
            if let Some(record) = self.record_at(stretch.start)? {
                reader.take(&record, stretch.start);
            }
        }
        Ok(Some(reader))
    }
}

/// Reads one record at a time, and keeps no shots.
impl Reader {
    /// Takes one record, whole with its head, from `offset` in the file.
    fn take(&mut self, record: &[u8], offset: u64) {
        // Little of it is kept: each record has the room of a whole file.
        self.budget = MAX_UNPACKED_BYTES;
        let offset = usize::try_from(offset).unwrap_or(usize::MAX);
        let parsed =
            container::split(record).and_then(|(opcode, body, _)| container::parse(opcode, body));
        match parsed {
            Ok(McapRecord::Chunk(records)) => self.chunk(&records, offset),
            Ok(record) => self.record(record, offset),
            Err(error) => self.problem(format!("byte {offset}: {error}")),
        }
    }

    /// Numbers of the shots of which something was found since the last call; their data are
    /// dropped.
    fn forget_shots(&mut self) -> Vec<u32> {
        let mut numbers: BTreeSet<u32> = std::mem::take(&mut self.shots).into_keys().collect();
        // What is kept beside a shot may stand in a later chunk than the shot; what stands before
        // the first belongs to none.
        numbers
            .extend(std::mem::take(&mut self.set.notes).into_keys().filter(|number| *number > 0));
        numbers.into_iter().collect()
    }

    /// Lines of the remote interface since the last call. They are dropped, and so are old lines of
    /// the log.
    fn forget_traffic(&mut self) -> Vec<ScpiLine> {
        let log = &mut self.set.log;
        if log.len() >= 2 * LOG_LINES {
            log.drain(..log.len() - LOG_LINES);
        }
        std::mem::take(&mut self.set.lines)
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
