//! Writes recordings so that an abort loses nothing already triggered, and the same seed gives the
//! same bytes.

use super::message::ShotNotes;
use std::collections::BTreeMap;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment as McapAttachment, Compression, WriteOptions, Writer};
use prost::Message as _;

use super::encode::{capture_message, line_message, series_message};
use super::message::{self, timestamp};
use super::schema::Schema;
use crate::files::NewFile;
use crate::recording::{Attachment, RecordingError, ScpiLine, Shot, TraceSet, true_signal};

/// Profile that the file's header names.
pub const PROFILE: &str = "hertzscope";
/// Uncompressed size at which a chunk ends: a damaged chunk takes no more than this with it.
const CHUNK_BYTES: u64 = 256 * 1024;

/// An open recording.
pub struct RecordingWriter {
    file: PathBuf,
    writer: Writer<NoSeek<BufWriter<NewFile>>>,
    schemas: BTreeMap<Schema, u16>,
    channels: BTreeMap<String, u16>,
    sequence: u32,
}

impl RecordingWriter {
    /// Begins a recording that replaces `file` when it is finished, with the facts that hold for
    /// all of it.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn create(
        file: &Path,
        metadata: &BTreeMap<String, BTreeMap<String, String>>,
        attachments: &[Attachment],
    ) -> Result<Self, RecordingError> {
        Self::begin(file, NewFile::replace(file), metadata, attachments)
    }

    /// Begins a recording that is called `file` or, if that exists when it is finished, by the next
    /// free number.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn create_numbered(
        file: &Path,
        metadata: &BTreeMap<String, BTreeMap<String, String>>,
        attachments: &[Attachment],
    ) -> Result<Self, RecordingError> {
        Self::begin(file, NewFile::numbered(file), metadata, attachments)
    }

    /// Begins a recording that others can read while it grows: `file` or, if that exists, the next
    /// free number.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn create_live(
        file: &Path,
        metadata: &BTreeMap<String, BTreeMap<String, String>>,
        attachments: &[Attachment],
    ) -> Result<Self, RecordingError> {
        let live = NewFile::live(file);
        let path = live.as_ref().map_or(file, NewFile::path).to_owned();
        Self::begin(&path, live, metadata, attachments)
    }

    fn begin(
        file: &Path,
        output: std::io::Result<NewFile>,
        metadata: &BTreeMap<String, BTreeMap<String, String>>,
        attachments: &[Attachment],
    ) -> Result<Self, RecordingError> {
        let path = file.to_owned();
        let container = |source| RecordingError::caused(&path, source);
        let output = output.map_err(|source| RecordingError::caused(&path, source))?;
        // To ask a buffered file where it is would empty the buffer each time.
        let target = NoSeek::new(BufWriter::new(output));
        let mut writer = WriteOptions::new()
            .profile(PROFILE)
            .library(concat!("hertzscope ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Zstd))
            .compression_level(1)
            .compression_threads(0)
            .chunk_size(Some(CHUNK_BYTES))
            .disable_seeking(true)
            .create(target)
            .map_err(container)?;
        writer.flush().map_err(container)?;
        let mut recording = Self {
            file: path.clone(),
            writer,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            sequence: 0,
        };
        recording.add_facts(metadata)?;
        for attachment in attachments {
            recording.attach(attachment)?;
        }
        recording.flush()?;
        Ok(recording)
    }

    /// Adds groups of facts.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn add_facts(
        &mut self,
        metadata: &BTreeMap<String, BTreeMap<String, String>>,
    ) -> Result<(), RecordingError> {
        for (name, facts) in metadata {
            let record = Metadata { name: name.clone(), metadata: facts.clone() };
            self.writer.write_metadata(&record).map_err(|source| self.container(source))?;
        }
        Ok(())
    }

    /// Adds a file that travels with the recording.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn attach(&mut self, attachment: &Attachment) -> Result<(), RecordingError> {
        let attachment = McapAttachment {
            log_time: 0,
            create_time: 0,
            name: attachment.name.clone(),
            media_type: attachment.media_type.clone(),
            data: std::borrow::Cow::Borrowed(&attachment.data),
        };
        self.writer.attach(&attachment).map_err(|source| self.container(source))
    }

    /// Adds one shot and hands it to the operating system before returning.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn add(&mut self, shot: &Shot, notes: &ShotNotes) -> Result<(), RecordingError> {
        let at = shot.timestamp_ns;
        let set_up = message::SetupMessage {
            timestamp: Some(timestamp(at)),
            shot: shot.number,
            set: notes.set_up.clone(),
        };
        self.message("/scope/setup", Schema::Setup, at, &set_up.encode_to_vec())?;
        for capture in &shot.captures {
            let topic = format!("/scope/{}", capture.waveform.source.to_string().to_lowercase());
            let message = capture_message(shot, capture);
            self.message(&topic, Schema::Capture, at, &message.encode_to_vec())?;
        }
        for trace in &shot.truth {
            let message = series_message(shot, trace);
            let topic = format!("/truth/{}", true_signal::topic(trace));
            self.message(&topic, Schema::Series, at, &message.encode_to_vec())?;
        }
        if let Some(energy) = &notes.energy {
            let energy = message::EnergyMessage {
                timestamp: Some(timestamp(at)),
                shot: shot.number,
                ..*energy
            };
            self.message("/energy", Schema::Energy, at, &energy.encode_to_vec())?;
        }
        self.log(&notes.log, at)?;
        self.flush()
    }

    /// Adds lines of the log that belong to no shot; before the first shot.
    ///
    /// # Errors
    /// [`RecordingError`] if the file cannot be written.
    pub fn add_log(&mut self, lines: &[(bool, String)]) -> Result<(), RecordingError> {
        self.log(lines, 0)
    }

    fn log(&mut self, lines: &[(bool, String)], at: u64) -> Result<(), RecordingError> {
        for (warning, line) in lines {
            let log = message::LogMessage {
                timestamp: Some(timestamp(at)),
                level: if *warning { message::WARNING } else { message::INFORMATION },
                message: line.clone(),
                name: "hertzscope".to_owned(),
                ..Default::default()
            };
            self.message("/log", Schema::Log, at, &log.encode_to_vec())?;
        }
        Ok(())
    }

    /// Adds a command or a reply; it may stay in memory until [`Self::flush`] or the next shot.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn add_line(&mut self, line: &ScpiLine) -> Result<(), RecordingError> {
        let message = line_message(line).encode_to_vec();
        self.message("/scpi", Schema::ScpiLine, line.timestamp_ns, &message)
    }

    /// Hands everything to the operating system before returning.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordingError> {
        self.writer.flush().map_err(|source| self.container(source))
    }

    /// The name of a live recording, or the one that was asked for.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Writes the summary section and waits until the disk has all of it. Returns the recording's
    /// name.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn finish(mut self) -> Result<PathBuf, RecordingError> {
        self.writer.finish().map_err(|source| self.container(source))?;
        let file = self.file;
        let system = |source| RecordingError::caused(&file, source);
        let buffer = self.writer.into_inner().into_inner();
        buffer.into_inner().map_err(|e| system(e.into_error()))?.complete().map_err(system)
    }

    fn message(
        &mut self,
        topic: &str,
        schema: Schema,
        at: u64,
        data: &[u8],
    ) -> Result<(), RecordingError> {
        let channel_id = self.channel(topic, schema).map_err(|source| self.container(source))?;
        let header =
            MessageHeader { channel_id, sequence: self.sequence, log_time: at, publish_time: at };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, data).map_err(|source| self.container(source))
    }

    fn channel(&mut self, topic: &str, schema: Schema) -> Result<u16, mcap::McapError> {
        if let Some(id) = self.channels.get(topic) {
            return Ok(*id);
        }
        let schema_id = if let Some(id) = self.schemas.get(&schema) {
            *id
        } else {
            let id = self.writer.add_schema(schema.name(), "protobuf", &schema.descriptor())?;
            self.schemas.insert(schema, id);
            id
        };
        let id = self.writer.add_channel(schema_id, topic, "protobuf", &BTreeMap::new())?;
        self.channels.insert(topic.to_owned(), id);
        Ok(id)
    }

    fn container(&self, source: mcap::McapError) -> RecordingError {
        RecordingError::caused(&self.file, source)
    }
}

/// Writes a whole set, such as an import, to `file`, replacing it.
///
/// # Errors
/// [`RecordingError`] where the file cannot be written.
pub fn write(file: &Path, set: &TraceSet) -> Result<(), RecordingError> {
    write_set(RecordingWriter::create(file, &set.metadata, &set.attachments)?, set).map(|_| ())
}

/// Writes a whole set to `file` or, if that exists, to the next free number. Returns the
/// recording's name.
///
/// # Errors
/// [`RecordingError`] where the file cannot be written.
pub fn write_numbered(file: &Path, set: &TraceSet) -> Result<PathBuf, RecordingError> {
    write_set(RecordingWriter::create_numbered(file, &set.metadata, &set.attachments)?, set)
}

fn write_set(mut writer: RecordingWriter, set: &TraceSet) -> Result<PathBuf, RecordingError> {
    // Lines that belong to no shot go with the last one.
    let known: usize = set.notes.values().map(|notes| notes.log.len()).sum();
    let mut loose = if known == 0 { set.log.as_slice() } else { &[] };
    if let Some(before) = set.notes.get(&0) {
        writer.add_log(&before.log)?;
    }
    let mut shots = set.shots.iter().peekable();
    let mut lines = set.lines.iter().peekable();
    while let Some(shot) = shots.next() {
        while let Some(line) = lines.next_if(|line| line.timestamp_ns <= shot.timestamp_ns) {
            writer.add_line(line)?;
        }
        let mut notes = set.notes.get(&shot.number).cloned().unwrap_or_default();
        if shots.peek().is_none() {
            notes.log.extend(std::mem::take(&mut loose).iter().map(|line| (false, line.clone())));
        }
        writer.add(shot, &notes)?;
    }
    for line in lines {
        writer.add_line(line)?;
    }
    writer.finish()
}
