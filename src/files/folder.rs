//! A folder that gets its name when it is complete.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::output::{folder_of, sync_folder};
use super::part;
use super::step::step;
use super::whole::write;

/// A folder that gets its name when it is complete; dropped before that, it leaves no trace.
#[derive(Debug)]
pub struct NewFolder {
    target: PathBuf,
    part: PathBuf,
    /// Holds the lock that tells others that the folder is being written.
    _lock: Option<File>,
}

impl NewFolder {
    /// Begins a folder whose files replace those of the same name in `target`, all at once. What else
    /// lies in `target` stays. Where two folders cannot be exchanged (a mounted one, the working one, some systems), each file is replaced
    /// by itself.
    ///
    /// # Errors
    /// [`ErrorKind::ResourceBusy`] where another process writes `target`; what the system says otherwise.
    pub fn replace(target: &Path) -> io::Result<Self> {
        let target = std::fs::canonicalize(target).unwrap_or_else(|_| target.to_owned());
        if std::fs::metadata(&target).is_ok_and(|found| !found.is_dir()) {
            return Err(ErrorKind::NotADirectory.into());
        }
        let made = part::create(&target, |path| std::fs::create_dir(path));
        let (part, ()) = match made {
            // The folder around may not be written to.
            Err(error) if error.kind() == ErrorKind::PermissionDenied && target.is_dir() => {
                part::create(&target.join("results"), |path| std::fs::create_dir(path))?
            }
            made => made?,
        };
        Ok(Self::begun(target, part))
    }

    fn begun(target: PathBuf, part: PathBuf) -> Self {
        let lock = File::open(&part).ok().filter(|folder| folder.lock().is_ok());
        Self { target, part, _lock: lock }
    }

    /// Where a file of this name is to be written.
    pub fn join(&self, name: impl AsRef<Path>) -> PathBuf {
        self.part.join(name)
    }

    /// Gives the folder its name.
    ///
    /// # Errors
    /// The system's error; what was there before then is as it was.
    pub fn complete(self) -> io::Result<()> {
        sync_folder(&self.part);
        if !self.target.exists() {
            step();
            match std::fs::rename(&self.part, &self.target) {
                Ok(()) => {
                    sync_folder(folder_of(&self.target));
                    return Ok(());
                }
                // Another process was faster.
                Err(_) if self.target.is_dir() => {}
                Err(error) => return Err(error),
            }
        }
        // A process with this working directory would stay in the old folder.
        let inside = std::env::current_dir()
            .and_then(std::fs::canonicalize)
            .is_ok_and(|here| here.starts_with(&self.target));
        if !inside && !self.part.starts_with(&self.target) && self.exchange().is_ok() {
            return Ok(());
        }
        for entry in std::fs::read_dir(&self.part)? {
            let entry = entry?;
            write(&self.target.join(entry.file_name()), std::fs::read(entry.path())?)?;
        }
        Ok(())
    }

    /// Exchanges the names of the new folder and the old one, whose other files get a second name in the new one before.
    #[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
    fn exchange(&self) -> io::Result<()> {
        use rustix::fs::{CWD, RenameFlags, renameat_with};

        link_others(&self.target, &self.part)?;
        let rights = std::fs::metadata(&self.target)?.permissions();
        std::fs::set_permissions(&self.part, rights)?;
        sync_folder(&self.part);
        step();
        renameat_with(CWD, &self.part, CWD, &self.target, RenameFlags::EXCHANGE)?;
        step();
        sync_folder(folder_of(&self.target));
        Ok(())
    }

    /// Elsewhere no two names can be exchanged.
    #[cfg(not(any(target_os = "linux", target_os = "android", target_vendor = "apple")))]
    fn exchange(&self) -> io::Result<()> {
        Err(ErrorKind::Unsupported.into())
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        // The new one that failed, or the old one that was exchanged; all that is left of it has other names.
        let _ = std::fs::remove_dir_all(&self.part);
    }
}

/// Gives everything in `from` that `to` does not hold a second name there.
#[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
fn link_others(from: &Path, to: &Path) -> io::Result<()> {
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let (old, new) = (entry.path(), to.join(entry.file_name()));
        if new.symlink_metadata().is_ok() {
            continue;
        }
        let kind = entry.file_type()?;
        step();
        if kind.is_dir() {
            std::fs::create_dir(&new)?;
            link_others(&old, &new)?;
            std::fs::set_permissions(&new, std::fs::metadata(&old)?.permissions())?;
        } else {
            std::fs::hard_link(&old, &new)?;
        }
    }
    Ok(())
}

/// Makes the first folder `parent/name(N)`, from N = 0, that does not exist, complete with `files(N)`. Returns the names of these.
///
/// # Errors
/// The system's error; there is no part of the folder then.
pub fn write_numbered_folder(
    parent: &Path,
    name: impl Fn(u32) -> String,
    files: impl Fn(u32) -> Vec<(String, Vec<u8>)>,
) -> io::Result<Vec<PathBuf>> {
    let mut number = 0;
    loop {
        let target = parent.join(name(number));
        if target.symlink_metadata().is_ok() {
            number += 1;
            continue;
        }
        let (part, ()) = part::create_beside(&target, |path| std::fs::create_dir(path))?;
        let new = NewFolder::begun(target.clone(), part);
        let files = files(number);
        for (name, bytes) in &files {
            write(&new.join(name), bytes)?;
        }
        step();
        // A folder that holds something is never replaced by this.
        match std::fs::rename(&new.part, &target) {
            Ok(()) => {
                sync_folder(parent);
                return Ok(files.into_iter().map(|(name, _)| target.join(name)).collect());
            }
            Err(_) if target.exists() => {}
            Err(error) => return Err(error),
        }
    }
}
