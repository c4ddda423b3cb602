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

/// The same notes in fewer lines: what is said of several channels in the same words is said once,
/// where it was said first.
///
/// ```
/// use hertzscope::note::joined;
/// let notes = ["CH1: cut", "no speeds", "CH2: cut"].map(str::to_owned);
/// assert_eq!(joined(notes), ["CH1, CH2: cut", "no speeds"]);
/// ```
pub fn joined(notes: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut lines: Vec<(Option<String>, String)> = Vec::new();
    for note in notes {
        let (channel, words) = match note.split_once(": ") {
            Some((channel, words)) if channel.starts_with("CH") && !channel.contains(' ') => {
                (Some(channel.to_owned()), words.to_owned())
            }
            _ => (None, note),
        };
        let same = lines.iter_mut().find(|(channels, said)| channels.is_some() && *said == words);
        match (same, channel) {
            (Some((Some(channels), _)), Some(channel)) => {
                channels.push_str(", ");
                channels.push_str(&channel);
            }
            (_, channel) => lines.push((channel, words)),
        }
    }
    let line = |(channels, words): (Option<String>, String)| match channels {
        Some(channels) => format!("{channels}: {words}"),
        None => words,
    };
    lines.into_iter().map(line).collect()
}
