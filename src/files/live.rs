//! A file that others read while it grows.

use std::fs::OpenOptions;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::guarded::GuardedFile;
use super::output::{Output, folder_of, numbered};
use super::step::step;

/// A file that others read while it grows: it has its name from the beginning, and a lock until it
/// is complete.
#[derive(Debug)]
pub struct LiveFile {
    path: PathBuf,
    file: GuardedFile,
}

impl LiveFile {
    /// Creates `target` or, if that exists, the first free name of [`numbered`]; missing folders
    /// are made.
    ///
    /// # Errors
    /// The system's error.
    pub fn numbered(target: &Path) -> io::Result<Self> {
        std::fs::create_dir_all(folder_of(target))?;
        for path in numbered(target) {
            step();
            match OpenOptions::new().read(true).write(true).create_new(true).open(&path) {
                Ok(file) => {
                    // Without locks others do not know that this one is being written.
                    let _ = file.try_lock();
                    return Ok(Self { path, file: GuardedFile::new(file) });
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(ErrorKind::AlreadyExists.into())
    }

    /// Its name.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Write for LiveFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Output for LiveFile {
    fn complete(self: Box<Self>) -> io::Result<PathBuf> {
        self.file.sync()?;
        Ok(self.path)
    }
}
