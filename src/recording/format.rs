//! Recognises file formats and opens them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::binary;
use super::isf;
use super::mcap::{IndexedRecording, MAGIC, ShotNotes, Traffic};
use super::rohde_schwarz;
use super::set_file::{self, SetFile};
use super::tek_csv::{self, TableColumns};
use super::{Attachment, Capture, Origin, RecordingError, ScpiLine, Shot, TraceSet};
use crate::scope::Source;

/// A format of files with the captures of one trigger. To add one, write its module and its row in
/// [`FORMATS`].
#[derive(Debug)]
pub struct FileFormat {
    /// Ending of the files that are written, in small letters.
    pub ending: &'static str,
    /// Endings of measurements alone: those of `LabVIEW`.
    measurement_endings: &'static [&'static str],
    /// Endings under which programs save it as well; in folders, such files are often notes.
    other_endings: &'static [&'static str],
    /// Whether a scope saves a folder of such files for each trigger.
    pub is_in_folders: bool,
    media_type: &'static str,
    /// Larger files are refused unread (bytes).
    max_bytes: u64,
    read: ReadFile,
    /// Writes one capture as a whole file.
    pub write: fn(&Capture) -> Result<Vec<u8>, RecordingError>,
}

/// Reads the captures of a file from its bytes, its name, and what the user says of its columns.
type ReadFile = fn(&[u8], &str, &TableColumns) -> Result<Vec<Capture>, RecordingError>;

/// The formats of files with captures.
pub const FORMATS: [FileFormat; 2] = [
    FileFormat {
        ending: "csv",
        measurement_endings: &["lvm", "npy", "npz", "wav", "tdms", "trc", "bin", "wfm"],
        other_endings: &["txt", "tsv", "dat", "asc", "prn"],
        is_in_folders: true,
        media_type: "text/csv",
        max_bytes: tek_csv::MAXIMUM_BYTES as u64,
        read: |bytes, name, columns| match binary::as_text(bytes, name) {
            Some(text) => tek_csv::read_columns(text?.as_bytes(), name, columns),
            None => tek_csv::read_columns(bytes, name, columns),
        },
        write: |capture| Ok(tek_csv::write(capture)?.into_bytes()),
    },
    FileFormat {
        ending: "isf",
        measurement_endings: &[],
        other_endings: &[],
        is_in_folders: false,
        media_type: "application/octet-stream",
        max_bytes: isf::MAXIMUM_BYTES as u64,
        read: |bytes, name, _| Ok(vec![isf::read(bytes, name)?]),
        write: |capture| isf::write(capture, isf::Width::One),
    },
];

impl FileFormat {
    /// The format of files with this ending.
    pub fn by_ending(ending: &str) -> Option<&'static Self> {
        FORMATS.iter().find(|format| format.ending.eq_ignore_ascii_case(ending))
    }

    /// Whether files with this ending, in small letters, are nothing else.
    fn is_measurement(&self, ending: &str) -> bool {
        self.ending == ending || self.measurement_endings.contains(&ending)
    }

    /// The format that a file is read as, by its ending, else by its content.
    fn of(path: &Path) -> Option<&'static Self> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let ending = ending.to_ascii_lowercase();
        let has = |format: &&Self| {
            format.is_measurement(&ending) || format.other_endings.contains(&ending.as_str())
        };
        FORMATS.iter().find(has).or_else(|| Self::by_content(&head(path)?))
    }

    /// The format of a file that begins with `head`; none for text that is no table, and for other
    /// bytes.
    fn by_content(head: &[u8]) -> Option<&'static Self> {
        let [tables, isf] = &FORMATS;
        let text = String::from_utf8_lossy(head).to_ascii_uppercase();
        let is_number = |cell: &str| cell.trim().parse::<f64>().is_ok();
        let is_row = |line: &&str| {
            let cells = line.split([',', ';', '\t', ' ']).filter(|cell| !cell.trim().is_empty());
            let numbers = cells.clone().filter(|cell| is_number(cell)).count();
            numbers > 0 && 2 * numbers >= cells.count()
        };
        if text.trim_start_matches(':').starts_with("WFMP") || text.starts_with(":CURV") {
            return Some(isf);
        }
        let rows = text.lines().filter(is_row).count();
        let is_table = !head.contains(&0) && 2 * rows > text.lines().count();
        (binary::recognises(head) || is_table).then_some(tables)
    }
}

/// The first bytes of a file.
fn head(path: &Path) -> Option<Vec<u8>> {
    use std::io::Read as _;
    const BYTES: u64 = 16 << 10;
    let mut head = Vec::new();
    std::fs::File::open(path).ok()?.take(BYTES).read_to_end(&mut head).ok()?;
    Some(head)
}

/// Key of a shot's folder in the metadata `hertzscope:import/<shot>`.
const FOLDER_KEY: &str = "folder";

/// How the folders of a memory stick begin: `ALL0000`, one a trigger.
const FOLDER: &str = "ALL";

/// The formats that files come in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// This program's recordings.
    Mcap,
    /// A file with captures, in one of [`FORMATS`].
    File,
    /// A folder of such files, as the scope makes for one trigger (`ALL0000`), or a memory stick
    /// with several of these.
    Folder,
}

impl Format {
    /// The format that a path's ending or kind tells.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("mcap") => Some(Self::Mcap),
            Some(ending) if FORMATS.iter().any(|format| format.is_measurement(ending)) => {
                Some(Self::File)
            }
            _ if path.is_dir() => Some(Self::Folder),
            _ => None,
        }
    }
}

/// The captures of files that other programs and instruments wrote.
fn imported(path: &Path, columns: &TableColumns) -> Result<TraceSet, RecordingError> {
    match Format::of(path) {
        Some(Format::Folder) => folder(path, columns),
        None if !path.exists() => {
            let expected = "a recording (.mcap), a scope's file (.csv, .isf), or a folder of them";
            let problem = format!("no such file or folder, expected {expected}");
            Err(RecordingError::new(path.display(), problem))
        }
        None if !path.is_file() || FileFormat::of(path).is_none() => Err(unknown_format(path)),
        _ => {
            let mut set = TraceSet::default();
            let pair = rohde_schwarz::pair(path).map(|pair| pair.to_vec());
            add_shot(&mut set, &pair.unwrap_or_else(|| vec![path.to_owned()]), "", columns)?;
            Ok(set)
        }
    }
}

/// An open recording: what holds for all its shots, and a way to each of them, whatever its size.
pub struct Recording {
    /// Facts, and at most one shot: the one that was read last.
    set: TraceSet,
    shots: ShotStore,
    /// Number and channels of each shot, in order of time.
    index: Vec<(u32, Vec<Source>)>,
    traffic: Traffic,
}

/// Where the shots of a recording are.
enum ShotStore {
    /// In memory, with the notes of each and the messages of the remote interface.
    Memory(Vec<(Shot, Option<ShotNotes>)>, Vec<ScpiLine>),
    /// In a file; the places are in order of time.
    File(Box<IndexedRecording>, Vec<usize>),
}

impl Recording {
    /// Opens a recording, a scope's file, or a folder of them; `columns` says what the columns of
    /// tables are.
    ///
    /// # Errors
    /// [`RecordingError`] with the file and what is wrong with it.
    pub fn open(path: &Path, columns: &TableColumns) -> Result<Self, RecordingError> {
        let is_mcap = || path.is_file() && head(path).is_some_and(|head| head.starts_with(&MAGIC));
        if Format::of(path) != Some(Format::Mcap) && (Format::of(path).is_some() || !is_mcap()) {
            return Ok(imported(path, columns)?.into());
        }
        let mut file = IndexedRecording::open(path)?;
        file.read_all()?;
        let places = file.in_order_of_time();
        let shots = places.iter().filter_map(|place| file.indexed(*place));
        let index: Vec<(u32, Vec<Source>)> =
            shots.map(|(number, channels)| (number, channels.to_vec())).collect();
        let (mut set, traffic) = (file.facts(), file.traffic().clone());
        let numbers: Vec<u32> = index.iter().map(|(number, _)| *number).collect();
        link_folders(&mut set, &numbers);
        Ok(Self { set, shots: ShotStore::File(Box::new(file), places), index, traffic })
    }

    /// Facts, attachments, log and problems; no shots but the one that was read last.
    pub fn facts(&self) -> &TraceSet {
        &self.set
    }

    /// The same, to note what the user says of the recording: every shot is read with it.
    pub fn facts_mut(&mut self) -> &mut TraceSet {
        &mut self.set
    }

    /// Messages of the remote interface.
    pub fn traffic(&self) -> &Traffic {
        &self.traffic
    }

    /// Number and channels of each shot, in order of time.
    pub fn index(&self) -> &[(u32, Vec<Source>)] {
        &self.index
    }

    /// Names of the channels of all shots.
    pub fn channels(&self) -> BTreeSet<String> {
        let sources = self.index.iter().flat_map(|(_, sources)| sources);
        sources.map(ToString::to_string).collect()
    }

    /// Reads the shot at `place` of [`Self::index`] into the facts, in the place of the one before.
    ///
    /// # Errors
    /// [`RecordingError`] if the file cannot be read any more.
    pub fn shot(&mut self, place: usize) -> Result<&mut TraceSet, RecordingError> {
        for shot in self.set.shots.drain(..) {
            self.set.notes.remove(&shot.number);
        }
        let found = match &mut self.shots {
            ShotStore::Memory(shots, _) => shots.get(place).cloned(),
            ShotStore::File(file, places) => match places.get(place) {
                Some(place) => {
                    file.shot_and_notes(*place)?.map(|(shot, notes)| (shot, Some(notes)))
                }
                None => None,
            },
        };
        if let Some((shot, notes)) = found {
            self.set.notes.extend(notes.map(|notes| (shot.number, notes)));
            self.set.shots.push(shot);
        }
        Ok(&mut self.set)
    }

    /// Messages of the remote interface from `from` to `to` (ns since 1970, both included).
    ///
    /// # Errors
    /// [`RecordingError`] if the file cannot be read any more.
    pub fn lines(&mut self, from: u64, to: u64) -> Result<Vec<ScpiLine>, RecordingError> {
        match &mut self.shots {
            ShotStore::Memory(_, lines) => {
                let inside = lines.iter().filter(|line| (from..=to).contains(&line.timestamp_ns));
                Ok(inside.cloned().collect())
            }
            ShotStore::File(file, _) => Ok(file.lines(from, to)?),
        }
    }

    /// Reads everything into memory.
    ///
    /// # Errors
    /// [`RecordingError`] if the file cannot be read any more, or is too large.
    pub fn into_set(self) -> Result<TraceSet, RecordingError> {
        let Self { mut set, shots, .. } = self;
        for shot in set.shots.drain(..) {
            set.notes.remove(&shot.number);
        }
        match shots {
            ShotStore::Memory(shots, lines) => {
                set.lines = lines;
                for (shot, notes) in shots {
                    set.notes.extend(notes.map(|notes| (shot.number, notes)));
                    set.shots.push(shot);
                }
                Ok(set)
            }
            ShotStore::File(file, _) => {
                let all = file.into_set()?;
                Ok(TraceSet { metadata: set.metadata, attachments: set.attachments, ..all })
            }
        }
    }
}

impl From<TraceSet> for Recording {
    fn from(mut set: TraceSet) -> Self {
        let lines = std::mem::take(&mut set.lines);
        let mut traffic = Traffic::default();
        for line in &lines {
            traffic.count(line);
        }
        let channels = |shot: &Shot| shot.captures.iter().map(|c| c.waveform.source).collect();
        let index = set.shots.iter().map(|shot| (shot.number, channels(shot))).collect();
        let notes = &mut set.notes;
        let shots = set.shots.drain(..).map(|shot| {
            let notes = notes.remove(&shot.number);
            (shot, notes)
        });
        let shots = ShotStore::Memory(shots.collect(), lines);
        Self { set, shots, index, traffic }
    }
}

/// Opens a recording, a scope's CSV or ISF file, or a folder of them, and reads all of it.
///
/// # Errors
/// [`RecordingError`] with the file and what is wrong with it.
pub fn open(path: &Path) -> Result<TraceSet, RecordingError> {
    open_with(path, &TableColumns::default())
}

/// The same where the user says what the columns of tables are.
///
/// # Errors
/// As [`open`].
pub fn open_with(path: &Path, columns: &TableColumns) -> Result<TraceSet, RecordingError> {
    Recording::open(path, columns)?.into_set()
}

/// As [`open_with`], with shot `number` only.
///
/// # Errors
/// As [`open_with`], and if there is no such shot.
pub fn open_shot(
    path: &Path,
    number: u32,
    columns: &TableColumns,
) -> Result<TraceSet, RecordingError> {
    let mut recording = Recording::open(path, columns)?;
    let place = recording.index.iter().position(|(found, _)| *found == number);
    let Some(place) = place else {
        let found = format!("{} shots", recording.index.len());
        let expected = format!("one with number {number}");
        return Err(RecordingError::found(path.display(), found, expected));
    };
    recording.shot(place)?;
    Ok(recording.set)
}

/// Contents of a folder, each list in order of names.
#[derive(Default)]
struct Content {
    files: Vec<PathBuf>,
    set_ups: Vec<PathBuf>,
    shots: Vec<PathBuf>,
}

impl Content {
    fn of(path: &Path) -> Result<Self, RecordingError> {
        let failed = |source| RecordingError::caused(path, source);
        let mut content = Self::default();
        for entry in std::fs::read_dir(path).map_err(failed)? {
            let file = entry.map_err(failed)?.path();
            let name = file.file_name().unwrap_or_default().to_string_lossy().to_ascii_uppercase();
            // What some systems leave beside the files they copy.
            if name.starts_with("._") {
                continue;
            }
            if Format::of(&file) == Some(Format::File) {
                content.files.push(file);
            } else if file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("set")) {
                content.set_ups.push(file);
            } else if file.is_dir() && name.starts_with(FOLDER) {
                content.shots.push(file);
            }
        }
        for list in [&mut content.files, &mut content.set_ups, &mut content.shots] {
            list.sort();
        }
        Ok(content)
    }
}

fn folder(path: &Path, columns: &TableColumns) -> Result<TraceSet, RecordingError> {
    let content = Content::of(path)?;
    let mut set = TraceSet::default();
    if content.shots.is_empty() {
        add_folder(&mut set, path, &content, "", columns)?;
        return Ok(set);
    }
    let mut first = None;
    let several = content.shots.len() > 1;
    for shot in &content.shots {
        let name = shot.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let prefix = if several { format!("{name}/") } else { String::new() };
        let read = Content::of(shot)
            .and_then(|found| add_folder(&mut set, shot, &found, &prefix, columns));
        if let Err(error) = read {
            set.problems.push(error.to_string());
            first = first.or(Some(error));
        }
    }
    if !content.files.is_empty() {
        let (count, path) = (content.files.len(), path.display());
        set.problems
            .push(format!("{path}: {count} files beside the folders {FOLDER}nnnn were not read"));
    }
    if let Some(error) = first.filter(|_| set.shots.is_empty()) {
        return Err(error);
    }
    set.shots.sort_by_key(|shot| (shot.timestamp_ns, shot.number));
    Ok(set)
}

/// Adds the one shot of a folder.
fn add_folder(
    set: &mut TraceSet,
    path: &Path,
    content: &Content,
    prefix: &str,
    columns: &TableColumns,
) -> Result<(), RecordingError> {
    if content.files.is_empty() {
        let found = "no .csv or .isf file in this folder";
        let expected = "at least one, e.g. F0000CH1.CSV, or folders ALLnnnn";
        return Err(RecordingError::found(path.display(), found, expected));
    }
    add_shot(set, &content.files, prefix, columns)?;
    match content.set_ups.as_slice() {
        [] => {}
        [file] => apply_set_file(set, file, prefix)?,
        several => set.problems.push(format!(
            "{}: found {} .SET files and used none, expected one",
            path.display(),
            several.len()
        )),
    }
    Ok(())
}

/// Completes the last shot by the front panel's file.
fn apply_set_file(set: &mut TraceSet, file: &Path, prefix: &str) -> Result<(), RecordingError> {
    let bytes = read_limited(file, set_file::MAXIMUM_BYTES as u64)?;
    match SetFile::read(&bytes, &file.display().to_string()) {
        Ok(set_up) => {
            let captures = set.shots.last_mut().into_iter().flat_map(|shot| &mut shot.captures);
            captures.for_each(|capture| set_up.complete(capture));
        }
        Err(error) => set.problems.push(error.to_string()),
    }
    set.attachments.push(attachment(file, prefix, "text/plain", bytes));
    Ok(())
}

/// Adds one measured shot from the files of one trigger; each file travels along as it was. A file
/// that cannot be read is named among the problems, and refused where there is no other.
fn add_shot(
    set: &mut TraceSet,
    files: &[PathBuf],
    prefix: &str,
    columns: &TableColumns,
) -> Result<(), RecordingError> {
    let mut captures: Vec<Capture> = Vec::new();
    let (mut sensors, mut attachments) = (Vec::new(), Vec::new());
    let (mut first, mut saved) = (None, 0);
    for file in files {
        if rohde_schwarz::is_header(file) {
            let bytes = read_limited(file, FORMATS[0].max_bytes)?;
            attachments.push(attachment(file, prefix, "text/csv", bytes));
            continue;
        }
        let (found, bytes, media_type) = match read(file, columns) {
            Ok(read) => read,
            Err(error) => {
                first = first.or(Some(error));
                continue;
            }
        };
        for (source, label) in columns.labels(&found) {
            let facts = [("name", label), ("channel", source.to_string())];
            let facts = facts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
            sensors.push((format!("hertzscope:sensor/{source}"), facts));
        }
        for capture in found {
            let source = capture.waveform.source;
            if captures.iter().any(|c| c.waveform.source == source) {
                let (file, channel) = (file.clone(), source.to_string());
                let found = format!("a second capture of {channel}");
                let expected =
                    "one file a channel: name a single file, or a folder with a single shot";
                return Err(RecordingError::found(file.display(), found, expected));
            }
            captures.push(capture);
        }
        saved = saved.max(modified(file));
        attachments.push(attachment(file, prefix, media_type, bytes));
    }
    match first {
        Some(error) if captures.is_empty() => return Err(error),
        Some(error) => {
            set.problems.push(format!("{error}; the other files of the folder were read"));
        }
        None => {}
    }
    captures.sort_by_key(|capture| capture.waveform.source);
    let number = u32::try_from(set.shots.len()).unwrap_or(u32::MAX).saturating_add(1);
    set.metadata.extend(sensors);
    set.attachments.extend(attachments);
    if let Some(folder) = prefix.strip_suffix('/') {
        link_folder(set, number, folder);
    }
    set.shots.push(Shot {
        number,
        origin: Origin::Measured,
        timestamp_ns: saved,
        captures,
        truth: Vec::new(),
        trigger_time: None,
    });
    Ok(())
}

/// The captures of a file, its bytes, and its media type.
fn read(
    file: &Path,
    columns: &TableColumns,
) -> Result<(Vec<Capture>, Vec<u8>, &'static str), RecordingError> {
    let Some(format) = FileFormat::of(file) else {
        return Err(unknown_format(file));
    };
    let bytes = read_limited(file, format.max_bytes)?;
    if let Some([header, _]) = rohde_schwarz::pair(file) {
        let name = file.display().to_string();
        let header = read_limited(&header, format.max_bytes)?;
        let table = rohde_schwarz::table(&header, &bytes, &name)?;
        return Ok((tek_csv::read_columns(&table, &name, columns)?, bytes, format.media_type));
    }
    let captures = (format.read)(&bytes, &file.display().to_string(), columns)?;
    let is_text = !binary::recognises(&bytes);
    let media_type = if is_text { format.media_type } else { "application/octet-stream" };
    Ok((captures, bytes, media_type))
}

/// When a file was last written, nanoseconds since 1970; 0 where the system does not tell.
fn modified(file: &Path) -> u64 {
    let time = std::fs::metadata(file).and_then(|found| found.modified()).ok();
    let since = time.and_then(|time| time.duration_since(std::time::UNIX_EPOCH).ok());
    since.and_then(|since| u64::try_from(since.as_nanos()).ok()).unwrap_or_default()
}

fn attachment(file: &Path, prefix: &str, media_type: &str, data: Vec<u8>) -> Attachment {
    let name = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    Attachment { name: format!("{prefix}{name}"), media_type: media_type.to_owned(), data }
}

/// Notes that shot `number` was imported from `folder`.
fn link_folder(set: &mut TraceSet, number: u32, folder: &str) {
    let facts = BTreeMap::from([(FOLDER_KEY.to_owned(), folder.to_owned())]);
    set.metadata.insert(format!("hertzscope:import/{number}"), facts);
}

/// Links the shots of a recording that an earlier version imported to their folders: the n-th shot
/// to the n-th folder, if there are as many of both.
fn link_folders(set: &mut TraceSet, shots: &[u32]) {
    if set.metadata.keys().any(|name| name.starts_with("hertzscope:import/")) {
        return;
    }
    let names = set.attachments.iter().filter_map(|a| Some(a.name.split_once('/')?.0.to_owned()));
    let mut folders: Vec<String> = names.filter(|name| name.starts_with(FOLDER)).collect();
    folders.dedup();
    if folders.len() == shots.len() {
        for (number, folder) in (1..).zip(&folders) {
            link_folder(set, number, folder);
        }
    }
}

/// The `.SET` file that was imported with a shot.
pub fn set_up_of(set: &TraceSet, shot: u32) -> Option<&Attachment> {
    let link = set.metadata.get(&format!("hertzscope:import/{shot}"));
    let folder = link.and_then(|facts| facts.get(FOLDER_KEY)).map_or("", String::as_str);
    let mut found = set.attachments.iter().filter(|attachment| {
        let (before, name) = attachment.name.split_once('/').unwrap_or(("", &attachment.name));
        before == folder && name.to_ascii_uppercase().ends_with(".SET")
    });
    found.next().filter(|_| found.next().is_none())
}

/// The bytes of a file that has at most `limit`.
fn read_limited(file: &Path, limit: u64) -> Result<Vec<u8>, RecordingError> {
    use std::io::Read as _;
    let failed = |source| RecordingError::caused(file, source);
    let opened = std::fs::File::open(file).map_err(failed)?;
    // A device or a pipe tells no size: one byte more than the limit is read.
    let mut found = opened.metadata().map_err(failed)?.len();
    let mut bytes = Vec::new();
    if found <= limit {
        opened.take(limit + 1).read_to_end(&mut bytes).map_err(failed)?;
        found = bytes.len() as u64;
    }
    if found > limit {
        return Err(RecordingError::too_large(file.display(), found, limit));
    }
    Ok(bytes)
}

fn unknown_format(file: &Path) -> RecordingError {
    let expected = ".mcap, .csv, .isf, .lvm, .tdms, .npy, .npz, .wav, .wfm, .bin, .trc, or a folder of .csv files as the scope saves them";
    RecordingError::found(file.display(), "no known format", expected)
}
