//! The command line as a user meets it: exit codes, what is printed where, and what is left on
//! disk.

mod convert;
mod cost;
mod digits;
mod doctor;
mod effects;
mod help;
mod hostile;
mod lab_files;
mod output;
#[cfg(feature = "png")]
mod pdf;
mod pictures;
mod run;
mod transfer;
mod units;

use std::path::Path;

use assert_cmd::Command;

/// What could not be done, and what was typed wrong.
const COULD_NOT: i32 = 2;
/// A run that is quick: this is about the command, not about physics.
const QUICK: [&str; 2] = ["--accuracy", "1e-3"];

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// What the program did.
struct Done {
    code: i32,
    stdout: String,
    stderr: String,
}

/// Runs the program in `folder`.
fn hertzscope(folder: &Path, arguments: &[&str]) -> Done {
    let output = Command::cargo_bin("hertzscope")
        .expect("the program is built with its tests")
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text in UTF-8");
    Done {
        code: output.status.code().expect("an exit code, no signal"),
        stdout: text(output.stdout),
        stderr: text(output.stderr),
    }
}

/// What the program prints when all goes well.
fn printed(folder: &Path, arguments: &[&str]) -> String {
    let done = hertzscope(folder, arguments);
    assert_eq!(done.code, 0, "{arguments:?}: {}", done.stderr);
    // A quiet run names its recording there if the user has not.
    let has = |words: &[&str]| arguments.iter().any(|argument| words.contains(argument));
    let names = has(&["run"]) && has(&["-q", "--quiet"]) && !has(&["--json", "-o", "--output"]);
    assert_eq!(done.stderr.starts_with("recording   "), names, "{arguments:?}: {}", done.stderr);
    assert!(names || done.stderr.is_empty(), "{arguments:?}: {}", done.stderr);
    done.stdout
}

/// What the program says when it cannot: on standard error, with exit code 2, and nothing on
/// standard output.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let done = hertzscope(folder, arguments);
    assert_eq!(done.code, COULD_NOT, "{arguments:?}: {}{}", done.stdout, done.stderr);
    assert_eq!(done.stdout, "", "{arguments:?}");
    assert!(done.stderr.starts_with("error: "), "{}", done.stderr);
    done.stderr
}

fn says(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "expected `{word}` in:\n{text}");
    }
}

/// Names of the files in `folder`, sorted.
fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let mut names: Vec<String> = entries.map(|entry| name(entry.expect("an entry"))).collect();
    names.sort();
    names
}
