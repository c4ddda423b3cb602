//! Folders written under a temporary name and moved into place when they are complete: every
//! command that writes several files together.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::output::{folder_of, sync_folder};
use super::part;
use super::step::step;
use super::whole::write;

/// A folder that is written under a temporary name and moved into place when complete. If dropped
/// earlier, the temporary folder is deleted.
#[derive(Debug)]
pub struct NewFolder {
    target: PathBuf,
    part: PathBuf,
    /// Holds the lock that tells others that the folder is being written.
    _lock: Option<File>,
}

impl NewFolder {
    /// Starts a folder whose files will replace those of the same name in `target` in one step;
    /// other files in `target` are kept. Where the two cannot be swapped (a mount point, the
    /// working directory, some operating systems), the files are replaced one at a time.
    ///
    /// # Errors
    /// [`ErrorKind::ResourceBusy`] if another process is writing `target`; otherwise the operating
    /// system's error.
    pub fn replace(target: &Path) -> io::Result<Self> {
        let target = std::fs::canonicalize(target).unwrap_or_else(|_| target.to_owned());
        if std::fs::metadata(&target).is_ok_and(|found| !found.is_dir()) {
            return Err(ErrorKind::NotADirectory.into());
        }
        let made = part::create(&target, |path| std::fs::create_dir(path));
        let (part, ()) = match made {
            // The parent folder may be read-only: the temporary folder is made in the target.
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

    /// Moves the folder to its final name.
    ///
    /// # Errors
    /// The operating system's error. The old contents are unchanged then, unless files had to be
    /// replaced one at a time.
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
        let files = files_in(&self.part, Path::new(""))?;
        // A process with this working directory would stay in the old folder.
        let inside = std::env::current_dir()
            .and_then(std::fs::canonicalize)
            .is_ok_and(|here| here.starts_with(&self.target));
        if !inside && !self.part.starts_with(&self.target) && self.exchange().is_ok() {
            return Ok(());
        }
        for file in files {
            let place = self.target.join(&file);
            std::fs::create_dir_all(folder_of(&place))?;
            write(&place, std::fs::read(self.part.join(&file))?)?;
        }
        Ok(())
    }

    /// Swaps the two folders after hard-linking the other files of the old one into the new one.
    #[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
    fn exchange(&self) -> io::Result<()> {
        use rustix::fs::{CWD, RenameFlags, renameat_with};

        link_others(&self.target, &self.part)?;
        let permissions = std::fs::metadata(&self.target)?.permissions();
        std::fs::set_permissions(&self.part, permissions)?;
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
        // After a failure this is the incomplete folder, after a swap the old one, whose kept files
        // are hard-linked elsewhere.
        let _ = std::fs::remove_dir_all(&self.part);
    }
}

/// The files in `folder` and its subfolders, by their paths from it, each behind `before`.
fn files_in(folder: &Path, before: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let path = before.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            files.extend(files_in(&entry.path(), &path)?);
        } else {
            files.push(path);
        }
    }
    Ok(files)
}

/// Hard-links into `to` every file of `from` that it lacks, in subfolders too.
#[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
fn link_others(from: &Path, to: &Path) -> io::Result<()> {
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let (old, new) = (entry.path(), to.join(entry.file_name()));
        let kind = entry.file_type()?;
        match new.symlink_metadata() {
            Ok(found) if found.is_dir() && kind.is_dir() => {
                link_others(&old, &new)?;
                continue;
            }
            Ok(_) => continue,
            Err(_) => {}
        }
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

/// Creates the first folder `parent/name(N)`, N = 0, 1, ..., that does not exist yet, with the
/// contents `files(N)`. Returns the paths of the files.
///
/// # Errors
/// The operating system's error; then nothing is left behind.
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

#[cfg(test)]
mod tests {
    use super::NewFolder;

    #[test]
    fn files_beside_the_new_ones_are_kept_in_subfolders_too() {
        let around = tempfile::tempdir().expect("a folder");
        let target = around.path().join("results");
        let old = |name: &str| {
            let path = target.join(name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(path, "old").expect("a file");
        };
        for name in ["notes.txt", "report.txt", "raw/notes.txt", "raw/report.txt", "lab/notes.txt"]
        {
            old(name);
        }
        let new = NewFolder::replace(&target).expect("a folder");
        std::fs::create_dir(new.join("raw")).expect("a folder");
        for name in ["report.txt", "raw/report.txt"] {
            std::fs::write(new.join(name), "new").expect("a file");
        }
        new.complete().expect("the folder in place");
        let text = |name: &str| std::fs::read_to_string(target.join(name)).expect(name);
        for name in ["notes.txt", "raw/notes.txt", "lab/notes.txt"] {
            assert_eq!(text(name), "old", "{name}");
        }
        for name in ["report.txt", "raw/report.txt"] {
            assert_eq!(text(name), "new", "{name}");
        }
        assert_eq!(std::fs::read_dir(around.path()).expect("a folder").count(), 1);
    }
}
