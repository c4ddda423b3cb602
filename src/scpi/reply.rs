//! Writes answers as one reply, with headers or without.

use super::value::{ReplyValue, abbreviated};
use crate::scope::word::words;

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
/// With headers the first answer begins at the root, `:TRIGGER:MAIN:MODE AUTO`; the next ones leave
/// out the path that they share with the one before, `TYPE EDGE`, where all of that path is theirs,
/// and begin at the root where not.
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

words! {
    /// Terminator of replies.
    Terminator {
        /// Carriage return.
        Cr = "CR",
        /// Line feed.
        Lf = "LF",
        /// Carriage return, line feed.
        CrLf = "CRLf",
        /// Line feed, carriage return.
        LfCr = "LFCr",
    }
}

impl Terminator {
    /// The bytes.
    pub fn bytes(self) -> &'static [u8] {
        match self {
            Self::Cr => b"\r",
            Self::Lf => b"\n",
            Self::CrLf => b"\r\n",
            Self::LfCr => b"\n\r",
        }
    }
}

/// How replies on one connection look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preferences {
    /// Whether answers begin with headers (`HEADer`).
    pub header: bool,
    /// Whether words are written in full (`VERBose`).
    pub verbose: bool,
    /// Terminator of replies (`RS232:TRANsmit:TERMinator`).
    pub terminator: Terminator,
}

impl Preferences {
    /// Words in full, a line feed at the end, headers as asked for. The original answers with
    /// headers over RS-232, most programs expect none.
    pub fn new(header: bool) -> Self {
        Self { header, verbose: true, terminator: Terminator::Lf }
    }
}
