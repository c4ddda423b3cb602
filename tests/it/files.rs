//! Files that the program writes: whatever ends it, each name holds what it held before or all that
//! is new.
//!
//! `HERTZSCOPE_TEST_ABORT_AT=N` ends a development build at its N-th write, creation or renaming,
//! as `kill -9` would: no destructor runs.

mod killed;
mod two_writers;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// A run that is quick: this is about files, not about physics.
const QUICK: [&str; 2] = ["--accuracy", "1e-3"];

/// Every visible file under `folder` with its content. Hidden ones are temporary and open as
/// nothing.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if name.starts_with('.') {
            continue;
        }
        if path.is_dir() {
            let inner = contents(&path);
            all.extend(inner.into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            all.insert(name, std::fs::read(&path).expect("a file"));
        }
    }
    all
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hertzscope"));
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    // Reports say when they were made.
    command.env("SOURCE_DATE_EPOCH", "1790000000");
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Runs the program, which must be done with it.
fn done(folder: &Path, arguments: &[&str]) {
    let output = command(folder, arguments).output().expect("the program starts");
    // Exit code 1 is an answer, too.
    let code = output.status.code().expect("an exit code");
    assert!(code < 2, "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}
