//! Reads typed values out of a table, collecting every problem instead of stopping at the first.
//!
//! Each getter returns `None` where the key is absent or wrong; wrong ones leave a
//! [`Problem`](super::Problem). A table that is done reports keys that were not read.

use std::cell::RefCell;
use std::rc::Rc;

use super::document::{Entries, Entry, Node, SourceLocation, Value};
use super::problem::MISSING;
use crate::quantity::{self, Dimension, QuantityError};

pub use super::bound::Bound;
pub use super::problem::Problems;

/// What a quantity must be, with an example where there is one.
fn expectation(dimension: Dimension, bound: Bound) -> String {
    let example = dimension.example().map_or_else(String::new, |e| format!(", e.g. \"{e}\""));
    format!("{dimension}{}{example}", bound.words())
}

/// `text` with a point in place of a comma between two digits; none without one.
fn with_decimal_point(text: &str) -> Option<String> {
    let is_digit = |index: Option<usize>| {
        index.and_then(|index| text.as_bytes().get(index)).is_some_and(u8::is_ascii_digit)
    };
    let comma = text.find(',')?;
    let is_decimal = is_digit(comma.checked_sub(1)) && is_digit(Some(comma + 1));
    is_decimal.then(|| text.replacen(',', ".", 1))
}

/// The key among `known` that `key` may be a slip of: two letters wrong at most, and less than half
/// of them.
fn similar<'k>(key: &str, known: &[&'k str]) -> Option<&'k str> {
    let distance = |name: &str| strsim::damerau_levenshtein(key, name);
    let near = known.iter().copied().min_by_key(|name| distance(name))?;
    (distance(near) <= 2 && 2 * distance(near) < key.chars().count().max(2)).then_some(near)
}

/// A table being read.
pub struct TableReader<'a> {
    pub(super) entries: &'a Rc<Entries>,
    place: &'a SourceLocation,
    path: String,
    problems: &'a Problems,
    /// Keys that were asked for, some of them more than once.
    asked: RefCell<Vec<&'static str>>,
}

impl<'a> TableReader<'a> {
    /// The table in `node`, with its keys' full names behind `path`; anything else is a problem.
    pub fn of(node: &'a Node, path: &str, problems: &'a Problems) -> Option<Self> {
        let Value::Table(entries) = &node.value else {
            let expected = match path.split_once('.') {
                Some(("effects", _)) => {
                    format!("a table [{path}], or `{path} = false` to switch the effect off")
                }
                _ => format!("a table [{path}]"),
            };
            problems.push(node.place.problem(path, node.describe(), expected));
            return None;
        };
        Some(Self {
            entries,
            place: &node.place,
            path: path.to_owned(),
            problems,
            // As many as are there, and some that could be.
            asked: RefCell::new(Vec::with_capacity(entries.len() + 8)),
        })
    }

    /// The path of `key` from the top.
    pub fn path_of(&self, key: &str) -> String {
        let dot = if self.path.is_empty() || key.is_empty() { "" } else { "." };
        [&self.path, dot, key].concat()
    }

    /// Where `key` stands, or where the table begins.
    pub fn place_of(&self, key: &str) -> &SourceLocation {
        self.entries.get(key).map_or(self.place, |entry| &entry.node.place)
    }

    /// Notes a problem with the value of `key`.
    pub fn problem(&self, key: &str, found: impl Into<String>, expected: impl Into<String>) {
        let place = self.place_of(key);
        self.problems.push(place.problem(&self.path_of(key), found.into(), expected.into()));
    }

    /// Notes a problem at a place inside the value of `key`.
    pub fn problem_at(&self, place: &SourceLocation, key: &str, found: String, expected: String) {
        self.problems.push(place.problem(&self.path_of(key), found, expected));
    }

    /// Whether `key` is there; does not count as asking for it.
    pub fn has(&self, key: &str) -> bool {
        self.entries.contains_key(key)
    }

    /// Whether `key` stands in the table's own file, and not in that of a model or base.
    pub fn is_own(&self, key: &str) -> bool {
        self.entries.get(key).is_some_and(|e| e.node.place.file() == self.place.file())
    }

    /// The value of `key` as it stands.
    pub fn node(&self, key: &'static str) -> Option<&'a Node> {
        self.asked.borrow_mut().push(key);
        self.entries.get(key).map(|entry| &entry.node)
    }

    /// Asks for `key`, which must be there, and says so if it is missing.
    fn missing(&self, key: &'static str, expected: impl FnOnce() -> String) -> bool {
        let missing = self.node(key).is_none();
        if missing {
            self.problem(key, MISSING, expected());
        }
        missing
    }

    /// A quantity with a unit, as a number of SI units (unit).
    pub fn quantity(&self, key: &'static str, dimension: Dimension, bound: Bound) -> Option<f64> {
        self.read(key, dimension, bound, quantity::parse)
    }

    /// A difference of two quantities, such as a change of temperature, as a number of SI units
    /// (unit).
    pub fn difference(&self, key: &'static str, dimension: Dimension, bound: Bound) -> Option<f64> {
        self.read(key, dimension, bound, quantity::parse_difference)
    }

    fn read(
        &self,
        key: &'static str,
        dimension: Dimension,
        bound: Bound,
        parse: fn(&str, Dimension) -> Result<f64, QuantityError>,
    ) -> Option<f64> {
        let node = self.node(key)?;
        let expected = || expectation(dimension, bound);
        let value = match &node.value {
            Value::Text(text) => match parse(text, dimension) {
                Ok(value) => value,
                Err(error) => {
                    if let Some(point) = with_decimal_point(text) {
                        let found = format!("\"{text}\", a decimal comma");
                        self.problem(key, found, format!("a decimal point: \"{point}\""));
                        return None;
                    }
                    let found = match error {
                        QuantityError::WrongDimension { .. } | QuantityError::NotFinite { .. } => {
                            error.to_string()
                        }
                        _ => format!("\"{text}\" ({error})"),
                    };
                    self.problem(key, found, expected());
                    return None;
                }
            },
            Value::Number { value, .. } if dimension == Dimension::NONE && value.is_finite() => {
                *value
            }
            Value::Number { typed, value, .. } if value.is_finite() => {
                let unit = usual_unit(dimension);
                self.problem(
                    key,
                    format!("the number {typed} without a unit"),
                    format!("{dimension}{}, typed like \"{typed} {unit}\"", bound.words()),
                );
                return None;
            }
            _ => {
                self.problem(key, node.describe(), expected());
                return None;
            }
        };
        if bound.holds(value) {
            return Some(value);
        }
        self.problem(key, node.describe(), format!("{dimension}{}", bound.broken_by(value)));
        None
    }

    /// A quantity that must be there, as a number of SI units (unit).
    pub fn required(&self, key: &'static str, dimension: Dimension, bound: Bound) -> Option<f64> {
        if self.missing(key, || expectation(dimension, bound)) {
            return None;
        }
        self.quantity(key, dimension, bound)
    }

    /// A whole number from `least` to `most`.
    pub fn count(&self, key: &'static str, least: u64, most: u64) -> Option<u64> {
        let node = self.node(key)?;
        match node.value {
            Value::Number { value, whole: true, .. }
                if value >= least as f64 && value <= most as f64 =>
            {
                Some(value as u64)
            }
            _ => {
                let expected = format!("a whole number from {least} to {most}");
                self.problem(key, node.describe(), expected);
                None
            }
        }
    }

    /// A whole number that must be there.
    pub fn required_count(&self, key: &'static str, least: u64, most: u64) -> Option<u64> {
        if self.missing(key, || format!("a whole number from {least} to {most}")) {
            return None;
        }
        self.count(key, least, most)
    }

    /// Text.
    pub fn text(&self, key: &'static str) -> Option<&'a str> {
        let node = self.node(key)?;
        if let Value::Text(text) = &node.value {
            return Some(text);
        }
        self.problem(key, node.describe(), "text in quotes");
        None
    }

    /// Text that must be there.
    pub fn required_text(&self, key: &'static str, what: &str) -> Option<&'a str> {
        if self.missing(key, || what.to_owned()) {
            return None;
        }
        self.text(key)
    }

    /// Whether `key` is this word.
    pub fn is_word(&self, key: &'static str, word: &str) -> bool {
        let text = self.node(key).map(|node| &node.value);
        matches!(text, Some(Value::Text(text)) if text.eq_ignore_ascii_case(word))
    }

    /// One of several words.
    pub fn choice<T: Copy>(&self, key: &'static str, words: &[(&str, T)]) -> Option<T> {
        let node = self.node(key)?;
        let found = match &node.value {
            Value::Text(text) => words.iter().find(|(word, _)| word.eq_ignore_ascii_case(text)),
            _ => None,
        };
        if found.is_none() {
            let names: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
            self.problem(key, node.describe(), format!("one of {}", names.join(", ")));
        }
        found.map(|(_, value)| *value)
    }

    /// `true` or `false`.
    pub fn flag(&self, key: &'static str) -> Option<bool> {
        let node = self.node(key)?;
        if let Value::Flag(flag) = node.value {
            return Some(flag);
        }
        self.problem(key, node.describe(), "true or false");
        None
    }

    /// A table.
    pub fn table(&self, key: &'static str) -> Option<TableReader<'a>> {
        TableReader::of(self.node(key)?, &self.path_of(key), self.problems)
    }

    /// A table of tables with free names, in the order of the names.
    pub fn tables(&self, key: &'static str) -> Vec<(&'a str, TableReader<'a>)> {
        let Some(table) = self.table(key) else {
            return Vec::new();
        };
        let of = |(name, entry): (&'a Rc<str>, &'a Entry)| {
            let inner = TableReader::of(&entry.node, &table.path_of(name), self.problems)?;
            Some((&**name, inner))
        };
        table.entries.iter().filter_map(of).collect()
    }

    /// A list of tables.
    pub fn list(&self, key: &'static str) -> Vec<TableReader<'a>> {
        let Some(node) = self.node(key) else {
            return Vec::new();
        };
        let Value::List(items) = &node.value else {
            self.problem(
                key,
                node.describe(),
                format!("a list of tables, [[{}]]", self.path_of(key)),
            );
            return Vec::new();
        };
        let path = |index: usize| format!("{}[{}]", self.path_of(key), index + 1);
        let tables = items.iter().enumerate();
        tables.filter_map(|(i, item)| TableReader::of(item, &path(i), self.problems)).collect()
    }

    /// Whether `key` is there and an empty list.
    pub fn is_empty_list(&self, key: &str) -> bool {
        let node = self.entries.get(key).map(|entry| &entry.node.value);
        matches!(node, Some(Value::List(items)) if items.is_empty())
    }

    /// A list of texts, each with its place.
    pub fn texts(&self, key: &'static str) -> Vec<(&'a str, &'a SourceLocation)> {
        let Some(node) = self.node(key) else {
            return Vec::new();
        };
        let Value::List(items) = &node.value else {
            self.problem(key, node.describe(), "a list of names");
            return Vec::new();
        };
        let mut texts = Vec::with_capacity(items.len());
        for item in &**items {
            if let Value::Text(text) = &item.value {
                texts.push((&**text, &item.place));
            } else {
                let problem =
                    item.place.problem(&self.path_of(key), item.describe(), "a name".to_owned());
                self.problems.push(problem);
            }
        }
        texts
    }

    /// Reports every key that was not asked for.
    pub fn finish(self) {
        let mut asked = self.asked.take();
        let unknown = |(key, _): &(&'a Rc<str>, &'a Entry)| !asked.contains(&&***key);
        let unknown: Vec<_> = self.entries.iter().filter(unknown).collect();
        if unknown.is_empty() {
            return;
        }
        asked.sort_unstable();
        asked.dedup();
        let expected = if asked.is_empty() {
            "nothing here".to_owned()
        } else {
            format!("one of {}", asked.join(", "))
        };
        for (key, entry) in unknown {
            let path = self.path_of(key);
            let found = match similar(key, &asked) {
                Some(similar) => format!("the unknown key `{key}` (did you mean `{similar}`?)"),
                None => format!("the unknown key `{key}`"),
            };
            self.problems.push(entry.key_place.problem(&path, found, expected.clone()));
        }
    }
}

/// The table of an effect; `false` in its place switches off what a base scene switched on.
pub(super) fn effect<'a>(effects: &TableReader<'a>, name: &'static str) -> Option<TableReader<'a>> {
    let node = effects.node(name)?;
    if matches!(node.value, Value::Flag(false)) {
        return None;
    }
    let table = effects.table(name)?;
    let _ = table.node("state");
    Some(table)
}

/// The unit that a bench's values of this dimension are mostly given in.
fn usual_unit(dimension: Dimension) -> String {
    match dimension {
        Dimension::LENGTH => "mm".to_owned(),
        Dimension::TIME => "ms".to_owned(),
        Dimension::MASS => "g".to_owned(),
        other => other.unit(),
    }
}
