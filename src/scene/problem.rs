//! Problems of a scene with their places, all reported at once.

use std::fmt::{self, Write as _};

use crate::quantity::printable;

/// The text found where a required key is missing.
pub(super) const MISSING: &str = "no such key";

/// One thing wrong with a file that describes a scene or an instrument.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// File, or the name of an embedded one.
    pub file: String,
    /// Line, counted from 1; 0 if it concerns the whole file.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// Where in the table tree, e.g. `striker.mass`.
    pub key: String,
    /// The text found.
    pub found: String,
    /// The text expected.
    pub expected: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Names in a file may hold what a terminal obeys.
        f.write_str(&printable(&self.sentence()))
    }
}

impl Problem {
    /// The place, what was found there and what is expected.
    fn sentence(&self) -> String {
        let Self { file, line, column, key, found, expected } = self;
        if *line == 0 {
            return format!("{file}: {found}");
        }
        let place = format!("{file}:{line}:{column}: ");
        if found == MISSING {
            return format!("{place}missing `{key}`: give {expected}");
        }
        let place = if key.is_empty() { place } else { format!("{place}{key}: ") };
        if expected.is_empty() {
            return format!("{place}{found}");
        }
        // What is needed stands before the example of it.
        let (needed, example) = expected.split_once(", e.g. ").unwrap_or((expected, ""));
        let example = if example.is_empty() { "" } else { &expected[needed.len()..] };
        if found.starts_with('`') && found.contains("` is ") {
            format!("{place}{found}; {needed} is needed{example}")
        } else {
            format!("{place}found {found}, expected {expected}")
        }
    }

    /// Adds that a problem in the base of the scene `file` may come from the changes in `file`.
    pub(super) fn mention_base(&mut self, file: &str) {
        if self.file != file && self.line > 0 {
            let end = if self.expected.is_empty() { &mut self.found } else { &mut self.expected };
            let _ = write!(end, " (base of {file}, whose changes may not fit here)");
        }
    }
}

/// Why there is no scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file could not be read.
    #[error("{}", printable(file))]
    Read {
        /// The file.
        file: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// The file is too large for a scene.
    #[error("{}: found more than {limit} bytes, expected a scene", printable(file))]
    TooLarge {
        /// The file.
        file: String,
        /// Most bytes that are read.
        limit: u64,
    },
    /// Neither an embedded scene nor a file.
    #[error(
        "no scene or file `{}`{}; `hertzscope scenes` lists the shipped ones",
        printable(name),
        did_you_mean(name, shipped)
    )]
    Unknown {
        /// The requested name.
        name: String,
        /// The scenes there are.
        shipped: Vec<&'static str>,
    },
    /// Neither an included instrument nor a file.
    #[error(
        "found no `{}` among the included {listed} ({}), and it is no .toml file{}",
        printable(name),
        known.join(", "),
        did_you_mean(name, known)
    )]
    NoInstrument {
        /// What was looked through, as `hertzscope list` calls it.
        listed: &'static str,
        /// The requested name.
        name: String,
        /// Those there are.
        known: Vec<&'static str>,
    },
    /// A file of the command line that is not there.
    #[error("found `{}`, which is no file, expected the path of {what}", printable(name))]
    NoFile {
        /// The path as typed.
        name: String,
        /// What is expected, with an example.
        what: &'static str,
    },
    /// A file that is no scene is wrong in at least one place.
    #[error("{}", listed(.problems, what))]
    InFile {
        /// The kind of file, `the plan`.
        what: &'static str,
        /// What is wrong.
        problems: Vec<Problem>,
    },
    /// A file or folder that is no scene.
    #[error(
        "{} is no scene, which is a .toml file; a simulated recording carries its scene (`hertzscope info`)",
        printable(name)
    )]
    NoScene {
        /// The path.
        name: String,
    },
    /// The text is wrong in at least one place.
    #[error("{}", list(.0))]
    Problems(Vec<Problem>),
}

impl SceneError {
    /// The error with its problems ascribed to `what`, the file of a kind.
    pub(super) fn in_file(self, what: &'static str) -> Self {
        match self {
            Self::Problems(problems) => Self::InFile { what, problems },
            error => error,
        }
    }
}

/// What `name` may have been meant for, as the end of a sentence.
pub(super) fn did_you_mean(name: &str, known: &[&str]) -> String {
    let distance = |known: &&&str| strsim::damerau_levenshtein(name, known);
    let near = known.iter().min_by_key(distance);
    let near = near.filter(|near| 2 * distance(near) <= name.chars().count());
    near.map(|near| format!(": did you mean `{near}`?")).unwrap_or_default()
}

fn list(problems: &[Problem]) -> String {
    listed(problems, "the scene")
}

/// All problems of `what`, one a line, and how many there are.
pub(super) fn listed(problems: &[Problem], what: &str) -> String {
    let mut lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    let count = problems.iter().filter(|problem| problem.line > 0).count();
    lines.push(format!("{count} problem{} in {what}", if count == 1 { "" } else { "s" }));
    lines.join("\n")
}

/// `"a"`, or the first of many names, for messages.
pub(super) fn one_of<T: AsRef<str>>(names: impl IntoIterator<Item = T>) -> String {
    let mut names = names.into_iter();
    let first: Vec<T> = names.by_ref().take(MAX_NAMES).collect();
    let first: Vec<&str> = first.iter().map(AsRef::as_ref).collect();
    let more = names.count();
    let rest = if more == 0 { String::new() } else { format!(" and {more} more") };
    format!("one of {}{rest}", first.join(", "))
}

/// Most names that a message lists.
const MAX_NAMES: usize = 50;
