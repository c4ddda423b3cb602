//! A file that refuses everything after a failed write.

use std::fs::File;
use std::io::{self, ErrorKind, Write};

use super::output::after_failure;
use super::step::step;

/// A file that refuses everything after a failed write: who goes on, as destructors do, must not
/// complete what has a gap.
#[derive(Debug)]
pub(super) struct GuardedFile {
    file: File,
    failed: bool,
}

impl GuardedFile {
    pub(super) fn new(file: File) -> Self {
        Self { file, failed: false }
    }

    /// Whether no write has failed.
    ///
    /// # Errors
    /// The error of writing after a failure.
    pub(super) fn check(&self) -> io::Result<()> {
        if self.failed { Err(after_failure()) } else { Ok(()) }
    }

    /// Waits until all is on the disk.
    ///
    /// # Errors
    /// That of [`Self::check`], or the system's.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.check()?;
        step();
        self.file.sync_all()
    }
}

impl Write for GuardedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.check()?;
        step();
        let written = self.file.write(bytes);
        self.failed |= written.as_ref().is_err_and(|error| error.kind() != ErrorKind::Interrupted);
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
