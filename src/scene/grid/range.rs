//! Values and ranges of a sweep: `["0.3 m/s", "0.6 m/s"]`,
//! `{ from = "1 N", to = "10 N", count = 5, spacing = "logarithmic" }`,
//! `{ mean = "1.46 GPa", deviation = "5 %" }`.

use crate::quantity::{Dimension, parse_any};
use crate::scene::document::{Entries, Node, SourceLocation, Value};
use crate::scene::reader::{Problems, TableReader};

/// Most values of a range.
const MAX_VALUES: u64 = 10_000_000;

/// How values lie between the ends of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Law {
    Linear,
    Logarithmic,
    /// Around a mean, with a standard deviation.
    Normal,
}

/// Numbers between two ends, or around a mean.
#[derive(Debug, Clone)]
pub(super) struct Range {
    place: SourceLocation,
    law: Law,
    /// Both ends, or mean and standard deviation.
    ends: [f64; 2],
    dimension: Dimension,
    /// Whether both ends are whole numbers.
    whole: bool,
    /// Whether its numbers are drawn: between whole ends they are whole.
    drawn: bool,
}

/// Whether a table of a sweep is a range and no table of the scene.
pub(super) fn is_range(table: &Entries) -> bool {
    table.contains_key("from") || table.contains_key("mean")
}

/// A node's number in SI units, with its dimension; none if it is no number.
pub fn number(node: &Node) -> Option<(f64, Dimension)> {
    match &node.value {
        Value::Number { value, .. } if value.is_finite() => Some((*value, Dimension::NONE)),
        Value::Text(text) => parse_any(text).ok(),
        _ => None,
    }
}

/// A node as TOML has it, on one line; text without its quotes.
pub fn typed(node: &Node) -> String {
    let inner = |node: &Node| match &node.value {
        Value::Text(text) => format!("{text:?}"),
        _ => typed(node),
    };
    match &node.value {
        Value::Text(text) => text.to_string(),
        Value::Number { typed, .. } => typed.to_string(),
        Value::Flag(flag) => flag.to_string(),
        Value::Date(date) => date.to_string(),
        Value::List(items) => {
            format!("[{}]", items.iter().map(inner).collect::<Vec<_>>().join(", "))
        }
        Value::Table(table) => {
            let pairs = table.iter().map(|(key, entry)| format!("{key} = {}", inner(&entry.node)));
            format!("{{ {} }}", pairs.collect::<Vec<_>>().join(", "))
        }
    }
}

/// All values of a grid's entry; none, and a problem, where it is wrong.
pub(super) fn values(path: &str, node: &Node, problems: &Problems) -> Option<Vec<Node>> {
    match &node.value {
        Value::List(items) if items.is_empty() => {
            let expected = "values, or { from = ..., to = ..., count = ... }".to_owned();
            problems.push(node.place.problem(path, "an empty list".to_owned(), expected));
            None
        }
        Value::List(items) => Some(items.to_vec()),
        Value::Table(_) => {
            let table = TableReader::of(node, path, problems)?;
            let range = read(&table, node, false);
            let count = table.required_count("count", 2, MAX_VALUES);
            table.finish();
            let (range, count) = (range?, count?);
            let share = |index: u64| index as f64 / (count - 1) as f64;
            Some((0..count).map(|index| range.at(share(index))).collect())
        }
        _ => Some(vec![node.clone()]),
    }
}

/// The limits of a sample's entry; none, and a problem, where it is wrong.
pub(super) fn limits(path: &str, node: &Node, latin: bool, problems: &Problems) -> Option<Range> {
    let Value::Table(_) = &node.value else {
        let expected = "{ from = ..., to = ... }".to_owned();
        problems.push(node.place.problem(path, node.describe(), expected));
        return None;
    };
    let table = TableReader::of(node, path, problems)?;
    let range = read(&table, node, true);
    if latin && table.has("mean") {
        let expected = "from and to: a normal distribution has no strata of equal width";
        table.problem("mean", "a normal distribution", expected);
    }
    table.finish();
    range
}

fn read(table: &TableReader<'_>, node: &Node, drawn: bool) -> Option<Range> {
    let normal = drawn && table.has("mean");
    let keys = if normal { ["mean", "deviation"] } else { ["from", "to"] };
    let mut found = [None; 2];
    for (key, found) in keys.into_iter().zip(&mut found) {
        let Some(node) = table.node(key) else {
            table.problem(key, "no such key", "a number with its unit");
            continue;
        };
        *found = number(node);
        if found.is_none() {
            table.problem(key, node.describe(), "a number with its unit");
        }
    }
    let laws = [("linear", Law::Linear), ("logarithmic", Law::Logarithmic)];
    let law = table.choice("spacing", &laws).unwrap_or(Law::Linear);
    let (Some((first, dimension)), Some((mut second, other))) = (found[0], found[1]) else {
        return None;
    };
    if normal && other == Dimension::NONE {
        second *= if dimension == Dimension::NONE { 1.0 } else { first };
    } else if other != dimension {
        table.problem(keys[1], other.to_string(), format!("{dimension}, as `{}`", keys[0]));
        return None;
    }
    if law == Law::Logarithmic && !(first > 0.0 && second > 0.0) {
        table.problem("from", "an end that is not above zero", "both ends above zero");
        return None;
    }
    let is_whole = |key| {
        matches!(table.node(key).map(|node| &node.value), Some(Value::Number { whole: true, .. }))
    };
    Some(Range {
        place: node.place.clone(),
        law: if normal { Law::Normal } else { law },
        ends: [first, second],
        dimension,
        whole: keys.into_iter().all(is_whole),
        drawn,
    })
}

impl Range {
    /// The value at `share` of the way from end to end, or `share` standard deviations from the
    /// mean (1), to twelve digits.
    pub(super) fn at(&self, share: f64) -> Node {
        let [first, second] = self.ends;
        let value = match self.law {
            Law::Linear if self.whole && self.drawn => {
                (first + (second - first + 1.0) * share).floor().min(second)
            }
            Law::Linear => first + (second - first) * share,
            Law::Logarithmic => first * (second / first).powf(share),
            Law::Normal => first + second * share,
        };
        let value = format!("{value:.11e}").parse().unwrap_or(value);
        self.node(value)
    }

    pub(super) fn is_normal(&self) -> bool {
        self.law == Law::Normal
    }

    pub(super) fn unit(&self) -> String {
        self.dimension.unit()
    }

    fn node(&self, value: f64) -> Node {
        let value = if self.dimension == Dimension::NONE {
            let whole = self.whole && value.fract() == 0.0;
            Value::Number { typed: value.to_string().into(), value, whole }
        } else {
            Value::Text(format!("{value:e} {}", self.dimension.unit()).into())
        };
        Node { place: self.place.clone(), value }
    }
}
