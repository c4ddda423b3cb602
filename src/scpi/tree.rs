//! Finds the row of a header.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::command::GROUPS;
use super::placeholder::Placeholder;
use super::reply::ResponseUnit;
use super::row::{CommandRow, Support};
use super::setting::{Context, Parts, Stop};
use crate::instrument::Event;
use crate::instrument::word::abbreviates;
use crate::scope::Source;

/// How deep rows may answer by other rows: `SET?`, then a group.
const MAX_GROUP_DEPTH: u8 = 3;

/// A row and what its placeholder stood for.
#[derive(Clone, Copy)]
pub struct MatchedRow {
    /// The row.
    pub row: &'static CommandRow,
    /// Value of its placeholder.
    pub place: Placeholder,
}

/// The row that a header's words name, on an instrument with so many channels.
pub fn find(words: &[String], channels: u8) -> Option<MatchedRow> {
    let found = rows().find_map(|row| {
        let place = matches(row, words, channels)?;
        Some(MatchedRow { row, place })
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

fn matches(row: &CommandRow, words: &[String], channels: u8) -> Option<Placeholder> {
    let mut place = Placeholder::default();
    let mut nodes = row.nodes();
    for word in words {
        node_matches(nodes.next()?, word, channels, &mut place).then_some(())?;
    }
    nodes.next().is_none().then_some(place)
}

/// Whether `word` is `node`; a placeholder is noted in `place`.
fn node_matches(node: &str, word: &str, channels: u8, place: &mut Placeholder) -> bool {
    let exists = |source: Source| match source {
        Source::Channel(number) => number <= channels,
        Source::Math | Source::Reference(_) => true,
    };
    if matches!(node, "<wfm>" | "CH<x>" | "REF<x>") {
        let Some(source) = Source::from_name(word).filter(|source| exists(*source)) else {
            return false;
        };
        place.source = source;
        if let Source::Channel(number) = source {
            place.number = number;
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
            place.number = number;
            true
        }
        _ => false,
    }
}

/// The highest number of a placeholder.
fn last_number(stem: &str) -> u8 {
    if stem == "MEAS" { 5 } else { 2 }
}

/// A node with its placeholder filled in.
pub fn filled(node: &str, place: Placeholder) -> String {
    match node {
        "<wfm>" | "CH<x>" | "REF<x>" => place.source.to_string(),
        _ => match node.strip_suffix("<x>") {
            Some(stem) => format!("{stem}{}", place.number),
            None => node.to_owned(),
        },
    }
}

/// Everything that the query of a row tells.
///
/// # Errors
/// [`Stop`] where a row cannot tell.
pub fn query(found: MatchedRow, at: &mut Context<'_>) -> Result<Vec<ResponseUnit>, Stop> {
    let mut answers = Vec::new();
    collect(found, at, MAX_GROUP_DEPTH, &mut answers)?;
    Ok(answers)
}

fn collect(
    found: MatchedRow,
    at: &mut Context<'_>,
    depth: u8,
    answers: &mut Vec<ResponseUnit>,
) -> Result<(), Stop> {
    at.place = found.place;
    let depth = depth.checked_sub(1).ok_or(Event::UndefinedHeader)?;
    match found.row.setting.parts {
        None => {
            let value = found.row.setting.get.ok_or(Event::UndefinedHeader)?(at)?;
            let nodes = found.row.nodes().map(|node| filled(node, found.place)).collect();
            answers.push(ResponseUnit { nodes, value });
        }
        Some(Parts::Below) => {
            for row in rows().filter(|row| row.in_group && is_below(row, found.row)) {
                if row.setting.get.is_some() {
                    collect(MatchedRow { row, place: found.place }, at, depth, answers)?;
                }
            }
        }
        Some(Parts::Of(headers)) => {
            let channels = at.instrument.model.channels;
            for part in headers.iter().filter_map(|header| parts().get(header)) {
                // A header of a channel that this model has not.
                if !matches!(part.place.source, Source::Channel(number) if number > channels) {
                    collect(*part, at, depth, answers)?;
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
        let named = rows().filter_map(|row| match row.setting.parts {
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
