//! Reads recordings of any size: finished, unfinished, damaged, or still growing.
//!
//! [`IndexedRecording`] goes through the file once, record by record. It keeps what holds for all
//! shots (facts, attachments, problems) and where each shot is in the file. A shot is read when it
//! is asked for. What is damaged is reported as a problem; everything else is kept.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use prost::Message as _;

use super::container::{self, DATA_END_BYTES, MAGIC, McapRecord, RECORD_HEADER_BYTES};
use super::decode;
use super::message::{self, ShotNotes};
use super::schema::Schema;
use crate::recording::{Attachment, Direction, Origin, RecordingError, ScpiLine, Shot, TraceSet};
use crate::scope::Source;

/// Largest file that is read into memory (bytes).
const LARGEST_FILE: u64 = 4 * 1024 * 1024 * 1024;
/// More problems than this are counted but not listed.
const MAX_LISTED_PROBLEMS: usize = 100;
/// What is unpacked and kept of a file may take this and [`MAX_EXPANSION`] times its size (bytes).
const MAX_UNPACKED_BYTES: u64 = 256 * 1024 * 1024;
/// Recordings shrink to a third or so; only a file made to do harm shrinks to a hundredth (1).
const MAX_EXPANSION: u64 = 100;
/// What an object takes beside its content, as a message, a fact or a line of the log does (bytes).
const OBJECT_BYTES: u64 = 128;
/// Larger records are passed over: a chunk of this program has 256 KiB (bytes).
const MAX_RECORD_BYTES: u64 = 1 << 30;
/// Bytes that are read at a time.
const READ_BYTES: usize = 256 * 1024;
/// Lines of the log that [`IndexedRecording::facts`] gives: the last ones.
const LOG_LINES: usize = 1000;
/// Messages of the remote interface that are read with a shot, before it and after it each.
const NEIGHBOURING_LINES: usize = 500;
/// Neighbouring records with messages of the remote interface are indexed together up to this size
/// (bytes).
const LINE_RANGE_BYTES: u64 = 256 * 1024;
/// Connections that are told apart.
const MAX_PEERS: usize = 1000;

/// Reads a whole recording from `file`.
///
/// # Errors
/// [`RecordingError`] if nothing can be read from it; lesser damage is listed in
/// [`TraceSet::problems`].
pub fn read(file: &Path) -> Result<TraceSet, RecordingError> {
    IndexedRecording::open(file)?.into_set()
}

/// Reads a recording from memory; `file` is its name in errors.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8], file: &Path) -> Result<TraceSet, RecordingError> {
    IndexedRecording::begin(Box::new(Cursor::new(bytes.to_vec())), file)?.into_set()
}

/// Number of messages on the remote interface, and its clients.
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
        if self.peers.len() < MAX_PEERS && !self.peers.contains(&line.peer) {
            self.peers.insert(line.peer.clone());
        }
    }
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

/// A record of the file, and the shot to which its first lines of the log belong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct RecordPlace {
    start: u64,
    current: u32,
}

/// A shot in the index.
#[derive(Debug)]
struct IndexedShot {
    number: u32,
    /// Nanoseconds since 1970.
    timestamp_ns: u64,
    channels: Vec<Source>,
    records: Vec<RecordPlace>,
}

/// A part of the file with messages of the remote interface, and the times of its first and last
/// one (ns since 1970).
#[derive(Debug, Clone, Copy)]
struct LineRange {
    first_ns: u64,
    last_ns: u64,
    start: u64,
    end: u64,
}

/// A file, or bytes in memory.
trait Input: Read + Seek + Send {
    fn size(&self) -> io::Result<u64>;
}

impl Input for File {
    fn size(&self) -> io::Result<u64> {
        Ok(self.metadata()?.len())
    }
}

impl Input for Cursor<Vec<u8>> {
    fn size(&self) -> io::Result<u64> {
        Ok(self.get_ref().len() as u64)
    }
}

/// A recording with an index of its shots.
pub struct IndexedRecording {
    path: PathBuf,
    input: BufReader<Box<dyn Input>>,
    /// Where `input` reads next.
    position: u64,
    /// Size of the file when it was last looked at (bytes).
    size: u64,
    /// Where the next record of the index begins.
    offset: u64,
    /// Checksum of everything before `offset`.
    checksum: crc32fast::Hasher,
    /// Opcode 0 was found at `offset`.
    is_zero: bool,
    reader: Reader,
    /// In the order of the file.
    shots: Vec<IndexedShot>,
    /// Place in `shots` of each number.
    places: BTreeMap<u32, usize>,
    lines: Vec<LineRange>,
    end: ReadState,
    traffic: Traffic,
    /// The record that was read last for a shot.
    last: Option<(RecordPlace, Reader)>,
}

impl IndexedRecording {
    /// Opens `path` and reads its first bytes only.
    ///
    /// # Errors
    /// [`RecordingError`] if it cannot be read or is not an MCAP file.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let failed = |source| RecordingError::caused(path, source);
        let mut file = File::open(path).map_err(failed)?;
        if file.metadata().map_err(failed)?.is_file() {
            return Self::begin(Box::new(file), path);
        }
        // A pipe or a device has no size, and may have no end.
        let mut bytes = Vec::new();
        file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut bytes).map_err(failed)?;
        if bytes == MAGIC {
            file.take(MAX_UNPACKED_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
        }
        let found = bytes.len() as u64;
        if found > MAX_UNPACKED_BYTES {
            return Err(too_large(path, found, MAX_UNPACKED_BYTES));
        }
        Self::begin(Box::new(Cursor::new(bytes)), path)
    }

    fn begin(mut input: Box<dyn Input>, path: &Path) -> Result<Self, RecordingError> {
        let failed = |source| RecordingError::caused(path, source);
        let mut head = Vec::new();
        (&mut input).take(MAGIC.len() as u64).read_to_end(&mut head).map_err(failed)?;
        if head != MAGIC {
            let found = if head.is_empty() {
                "an empty file".to_owned()
            } else {
                head.escape_ascii().to_string()
            };
            let expected = "an MCAP file, which begins with \\x89MCAP0\\r\\n";
            return Err(RecordingError::found(path.display(), found, expected));
        }
        let size = input.size().map_err(failed)?;
        let mut checksum = crc32fast::Hasher::new();
        checksum.update(&MAGIC);
        Ok(Self {
            path: path.to_owned(),
            input: BufReader::with_capacity(READ_BYTES, input),
            position: MAGIC.len() as u64,
            size,
            offset: MAGIC.len() as u64,
            checksum,
            is_zero: false,
            reader: Reader { allowed: allowed(size), ..Reader::default() },
            shots: Vec::new(),
            places: BTreeMap::new(),
            lines: Vec::new(),
            end: ReadState::More,
            traffic: Traffic::default(),
            last: None,
        })
    }

    fn failed(&self, source: io::Error) -> RecordingError {
        RecordingError::caused(&self.path, source)
    }

    /// Indexes all that is in the file.
    ///
    /// # Errors
    /// [`RecordingError`] if it cannot be read, or if nothing of it is a recording.
    pub fn read_all(&mut self) -> Result<(), RecordingError> {
        while self.read_on()? == ReadState::More {}
        let facts = &self.reader.set;
        let is_empty = facts.metadata.is_empty()
            && facts.attachments.is_empty()
            && facts.log.is_empty()
            && self.shots.is_empty()
            && self.lines.is_empty();
        if is_empty {
            let first = self.facts().problems.into_iter().next();
            let because = first.map(|problem| format!(" ({problem})")).unwrap_or_default();
            let found =
                format!("an MCAP file without a single readable capture, series or fact{because}");
            return Err(RecordingError::found(self.path.display(), found, "a recording"));
        }
        Ok(())
    }

    /// Indexes the next record, if it is whole.
    ///
    /// # Errors
    /// [`RecordingError`] if the file cannot be read any more.
    pub fn read_on(&mut self) -> Result<ReadState, RecordingError> {
        if self.end == ReadState::Finished {
            return Ok(self.end);
        }
        self.end = self.index_record().map_err(|source| self.failed(source))?;
        Ok(self.end)
    }

    fn index_record(&mut self) -> io::Result<ReadState> {
        let start = self.offset;
        let Some((head, end)) = self.head_at(start)? else { return Ok(ReadState::Open) };
        let [opcode, ..] = head;
        self.is_zero = opcode == 0;
        if self.is_zero {
            return Ok(ReadState::Open);
        }
        let length = end - start - RECORD_HEADER_BYTES as u64;
        if !container::is_known(opcode) || length > MAX_RECORD_BYTES {
            if length > MAX_RECORD_BYTES {
                self.reader.problem(format!(
                    "byte {start}: found a record of {length} bytes, expected at most {MAX_RECORD_BYTES}: it is passed over"
                ));
            }
            self.checksum.update(&head);
            self.skip(length)?;
            self.offset = end;
            return Ok(ReadState::More);
        }
        let body = self.body(length)?;
        let place = RecordPlace { start, current: self.reader.current };
        let parsed = container::parse(opcode, &body);
        if let Ok(McapRecord::DataEnd(expected)) = parsed {
            if length != DATA_END_BYTES {
                self.reader.problem(format!(
                    "byte {start}: found an end of the data of {length} bytes, expected {DATA_END_BYTES}: something was changed"
                ));
            }
            self.finish(expected)?;
            return Ok(ReadState::Finished);
        }
        self.checksum.update(&head);
        self.checksum.update(&body);
        self.offset = end;
        let goes_on = self.reader.take(parsed, start);
        self.index(place, end);
        Ok(if goes_on { ReadState::More } else { ReadState::Finished })
    }

    /// Compares the checksum of all data, and checks that the file goes on to its end.
    fn finish(&mut self, expected: u32) -> io::Result<()> {
        let found = self.checksum.clone().finalize();
        if expected != 0 && expected != found {
            self.reader.problem(format!(
                "found checksum {found:08x} of all data, expected {expected:08x}: something was changed"
            ));
        }
        self.size = self.input.get_ref().size()?;
        let mut tail = Vec::new();
        self.seek(self.size.saturating_sub(MAGIC.len() as u64))?;
        (&mut self.input).take(MAGIC.len() as u64).read_to_end(&mut tail)?;
        self.position += tail.len() as u64;
        if tail != MAGIC {
            self.reader.problem("the file is cut behind its data, which are whole".to_owned());
        }
        Ok(())
    }

    /// Enters what the reader found in the record at `place`, and drops the shots' data.
    fn index(&mut self, place: RecordPlace, end: u64) {
        let shots = std::mem::take(&mut self.reader.shots);
        // Lines before the first shot belong to all of the recording.
        let before = self.reader.set.notes.remove(&0);
        let notes = std::mem::take(&mut self.reader.set.notes);
        self.reader.set.notes.extend(before.map(|before| (0, before)));
        for number in shots.keys().chain(notes.keys()).copied().collect::<BTreeSet<u32>>() {
            let index = *self.places.entry(number).or_insert(self.shots.len());
            if index == self.shots.len() {
                let timestamp_ns = shots.get(&number).map_or(0, |shot| shot.timestamp_ns);
                let (channels, records) = (Vec::new(), Vec::new());
                self.shots.push(IndexedShot { number, timestamp_ns, channels, records });
            }
            let Some(shot) = self.shots.get_mut(index) else { continue };
            shot.records.push(place);
            for capture in shots.get(&number).into_iter().flat_map(|shot| &shot.captures) {
                let source = capture.waveform.source;
                if shot.channels.contains(&source) {
                    self.reader.problem(second_capture(source, number));
                } else {
                    shot.channels.push(source);
                }
            }
        }
        let lines = std::mem::take(&mut self.reader.set.lines);
        for line in &lines {
            self.traffic.count(line);
        }
        let times = || lines.iter().map(|line| line.timestamp_ns);
        let (Some(first_ns), Some(last_ns)) = (times().min(), times().max()) else { return };
        match self.lines.last_mut() {
            Some(range) if end - range.start <= LINE_RANGE_BYTES => {
                range.first_ns = range.first_ns.min(first_ns);
                range.last_ns = range.last_ns.max(last_ns);
                range.end = end;
            }
            _ => self.lines.push(LineRange { first_ns, last_ns, start: place.start, end }),
        }
    }

    /// The head of the record at `offset`, and where its body ends; none if it is not whole.
    fn head_at(&mut self, offset: u64) -> io::Result<Option<([u8; RECORD_HEADER_BYTES], u64)>> {
        let body = offset + RECORD_HEADER_BYTES as u64;
        if body > self.size {
            self.look_at_size()?;
        }
        if body > self.size {
            return Ok(None);
        }
        self.seek(offset)?;
        let mut head = [0; RECORD_HEADER_BYTES];
        self.input.read_exact(&mut head)?;
        self.position = body;
        let Some(end) = body.checked_add(container::body_length(&head)) else { return Ok(None) };
        if end > self.size {
            self.look_at_size()?;
        }
        Ok((end <= self.size).then_some((head, end)))
    }

    /// The file may have grown.
    fn look_at_size(&mut self) -> io::Result<()> {
        self.size = self.input.get_ref().size()?;
        self.reader.allowed = allowed(self.size);
        Ok(())
    }

    fn seek(&mut self, to: u64) -> io::Result<()> {
        match i64::try_from(i128::from(to) - i128::from(self.position)) {
            Ok(0) => {}
            // Within the buffer, nothing is read again.
            Ok(distance) => self.input.seek_relative(distance)?,
            Err(_) => self.input.seek(SeekFrom::Start(to)).map(|_| ())?,
        }
        self.position = to;
        Ok(())
    }

    fn body(&mut self, length: u64) -> io::Result<Vec<u8>> {
        let mut body = Vec::new();
        (&mut self.input).take(length).read_to_end(&mut body)?;
        self.position += body.len() as u64;
        if (body.len() as u64) < length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        Ok(body)
    }

    /// Passes over `length` bytes, which count for the checksum.
    fn skip(&mut self, length: u64) -> io::Result<()> {
        let mut left = length;
        while left > 0 {
            let piece = self.body(left.min(READ_BYTES as u64))?;
            self.checksum.update(&piece);
            left -= piece.len() as u64;
        }
        Ok(())
    }

    /// How far the recording has been read.
    pub fn end(&self) -> ReadState {
        self.end
    }

    /// Number of shots found so far. The last one counts if nothing follows it: until then it may
    /// not be whole.
    pub fn shots(&self) -> usize {
        let unfinished = usize::from(self.end == ReadState::More);
        self.shots.len().saturating_sub(unfinished)
    }

    /// Places of all shots in order of time.
    pub fn in_order_of_time(&self) -> Vec<usize> {
        let mut places: Vec<usize> = (0..self.shots.len()).collect();
        places.sort_by_key(|place| {
            self.shots.get(*place).map(|shot| (shot.timestamp_ns, shot.number))
        });
        places
    }

    /// Number of the shot at `place`, and its channels.
    pub fn indexed(&self, place: usize) -> Option<(u32, &[Source])> {
        self.shots.get(place).map(|shot| (shot.number, shot.channels.as_slice()))
    }

    /// Of how many pieces of the file the shot at `place` is made so far; more may come as long as
    /// the file grows.
    pub fn pieces(&self, place: usize) -> usize {
        self.shots.get(place).map_or(0, |shot| shot.records.len())
    }

    /// Parts of the file found so far with messages of the remote interface around the shot at
    /// `place`, and where the last one ends.
    pub fn line_pieces(&self, place: usize) -> (usize, u64) {
        let (from, to) = self.span_of(place);
        let ranges = self.line_ranges(from, to);
        (ranges.len(), ranges.last().map_or(0, |range| range.end))
    }

    fn line_ranges(&self, from: u64, to: u64) -> Vec<LineRange> {
        let inside = |part: &&LineRange| part.last_ns >= from && part.first_ns <= to;
        self.lines.iter().filter(inside).copied().collect()
    }

    /// From the shot before the one at `place` to the one after it (ns since 1970).
    fn span_of(&self, place: usize) -> (u64, u64) {
        let time = |place: usize| self.shots.get(place).map(|shot| shot.timestamp_ns);
        let before = place.checked_sub(1).and_then(time);
        (before.map_or(0, |at| at + 1), time(place + 1).unwrap_or(u64::MAX))
    }

    /// Reads the messages of the remote interface from `from` to `to` (ns since 1970, both
    /// included), in the order of the file.
    ///
    /// # Errors
    /// [`RecordingError`] if the file cannot be read any more.
    pub fn lines(&mut self, from: u64, to: u64) -> Result<Vec<ScpiLine>, RecordingError> {
        let mut lines = Vec::new();
        for range in self.line_ranges(from, to) {
            let mut start = range.start;
            while start < range.end {
                let place = RecordPlace { start, current: 0 };
                let (reader, end) = self.reread(place).map_err(|source| self.failed(source))?;
                let inside =
                    reader.set.lines.into_iter().filter(|l| (from..=to).contains(&l.timestamp_ns));
                lines.extend(inside);
                start = end;
            }
        }
        Ok(lines)
    }

    /// Reads the messages of the remote interface from the shot before the one at `place` to the
    /// shot after it, in order; of many the nearest.
    ///
    /// # Errors
    /// [`RecordingError`] if the file cannot be read any more.
    pub fn lines_around(&mut self, place: usize) -> Result<Vec<ScpiLine>, RecordingError> {
        let (from, to) = self.span_of(place);
        let mut lines = self.lines(from, to)?;
        let shot = self.shots.get(place).map(|shot| shot.timestamp_ns);
        let before = lines.partition_point(|line| Some(line.timestamp_ns) <= shot);
        lines.truncate(before + NEIGHBOURING_LINES);
        Ok(lines.split_off(before.saturating_sub(NEIGHBOURING_LINES)))
    }

    /// Everything found so far beside the shots: facts, attachments, the end of the log, problems.
    pub fn facts(&self) -> TraceSet {
        let mut facts = self.reader.set.clone();
        let earlier = self.reader.log_lines.saturating_sub(LOG_LINES);
        if earlier > 0 {
            facts.log.drain(..facts.log.len() - LOG_LINES);
            facts.log.insert(0, format!("({earlier} earlier lines are left out)"));
        }
        if self.reader.unlisted > 0 {
            facts.problems.push(format!("and {} more problems", self.reader.unlisted));
        }
        if self.end == ReadState::Open {
            let (offset, left) = (self.offset, self.size.saturating_sub(self.offset));
            facts.problems.push(if self.is_zero {
                format!(
                    "byte {offset}: found zeros instead of a record: the last {left} bytes are not read (was the power cut?)"
                )
            } else if left > 0 {
                format!("byte {offset}: the file breaks off in a record, of which {left} bytes are left")
            } else {
                "the file has no end: it was not finished, or cut".to_owned()
            });
        }
        facts
    }

    /// Messages of the remote interface so far.
    pub fn traffic(&self) -> &Traffic {
        &self.traffic
    }

    /// Reads the shot at `place`, counted from 0, and the records beside its captures and truth;
    /// none beyond the last.
    ///
    /// # Errors
    /// [`RecordingError`] if the file cannot be read any more.
    pub fn shot_and_notes(
        &mut self,
        place: usize,
    ) -> Result<Option<(Shot, ShotNotes)>, RecordingError> {
        let Some(indexed) = self.shots.get(place) else { return Ok(None) };
        let number = indexed.number;
        let mut shot = empty_shot(number, indexed.timestamp_ns);
        let mut notes = ShotNotes::default();
        for place in indexed.records.clone() {
            let path = self.path.clone();
            let failed = |source| RecordingError::caused(&path, source);
            let reader = self.reread_for_shot(place).map_err(failed)?;
            if let Some(found) = reader.shots.get(&number) {
                shot.origin = found.origin;
                shot.trigger_time = found.trigger_time.or(shot.trigger_time);
                for capture in &found.captures {
                    let source = capture.waveform.source;
                    if shot.captures.iter().all(|other| other.waveform.source != source) {
                        shot.captures.push(capture.clone());
                    }
                }
                shot.truth.extend(found.truth.iter().cloned());
            }
            if let Some(found) = reader.set.notes.get(&number) {
                if !found.set_up.is_empty() {
                    notes.set_up.clone_from(&found.set_up);
                }
                notes.energy = found.energy.clone().or(notes.energy);
                notes.log.extend(found.log.iter().cloned());
            }
        }
        Ok(Some((shot, notes)))
    }

    /// The content of the record at `place`; shots that are neighbours share one.
    fn reread_for_shot(&mut self, place: RecordPlace) -> io::Result<&Reader> {
        let reader = match self.last.take() {
            Some((known, reader)) if known == place => reader,
            _ => self.reread(place)?.0,
        };
        Ok(&self.last.insert((place, reader)).1)
    }

    /// The content of the record at `place`, and where the next one begins.
    fn reread(&mut self, place: RecordPlace) -> io::Result<(Reader, u64)> {
        let mut reader = Reader {
            schemas: self.reader.schemas.clone(),
            channels: self.reader.channels.clone(),
            current: place.current,
            allowed: self.reader.allowed,
            ..Reader::default()
        };
        let Some((head, end)) = self.head_at(place.start)? else {
            return Err(io::ErrorKind::UnexpectedEof.into());
        };
        let [opcode, ..] = head;
        if container::is_known(opcode) && end - place.start <= MAX_RECORD_BYTES {
            let body = self.body(end - place.start - RECORD_HEADER_BYTES as u64)?;
            reader.take(container::parse(opcode, &body), place.start);
        }
        Ok((reader, end))
    }

    /// Reads everything into memory.
    ///
    /// # Errors
    /// [`RecordingError`] if it cannot be read, if nothing of it is a recording, or if it is too
    /// large.
    pub fn into_set(mut self) -> Result<TraceSet, RecordingError> {
        if self.size > LARGEST_FILE {
            return Err(too_large(&self.path, self.size, LARGEST_FILE));
        }
        self.read_all()?;
        let mut set = self.facts();
        set.lines = self.lines(0, u64::MAX)?;
        for place in self.in_order_of_time() {
            if let Some((shot, notes)) = self.shot_and_notes(place)? {
                set.notes.insert(shot.number, notes);
                set.shots.push(shot);
            }
        }
        let notes = set.notes.get(&0).into_iter();
        let notes = notes.chain(set.shots.iter().filter_map(|shot| set.notes.get(&shot.number)));
        set.log = notes.flat_map(|notes| &notes.log).map(|(_, line)| line.clone()).collect();
        Ok(set)
    }
}

fn allowed(size: u64) -> u64 {
    MAX_UNPACKED_BYTES.saturating_add(MAX_EXPANSION.saturating_mul(size))
}

fn empty_shot(number: u32, timestamp_ns: u64) -> Shot {
    Shot {
        number,
        origin: Origin::Simulated,
        timestamp_ns,
        captures: Vec::new(),
        truth: Vec::new(),
        trigger_time: None,
    }
}

fn second_capture(source: Source, number: u32) -> String {
    format!("found a second capture of {source} in shot {number}")
}

/// Decodes records, and collects what is in them.
#[derive(Default)]
struct Reader {
    set: TraceSet,
    schemas: BTreeMap<u16, String>,
    /// Topic and schema name by channel.
    channels: BTreeMap<u16, (String, String)>,
    shots: BTreeMap<u32, Shot>,
    /// The shot whose messages are being read: lines of the log belong to it.
    current: u32,
    /// Bytes that may be unpacked and kept, and those that were.
    allowed: u64,
    spent: u64,
    unlisted: usize,
    /// Lines of the log, those no longer in `set` included.
    log_lines: usize,
    /// Whether there is no room for more.
    is_full: bool,
}

impl Reader {
    fn problem(&mut self, text: String) {
        if self.set.problems.len() < MAX_LISTED_PROBLEMS {
            self.set.problems.push(text);
        } else {
            self.unlisted += 1;
        }
    }

    /// Takes the record at `offset` in the file; false if nothing after it is to be read.
    fn take(&mut self, record: Result<McapRecord<'_>, String>, offset: u64) -> bool {
        match record {
            Ok(McapRecord::Chunk(records)) => {
                if !self.spend(records.len() as u64) {
                    self.problem(format!(
                        "byte {offset}: found chunks that unpack to more than {MAX_EXPANSION} times the file, expected a recording"
                    ));
                    return false;
                }
                self.chunk(&records, offset);
            }
            Ok(record) => self.record(record, offset),
            Err(error) => self.problem(format!("byte {offset}: {error}")),
        }
        !self.is_full
    }

    fn chunk(&mut self, mut rest: &[u8], offset: u64) {
        while !rest.is_empty() && !self.is_full {
            let (opcode, body, tail) = match container::split(rest) {
                Ok(parts) => parts,
                Err(error) => {
                    self.problem(format!("chunk at byte {offset}: {error}"));
                    return;
                }
            };
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
    }

    /// Takes `bytes` from what is allowed; false, and nothing taken, if there is less left.
    fn spend(&mut self, bytes: u64) -> bool {
        let spent = self.spent.saturating_add(bytes);
        let fits = spent <= self.allowed;
        if fits {
            self.spent = spent;
        }
        fits
    }

    fn record(&mut self, record: McapRecord<'_>, offset: u64) {
        // The bytes of objects are counted when they are unpacked.
        let objects = match &record {
            McapRecord::Schema(..) => 1,
            McapRecord::Channel { .. } | McapRecord::Message { .. } => 2,
            McapRecord::Attachment(..) => 3,
            McapRecord::Metadata(_, facts) => 1 + 2 * facts.len(),
            McapRecord::Chunk(_) | McapRecord::DataEnd(_) | McapRecord::Other => 0,
        };
        if !self.spend(OBJECT_BYTES * objects as u64) {
            self.is_full = true;
            self.problem(format!(
                "byte {offset}: found more than a recording of this size holds: what follows is passed over"
            ));
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
            self.problem(format!(
                "{topic}: found messages of the kind `{name}`, expected one of hertzscope's: they are passed over"
            ));
        }
        self.channels.insert(id, declared);
    }

    fn message(&mut self, schema: &str, log_time: u64, data: &[u8]) -> Result<(), String> {
        let undecodable =
            |error: prost::DecodeError| format!("found a message that is no {schema} ({error})");
        if let Some(known) = Schema::ALL.into_iter().find(|known| known.name() == schema) {
            decode::check_doubles(known, data)
                .map_err(|error| format!("found no {schema} ({error})"))?;
        }
        if schema == Schema::Capture.name() {
            let message = message::CaptureMessage::decode(data).map_err(undecodable)?;
            let capture = decode::capture(&message)?;
            let shot = self.shot(message.shot, log_time);
            let source = capture.waveform.source;
            if shot.captures.iter().any(|other| other.waveform.source == source) {
                return Err(second_capture(source, shot.number));
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
            let _ = self.shot(message.shot, log_time);
            self.notes().energy = Some(message);
        } else if schema == Schema::Log.name() {
            let message = message::LogMessage::decode(data).map_err(undecodable)?;
            let log = &mut self.set.log;
            if log.len() >= 2 * LOG_LINES {
                log.drain(..LOG_LINES);
            }
            log.push(message.message.clone());
            self.log_lines += 1;
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
        self.shots.entry(number).or_insert_with(|| empty_shot(number, timestamp_ns))
    }
}

fn too_large(file: &Path, found: u64, limit: u64) -> RecordingError {
    let found = format!("{found} bytes");
    let expected = format!("at most {limit} to be held in memory: name one shot with --shot");
    RecordingError::found(file.display(), found, expected)
}
