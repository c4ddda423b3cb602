//! The log of a sweep: finished runs, one a line, only ever added to.
//!
//! The first line says which sweep it is of. Every line begins with the CRC-32 of what follows, in
//! eight hexadecimal digits and a blank. A process that is killed leaves at most one torn line at
//! the end: it is cut off, and its run is done again. A line that does not agree with its checksum
//! is reported and counts for nothing, so its run is done again, too.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead as _, BufReader, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::plan::{Column, SweepPlan};
use super::{SweepError, at};

/// Version of the format.
const LOG_VERSION: u32 = 1;
/// Characters of a checksum with the blank behind it.
const CHECKSUM_LENGTH: usize = 9;

/// The first line of a log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LogHeader {
    /// Version of the format.
    pub hertzscope_sweep_log: u32,
    /// Hash that identifies the sweep.
    pub sweep: String,
    /// Runs of the whole sweep.
    pub runs: u64,
    /// Instructions that the log's runs are made with.
    pub instructions: String,
    /// Columns of the lines below.
    pub columns: Vec<Column>,
}

impl LogHeader {
    /// That of `plan`, run with these instructions.
    pub fn of(plan: &SweepPlan, instructions: &str) -> Self {
        Self {
            hertzscope_sweep_log: LOG_VERSION,
            sweep: plan.hash().to_owned(),
            runs: plan.count(),
            instructions: instructions.to_owned(),
            columns: plan.columns().to_vec(),
        }
    }
}

/// Where a run's line stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LoggedRun {
    pub(super) run: u64,
    /// Where its text begins.
    pub(super) offset: u64,
    /// Bytes of its text.
    pub(super) length: u32,
    pub(super) checksum: u32,
}

/// Contents of a log.
#[derive(Debug)]
pub struct Scan {
    /// The file.
    pub file: PathBuf,
    /// Its first line.
    pub header: LogHeader,
    pub(super) entries: Vec<LoggedRun>,
    /// Where its sound lines end: what follows is torn.
    sound: u64,
    /// Bytes behind that.
    torn: u64,
    /// Whole lines that do not agree with their checksums.
    damaged: u64,
}

impl Scan {
    /// Numbers of the runs that are finished.
    pub fn finished(&self) -> impl Iterator<Item = u64> {
        self.entries.iter().map(|entry| entry.run)
    }

    /// The log's problem, as a message.
    pub fn notices(&self) -> Vec<String> {
        let file = self.file.display();
        let mut notices = Vec::new();
        if self.torn > 0 {
            let torn = self.torn;
            notices.push(format!(
                "{file}: found a torn line of {torn} bytes at its end; its run is not finished"
            ));
        }
        if self.damaged > 0 {
            let lines = if self.damaged == 1 { "line that does" } else { "lines that do" };
            let damaged = self.damaged;
            notices.push(format!(
                "{file}: found {damaged} {lines} not agree with the checksum; the runs there are not finished"
            ));
        }
        notices
    }
}

/// Reads the log `file`; none if not even its first line is whole, as of a process that was killed
/// at once.
///
/// # Errors
/// [`SweepError`] where it cannot be read or is no log.
pub fn scan(file: &Path) -> Result<Option<Scan>, SweepError> {
    let mut reader = BufReader::with_capacity(1 << 20, File::open(file).map_err(at(file))?);
    let (mut line, mut offset) = (Vec::new(), 0_u64);
    let mut header: Option<LogHeader> = None;
    let no_log = || SweepError::NoLog { file: file.display().to_string() };
    let (mut entries, mut torn, mut damaged) = (Vec::new(), 0, 0);
    loop {
        line.clear();
        let read = reader.read_until(b'\n', &mut line).map_err(at(file))? as u64;
        if read == 0 {
            break;
        }
        if line.last() != Some(&b'\n') {
            // A torn first line is text all the same: what is not is something else, or damaged,
            // and not to be begun again.
            if header.is_none() && line.iter().any(u8::is_ascii_control) {
                return Err(no_log());
            }
            torn = read;
            break;
        }
        let text = sound_text(&line);
        if let Some(header) = &header {
            let number = text.and_then(|text| text.split(',').next()?.parse().ok());
            match (text, number.filter(|run| *run < header.runs)) {
                (Some(text), Some(run)) => entries.push(LoggedRun {
                    run,
                    offset: offset + CHECKSUM_LENGTH as u64,
                    length: u32::try_from(text.len()).unwrap_or(u32::MAX),
                    checksum: crc32fast::hash(text.as_bytes()),
                }),
                _ => damaged += 1,
            }
        } else {
            let found: Option<LogHeader> = text.and_then(|text| serde_json::from_str(text).ok());
            let known = found.filter(|found| found.hertzscope_sweep_log == LOG_VERSION);
            header = Some(known.ok_or_else(no_log)?);
        }
        offset += read;
    }
    let file = file.to_owned();
    Ok(header.map(|header| Scan { file, header, entries, sound: offset, torn, damaged }))
}

/// Contents of a line, if its checksum is right.
fn sound_text(line: &[u8]) -> Option<&str> {
    let text = std::str::from_utf8(line).ok()?.strip_suffix('\n')?;
    let (checksum, text) = (text.get(..CHECKSUM_LENGTH)?, text.get(CHECKSUM_LENGTH..)?);
    let checksum = u32::from_str_radix(checksum.strip_suffix(' ')?, 16).ok()?;
    (checksum == crc32fast::hash(text.as_bytes())).then_some(text)
}

fn write_line(out: &mut Vec<u8>, text: &str) {
    // Writing to memory does not fail.
    let _ = writeln!(out, "{:08x} {text}", crc32fast::hash(text.as_bytes()));
}

/// A log that is being written.
#[derive(Debug)]
pub struct SweepLog {
    file: File,
    path: PathBuf,
}

impl SweepLog {
    /// Opens the log `path`, or begins it. Without `chosen` instructions, a log goes on with those
    /// that it was begun with, and a new one takes `best`. Also returns what it holds, and what the
    /// user should know.
    ///
    /// # Errors
    /// [`SweepError`] where it is of another sweep, of other instructions, or at work elsewhere.
    pub fn open(
        path: &Path,
        plan: &SweepPlan,
        (chosen, best): (Option<&str>, &str),
    ) -> Result<(Self, Scan, Vec<String>), SweepError> {
        let mut options = OpenOptions::new();
        let mut file = options
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(at(path))?;
        let mut notices = Vec::new();
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(SweepError::Busy { file: path.display().to_string() });
            }
            Err(TryLockError::Error(error)) => notices.push(format!(
                "{}: cannot be locked ({error}): see to it that no other process works at this shard",
                path.display()
            )),
        }
        let Some(scan) = scan(path)? else {
            let header = LogHeader::of(plan, chosen.unwrap_or(best));
            let mut line = Vec::new();
            write_line(&mut line, &serde_json::to_string(&header).unwrap_or_default());
            file.set_len(0).and_then(|()| file.write_all(&line)).map_err(at(path))?;
            let (file_name, sound) = (path.to_owned(), line.len() as u64);
            let scan =
                Scan { file: file_name, header, entries: Vec::new(), sound, torn: 0, damaged: 0 };
            return Ok((Self { file, path: path.to_owned() }, scan, notices));
        };
        let instructions = chosen.unwrap_or(&scan.header.instructions);
        if scan.header != LogHeader::of(plan, instructions) {
            return Err(SweepError::OtherSweep { file: path.display().to_string() });
        }
        notices.extend(scan.notices());
        let end = SeekFrom::Start(scan.sound);
        file.set_len(scan.sound).and_then(|()| file.seek(end)).map_err(at(path))?;
        Ok((Self { file, path: path.to_owned() }, scan, notices))
    }

    /// Adds the lines of finished runs.
    ///
    /// # Errors
    /// [`SweepError::File`].
    pub fn append(&mut self, lines: &[String]) -> Result<(), SweepError> {
        let mut text = Vec::with_capacity(lines.iter().map(|line| line.len() + 10).sum());
        for line in lines {
            write_line(&mut text, line);
        }
        self.file.write_all(&text).map_err(at(&self.path))
    }

    /// Waits until everything is on the disk.
    ///
    /// # Errors
    /// [`SweepError::File`].
    pub fn finish(&self) -> Result<(), SweepError> {
        self.file.sync_all().map_err(at(&self.path))
    }
}

/// The logs in `folder`, in the order of their names.
///
/// # Errors
/// [`SweepError::File`] where it cannot be read.
pub fn logs(folder: &Path) -> Result<Vec<PathBuf>, SweepError> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(at(folder))? {
        let file = entry.map_err(at(folder))?.path();
        if file.extension().is_some_and(|extension| extension == "log") {
            files.push(file);
        }
    }
    files.sort();
    Ok(files)
}
