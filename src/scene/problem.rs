//! What is wrong with a scene, each with its place: all of it is reported at once.

use std::fmt;

/// One thing wrong with a file that describes a scene or an instrument.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// File, or the name of an embedded one.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// Where in the table tree, e.g. `striker.mass`.
    pub key: String,
    /// What stands there.
    pub found: String,
    /// What should stand there.
    pub expected: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: ", self.file, self.line, self.column)?;
        if !self.key.is_empty() {
            write!(f, "{}: ", self.key)?;
        }
        write!(f, "found {}, expected {}", self.found, self.expected)
    }
}

/// Why there is no scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file could not be read.
    #[error("{file}: {source}")]
    Read {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// Neither an embedded scene nor a file.
    #[error("found `{name}`, which is neither a file nor one of the scenes shipped, expected one of: {}", shipped.join(", "))]
    Unknown {
        /// What was asked for.
        name: String,
        /// The scenes there are.
        shipped: Vec<&'static str>,
    },
    /// The text is wrong in at least one place.
    #[error("{}", list(.0))]
    Problems(Vec<Problem>),
}

fn list(problems: &[Problem]) -> String {
    listed(problems, "the scene")
}

/// All problems of `what`, one a line, and how many there are.
pub(super) fn listed(problems: &[Problem], what: &str) -> String {
    let mut lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    let count = problems.len();
    lines.push(format!("{count} problem{} in {what}", if count == 1 { "" } else { "s" }));
    lines.join("\n")
}
