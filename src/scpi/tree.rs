//! Finds the row of a header, and collects the replies of groups of rows.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::command::GROUPS;
use super::reply::ResponseUnit;
use super::table::{CommandRow, Context, Deferred, Parts, Suffix, Support};
use crate::instrument::Event;
use crate::scope::Source;
use crate::scope::word::{Word as _, abbreviates};

/// Levels of rows that answer by other rows: `SET?`, then a group.
const MAX_GROUP_DEPTH: u8 = 3;

/// A row and the numbers in its header.
#[derive(Clone, Copy)]
pub struct MatchedRow {
    /// The row.
    pub row: &'static CommandRow,
    /// The numbers.
    pub suffix: Suffix,
}

/// The row that a header's words name, on an instrument with `channels` channels.
pub fn find(words: &[String], channels: u8) -> Option<MatchedRow> {
    let found = rows().find_map(|row| {
        let suffix = matches(row, words, channels)?;
        Some(MatchedRow { row, suffix })
    })?;
    match found.row.support {
        Support::Alias(of) => {
            let row = rows().find(|row| row.header == of)?;
            Some(MatchedRow { row, ..found })
        }
        _ => Some(found),
    }
}

/// Every row, group after group.
pub fn rows() -> impl Iterator<Item = &'static CommandRow> {
    GROUPS.iter().flat_map(|group| group.rows)
}

fn matches(row: &CommandRow, words: &[String], channels: u8) -> Option<Suffix> {
    let mut suffix = Suffix::default();
    let mut nodes = row.nodes();
    for word in words {
        node_matches(nodes.next()?, word, channels, &mut suffix).then_some(())?;
    }
    nodes.next().is_none().then_some(suffix)
}

/// Whether `word` is `node`; a number in it is noted in `suffix`.
fn node_matches(node: &str, word: &str, channels: u8, suffix: &mut Suffix) -> bool {
    if matches!(node, "<wfm>" | "CH<x>" | "REF<x>") {
        let source = Source::from_name(word).filter(|source| source.exists(channels));
        let Some(source) = source else { return false };
        suffix.source = source;
        if let Source::Channel(number) = source {
            suffix.number = number;
        }
        return match node {
            "CH<x>" => matches!(source, Source::Channel(_)),
            "REF<x>" => matches!(source, Source::Reference(_)),
            _ => true,
        };
    }
    let Some((stem, last)) = node.strip_suffix("<x>").map(|stem| (stem, last_number(stem))) else {
        return abbreviates(word, node);
    };
    let Some((name, digit)) = word.split_at_checked(stem.len()) else { return false };
    match digit.parse() {
        Ok(number) if name.eq_ignore_ascii_case(stem) && (1..=last).contains(&number) => {
            suffix.number = number;
            true
        }
        _ => false,
    }
}

/// The highest number behind a word.
fn last_number(stem: &str) -> u8 {
    if stem == "MEAS" { 5 } else { 2 }
}

/// A node with its number filled in.
fn filled(node: &str, suffix: Suffix) -> String {
    match node {
        "<wfm>" | "CH<x>" | "REF<x>" => suffix.source.to_string(),
        _ => match node.strip_suffix("<x>") {
            Some(stem) => format!("{stem}{}", suffix.number),
            None => node.to_owned(),
        },
    }
}

/// The reply to the query of a row.
///
/// # Errors
/// [`Deferred`] if a row has none.
pub fn query(found: MatchedRow, context: &mut Context<'_>) -> Result<Vec<ResponseUnit>, Deferred> {
    let mut answers = Vec::new();
    collect(found, context, MAX_GROUP_DEPTH, &mut answers)?;
    Ok(answers)
}

fn collect(
    found: MatchedRow,
    context: &mut Context<'_>,
    depth: u8,
    answers: &mut Vec<ResponseUnit>,
) -> Result<(), Deferred> {
    context.suffix = found.suffix;
    let depth = depth.checked_sub(1).ok_or(Event::UndefinedHeader)?;
    match found.row.setting.parts() {
        None => {
            let value = found.row.get(context)?;
            let nodes = found.row.nodes().map(|node| filled(node, found.suffix)).collect();
            answers.push(ResponseUnit { nodes, value });
        }
        Some(Parts::Below) => {
            for row in rows().filter(|row| row.in_group && is_below(row, found.row)) {
                if row.setting.is_query() && row.setting.parts().is_none() {
                    collect(MatchedRow { row, suffix: found.suffix }, context, depth, answers)?;
                }
            }
        }
        Some(Parts::Of(headers)) => {
            let channels = context.instrument.model.channels;
            for part in headers.iter().filter_map(|header| parts().get(header)) {
                // Headers of channels and memories that this model does not have are left out.
                if part.suffix.source.exists(channels) {
                    collect(*part, context, depth, answers)?;
                }
            }
        }
    }
    Ok(())
}

/// The rows that other rows answer by, found once: `SET?` names more than fifty.
fn parts() -> &'static BTreeMap<&'static str, MatchedRow> {
    static PARTS: OnceLock<BTreeMap<&'static str, MatchedRow>> = OnceLock::new();
    PARTS.get_or_init(|| {
        let named = rows().filter_map(|row| match row.setting.parts() {
            Some(Parts::Of(headers)) => Some(headers),
            _ => None,
        });
        let found = named.flatten().filter_map(|header| {
            let words: Vec<String> = header.split(':').map(str::to_owned).collect();
            Some((*header, find(&words, u8::MAX)?))
        });
        found.collect()
    })
}

fn is_below(row: &CommandRow, group: &CommandRow) -> bool {
    row.header.strip_prefix(group.header).is_some_and(|rest| rest.starts_with(':'))
}
