//! Which format a file is in, and opening whatever a user brings.

use std::path::{Path, PathBuf};

use super::isf::{self, IsfError};
use super::mcap::indexed_recording::{IndexedRecording, ReadState};
use super::mcap::{self, ReadError};
use super::set_file::{self, SetFile};
use super::tek_csv::{self, TableColumns, TekCsvError};
use super::{Attachment, Capture, Origin, Shot, TraceSet};

/// Endings under which programs save tables; in folders, such files are notes as often.
const TABLE_ENDINGS: [&str; 5] = ["txt", "tsv", "dat", "asc", "prn"];

/// Largest recording that is read at once (bytes).
const LARGEST_AT_ONCE: u64 = 32 * 1024 * 1024;

/// How the folders of a memory stick begin: `ALL0000`, one a trigger.
const FOLDER: &str = "ALL";

/// The formats that files come in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// This program's recordings.
    Mcap,
    /// One channel of a TDS2000, or what other programs and models make of it.
    TekCsv,
    /// One channel as an instrument sends it.
    Isf,
    /// A folder of such files, as the scope makes for one trigger (`ALL0000`), or a memory stick
    /// with several of these.
    Folder,
}

/// Why a file or folder could not be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Not a recording.
    #[error(transparent)]
    Mcap(#[from] ReadError),
    /// Not a TDS2000 file.
    #[error(transparent)]
    TekCsv(#[from] TekCsvError),
    /// Not an ISF file.
    #[error(transparent)]
    Isf(#[from] IsfError),
    /// The file or folder could not be read.
    #[error("{file}")]
    File {
        /// The file or folder.
        file: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// Nothing is there.
    #[error(
        "{file}: no such file or folder, expected a recording (.mcap), a scope's file (.csv, .isf), or a folder of them"
    )]
    Missing {
        /// The path.
        file: PathBuf,
    },
    /// The name tells no format.
    #[error(
        "{file}: found no known format, expected .mcap, .csv, .isf, or a folder of .csv files as the scope saves them"
    )]
    UnknownFormat {
        /// The file.
        file: PathBuf,
    },
    /// A folder without a single capture.
    #[error(
        "{file}: found no .csv or .isf file in this folder, expected at least one, e.g. F0000CH1.CSV, or folders ALLnnnn"
    )]
    EmptyFolder {
        /// The folder.
        file: PathBuf,
    },
    /// A large recording without the shot that is looked at.
    #[error("{file}: found {shots} shots, expected one with number {number}")]
    NoShot {
        /// The file.
        file: PathBuf,
        /// How many it has.
        shots: usize,
        /// The number that was asked for.
        number: u32,
    },
    /// Two captures of one folder claim the same channel.
    #[error(
        "{file}: found a second capture of {channel}, expected one file a channel: name a single file, or a folder with a single shot"
    )]
    SameChannel {
        /// The file.
        file: PathBuf,
        /// The channel.
        channel: String,
    },
}

impl Format {
    /// The format that a path's ending or kind tells.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("mcap") => Some(Self::Mcap),
            Some("csv") => Some(Self::TekCsv),
            Some("isf") => Some(Self::Isf),
            _ if path.is_dir() => Some(Self::Folder),
            _ => None,
        }
    }
}

/// Opens a recording, a scope's CSV or ISF file, or a folder of them.
///
/// # Errors
/// [`OpenError`] with the file and what is wrong with it.
pub fn open(path: &Path) -> Result<TraceSet, OpenError> {
    open_with(path, &TableColumns::default())
}

/// The same where the user says what the columns of tables are.
///
/// # Errors
/// As [`open`].
pub fn open_with(path: &Path, columns: &TableColumns) -> Result<TraceSet, OpenError> {
    match Format::of(path) {
        Some(Format::Mcap) => Ok(mcap::read(path)?),
        Some(Format::TekCsv | Format::Isf) => {
            let mut set = TraceSet::default();
            import(&mut set, &[path.to_owned()], "", columns)?;
            Ok(set)
        }
        Some(Format::Folder) => folder(path, columns),
        None if path.is_file() && is_table(path) => {
            let mut set = TraceSet::default();
            import(&mut set, &[path.to_owned()], "", columns)?;
            Ok(set)
        }
        None if path.exists() => Err(OpenError::UnknownFormat { file: path.to_owned() }),
        None => Err(OpenError::Missing { file: path.to_owned() }),
    }
}

fn is_table(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    TABLE_ENDINGS.iter().any(|known| known.eq_ignore_ascii_case(ending))
}

/// The recording at `path`, to be read shot by shot, if it is too large to be read at once.
///
/// # Errors
/// [`OpenError`] where it cannot be read.
pub fn open_large(path: &Path) -> Result<Option<IndexedRecording>, OpenError> {
    let size = std::fs::metadata(path).map_or(0, |file| file.len());
    if Format::of(path) != Some(Format::Mcap) || size <= LARGEST_AT_ONCE {
        return Ok(None);
    }
    let mut recording = IndexedRecording::open(path)?;
    while recording.read_on()? == ReadState::More {}
    Ok(Some(recording))
}

/// Calls `act` with the shots of a file: with all at once or, of a recording that is too large for
/// that, with each by itself.
///
/// # Errors
/// Those of `act`, and [`OpenError`] where the file cannot be read.
pub fn for_each_shot<E: From<OpenError>>(
    path: &Path,
    columns: &TableColumns,
    mut act: impl FnMut(TraceSet) -> Result<(), E>,
) -> Result<(), E> {
    let Some(mut recording) = open_large(path)? else { return act(open_with(path, columns)?) };
    let facts = recording.facts();
    for place in 0..recording.shots() {
        if let Some((shot, notes)) = recording.shot_and_notes(place).map_err(OpenError::from)? {
            let mut set = facts.clone();
            set.notes.insert(shot.number, notes);
            set.shots.push(shot);
            act(set)?;
        }
    }
    Ok(())
}

/// The shot `number` of a large recording, which is not read at once; none of other files.
///
/// # Errors
/// [`OpenError`] where it cannot be read or has no such shot.
pub fn read_shot(path: &Path, number: u32) -> Result<Option<TraceSet>, OpenError> {
    let Some(mut recording) = open_large(path)? else { return Ok(None) };
    let found = match recording.place_of(number) {
        Some(place) => recording.shot_and_notes(place)?,
        None => None,
    };
    let Some((shot, notes)) = found else {
        let shots = recording.shots();
        return Err(OpenError::NoShot { file: path.to_owned(), shots, number });
    };
    let mut set = recording.facts();
    set.shots.push(shot);
    set.notes.insert(number, notes);
    Ok(Some(set))
}

/// As [`open`], where only shot `number` is looked at.
///
/// # Errors
/// As [`open`]; also for a large recording without this shot.
pub fn open_shot(path: &Path, number: u32) -> Result<TraceSet, OpenError> {
    match read_shot(path, number)? {
        Some(set) => Ok(set),
        None => open(path),
    }
}

/// Contents of a folder, each list in order of names.
#[derive(Default)]
struct Content {
    files: Vec<PathBuf>,
    set_ups: Vec<PathBuf>,
    shots: Vec<PathBuf>,
}

impl Content {
    fn of(path: &Path) -> Result<Self, OpenError> {
        let failed = |source| OpenError::File { file: path.to_owned(), source };
        let mut content = Self::default();
        for entry in std::fs::read_dir(path).map_err(failed)? {
            let file = entry.map_err(failed)?.path();
            let name = file.file_name().unwrap_or_default().to_string_lossy().to_ascii_uppercase();
            // What some systems leave beside the files they copy.
            if name.starts_with("._") {
                continue;
            }
            if matches!(Format::of(&file), Some(Format::TekCsv | Format::Isf)) {
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

fn folder(path: &Path, columns: &TableColumns) -> Result<TraceSet, OpenError> {
    let content = Content::of(path)?;
    let mut set = TraceSet::default();
    if content.shots.is_empty() {
        trigger(&mut set, path, &content, "", columns)?;
        return Ok(set);
    }
    let mut first = None;
    let several = content.shots.len() > 1;
    for shot in &content.shots {
        let name = shot.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let prefix = if several { format!("{name}/") } else { String::new() };
        let read =
            Content::of(shot).and_then(|found| trigger(&mut set, shot, &found, &prefix, columns));
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
fn trigger(
    set: &mut TraceSet,
    path: &Path,
    content: &Content,
    prefix: &str,
    columns: &TableColumns,
) -> Result<(), OpenError> {
    if content.files.is_empty() {
        return Err(OpenError::EmptyFolder { file: path.to_owned() });
    }
    import(set, &content.files, prefix, columns)?;
    match content.set_ups.as_slice() {
        [] => {}
        [file] => complete(set, file, prefix)?,
        several => set.problems.push(format!(
            "{}: found {} .SET files and used none, expected one",
            path.display(),
            several.len()
        )),
    }
    Ok(())
}

/// Adds what the front panel's file tells of the last shot.
fn complete(set: &mut TraceSet, file: &Path, prefix: &str) -> Result<(), OpenError> {
    let bytes = read_limited(file, set_file::MAXIMUM_BYTES)?;
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
fn import(
    set: &mut TraceSet,
    files: &[PathBuf],
    prefix: &str,
    columns: &TableColumns,
) -> Result<(), OpenError> {
    let mut captures: Vec<Capture> = Vec::new();
    let (mut first, mut saved) = (None, 0);
    for file in files {
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
            set.metadata.insert(format!("hertzscope:sensor/{source}"), facts);
        }
        for capture in found {
            let source = capture.waveform.source;
            if captures.iter().any(|c| c.waveform.source == source) {
                let (file, channel) = (file.clone(), source.to_string());
                return Err(OpenError::SameChannel { file, channel });
            }
            captures.push(capture);
        }
        saved = saved.max(modified(file));
        set.attachments.push(attachment(file, prefix, media_type, bytes));
    }
    match first {
        Some(error) if captures.is_empty() => return Err(error),
        Some(error) => {
            set.problems.push(format!("{error}; the other files of the folder were read"));
        }
        None => {}
    }
    captures.sort_by_key(|capture| capture.waveform.source);
    set.shots.push(Shot {
        number: u32::try_from(set.shots.len()).unwrap_or(u32::MAX).saturating_add(1),
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
) -> Result<(Vec<Capture>, Vec<u8>, &'static str), OpenError> {
    let name = file.display().to_string();
    if Format::of(file) == Some(Format::Isf) {
        let bytes = read_limited(file, isf::MAXIMUM_BYTES)?;
        return Ok((vec![isf::read(&bytes, &name)?], bytes, "application/octet-stream"));
    }
    let size = std::fs::metadata(file).map(|found| found.len()).unwrap_or_default();
    let limit = tek_csv::MAXIMUM_BYTES as u64;
    if size > limit {
        return Err(TekCsvError::TooLarge { file: name, found: size, limit }.into());
    }
    let bytes = read_limited(file, tek_csv::MAXIMUM_BYTES)?;
    Ok((tek_csv::read_columns(&bytes, &name, columns)?, bytes, "text/csv"))
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

/// The `.SET` file that was imported with a shot.
pub fn set_up_of(set: &TraceSet, shot: u32) -> Option<&Attachment> {
    let is_set_up = |name: &str| name.to_ascii_uppercase().ends_with(".SET");
    let set_ups = || set.attachments.iter().filter(|a| is_set_up(&a.name));
    if set.shots.len() == 1 {
        let mut all = set_ups();
        return all.next().filter(|_| all.next().is_none());
    }
    let mut folders: Vec<&str> =
        set.attachments.iter().filter_map(|a| Some(a.name.split_once('/')?.0)).collect();
    folders.dedup();
    let folder = folders.get(usize::try_from(shot).ok()?.checked_sub(1)?)?;
    set_ups().find(|a| a.name.split_once('/').is_some_and(|(found, _)| found == *folder))
}

/// The file's bytes, at most one more than the reader takes, so that it can refuse what is too
/// large.
fn read_limited(file: &Path, most: usize) -> Result<Vec<u8>, OpenError> {
    use std::io::Read as _;
    let failed = |source| OpenError::File { file: file.to_owned(), source };
    let mut bytes = Vec::new();
    let limit = most as u64 + 1;
    std::fs::File::open(file)
        .map_err(failed)?
        .take(limit)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    Ok(bytes)
}
