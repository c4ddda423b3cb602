//! Writes answers as one reply, with headers or without.

use super::preferences::Preferences;
use super::value::{ReplyValue, abbreviated};

/// The reply of one row.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseUnit {
    /// The header's words, short forms in capitals.
    pub nodes: Vec<String>,
    /// The answer.
    pub value: ReplyValue,
}

/// The answers to one query, without terminator.
///
/// With headers the first answer begins at the root, `:TRIGGER:MAIN:MODE AUTO`; the next ones leave out the path that
/// they share with the one before, `TYPE EDGE`, where all of that path is theirs, and begin at the root where not.
pub fn write(answers: &[ResponseUnit], preferences: &Preferences) -> Vec<u8> {
    let mut out = Vec::new();
    let mut path: &[String] = &[];
    for (index, answer) in answers.iter().enumerate() {
        if index > 0 {
            out.push(b';');
        }
        let is_common = answer.nodes.first().is_some_and(|node| node.starts_with('*'));
        if preferences.header && !is_common {
            let rest = answer.nodes.strip_prefix(path).filter(|rest| index > 0 && !rest.is_empty());
            let nodes = rest.unwrap_or_else(|| {
                out.push(b':');
                &answer.nodes
            });
            let words: Vec<String> =
                nodes.iter().map(|node| abbreviated(node, preferences.verbose)).collect();
            out.extend_from_slice(words.join(":").as_bytes());
            out.push(b' ');
            path = answer.nodes.split_last().map_or(&[], |(_, path)| path);
        }
        answer.value.write(preferences.verbose, &mut out);
    }
    out
}
