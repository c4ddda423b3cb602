//! Which format a file is in, and opening whatever a user brings.

use std::path::{Path, PathBuf};

use super::isf::{self, IsfError};
use super::mcap::{self, ReadError};
use super::set_file::{self, SetFile};
use super::tek_csv::{self, TekCsvError};
use super::{Attachment, Capture, Origin, Shot, TraceSet};

/// The formats that files come in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// This program's recordings.
    Mcap,
    /// One channel of a TDS2000, or what other programs and models make of it.
    TekCsv,
    /// One channel as an instrument sends it.
    Isf,
    /// A folder of such files, as the scope makes for one trigger: `ALL0000`.
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
        /// What the system says.
        source: std::io::Error,
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
        "{file}: found no .csv or .isf file in this folder, expected at least one, e.g. F0000CH1.CSV, or one folder ALLnnnn"
    )]
    EmptyFolder {
        /// The folder.
        file: PathBuf,
    },
    /// Two captures of one folder claim the same channel.
    #[error("{file}: found a second capture of {channel}, expected one file a channel")]
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
    match Format::of(path) {
        Some(Format::Mcap) => Ok(mcap::read(path)?),
        Some(Format::TekCsv | Format::Isf) => import(&[path.to_owned()]),
        Some(Format::Folder) => folder(path),
        None if path.exists() => Err(OpenError::UnknownFormat { file: path.to_owned() }),
        None => {
            let source = std::io::Error::from(std::io::ErrorKind::NotFound);
            Err(OpenError::File { file: path.to_owned(), source })
        }
    }
}

fn folder(path: &Path) -> Result<TraceSet, OpenError> {
    let failed = |source| OpenError::File { file: path.to_owned(), source };
    let (mut files, mut set_ups, mut shots) = (Vec::new(), Vec::new(), Vec::new());
    for entry in std::fs::read_dir(path).map_err(failed)? {
        let file = entry.map_err(failed)?.path();
        if matches!(Format::of(&file), Some(Format::TekCsv | Format::Isf)) {
            files.push(file);
        } else if file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("set")) {
            set_ups.push(file);
        } else if file.is_dir()
            && file.file_name().is_some_and(|n| n.as_encoded_bytes().starts_with(b"ALL"))
        {
            shots.push(file);
        }
    }
    // The folder around the one folder of a trigger means that one.
    if let ([], [shot]) = (files.as_slice(), shots.as_slice()) {
        return folder(shot);
    }
    if files.is_empty() {
        return Err(OpenError::EmptyFolder { file: path.to_owned() });
    }
    files.sort();
    let mut set = import(&files)?;
    match set_ups.as_slice() {
        [] => {}
        [file] => complete(&mut set, file)?,
        several => set.problems.push(format!(
            "{}: found {} .SET files and used none, expected one",
            path.display(),
            several.len()
        )),
    }
    Ok(set)
}

/// Adds what the front panel's file tells.
fn complete(set: &mut TraceSet, file: &Path) -> Result<(), OpenError> {
    let bytes = read_limited(file, set_file::MAXIMUM_BYTES)?;
    match SetFile::read(&bytes, &file.display().to_string()) {
        Ok(set_up) => {
            let captures = set.shots.iter_mut().flat_map(|shot| &mut shot.captures);
            captures.for_each(|capture| set_up.complete(capture));
        }
        Err(error) => set.problems.push(error.to_string()),
    }
    set.attachments.push(attachment(file, "text/plain", bytes));
    Ok(())
}

/// One measured shot from files of one trigger; each file travels along as it was.
fn import(files: &[PathBuf]) -> Result<TraceSet, OpenError> {
    let mut set = TraceSet::default();
    let mut captures: Vec<Capture> = Vec::new();
    for file in files {
        let name = file.display().to_string();
        let (found, bytes, media_type) = if Format::of(file) == Some(Format::Isf) {
            let bytes = read_limited(file, isf::MAXIMUM_BYTES)?;
            (vec![isf::read(&bytes, &name)?], bytes, "application/octet-stream")
        } else {
            let bytes = read_limited(file, tek_csv::MAXIMUM_BYTES)?;
            (tek_csv::read_all(&bytes, &name)?, bytes, "text/csv")
        };
        for capture in found {
            let source = capture.waveform.source;
            if captures.iter().any(|c| c.waveform.source == source) {
                let (file, channel) = (file.clone(), source.to_string());
                return Err(OpenError::SameChannel { file, channel });
            }
            captures.push(capture);
        }
        set.attachments.push(attachment(file, media_type, bytes));
    }
    captures.sort_by_key(|capture| capture.waveform.source);
    set.shots.push(Shot {
        number: 1,
        origin: Origin::Measured,
        timestamp_ns: 0,
        captures,
        truth: Vec::new(),
        trigger_time: None,
    });
    Ok(set)
}

fn attachment(file: &Path, media_type: &str, data: Vec<u8>) -> Attachment {
    let name = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    Attachment { name, media_type: media_type.to_owned(), data }
}

/// The file's bytes, at most one more than the reader takes, so that it can refuse what is too large.
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
