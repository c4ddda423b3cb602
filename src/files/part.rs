//! Temporary names beside the final one, and the locks that tell whether their writers are alive.

use std::ffi::OsString;
use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use super::output::{busy, folder_of};
use super::step::step;

/// Ending of temporary names.
const ENDING: &str = ".part";
/// Age from which an unlocked temporary file is removed: a new one is not locked yet for an
/// instant.
const STALE_AGE: Duration = Duration::from_secs(60);

/// Creates something under a temporary name beside `target`; other writers of the same name are
/// refused.
///
/// # Errors
/// [`ErrorKind::ResourceBusy`] where another process writes `target`; what the system says
/// otherwise.
pub(super) fn create<T>(
    target: &Path,
    make: impl Fn(&Path) -> io::Result<T>,
) -> io::Result<(PathBuf, T)> {
    if has_live_writer(target)? {
        return Err(busy());
    }
    create_beside(target, make)
}

/// Creates something under a temporary name beside `target` that no other process uses.
///
/// # Errors
/// The system's error.
pub(super) fn create_beside<T>(
    target: &Path,
    make: impl Fn(&Path) -> io::Result<T>,
) -> io::Result<(PathBuf, T)> {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let folder = folder_of(target);
    std::fs::create_dir_all(folder)?;
    has_live_writer(target)?;
    let prefix = prefix_of(target);
    loop {
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let mut name = prefix.clone();
        name.push(format!("{}-{number}{ENDING}", std::process::id()));
        let part = folder.join(name);
        step();
        match make(&part) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            made => return made.map(|made| (part, made)),
        }
    }
}

/// How temporary names beside `target` begin.
fn prefix_of(target: &Path) -> OsString {
    let mut prefix = OsString::from(".");
    prefix.push(target.file_name().unwrap_or_default());
    prefix.push(".");
    prefix
}

/// Whether another writer of `target` is alive; removes what killed ones left behind.
fn has_live_writer(target: &Path) -> io::Result<bool> {
    let (folder, prefix) = (folder_of(target), prefix_of(target));
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
        // A folder that may be written to but not read.
        Err(error) if error.kind() == ErrorKind::PermissionDenied => return Ok(false),
        Err(error) => return Err(error),
    };
    let mut is_alive = false;
    for entry in entries {
        let entry = entry?;
        let name = entry.file_name();
        let name = name.as_encoded_bytes();
        if !name.starts_with(prefix.as_encoded_bytes()) || !name.ends_with(ENDING.as_bytes()) {
            continue;
        }
        let path = entry.path();
        let Ok(opened) = File::open(&path) else { continue };
        match opened.try_lock() {
            Err(TryLockError::WouldBlock) => {
                is_alive = true;
                continue;
            }
            // Without locks it is unknown whether its writer is alive.
            Err(TryLockError::Error(_)) => continue,
            Ok(()) => {}
        }
        let age = entry.metadata().and_then(|m| m.modified()).map(|time| time.elapsed());
        if age.is_ok_and(|age| age.is_ok_and(|age| age > STALE_AGE)) {
            // Another writer may have been faster.
            let _ = if path.is_dir() {
                std::fs::remove_dir_all(&path)
            } else {
                std::fs::remove_file(&path)
            };
        }
    }
    Ok(is_alive)
}

/// Refuses a file that another process has locked, such as a recording that is still growing.
pub(super) fn refuse_locked(file: &Path) -> io::Result<()> {
    match File::open(file).map(|opened| opened.try_lock()) {
        Ok(Err(TryLockError::WouldBlock)) => Err(busy()),
        // Nothing there, or nothing known about it: writing tells.
        Ok(_) | Err(_) => Ok(()),
    }
}
