//! The files of `instruments/` and `recordings/`, embedded in the binary so that a name is enough
//! wherever it runs.

use include_dir::{Dir, File, include_dir};

static INSTRUMENTS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/instruments");
static RECORDINGS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/recordings");

/// Text of the instrument file `kind/name.toml`; an empty `kind` is the top folder.
pub fn instrument(kind: &str, name: &str) -> Option<&'static str> {
    let is_it = |file: &&'static File<'static>| {
        let path = file.path().to_str().and_then(|path| path.strip_prefix(kind));
        let file = path.map(|path| path.trim_start_matches('/'));
        file.and_then(|file| file.strip_suffix(".toml")) == Some(name)
    };
    folder(kind)?.files().find(is_it)?.contents_utf8()
}

/// By name, letter by letter: paths would be compared part by part, which shows in how long a
/// program takes to start.
fn folder(kind: &str) -> Option<&'static Dir<'static>> {
    if kind.is_empty() {
        return Some(&INSTRUMENTS);
    }
    INSTRUMENTS.dirs().find(|folder| folder.path().as_os_str() == kind)
}

/// Names of all instrument files of one kind, sorted; an empty `kind` is the top folder.
pub fn instrument_names(kind: &str) -> Vec<&'static str> {
    let mut names: Vec<&str> = folder(kind)
        .into_iter()
        .flat_map(Dir::files)
        .filter(|file| file.path().extension().is_some_and(|e| e == "toml"))
        .filter_map(|file| file.path().file_stem()?.to_str())
        .collect();
    names.sort_unstable();
    names
}

/// Content of a file in `recordings/`.
pub fn recording(name: &str) -> Option<&'static [u8]> {
    RECORDINGS.get_file(name).map(File::contents)
}
