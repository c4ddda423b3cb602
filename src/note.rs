//! Notes: what a user should know of a scene or a run, for scripts and for people.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;
use serde_json::Value;

/// A note on a scene or a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Note {
    /// What the note is about, for scripts. A code does not change its meaning; `docs/accuracy.md`
    /// lists them.
    pub code: &'static str,
    /// Names and numbers of the sentence, in SI units.
    pub values: BTreeMap<&'static str, Value>,
    /// The note in words.
    pub sentence: String,
}

impl Note {
    /// A note without values.
    pub fn new(code: &'static str, sentence: impl Into<String>) -> Self {
        Self { code, values: BTreeMap::new(), sentence: sentence.into() }
    }

    /// The same with one more value.
    pub fn with(mut self, name: &'static str, value: impl Into<Value>) -> Self {
        self.values.insert(name, value.into());
        self
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence)
    }
}
