//! Writes files atomically: after a crash a file has its old or its complete new contents.
//!
//! A [`NewFile`] is written under a temporary name in the same folder, synchronised, and renamed
//! when it is complete. What the user names is replaced. Names that the program chooses never
//! replace anything: the next free number is taken ([`numbered`]). A live file is written under
//! its own name, because others read it while it grows. The files of a [`NewFolder`] are renamed
//! one after the other when all of them are complete.
//!
//! The temporary name of `x.mcap` is `.x.mcap.part`. It is locked while it is written, so that a
//! second writer is refused; if the writer was killed, the next one takes the name over. Where the
//! system has no file locks (some network file systems), each writer has a name of its own, and the
//! last one stays.

use std::ffi::OsString;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

/// Links that are followed from the name of a new file.
const MAX_LINKS: usize = 40;

/// A file that is written from its beginning to its end. Dropped before it is complete, it leaves
/// no trace.
#[derive(Debug)]
pub struct NewFile {
    target: PathBuf,
    /// Dropped before `file`: the temporary name is removed while it is locked.
    kind: Kind,
    file: LockedFile,
    /// Whether a write has failed: nothing is accepted after it, so that destructors cannot
    /// complete a file with a gap.
    is_broken: bool,
    /// Folders that were made for the file.
    _folders: MadeFolders,
}

/// An open file that may be locked. Dropping it releases the lock, even while a child process that
/// is being started still has the file open.
#[derive(Debug)]
struct LockedFile(File);

impl Drop for LockedFile {
    fn drop(&mut self) {
        // Without locks there is none to end.
        let _ = self.0.unlock();
    }
}

/// What becomes of the file when it is complete.
#[derive(Debug)]
enum Kind {
    /// Renamed to the target, in the place of what is there.
    Replacing(TempPath),
    /// Renamed to the target or, if that exists, to its next free number.
    Numbered(TempPath),
    /// It has its name: a growing recording, a device, or a pipe.
    InPlace,
}

impl NewFile {
    /// Begins a file that replaces `target`; missing folders are made.
    ///
    /// # Errors
    /// [`ErrorKind::ResourceBusy`] if another process is writing `target`; otherwise the operating
    /// system's error.
    pub fn replace(target: &Path) -> io::Result<Self> {
        // A link stays, and the file that it points to is written.
        let target = resolved(target);
        let before = std::fs::metadata(&target).ok();
        if let Some(before) = &before {
            if before.is_dir() {
                return Err(ErrorKind::IsADirectory.into());
            }
            if !before.is_file() {
                step();
                let file = OpenOptions::new().write(true).open(&target)?;
                return Ok(Self::new(target, file, Kind::InPlace, MadeFolders::default()));
            }
            if before.permissions().readonly() {
                return Err(ErrorKind::PermissionDenied.into());
            }
            if File::open(&target).is_ok_and(|file| is_locked(&file)) {
                return Err(busy());
            }
        }
        let folders = MadeFolders::make(folder_of(&target))?;
        let (file, part) = part_file(&target, true)?;
        if let Some(before) = before {
            // Where permissions cannot be set, the new file has the usual ones.
            let _ = file.set_permissions(before.permissions());
        }
        Ok(Self::new(target, file, Kind::Replacing(part), folders))
    }

    /// Begins a file that is called `target` or, if that exists when it is complete, by the first
    /// free name of [`numbered`]. Several may be written at a time.
    ///
    /// # Errors
    /// The operating system's error.
    pub fn numbered(target: &Path) -> io::Result<Self> {
        let folders = MadeFolders::make(folder_of(target))?;
        let (file, part) = part_file(target, false)?;
        Ok(Self::new(target.to_owned(), file, Kind::Numbered(part), folders))
    }

    /// Begins a file that others read while it grows: `target` or, if that exists, the first free
    /// name of [`numbered`]. It is locked until it is complete.
    ///
    /// # Errors
    /// The operating system's error.
    pub fn live(target: &Path) -> io::Result<Self> {
        let folders = MadeFolders::make(folder_of(target))?;
        for path in numbered(target) {
            step();
            match OpenOptions::new().read(true).write(true).create_new(true).open(&path) {
                Ok(file) => {
                    // Without locks, others do not know that this one is being written.
                    let _ = file.try_lock();
                    return Ok(Self::new(path, file, Kind::InPlace, folders));
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(ErrorKind::AlreadyExists.into())
    }

    fn new(target: PathBuf, file: File, kind: Kind, folders: MadeFolders) -> Self {
        Self { target, kind, file: LockedFile(file), is_broken: false, _folders: folders }
    }

    /// Its name; a numbered file may get another one when it is complete.
    pub fn path(&self) -> &Path {
        &self.target
    }

    /// Completes the file: everything is on the disk and has its name when this returns. Returns
    /// that name.
    ///
    /// # Errors
    /// The operating system's error; a file that was to be replaced is as before.
    pub fn complete(self) -> io::Result<PathBuf> {
        self.check()?;
        step();
        match self.file.0.sync_all() {
            // Devices and pipes have no disk.
            Err(error) if !matches!(self.kind, Kind::InPlace) || self.path().is_file() => {
                return Err(error);
            }
            _ => {}
        }
        let name = match self.kind {
            Kind::InPlace => return Ok(self.target),
            Kind::Replacing(part) => {
                step();
                part.persist(&self.target)?;
                self.target
            }
            Kind::Numbered(part) => persist_numbered(part, &self.target)?,
        };
        sync_folder(folder_of(&name));
        Ok(name)
    }

    fn check(&self) -> io::Result<()> {
        if self.is_broken {
            return Err(io::Error::other("an earlier part of the file could not be written"));
        }
        Ok(())
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.check()?;
        step();
        let written = self.file.0.write(bytes);
        self.is_broken |=
            written.as_ref().is_err_and(|error| error.kind() != ErrorKind::Interrupted);
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.0.flush()
    }
}

fn persist_numbered(mut part: TempPath, target: &Path) -> io::Result<PathBuf> {
    for name in numbered(target) {
        step();
        match part.persist_noclobber(&name) {
            Ok(()) => return Ok(name),
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists => part = error.path,
            Err(error) => return Err(error.error),
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}

/// Writes `bytes` to `file`, replacing it.
///
/// # Errors
/// The operating system's error; `file` then is as before.
pub fn write(file: &Path, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let mut new = NewFile::replace(file)?;
    new.write_all(bytes.as_ref())?;
    new.complete().map(|_| ())
}

/// Writes several files; all of them are on the disk before the first is renamed, in the order
/// given.
///
/// # Errors
/// The file with which it failed, and the operating system's error.
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
        new.complete().map_err(|error| (file.clone(), error))?;
    }
    Ok(())
}

/// A folder whose files are written under a temporary name and moved into place when all of them
/// are complete. Dropped before that, it leaves no trace.
#[derive(Debug)]
pub struct NewFolder {
    target: PathBuf,
    part: PathBuf,
    /// Whether `part` has been renamed; the name may be another writer's by now.
    is_renamed: bool,
    /// Holds the lock of the temporary folder.
    _lock: Option<LockedFile>,
    _folders: MadeFolders,
}

impl NewFolder {
    /// Begins a folder whose files will replace those of the same names in `target`; other files
    /// in `target` stay.
    ///
    /// # Errors
    /// [`ErrorKind::ResourceBusy`] if another process is writing `target`; otherwise the operating
    /// system's error.
    pub fn replace(target: &Path) -> io::Result<Self> {
        let target = resolved(target);
        if std::fs::metadata(&target).is_ok_and(|found| !found.is_dir()) {
            return Err(ErrorKind::NotADirectory.into());
        }
        let folders = MadeFolders::make(folder_of(&target))?;
        let (part, lock) = match part_folder(&target, true) {
            // The parent may be read-only: the temporary folder is made in the target.
            Err(error) if error.kind() == ErrorKind::PermissionDenied && target.is_dir() => {
                part_folder(&target.join("results"), true)?
            }
            made => made?,
        };
        Ok(Self { target, part, is_renamed: false, _lock: lock, _folders: folders })
    }

    /// Where a file of this name is to be written.
    pub fn join(&self, name: impl AsRef<Path>) -> PathBuf {
        self.part.join(name)
    }

    /// Moves the files to their names, one after the other; a folder that does not exist yet
    /// appears with all of them.
    ///
    /// # Errors
    /// The operating system's error.
    pub fn complete(mut self) -> io::Result<()> {
        sync_folder(&self.part);
        step();
        if !self.target.exists() && std::fs::rename(&self.part, &self.target).is_ok() {
            self.is_renamed = true;
            sync_folder(folder_of(&self.target));
            return Ok(());
        }
        move_files(&self.part, &self.target)
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        if !self.is_renamed {
            let _ = std::fs::remove_dir_all(&self.part);
        }
    }
}

/// Moves the files in `from` and its subfolders to the same places in `to`.
fn move_files(from: &Path, to: &Path) -> io::Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            move_files(&entry.path(), &target)?;
            continue;
        }
        if std::fs::metadata(&target).is_ok_and(|before| before.permissions().readonly()) {
            return Err(ErrorKind::PermissionDenied.into());
        }
        step();
        std::fs::rename(entry.path(), resolved(&target))?;
    }
    sync_folder(to);
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
    let folders = MadeFolders::make(parent)?;
    let (part, lock) = part_folder(&parent.join("new"), false)?;
    let target = parent.to_owned();
    let mut new = NewFolder { target, part, is_renamed: false, _lock: lock, _folders: folders };
    for number in 0.. {
        let target = parent.join(name(number));
        if target.symlink_metadata().is_ok() {
            continue;
        }
        let files = files(number);
        for (name, bytes) in &files {
            write(&new.join(name), bytes)?;
        }
        sync_folder(&new.part);
        step();
        // A folder that holds something is never replaced by this.
        match std::fs::rename(&new.part, &target) {
            Ok(()) => {
                new.is_renamed = true;
                sync_folder(parent);
                return Ok(files.into_iter().map(|(name, _)| target.join(name)).collect());
            }
            // Another process was faster.
            Err(_) if target.exists() => empty(&new.part)?,
            Err(error) => return Err(error),
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}

/// `file`, then the same with `-2`, `-3`, ... before the ending.
pub fn numbered(file: &Path) -> impl Iterator<Item = PathBuf> {
    let first = file.to_owned();
    let others = (2_u32..).map(move |number| {
        let mut name: OsString = first.file_stem().unwrap_or_default().to_owned();
        name.push(format!("-{number}"));
        if let Some(ending) = first.extension() {
            name.push(".");
            name.push(ending);
        }
        first.with_file_name(name)
    });
    std::iter::once(file.to_owned()).chain(others)
}

/// The locked temporary file of `target`. If it is in use, `exclusive` refuses; otherwise the next
/// number is taken.
fn part_file(target: &Path, exclusive: bool) -> io::Result<(File, TempPath)> {
    for part in numbered(&part_of(target)) {
        // What is there and not a file was not left by a writer.
        if std::fs::symlink_metadata(&part).is_ok_and(|found| !found.is_file()) {
            continue;
        }
        step();
        let options = || {
            let mut options = OpenOptions::new();
            options.read(true).write(true).create(true).truncate(false);
            options
        };
        let file = options().open(&part)?;
        match file.try_lock() {
            // A writer that was faster has renamed or removed it.
            Ok(()) if !is_at(&file, &part) => return part_file(target, exclusive),
            Ok(()) => {
                file.set_len(0)?;
                return Ok((file, TempPath::try_from_path(part)?));
            }
            Err(TryLockError::WouldBlock) if exclusive => return Err(busy()),
            Err(TryLockError::WouldBlock) => {}
            // Without locks, each process has a name of its own.
            Err(TryLockError::Error(_)) => {
                let part = part.with_extension(format!("{}.part", std::process::id()));
                let file = options().create_new(true).open(&part)?;
                return Ok((file, TempPath::try_from_path(part)?));
            }
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}

/// The same for a folder; what a killed writer left in it is removed.
fn part_folder(target: &Path, exclusive: bool) -> io::Result<(PathBuf, Option<LockedFile>)> {
    for part in numbered(&part_of(target)) {
        step();
        match std::fs::create_dir(&part) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists && part.is_dir() => {}
            Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
            made => made?,
        }
        // Folders can be opened and locked on Unix only.
        let Ok(folder) = File::open(&part) else { return Ok((part, None)) };
        match folder.try_lock() {
            Ok(()) if !is_at(&folder, &part) => return part_folder(target, exclusive),
            Ok(()) => {
                empty(&part)?;
                return Ok((part, Some(LockedFile(folder))));
            }
            Err(TryLockError::WouldBlock) if exclusive => return Err(busy()),
            Err(TryLockError::WouldBlock) => {}
            Err(TryLockError::Error(_)) => return Ok((part, None)),
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}

/// Removes everything in `folder`.
fn empty(folder: &Path) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            std::fs::remove_dir_all(entry.path())?;
        } else {
            std::fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// The temporary name of `target`.
fn part_of(target: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(target.file_name().unwrap_or_default());
    name.push(".part");
    target.with_file_name(name)
}

/// Whether `path` still names `file`.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let identity = |found: std::fs::Metadata| (found.dev(), found.ino());
    let (here, there) = (file.metadata().map(identity), std::fs::metadata(path).map(identity));
    matches!((here, there), (Ok(here), Ok(there)) if here == there)
}

/// Elsewhere a file that is open keeps its name.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}

fn is_locked(file: &File) -> bool {
    match file.try_lock() {
        Ok(()) => {
            let _ = file.unlock();
            false
        }
        Err(error) => matches!(error, TryLockError::WouldBlock),
    }
}

fn busy() -> io::Error {
    io::Error::new(
        ErrorKind::ResourceBusy,
        "another process is writing it: wait until that is done, or choose another name",
    )
}

/// The file that `path` names at the end of its links, which need not exist.
fn resolved(path: &Path) -> PathBuf {
    if let Ok(path) = std::fs::canonicalize(path) {
        return path;
    }
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(link) = std::fs::read_link(&path) else { break };
        path = folder_of(&path).join(link);
    }
    path
}

/// The folder of `file`.
fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Waits until the disk has the names in `folder`; if that is not possible, the system writes them
/// later.
fn sync_folder(folder: &Path) {
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

/// Folders that were made for an output. Those that are still empty when this is dropped are
/// removed.
#[derive(Debug, Default)]
struct MadeFolders(Vec<PathBuf>);

impl MadeFolders {
    fn make(folder: &Path) -> io::Result<Self> {
        let missing = folder
            .ancestors()
            .take_while(|above| !above.as_os_str().is_empty() && above.symlink_metadata().is_err());
        // From the innermost to the outermost.
        let made = Self(missing.map(Path::to_owned).collect());
        std::fs::create_dir_all(folder)?;
        Ok(made)
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        for folder in &self.0 {
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// Marks a place where a write, a creation or a renaming is about to happen. For tests,
/// `HERTZSCOPE_TEST_ABORT_AT=N` aborts the program before the N-th, without any cleaning up.
#[cfg(debug_assertions)]
fn step() {
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicU64, Ordering};

    static LAST: OnceLock<Option<u64>> = OnceLock::new();
    static STEPS: AtomicU64 = AtomicU64::new(0);
    let last = LAST.get_or_init(|| std::env::var("HERTZSCOPE_TEST_ABORT_AT").ok()?.parse().ok());
    if let Some(last) = last
        && STEPS.fetch_add(1, Ordering::Relaxed) + 1 == *last
    {
        std::process::abort();
    }
}

/// Marks a place where a write, a creation or a renaming is about to happen.
#[cfg(not(debug_assertions))]
fn step() {}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(path: &Path) -> String {
        std::fs::read_to_string(path).expect("a file")
    }

    #[test]
    fn files_beside_the_new_ones_are_kept_in_subfolders_too() {
        let around = tempfile::tempdir().expect("a folder");
        let target = around.path().join("results");
        for name in ["notes.txt", "report.txt", "raw/notes.txt", "raw/report.txt", "lab/notes.txt"]
        {
            let path = target.join(name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(path, "old").expect("a file");
        }
        let new = NewFolder::replace(&target).expect("a folder");
        std::fs::create_dir(new.join("raw")).expect("a folder");
        for name in ["report.txt", "raw/report.txt"] {
            std::fs::write(new.join(name), "new").expect("a file");
        }
        new.complete().expect("the folder in place");
        for name in ["notes.txt", "raw/notes.txt", "lab/notes.txt"] {
            assert_eq!(text(&target.join(name)), "old", "{name}");
        }
        for name in ["report.txt", "raw/report.txt"] {
            assert_eq!(text(&target.join(name)), "new", "{name}");
        }
        assert_eq!(std::fs::read_dir(around.path()).expect("a folder").count(), 1);
    }

    /// Somebody stands in the folder, or has opened it: it is the same folder afterwards.
    #[cfg(unix)]
    #[test]
    fn a_folder_stays_the_same_when_its_files_are_replaced() {
        let around = tempfile::tempdir().expect("a folder");
        let target = around.path().join("results");
        std::fs::create_dir(&target).expect("a folder");
        let open = File::open(&target).expect("a folder");
        let new = NewFolder::replace(&target).expect("a folder");
        std::fs::write(new.join("report.txt"), "new").expect("a file");
        // Written after the new files were begun.
        std::fs::write(target.join("mine.txt"), "mine").expect("a file");
        new.complete().expect("the files in place");
        assert!(is_at(&open, &target));
        assert_eq!(text(&target.join("mine.txt")), "mine");
        assert_eq!(text(&target.join("report.txt")), "new");
    }

    #[test]
    fn a_second_writer_is_refused_until_the_first_is_done() {
        let around = tempfile::tempdir().expect("a folder");
        let target = around.path().join("x.mcap");
        let mut first = NewFile::replace(&target).expect("a file");
        let error = NewFile::replace(&target).expect_err("it is busy");
        assert_eq!(error.kind(), ErrorKind::ResourceBusy);
        first.write_all(b"first").expect("written");
        first.complete().expect("complete");
        write(&target, "second").expect("it is free again");
        assert_eq!(text(&target), "second");
        let new = NewFolder::replace(&around.path().join("out")).expect("a folder");
        let error = NewFolder::replace(&around.path().join("out")).expect_err("it is busy");
        assert_eq!(error.kind(), ErrorKind::ResourceBusy);
        drop(new);
        assert_eq!(std::fs::read_dir(around.path()).expect("a folder").count(), 1);
    }

    /// Temporary files of killed writers do not pile up: the next writer takes the name over.
    #[test]
    fn what_a_killed_writer_left_is_taken_over() {
        let around = tempfile::tempdir().expect("a folder");
        let target = around.path().join("x.mcap");
        for _ in 0..4 {
            // Longer than the next file.
            std::fs::write(part_of(&target), "the beginning of a file").expect("a file");
            write(&target, "new").expect("written");
            assert_eq!(text(&target), "new");
            assert_eq!(std::fs::read_dir(around.path()).expect("a folder").count(), 1);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_called_like_a_temporary_file_holds_no_writer_up() {
        let around = tempfile::tempdir().expect("a folder");
        let target = around.path().join("x.mcap");
        let made = std::process::Command::new("mkfifo").arg(part_of(&target)).status();
        assert!(made.expect("mkfifo").success());
        write(&target, "new").expect("written");
        assert_eq!(text(&target), "new");
    }

    /// A child process that is being started has all files of this one open for a moment.
    #[test]
    fn a_lock_ends_although_another_holds_the_file() {
        let around = tempfile::tempdir().expect("a folder");
        let target = around.path().join("x.mcap");
        let new = NewFile::replace(&target).expect("a file");
        let inherited = new.file.0.try_clone().expect("the same file");
        new.complete().expect("written");
        write(&target, "again").expect("not locked");
        drop(inherited);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_its_target_is_written_also_if_it_did_not_exist() {
        let around = tempfile::tempdir().expect("a folder");
        let path = |name: &str| around.path().join(name);
        std::os::unix::fs::symlink("target.mcap", path("link.mcap")).expect("a link");
        for content in ["first", "second"] {
            write(&path("link.mcap"), content).expect("written");
            assert!(path("link.mcap").is_symlink());
            assert_eq!(text(&path("target.mcap")), content);
        }
    }

    /// As after a full disk.
    #[test]
    fn a_file_that_was_not_completed_leaves_no_folder() {
        let around = tempfile::tempdir().expect("a folder");
        drop(NewFile::replace(&around.path().join("lab/raw/x.mcap")).expect("a file"));
        let failed = write_numbered_folder(
            &around.path().join("lab"),
            |number| format!("ALL{number:04}"),
            |_| vec![("no/such/folder/\0".to_owned(), Vec::new())],
        );
        assert!(failed.is_err());
        assert_eq!(std::fs::read_dir(around.path()).expect("a folder").count(), 0);
    }

    #[test]
    fn numbered_files_never_replace_one() {
        let around = tempfile::tempdir().expect("a folder");
        let target = around.path().join("x.mcap");
        std::fs::write(&target, "old").expect("a file");
        let [one, two] = [(), ()].map(|()| NewFile::numbered(&target).expect("a file"));
        let names = [one, two].map(|new| new.complete().expect("complete"));
        assert_eq!(names, ["x-2.mcap", "x-3.mcap"].map(|name| around.path().join(name)));
        assert_eq!(text(&target), "old");
    }
}
