//! `[uncertainty]`: the inputs of a scene that are not known exactly, each number by its path.
//!
//! A text or number is a standard uncertainty; a table has a distribution (`standard`,
//! `half_width`, or `between`), a `group` of inputs that vary together, and a `source`. `%` and
//! `ppm` are shares of the value, everything else is in the value's own unit.

use super::document::{ANY, DISTRIBUTION_KEYS, Entries, Node, Value};
use super::root::RootKeys;
use super::table::{Places, Problems, TableReader, any, key_at, table, text, texts};
use crate::quantity::{Difference, Dimension, Quantity};

table! {
    /// A distribution of an input.
    struct DistributionKeys<'a> {
        standard: &'a Node = any(&[]),
        half_width: &'a Node = any(&[]),
        between: Places<'a> = texts(),
        /// inputs of one group vary together
        group: &'a str = text(),
    }
}

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
pub fn uncertainty(root: &TableReader<'_>, node: Option<&Node>) -> Vec<UncertainInput> {
    let mut found = Vec::new();
    if let Some(node) = node {
        match &node.value {
            Value::Table(entries) => {
                let own = root.place_of("").file();
                collect(entries, "", (root.entries, own, root.problems()), &mut found);
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
        let keys: Vec<&str> = path.split('.').collect();
        if !is_known(scene, &keys) {
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
            problems.push(&node.place, &key, format!("nothing at `{path}` in the scene"), expected);
            continue;
        }
        let read = if node.is_table() {
            distribution(node, &path, problems)
        } else {
            let amount = amount(node, &path, problems);
            amount.map(|amount| input(node, &path, InputDistribution::Normal(amount)))
        };
        let Some(read) = read else { continue };
        let expected = key_at(&[RootKeys::KEYS], &keys).and_then(super::table::Key::dimension);
        match (read.distribution.dimension(), expected) {
            (Some(found), Some(expected)) if found != expected => {
                let found = format!("`{}` is {found}", typed(node));
                let expected = format!("{expected} or a share of the value, e.g. \"1 %\"");
                problems.push(&node.place, &format!("uncertainty.{path}"), found, expected);
            }
            _ => found.push(read),
        }
    }
}

/// A value as typed, for messages.
fn typed(node: &Node) -> String {
    node.as_text().map_or_else(|| super::document::inline(node), str::to_owned)
}

fn input(node: &Node, path: &str, distribution: InputDistribution) -> UncertainInput {
    let place = node.place.problem(path, String::new(), String::new());
    let typed = format!("{}:{}", place.file, place.line);
    UncertainInput { path: path.to_owned(), distribution, group: None, source: None, typed }
}

/// A standard uncertainty or half width: `%` and `ppm` are shares of the value. `None` if it is
/// negative, more than the value, or no number.
pub(super) fn spread_amount(node: &Node) -> Option<SpreadAmount> {
    let (value, dimension, is_share) = match &node.value {
        Value::Number { value, .. } => (*value, Dimension::NONE, false),
        Value::Text(text) => {
            let Difference { value, dimension } = text.parse().ok()?;
            let text = text.trim_end();
            (value, dimension, text.ends_with('%') || text.ends_with("ppm"))
        }
        _ => return None,
    };
    match (value >= 0.0 && value.is_finite(), is_share) {
        (true, true) if value <= 1.0 => Some(SpreadAmount::Share(value)),
        (true, false) => Some(SpreadAmount::Absolute(value, dimension)),
        _ => None,
    }
}

fn amount(node: &Node, path: &str, problems: &Problems) -> Option<SpreadAmount> {
    let amount = spread_amount(node);
    if amount.is_none() {
        let expected = "a standard uncertainty of zero or more, in the value's unit or as a share of at most 100 %, e.g. \"1 %\"";
        problems.push(&node.place, &format!("uncertainty.{path}"), node.describe(), expected);
    }
    amount
}

fn distribution(node: &Node, path: &str, problems: &Problems) -> Option<UncertainInput> {
    let key = format!("uncertainty.{path}");
    let table = TableReader::of(node, &key, &[DistributionKeys::KEYS], problems)?;
    let keys = DistributionKeys::read(&table);
    let given: Vec<&str> = DISTRIBUTION_KEYS.into_iter().filter(|width| table.has(width)).collect();
    if given.len() > 1 {
        table.problem(given[1], format!("both {} and {}", given[0], given[1]), "one of them");
    }
    let distribution = match (keys.standard, keys.half_width) {
        (Some(node), _) => amount(node, path, problems).map(InputDistribution::Normal),
        (None, Some(node)) => amount(node, path, problems).map(InputDistribution::Even),
        (None, None) => between(&table, keys.between.as_deref().unwrap_or_default()),
    };
    let source = table.node("source").and_then(Node::as_text);
    distribution.map(|distribution| UncertainInput {
        group: keys.group.map(str::to_owned),
        source: source.map(str::to_owned),
        ..input(node, path, distribution)
    })
}

/// `between = ["2.2 N", "2.5 N"]`.
fn between(
    table: &TableReader<'_>,
    texts: &[(&str, &super::document::SourceLocation)],
) -> Option<InputDistribution> {
    let read: Vec<Quantity> = texts.iter().filter_map(|(text, _)| text.parse().ok()).collect();
    match read.as_slice() {
        [low, high]
            if low.value < high.value && low.dimension == high.dimension && texts.len() == 2 =>
        {
            Some(InputDistribution::Between(low.value, high.value, low.dimension))
        }
        _ => {
            let found = texts.iter().map(|(text, _)| *text).collect::<Vec<_>>().join(", ");
            let expected = "two values of one unit, the lower first, e.g. [\"2.2 N\", \"2.5 N\"]";
            table.problem("between", format!("[{found}]"), expected);
            None
        }
    }
}

/// What is stated of the number at `path`, or of that of all sensors or kinds of particles.
pub fn stated<'u>(inputs: &'u [UncertainInput], path: &str) -> Option<&'u UncertainInput> {
    let named = |path: &str| inputs.iter().find(|input| input.path == path);
    named(path).or_else(|| match path.split('.').collect::<Vec<_>>()[..] {
        [table @ ("sensors" | "particles"), _, key] => named(&format!("{table}.{ANY}.{key}")),
        _ => None,
    })
}

impl InputDistribution {
    /// Dimension of its limits or width; none if that is a share of the value.
    fn dimension(self) -> Option<Dimension> {
        match self {
            Self::Normal(SpreadAmount::Absolute(_, dimension))
            | Self::Even(SpreadAmount::Absolute(_, dimension))
            | Self::Between(_, _, dimension) => Some(dimension),
            Self::Normal(SpreadAmount::Share(_)) | Self::Even(SpreadAmount::Share(_)) => None,
        }
    }

    /// Standard deviation about `value` (unit).
    pub fn standard(self, value: f64) -> f64 {
        match self {
            Self::Normal(amount) => amount.of(value),
            Self::Even(amount) => amount.of(value) / 3f64.sqrt(),
            Self::Between(low, high, _) => 0.5 * (high - low) / 3f64.sqrt(),
        }
    }
}
