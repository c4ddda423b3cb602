//! Writes files so that a name holds either what it held before or all that is new, whatever ends the program in between.
//!
//! [`NewFile`] is written under a temporary name in the same folder, synchronised and renamed; [`NewFolder`] is filled under a temporary
//! name and renamed when it is complete. [`LiveFile`] is written under its own name, because others read it while it grows; a lock keeps a
//! second writer away. What the user names is replaced by a complete new file. Names that the program chooses, and records of what happened
//! only once, never replace anything: the next free number is taken ([`numbered`]).
//!
//! Temporary names are `.NAME.PID-N.part`. Those of processes that were killed are removed by the next writer of the same name.
//! Limits: where the system has no file locks (some network file systems), two writers are not kept apart: each still writes whole files,
//! and the last one stays.

mod folder;
mod live;
mod part;
mod step;
mod whole;

pub use folder::{NewFolder, write_numbered_folder};
pub use live::LiveFile;
pub use whole::NewFile;

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file that is written from its beginning to its end.
pub trait Output: Write + Send {
    /// Completes the file: everything is on the disk and has its name when this returns. Returns that name.
    ///
    /// # Errors
    /// What the system says; a [`NewFile`] then leaves what was there before.
    fn complete(self: Box<Self>) -> io::Result<PathBuf>;
}

/// Writes `bytes` to `file`, replacing it in one step.
///
/// # Errors
/// What the system says; `file` then is as it was.
pub fn write(file: &Path, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let mut new = NewFile::replace(file)?;
    new.write_all(bytes.as_ref())?;
    Box::new(new).complete().map(|_| ())
}

/// Writes several files, each replaced in one step; all are on the disk before the first is renamed, in the order given.
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

/// `file`, then the same with `-2`, `-3`, ... before the ending.
pub fn numbered(file: &Path) -> impl Iterator<Item = PathBuf> {
    let stem = file.file_stem().unwrap_or_default().to_owned();
    let ending = file.extension().map(std::ffi::OsStr::to_owned);
    let first = file.to_owned();
    let others = (2..).map({
        let first = first.clone();
        move |number: u32| {
            let mut name: OsString = stem.clone();
            name.push(format!("-{number}"));
            if let Some(ending) = &ending {
                name.push(".");
                name.push(ending);
            }
            first.with_file_name(name)
        }
    });
    std::iter::once(first).chain(others)
}

/// Another process writes under this name.
fn busy() -> io::Error {
    io::Error::new(
        io::ErrorKind::ResourceBusy,
        "another process is writing it: wait until that is done, or choose another name",
    )
}

/// Something could not be written before.
fn after_failure() -> io::Error {
    io::Error::other("an earlier part of the file could not be written")
}

/// The folder of `file`.
fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Has the disk keep a renaming in `folder`; where that is not possible, the system does it in its own time.
fn sync_folder(folder: &Path) {
    if cfg!(unix) {
        let _ = std::fs::File::open(folder).and_then(|folder| folder.sync_all());
    }
}
