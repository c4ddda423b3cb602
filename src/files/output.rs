//! What all writers of files share: completion, numbered names, folders.

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file that is written from its beginning to its end.
pub trait Output: Write + Send {
    /// Completes the file: everything is on the disk and has its name when this returns. Returns
    /// that name.
    ///
    /// # Errors
    /// The system's error; a [`NewFile`](super::NewFile) then leaves what was there before.
    fn complete(self: Box<Self>) -> io::Result<PathBuf>;
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
pub(super) fn busy() -> io::Error {
    io::Error::new(
        io::ErrorKind::ResourceBusy,
        "another process is writing it: wait until that is done, or choose another name",
    )
}

/// Something could not be written before.
pub(super) fn after_failure() -> io::Error {
    io::Error::other("an earlier part of the file could not be written")
}

/// The folder of `file`.
pub(super) fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Has the disk keep a renaming in `folder`; where that is not possible, the system does it in its
/// own time.
pub(super) fn sync_folder(folder: &Path) {
    if cfg!(unix) {
        let _ = std::fs::File::open(folder).and_then(|folder| folder.sync_all());
    }
}
