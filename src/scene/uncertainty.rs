//! `[uncertainty]`: what a scene does not know exactly, each number by its path.
//!
//! A text or number is a standard uncertainty; a table says a distribution (`standard`,
//! `half_width`, or `between`), a `group` of inputs that vary together, and a `source`. `%` and
//! `ppm` are shares of the value, everything else is in the value's own unit.

use super::document::{DISTRIBUTION_KEYS, Entries, Node, Value};
use super::reader::{Problems, TableReader};
use super::tree::ANY;
use crate::quantity::{Dimension, parse_any_difference};

/// How far a value may be off: a share of it, or in its own unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpreadAmount {
    /// A share of the value (1).
    Share(f64),
    /// In SI units of this dimension (unit).
    Absolute(f64, Dimension),
}

impl SpreadAmount {
    /// The amount for `value` (unit).
    pub fn of(self, value: f64) -> f64 {
        match self {
            Self::Share(share) => share * value.abs(),
            Self::Absolute(amount, _) => amount,
        }
    }
}

/// How a number is distributed about its value in the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InputDistribution {
    /// Normally, with this standard deviation.
    Normal(SpreadAmount),
    /// Evenly within this distance.
    Even(SpreadAmount),
    /// Evenly between two values in SI units (unit).
    Between(f64, f64, Dimension),
}

/// A number that is not known exactly.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertainInput {
    /// Its path in the scene; `*` is every name.
    pub path: String,
    /// Its distribution.
    pub distribution: InputDistribution,
    /// Inputs of one group vary together.
    pub group: Option<String>,
    /// Where this is known from.
    pub source: Option<String>,
    /// Where it was typed: file and line.
    pub typed: String,
}

/// Reads `[uncertainty]`.
pub fn uncertainty(root: &TableReader<'_>, problems: &Problems) -> Vec<UncertainInput> {
    let mut found = Vec::new();
    if let Some(node) = root.node("uncertainty") {
        match &node.value {
            Value::Table(entries) => {
                let own = root.place_of("").file();
                collect(entries, "", (root.entries, own, problems), &mut found);
            }
            _ => root.problem("uncertainty", node.describe(), "a table [uncertainty]"),
        }
    }
    found
}

/// Whether `keys` lead to something in the scene, or to what follows from it, or through a table
/// that is switched off.
fn is_known(entries: &Entries, keys: &[&str]) -> bool {
    match keys {
        ["materials", ..] | ["sensors", _, "offset" | "host_mass" | "sensitivity"] | [] => true,
        [ANY, rest @ ..] => entries.values().any(|entry| leads_on(&entry.node, rest)),
        [first, rest @ ..] => entries.get(*first).is_some_and(|e| leads_on(&e.node, rest)),
    }
}

fn leads_on(node: &Node, keys: &[&str]) -> bool {
    match &node.value {
        _ if keys.is_empty() => true,
        Value::Table(entries) => is_known(entries, keys),
        Value::List(items) => {
            let place = keys[0].parse::<usize>().ok().and_then(|place| place.checked_sub(1));
            let meant = |place: usize| items.get(place);
            place.and_then(meant).is_some_and(|item| leads_on(item, &keys[1..]))
        }
        Value::Flag(is_on) => !is_on,
        _ => false,
    }
}

fn collect(
    entries: &Entries,
    above: &str,
    (scene, own, problems): (&Entries, &str, &Problems),
    found: &mut Vec<UncertainInput>,
) {
    for (key, entry) in entries {
        let path = if above.is_empty() { key.to_string() } else { format!("{above}.{key}") };
        let node = &entry.node;
        if let Value::Table(inner) = &node.value
            && DISTRIBUTION_KEYS.iter().all(|width| !inner.contains_key(*width))
        {
            collect(inner, &path, (scene, own, problems), found);
            continue;
        }
        if !is_known(scene, &path.split('.').collect::<Vec<_>>()) {
            // The base scene's, of a number that this scene has replaced.
            if node.place.file() != own {
                continue;
            }
            let key = format!("uncertainty.{path}");
            let expected = if path.contains('.') {
                "the path of a number of the scene, e.g. striker.speed"
            } else {
                "the path of a number of the scene, e.g. striker.speed; keys below a [table] belong to it, those of the scene itself stand above the first one"
            };
            let nothing = format!("nothing at `{path}` in the scene");
            problems.push(node.place.problem(&key, nothing, expected.to_owned()));
        } else if let Value::Table(_) = &node.value {
            found.extend(distribution(node, &path, problems));
        } else {
            let amount = amount(node, &path, problems);
            let normal = |amount| input(node, &path, InputDistribution::Normal(amount));
            found.extend(amount.map(normal));
        }
    }
}

fn input(node: &Node, path: &str, distribution: InputDistribution) -> UncertainInput {
    let place = node.place.problem(path, String::new(), String::new());
    let typed = format!("{}:{}", place.file, place.line);
    UncertainInput { path: path.to_owned(), distribution, group: None, source: None, typed }
}

/// A standard uncertainty or half width, zero or more.
fn amount(node: &Node, path: &str, problems: &Problems) -> Option<SpreadAmount> {
    let read = match &node.value {
        Value::Number { value, .. } => Some((*value, Dimension::NONE)),
        Value::Text(text) => parse_any_difference(text).ok(),
        _ => None,
    };
    let is_share = |text: &str| text.trim_end().ends_with('%') || text.trim_end().ends_with("ppm");
    let share = matches!(&node.value, Value::Text(text) if is_share(text));
    match read {
        Some((value, _)) if value >= 0.0 && share => Some(SpreadAmount::Share(value)),
        Some((value, dimension)) if value >= 0.0 && value.is_finite() => {
            Some(SpreadAmount::Absolute(value, dimension))
        }
        _ => {
            let expected = "a standard uncertainty of zero or more, a share or in the value's unit, e.g. \"1 %\"";
            let key = format!("uncertainty.{path}");
            problems.push(node.place.problem(&key, node.describe(), expected.to_owned()));
            None
        }
    }
}

fn distribution(node: &Node, path: &str, problems: &Problems) -> Option<UncertainInput> {
    let key = format!("uncertainty.{path}");
    let table = TableReader::of(node, &key, problems)?;
    let given: Vec<&str> = DISTRIBUTION_KEYS.into_iter().filter(|width| table.has(width)).collect();
    if given.len() > 1 {
        table.problem(given[1], format!("both {} and {}", given[0], given[1]), "one of them");
    }
    let width = |key| amount(table.node(key)?, path, problems);
    let distribution = if table.has("standard") {
        width("standard").map(InputDistribution::Normal)
    } else if table.has("half_width") {
        width("half_width").map(InputDistribution::Even)
    } else {
        between(&table)
    };
    let (group, source) = (table.text("group"), table.text("source"));
    let found = distribution.map(|distribution| UncertainInput {
        group: group.map(str::to_owned),
        source: source.map(str::to_owned),
        ..input(node, path, distribution)
    });
    table.finish();
    found
}

/// `between = ["2.2 N", "2.5 N"]`.
fn between(table: &TableReader<'_>) -> Option<InputDistribution> {
    let texts = table.texts("between");
    let read: Vec<_> =
        texts.iter().filter_map(|(text, _)| crate::quantity::parse_any(text).ok()).collect();
    match read.as_slice() {
        [(low, one), (high, other)] if low < high && one == other && texts.len() == 2 => {
            Some(InputDistribution::Between(*low, *high, *one))
        }
        _ => {
            let found = texts.iter().map(|(text, _)| *text).collect::<Vec<_>>().join(", ");
            let expected = "two values of one unit, the lower first, e.g. [\"2.2 N\", \"2.5 N\"]";
            table.problem("between", format!("[{found}]"), expected);
            None
        }
    }
}

/// Standard uncertainty of the offset of sensor `name`, which is `offset` (1).
pub fn of_offset(inputs: &[UncertainInput], name: &str, offset: f64) -> f64 {
    let paths = [format!("sensors.{name}.offset"), "sensors.*.offset".to_owned()];
    let named = |path: &String| inputs.iter().find(|input| input.path == *path);
    paths.iter().find_map(named).map_or(0.0, |input| input.distribution.standard(offset))
}

impl InputDistribution {
    /// Standard deviation about `value` (unit).
    pub fn standard(self, value: f64) -> f64 {
        match self {
            Self::Normal(amount) => amount.of(value),
            Self::Even(amount) => amount.of(value) / 3f64.sqrt(),
            Self::Between(low, high, _) => 0.5 * (high - low) / 3f64.sqrt(),
        }
    }
}
