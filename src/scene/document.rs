//! TOML text as a tree in which every value has its file, line and column, and paths through it.
//!
//! A path is a text of keys joined by dots, `chain.segments.2.repeat`: a number is a place in a
//! list, counted from 1, and `*` is any name. Copies of a tree share their equal parts: the scenes
//! of a sweep differ in a few values, and to copy the others took as long as to simulate the
//! chains.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::problem::Problem;

/// Where a value was typed.
#[derive(Debug, Clone)]
pub struct SourceLocation {
    source: Rc<Source>,
    offset: usize,
}

#[derive(Debug)]
struct Source {
    file: String,
    /// Path of a file; none of an included one.
    path: Option<PathBuf>,
    text: Arc<str>,
    /// First byte of each line but the first, found when the first problem is placed.
    lines: OnceCell<Vec<usize>>,
}

impl SourceLocation {
    /// A problem at this place.
    pub fn problem(&self, key: &str, found: String, expected: String) -> Problem {
        let text = &self.source.text;
        let lines = self
            .source
            .lines
            .get_or_init(|| text.match_indices('\n').map(|(at, _)| at + 1).collect());
        let line = lines.partition_point(|start| *start <= self.offset);
        let start = line.checked_sub(1).and_then(|line| lines.get(line)).copied().unwrap_or(0);
        let before = text.get(start..self.offset).unwrap_or_default();
        Problem {
            file: self.source.file.clone(),
            line: line + 1,
            column: before.chars().count() + 1,
            key: key.to_owned(),
            found,
            expected,
        }
    }

    /// The whole text it was typed in.
    pub fn text(&self) -> &Arc<str> {
        &self.source.text
    }

    /// The file's name.
    pub fn file(&self) -> &str {
        &self.source.file
    }

    /// The folder that paths in the file are relative to; none of an included file.
    pub(super) fn folder(&self) -> Option<&Path> {
        Some(self.source.path.as_ref()?.parent().unwrap_or(Path::new("")))
    }
}

/// Keys that make a table of `[uncertainty]` a distribution.
pub(super) const DISTRIBUTION_KEYS: [&str; 3] = ["standard", "half_width", "between"];

/// Keys and what they say, in the order of their names.
pub type Entries = BTreeMap<Rc<str>, Entry>;

/// A value of the tree.
#[derive(Debug, Clone)]
pub enum Value {
    /// Text.
    Text(Rc<str>),
    /// A number, as typed and as read; infinite or not a number where TOML allows it.
    Number {
        /// As typed.
        typed: Rc<str>,
        /// As read (1).
        value: f64,
        /// Whether it is typed without point and exponent.
        whole: bool,
    },
    /// `true` or `false`.
    Flag(bool),
    /// A date or time, which no key takes.
    Date(Rc<str>),
    /// A list.
    List(Rc<Vec<Node>>),
    /// A table.
    Table(Rc<Entries>),
}

/// A key's place and its value.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Where the key was typed.
    pub key_place: SourceLocation,
    /// The value.
    pub node: Node,
}

/// A value and its place.
#[derive(Debug, Clone)]
pub struct Node {
    /// Where it was typed.
    pub place: SourceLocation,
    /// The source text.
    pub value: Value,
}

impl Node {
    /// Reads `text` of an included file, which is called `file` in problems.
    ///
    /// # Errors
    /// The first syntax error, with its place: those behind it mostly follow from it.
    pub fn parse(file: &str, text: &str) -> Result<Self, Vec<Problem>> {
        Self::parse_file(file, None, text)
    }

    /// Reads `text` of the file at `path`, which is called `file` in problems.
    ///
    /// # Errors
    /// As [`Node::parse`].
    pub fn parse_file(file: &str, path: Option<PathBuf>, text: &str) -> Result<Self, Vec<Problem>> {
        let source = Rc::new(Source {
            file: file.to_owned(),
            path,
            text: text.into(),
            lines: OnceCell::new(),
        });
        let (table, errors) = DeTable::parse_recoverable(text);
        let offset = |error: &&toml::de::Error| error.span().map_or(0, |span| span.start);
        if let Some(error) = errors.iter().min_by_key(offset) {
            let place = SourceLocation { source: Rc::clone(&source), offset: offset(&error) };
            return Err(vec![place.problem(
                "",
                format!("not valid TOML: {}", error.message()),
                String::new(),
            )]);
        }
        let place = SourceLocation { source: Rc::clone(&source), offset: 0 };
        Ok(Self { place, value: table_of(&source, table.get_ref()) })
    }

    /// The value's kind, for messages.
    pub fn describe(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("\"{text}\""),
            Value::Number { typed, .. } => format!("the number {typed}"),
            Value::Flag(flag) => flag.to_string(),
            Value::Date(date) => format!("the date {date}"),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(entries) => match entries.keys().next() {
                Some(key) => format!("a table with `{key}`"),
                None => "an empty table".to_owned(),
            },
        }
    }

    /// Puts this tree on top of `base`: tables merge, everything else replaces.
    pub fn put_over(&mut self, base: &Self) {
        if let (Value::Table(upper), Value::Table(lower)) = (&mut self.value, &base.value) {
            // A distribution of `[uncertainty]` is replaced as a whole.
            if DISTRIBUTION_KEYS.iter().any(|key| upper.contains_key(*key)) {
                return;
            }
            let upper = Rc::make_mut(upper);
            for (key, below) in &**lower {
                match upper.get_mut(key) {
                    Some(entry) => entry.node.put_over(&below.node),
                    None => _ = upper.insert(Rc::clone(key), below.clone()),
                }
            }
        }
    }

    /// The text under `key`, if this is a table and has one.
    pub fn text(&self, key: &str) -> Option<(&str, &SourceLocation)> {
        let Value::Table(table) = &self.value else {
            return None;
        };
        let node = &table.get(key)?.node;
        let Value::Text(text) = &node.value else {
            return None;
        };
        Some((text, &node.place))
    }

    /// The text, if it is one.
    pub fn as_text(&self) -> Option<&str> {
        if let Value::Text(text) = &self.value { Some(text) } else { None }
    }

    /// Whether it is this word, in any case.
    pub fn is_text(&self, word: &str) -> bool {
        self.as_text().is_some_and(|text| text.eq_ignore_ascii_case(word))
    }

    /// Whether it is a table.
    pub fn is_table(&self) -> bool {
        matches!(self.value, Value::Table(_))
    }

    /// The keys of a table, to be changed; none of what is no table.
    pub fn entries_mut(&mut self) -> Option<&mut Entries> {
        match &mut self.value {
            Value::Table(entries) => Some(Rc::make_mut(entries)),
            _ => None,
        }
    }
}

fn table_of(source: &Rc<Source>, table: &DeTable<'_>) -> Value {
    let entry = |key: &Spanned<std::borrow::Cow<'_, str>>, value: &Spanned<DeValue<'_>>| Entry {
        key_place: SourceLocation { source: Rc::clone(source), offset: key.span().start },
        node: node_of(source, value),
    };
    let entries = table.iter().map(|(key, value)| (Rc::from(&**key.get_ref()), entry(key, value)));
    Value::Table(Rc::new(entries.collect()))
}

fn node_of(source: &Rc<Source>, value: &Spanned<DeValue<'_>>) -> Node {
    let value_of = match value.get_ref() {
        DeValue::String(text) => Value::Text(Rc::from(&**text)),
        DeValue::Integer(number) => Value::Number {
            typed: number.to_string().into(),
            value: i64::from_str_radix(number.as_str(), number.radix())
                .map_or(f64::NAN, |whole| whole as f64),
            whole: true,
        },
        DeValue::Float(number) => Value::Number {
            typed: number.to_string().into(),
            value: number.as_str().parse().unwrap_or(f64::NAN),
            whole: false,
        },
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(date) => Value::Date(date.to_string().into()),
        DeValue::Array(items) => {
            Value::List(Rc::new(items.iter().map(|item| node_of(source, item)).collect()))
        }
        DeValue::Table(table) => table_of(source, table),
    };
    Node {
        place: SourceLocation { source: Rc::clone(source), offset: value.span().start },
        value: value_of,
    }
}

/// Part of a path that matches any name.
pub(super) const ANY: &str = "*";

/// The value at a path.
pub(super) fn at<'a>(node: &'a Node, keys: &[&str]) -> Option<&'a Node> {
    let Some((first, rest)) = keys.split_first() else { return Some(node) };
    match &node.value {
        Value::Table(table) => at(&table.get(*first)?.node, rest),
        Value::List(items) => at(items.get(place_in_list(first)?)?, rest),
        _ => None,
    }
}

/// `1` is the first of a list.
fn place_in_list(key: &str) -> Option<usize> {
    key.parse::<usize>().ok()?.checked_sub(1)
}

/// The value at a path, to be changed.
pub(super) fn at_mut<'a>(node: &'a mut Node, keys: &[&str]) -> Option<&'a mut Node> {
    let Some((first, rest)) = keys.split_first() else { return Some(node) };
    match &mut node.value {
        Value::Table(table) => at_mut(&mut Rc::make_mut(table).get_mut(*first)?.node, rest),
        Value::List(items) => at_mut(Rc::make_mut(items).get_mut(place_in_list(first)?)?, rest),
        _ => None,
    }
}

/// Puts `value` at the path, creating the tables on the way.
pub(super) fn insert(node: &mut Node, keys: &[&str], value: Value) {
    let place = node.place.clone();
    put(node, keys, Node { place, value });
}

/// Puts `new` at the path, creating the tables on the way; false if it cannot: a list is not made
/// longer, and only tables have keys.
pub(super) fn put(node: &mut Node, keys: &[&str], new: Node) -> bool {
    let Some((first, rest)) = keys.split_first() else {
        *node = new;
        return true;
    };
    match &mut node.value {
        Value::Table(table) => {
            let table = Rc::make_mut(table);
            if !table.contains_key(*first) {
                let place = new.place.clone();
                let value = Value::Table(Rc::new(Entries::new()));
                let node = Node { place: place.clone(), value };
                table.insert(Rc::from(*first), Entry { key_place: place, node });
            }
            table.get_mut(*first).is_some_and(|entry| put(&mut entry.node, rest, new))
        }
        Value::List(items) => {
            let items = Rc::make_mut(items);
            let item = place_in_list(first).and_then(|index| items.get_mut(index));
            item.is_some_and(|item| put(item, rest, new))
        }
        _ => false,
    }
}

/// All values that `keys` lead to, each with its path.
pub(super) fn expand<'a>(
    node: &'a Node,
    keys: &[&str],
    path: &mut Vec<String>,
    found: &mut Vec<(String, &'a Node)>,
) {
    let Some((first, rest)) = keys.split_first() else {
        found.push((path.join("."), node));
        return;
    };
    let mut deeper = |key: String, node: &'a Node| {
        path.push(key);
        expand(node, rest, path, found);
        path.pop();
    };
    let meant = |key: &str| *first == ANY || key == *first;
    match &node.value {
        Value::Table(table) => {
            let entries = table.iter().filter(|(key, _)| meant(key));
            entries.for_each(|(key, entry)| deeper(key.to_string(), &entry.node));
        }
        Value::List(items) => {
            let items = (1..).map(|place: usize| place.to_string()).zip(&**items);
            items.filter(|(key, _)| meant(key)).for_each(|(key, node)| deeper(key, node));
        }
        _ => {}
    }
}

/// Whether the way along `path` leads through no list.
pub(super) fn is_in_tables(root: &Node, path: &str) -> bool {
    let keys: Vec<&str> = path.split('.').collect();
    let is_table = |end| matches!(at(root, &keys[..end]).map(|n| &n.value), Some(Value::Table(_)));
    (0..keys.len()).all(is_table)
}

/// Names at the last place of a path that is there.
pub(super) fn known(root: &Node, keys: &[&str]) -> Vec<String> {
    let mut node = root;
    for key in keys {
        let next = match &node.value {
            Value::Table(table) if *key == ANY => table.values().next().map(|entry| &entry.node),
            Value::List(items) if *key == ANY => items.first(),
            _ => at(node, &[key]),
        };
        node = match (next, &node.value) {
            (Some(next), _) => next,
            (None, Value::Table(table)) => return table.keys().map(ToString::to_string).collect(),
            (None, Value::List(items)) => {
                return (1..=items.len()).map(|i| i.to_string()).collect();
            }
            _ => return Vec::new(),
        };
    }
    Vec::new()
}

/// A TOML basic string. JSON's escapes are among TOML's, which has one character more that needs
/// one.
pub fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string().replace('\u{7f}', "\\u007f")
}

/// A key as TOML has it.
pub(super) fn quoted_key(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(is_bare) { name.to_owned() } else { quoted(name) }
}

/// A value as TOML has it, on one line.
pub(super) fn inline(node: &Node) -> String {
    match &node.value {
        Value::Text(text) => quoted(text),
        Value::Number { typed, .. } => typed.to_string(),
        Value::Flag(flag) => flag.to_string(),
        Value::Date(date) => date.to_string(),
        Value::List(items) => {
            format!("[{}]", items.iter().map(inline).collect::<Vec<_>>().join(", "))
        }
        Value::Table(entries) => {
            let pair = |(name, entry): (&Rc<str>, &Entry)| {
                format!("{} = {}", quoted_key(name), inline(&entry.node))
            };
            format!("{{ {} }}", entries.iter().map(pair).collect::<Vec<_>>().join(", "))
        }
    }
}
