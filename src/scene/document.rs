//! TOML text as a tree in which every value knows its file, line and column.
//!
//! A scene may stand on another (`base = "magnet-0.61g"`): tables are merged key by key, everything
//! else is replaced, and each value keeps the place where it was typed. Copies share what they have
//! in common: the scenes of a sweep differ in a few values, and copying all others took as long as
//! following their chains.

use std::collections::BTreeMap;
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
    text: Arc<str>,
}

impl SourceLocation {
    /// A problem at this place.
    pub fn problem(&self, key: &str, found: String, expected: String) -> Problem {
        let before = self.source.text.get(..self.offset).unwrap_or(&self.source.text);
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        Problem {
            file: self.source.file.clone(),
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
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
    /// Reads `text`, naming it `file` in problems.
    ///
    /// # Errors
    /// The first syntax error, with its place: those behind it mostly follow from it.
    pub fn parse(file: &str, text: &str) -> Result<Self, Vec<Problem>> {
        let source = Rc::new(Source { file: file.to_owned(), text: text.into() });
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
            // A distribution of `[uncertainty]` is one thing.
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
