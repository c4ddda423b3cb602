//! A file that gets its name when it is complete.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::guarded::GuardedFile;
use super::output::{Output, folder_of, numbered, sync_folder};
use super::part;
use super::step::step;

/// A file that gets its name when it is complete; dropped before that, it leaves no trace.
#[derive(Debug)]
pub struct NewFile {
    target: PathBuf,
    file: GuardedFile,
    /// Temporary name; none where `target` is a device or a pipe, which cannot be replaced.
    part: Option<PathBuf>,
    /// Whether a file that is called so already stays, and the new one takes the next free number.
    is_numbered: bool,
}

impl NewFile {
    /// Begins a file that replaces `target`; missing folders are made.
    ///
    /// # Errors
    /// [`ErrorKind::ResourceBusy`] where another process writes `target`; what the system says
    /// otherwise.
    pub fn replace(target: &Path) -> io::Result<Self> {
        // A link stays, and what it points to is replaced.
        let target = std::fs::canonicalize(target).unwrap_or_else(|_| target.to_owned());
        let before = std::fs::metadata(&target).ok();
        if before.as_ref().is_some_and(std::fs::Metadata::is_dir) {
            return Err(ErrorKind::IsADirectory.into());
        }
        if before.as_ref().is_some_and(|before| !before.is_file()) {
            step();
            let file = OpenOptions::new().write(true).open(&target)?;
            return Ok(Self {
                target,
                file: GuardedFile::new(file),
                part: None,
                is_numbered: false,
            });
        }
        if before.as_ref().is_some_and(|before| before.permissions().readonly()) {
            return Err(ErrorKind::PermissionDenied.into());
        }
        part::refuse_locked(&target)?;
        let (part, file) = part::create(&target, create_new)?;
        if let Some(before) = before {
            // Where rights cannot be set, the new file has the usual ones.
            let _ = file.set_permissions(before.permissions());
        }
        Ok(Self { target, file: GuardedFile::new(file), part: Some(part), is_numbered: false })
    }

    /// Begins a file that is called `target` or, if there is one already when it is complete, by
    /// the first free name of [`numbered`].
    ///
    /// # Errors
    /// The system's error.
    pub fn numbered(target: &Path) -> io::Result<Self> {
        // Several may be written at a time, each gets a name of its own.
        let (part, file) = part::create_beside(target, create_new)?;
        let target = target.to_owned();
        Ok(Self { target, file: GuardedFile::new(file), part: Some(part), is_numbered: true })
    }

    fn rename(&self, part: &Path) -> io::Result<PathBuf> {
        if !self.is_numbered {
            step();
            std::fs::rename(part, &self.target)?;
            return Ok(self.target.clone());
        }
        for target in numbered(&self.target) {
            step();
            match std::fs::hard_link(part, &target) {
                Ok(()) => {
                    step();
                    std::fs::remove_file(part)?;
                    return Ok(target);
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                // No hard links here: the name is taken first, and then replaced.
                Err(_) => match create_new(&target) {
                    Ok(_) => {
                        std::fs::rename(part, &target)?;
                        return Ok(target);
                    }
                    Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                    Err(error) => return Err(error),
                },
            }
        }
        Err(ErrorKind::AlreadyExists.into())
    }
}

fn create_new(path: &Path) -> io::Result<File> {
    let file = OpenOptions::new().read(true).write(true).create_new(true).open(path)?;
    // Waits for processes that test the lock. Without locks others do not know that this file is
    // being written.
    let _ = file.lock();
    Ok(file)
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Output for NewFile {
    fn complete(mut self: Box<Self>) -> io::Result<PathBuf> {
        self.file.check()?;
        let Some(part) = self.part.clone() else { return Ok(self.target.clone()) };
        self.file.sync()?;
        let name = self.rename(&part)?;
        self.part = None;
        sync_folder(folder_of(&name));
        Ok(name)
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        if let Some(part) = &self.part {
            // What failed has been reported; this is only tidying up.
            let _ = std::fs::remove_file(part);
        }
    }
}

/// Writes `bytes` to `file`, replacing it in one step.
///
/// # Errors
/// The system's error; `file` then is as it was.
pub fn write(file: &Path, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let mut new = NewFile::replace(file)?;
    new.write_all(bytes.as_ref())?;
    Box::new(new).complete().map(|_| ())
}

/// Writes several files, each replaced in one step; all are on the disk before the first is
/// renamed, in the order given.
///
/// # Errors
/// The file with which it failed, and what the system says.
pub fn write_together(files: &[(PathBuf, &str)]) -> Result<(), (PathBuf, io::Error)> {
    let mut written = Vec::new();
    for (file, text) in files {
        let begun = NewFile::replace(file).and_then(|mut new| {
            new.write_all(text.as_bytes())?;
            Ok(new)
        });
        written.push((file, begun.map_err(|error| (file.clone(), error))?));
    }
    for (file, new) in written {
        Box::new(new).complete().map_err(|error| (file.clone(), error))?;
    }
    Ok(())
}
