//! The files of `instruments/` and `recordings/`, embedded in the binary so that a name is enough wherever it runs.

use include_dir::{Dir, include_dir};

static INSTRUMENTS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/instruments");
static RECORDINGS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/recordings");

/// Text of the instrument file `kind/name.toml`; an empty `kind` is the top folder.
#[must_use]
pub fn instrument(kind: &str, name: &str) -> Option<&'static str> {
    INSTRUMENTS.get_file(path(kind, name))?.contents_utf8()
}

/// Names of all instrument files of one kind, sorted; an empty `kind` is the top folder.
#[must_use]
pub fn instrument_names(kind: &str) -> Vec<&'static str> {
    let folder = if kind.is_empty() { Some(&INSTRUMENTS) } else { INSTRUMENTS.get_dir(kind) };
    let mut names: Vec<&str> = folder
        .into_iter()
        .flat_map(Dir::files)
        .filter(|file| file.path().extension().is_some_and(|e| e == "toml"))
        .filter_map(|file| file.path().file_stem()?.to_str())
        .collect();
    names.sort_unstable();
    names
}

/// Content of a file in `recordings/`.
#[must_use]
pub fn recording(name: &str) -> Option<&'static [u8]> {
    RECORDINGS.get_file(name).map(include_dir::File::contents)
}

fn path(kind: &str, name: &str) -> String {
    if kind.is_empty() { format!("{name}.toml") } else { format!("{kind}/{name}.toml") }
}
