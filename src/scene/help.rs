//! The annotated pages of `hertzscope help`: an example of each file, with default and help of each
//! key from its declaration.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::document::Value;
use super::grid::SweepKeys;
use super::plan::PlanKeys;
use super::plan::lab::LabKeys;
use super::root::RootKeys;
use super::table::{Key, Keys, key_at};
use crate::data;

/// The annotated page of a `scene`, `plan`, `lab` (laboratory) or `grid` (sweep), with every key;
/// `None` for another topic.
pub fn annotated(topic: &str) -> Option<String> {
    // Help begins behind the longest usual lines.
    let (keys, column): (Keys, usize) = match topic {
        "scene" => (&[RootKeys::KEYS], 28),
        "plan" => (&[PlanKeys::KEYS], 43),
        "lab" => (&[LabKeys::KEYS], 43),
        "grid" => (&[SweepKeys::KEYS], 43),
        _ => return None,
    };
    data::instrument("help", topic).map(|page| explained(page, keys, column))
}

/// A page with default and help of each key, from `column` on, behind the first line that has it; a
/// comment in the page stays.
fn explained(text: &str, keys: Keys, column: usize) -> String {
    let mut table: Vec<&str> = Vec::new();
    let mut explained = BTreeSet::new();
    let mut page = String::new();
    for line in text.lines() {
        let bare = line.strip_prefix("# ").unwrap_or(line);
        let header = bare.strip_prefix('[').and_then(|rest| rest.split_once(']'));
        let is_end = |rest: &str| {
            matches!(rest.trim_start_matches(']').trim_start().chars().next(), None | Some('#'))
        };
        if let Some((path, _)) = header.filter(|(_, rest)| is_end(rest)) {
            table = path.trim_matches('[').split('.').collect();
            // A list's item is one step of a path.
            if bare.starts_with("[[") {
                table.push("1");
            }
        }
        let key = bare.split_once(" = ").filter(|(_, value)| !value.contains(" # "));
        let key = key.and_then(|(name, value)| {
            let path: Vec<&str> = table.iter().copied().chain([name]).collect();
            let key = key_at(keys, &path).filter(|key| key.name == name)?;
            Some((key, value.trim_matches('"')))
        });
        let new = key.filter(|(key, _)| explained.insert((key.name, key.help, key.default)));
        let comment = new.map_or_else(String::new, |(key, value)| explanation(key, value));
        let _ = if comment.is_empty() {
            writeln!(page, "{line}")
        } else {
            writeln!(page, "{line:<column$} # {comment}")
        };
    }
    page
}

/// Default and help of `key` behind a line with `value`.
fn explanation(key: &Key, value: &str) -> String {
    let default = match (key.default, key.default_value()) {
        (Some(""), _) => None,
        (Some(default), _) if default == value => Some("default".to_owned()),
        (Some(default), Some(Value::Text(_))) => Some(format!("default \"{default}\"")),
        (Some(default), _) => Some(format!("default {default}")),
        _ => None,
    };
    let help = key.help.trim();
    let help = (!help.is_empty()).then(|| help.to_owned());
    default.into_iter().chain(help).collect::<Vec<_>>().join("; ")
}
