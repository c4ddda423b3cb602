//! Tables of a file: their keys, declared once, and typed values read from them.
//!
//! `table!` declares a table as a struct: one line for each key with its help (the doc comment),
//! its type, its kind with dimension and bound, and its default. The declaration makes
//!
//! - the struct, whose fields are `Some` where a key is there and right, or has a default;
//! - `read`, which reads all keys before it answers, so that all problems are found at once;
//! - `KEYS`, from which unknown keys are refused and [`resolved`](super::resolved) shows defaults
//!   and writes the annotated pages.

use std::rc::Rc;

use super::document::{ANY, Entries, Node, SourceLocation, Value};
use super::problem::MISSING;
pub use super::problems::Problems;
use super::vocabulary;
use crate::quantity::{self, Dimension, Quantity, QuantityError};

/// A key that every table takes: where its numbers are from.
pub(super) const SOURCE: &str = "source";

/// Limits of numbers, in addition to their dimension.
#[derive(Debug, Clone, Copy)]
pub enum Bound {
    /// Any finite number.
    Any,
    /// Above zero.
    Positive,
    /// Zero or above.
    NotNegative,
    /// Zero or above, and at most what fits on a bench.
    UpTo(
        /// Upper limit, in the unit of what it bounds (unit).
        f64,
    ),
    /// Above zero, and within what fits on a bench: a wrong unit becomes an error that names its
    /// line.
    Bench(
        /// Lower limit, in the unit of what it bounds (unit).
        f64,
        /// Upper limit, in the unit of what it bounds (unit).
        f64,
    ),
    /// Strictly between two limits.
    Between(
        /// Lower limit, in the unit of what it bounds (unit).
        f64,
        /// Upper limit, in the unit of what it bounds (unit).
        f64,
    ),
    /// Within two limits, both included.
    Within(
        /// Lower limit, in the unit of what it bounds (unit).
        f64,
        /// Upper limit, in the unit of what it bounds (unit).
        f64,
    ),
}

/// Largest speed (m/s).
const MAX_SPEED: f64 = 1e5;

impl Bound {
    /// Of a mass (kg).
    pub const MASS: Self = Self::Bench(1e-18, 1e9);
    /// Of a length (m).
    pub const LENGTH: Self = Self::Bench(1e-9, 1e4);
    /// Of a force that presses the chain: a hundred tonnes (N).
    pub const FORCE: Self = Self::UpTo(1e6);
    /// Of Young's modulus (Pa).
    pub const MODULUS: Self = Self::Bench(1.0, 1e14);
    /// Of a density (kg/m³).
    pub const DENSITY: Self = Self::Bench(1.0, 1e5);
    /// Of a striker's speed (m/s).
    pub const SPEED: Self = Self::Bench(1e-12, MAX_SPEED);
    /// Of a velocity (m/s).
    pub const VELOCITY: Self = Self::Within(-MAX_SPEED, MAX_SPEED);

    /// Whether `value` keeps to it.
    pub(super) fn holds(self, value: f64) -> bool {
        match self {
            Self::Any => true,
            Self::Positive => value > 0.0,
            Self::NotNegative => value >= 0.0,
            Self::UpTo(high) => (0.0..=high).contains(&value),
            Self::Between(low, high) => low < value && value < high,
            Self::Bench(low, high) | Self::Within(low, high) => (low..=high).contains(&value),
        }
    }

    /// Whether a number without a unit has the sign that is needed.
    fn takes_sign_of(self, number: f64) -> bool {
        match self {
            Self::Positive | Self::Bench(..) => number > 0.0,
            Self::NotNegative | Self::UpTo(_) => number >= 0.0,
            Self::Any | Self::Between(..) | Self::Within(..) => true,
        }
    }

    /// The bound that `value` breaks, in words that follow the dimension's name.
    pub(super) fn broken_by(self, value: f64) -> String {
        match self {
            Self::Bench(low, high) if value > 0.0 => Self::Within(low, high).words(),
            Self::UpTo(high) if value > 0.0 => Self::Within(0.0, high).words(),
            _ => self.words(),
        }
    }

    /// The bound in words, for a message: ` above zero` follows the dimension's name.
    pub(super) fn words(self) -> String {
        match self {
            Self::Any => String::new(),
            Self::Positive | Self::Bench(..) => " above zero".to_owned(),
            Self::NotNegative | Self::UpTo(_) => " of zero or more".to_owned(),
            Self::Between(low, high) => format!(" above {low} and below {high}"),
            Self::Within(low, high) => format!(" from {} to {}", short(low), short(high)),
        }
    }
}

/// A long row of zeros is hard to count.
fn short(value: f64) -> String {
    let reads_well = value == 0.0 || (1e-4..=1e5).contains(&value.abs());
    if reads_well { value.to_string() } else { format!("{value:e}") }
}

/// Declarations of a table's keys; more than one where a table holds what two files may say.
pub type Keys = &'static [&'static [Key]];

/// What a key holds.
#[derive(Clone, Copy)]
pub enum Kind {
    /// Text.
    Text,
    /// `true` or `false`.
    Flag,
    /// One of several words.
    Word(fn() -> Vec<&'static str>),
    /// A whole number within two limits.
    Count(u64, u64),
    /// A number with a unit.
    Quantity(Dimension, Bound),
    /// A difference of two quantities, such as a change of temperature.
    Difference(Dimension, Bound),
    /// A list of texts.
    Texts,
    /// A list of quantities above zero.
    Series(Dimension),
    /// A table.
    Table(Keys),
    /// A table of tables with free names.
    Tables(Keys),
    /// A list of tables.
    List(Keys),
    /// The table of an effect; `false` in its place switches it off.
    Effect(Keys),
    /// Read by hand; keys of the table that it may be.
    Any(Keys),
}

/// The declaration of a key.
#[derive(Clone, Copy)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub kind: Kind,
    /// Whether it must be there.
    pub is_required: bool,
    /// What is expected, if that is not clear from the kind.
    pub needs: &'static str,
    /// Its value where it is not there.
    pub default: Option<&'static str>,
    /// One line for the annotated page.
    pub help: &'static str,
}

impl Key {
    /// A key of this kind.
    pub const fn new(kind: Kind) -> Self {
        Self { name: "", kind, is_required: false, needs: "", default: None, help: "" }
    }

    /// The key with its name and help.
    #[must_use]
    pub const fn named(self, name: &'static str, help: &'static str) -> Self {
        Self { name, help, ..self }
    }

    /// Refuses a table without it.
    #[must_use]
    pub const fn required(self) -> Self {
        Self { is_required: self.default.is_none(), ..self }
    }

    /// Says what is expected, if that is not clear from the kind.
    #[must_use]
    pub const fn needs(self, needs: &'static str) -> Self {
        Self { needs, ..self }
    }

    /// Sets the default.
    #[must_use]
    pub const fn or(self, default: &'static str) -> Self {
        Self { default: Some(default), ..self }
    }

    /// What is expected where the key is missing.
    pub(super) fn expected(&self) -> String {
        if self.needs.is_empty() { self.expected_value() } else { self.needs.to_owned() }
    }

    /// What is expected instead of a wrong value.
    fn expected_value(&self) -> String {
        match self.kind {
            Kind::Text => "text in quotes".to_owned(),
            Kind::Flag => "true or false".to_owned(),
            Kind::Word(words) => {
                let words: Vec<String> = words().iter().map(|word| format!("\"{word}\"")).collect();
                format!("one of {}", words.join(", "))
            }
            Kind::Count(least, most) => format!("a whole number from {least} to {most}"),
            Kind::Quantity(dimension, bound) | Kind::Difference(dimension, bound) => {
                let example = dimension.example();
                let example = example.map_or_else(String::new, |e| format!(", e.g. \"{e}\""));
                format!("{dimension}{}{example}", bound.words())
            }
            Kind::Texts => "a list of names".to_owned(),
            Kind::Series(dimension) => format!("a list, each {dimension} above zero"),
            Kind::Table(_) | Kind::Tables(_) | Kind::List(_) | Kind::Effect(_) | Kind::Any(_) => {
                self.needs.to_owned()
            }
        }
    }

    /// The default as a value of the tree.
    pub(super) fn default_value(&self) -> Option<Value> {
        let text = self.default?;
        Some(match (self.kind, text.parse::<f64>()) {
            (Kind::Flag, _) => Value::Flag(text == "true"),
            (Kind::Count(..) | Kind::Quantity(Dimension::NONE, _), Ok(value)) => {
                Value::Number { typed: text.into(), value, whole: value.fract() == 0.0 }
            }
            _ => Value::Text(text.into()),
        })
    }

    /// The keys below it.
    pub(super) fn below(&self) -> Keys {
        match self.kind {
            Kind::Table(keys)
            | Kind::Tables(keys)
            | Kind::List(keys)
            | Kind::Effect(keys)
            | Kind::Any(keys) => keys,
            _ => &[],
        }
    }

    /// Dimension of its values; none if they are no quantities.
    pub(super) fn dimension(&self) -> Option<Dimension> {
        match self.kind {
            Kind::Quantity(dimension, _) | Kind::Difference(dimension, _) => Some(dimension),
            Kind::Count(..) => Some(Dimension::NONE),
            _ => None,
        }
    }
}

/// The declaration that a path leads to, below `keys`. A free name and the number of a list's item
/// are one step each; `*` is any key.
pub(super) fn key_at(keys: Keys, path: &[&str]) -> Option<&'static Key> {
    let (first, rest) = path.split_first()?;
    let named = |key: &&Key| *first == ANY || key.name == *first;
    let mut named = keys.iter().flat_map(|keys| keys.iter()).filter(named);
    named.find_map(|key| {
        let below = match key.kind {
            _ if rest.is_empty() => return Some(key),
            Kind::Tables(_) | Kind::List(_) => &rest[1..],
            _ => rest,
        };
        key_at(key.below(), below)
    })
}

/// Declarations of the keys of the table at a path below `keys`, without the numbers of items of
/// lists; none for a table whose names are free.
pub(super) fn keys_at(keys: Keys, path: &[&str]) -> Keys {
    let Some((first, rest)) = path.split_first() else { return keys };
    let key = keys.iter().flat_map(|keys| keys.iter()).find(|key| key.name == *first);
    match (key, rest) {
        (Some(Key { kind: Kind::Tables(_), .. }), []) | (None, _) => &[],
        (Some(Key { kind: Kind::Tables(below), .. }), [_, rest @ ..]) => keys_at(below, rest),
        (Some(key), rest) => keys_at(key.below(), rest),
    }
}

/// Text.
pub const fn text() -> Key {
    Key::new(Kind::Text)
}

/// `true` or `false`.
pub const fn flag() -> Key {
    Key::new(Kind::Flag)
}

/// One of the words of `T`.
pub const fn word<T: Word>() -> Key {
    Key::new(Kind::Word(names::<T>))
}

/// A whole number from `least` to `most`.
pub const fn count(least: u64, most: u64) -> Key {
    Key::new(Kind::Count(least, most))
}

/// A number with a unit.
pub const fn quantity(dimension: Dimension, bound: Bound) -> Key {
    Key::new(Kind::Quantity(dimension, bound))
}

/// A number with a unit, above zero.
pub const fn positive(dimension: Dimension) -> Key {
    quantity(dimension, Bound::Positive)
}

/// A number with a unit, zero or above.
pub const fn not_negative(dimension: Dimension) -> Key {
    quantity(dimension, Bound::NotNegative)
}

/// A difference of two quantities, zero or above.
pub const fn difference(dimension: Dimension) -> Key {
    Key::new(Kind::Difference(dimension, Bound::NotNegative))
}

/// A list of texts.
pub const fn texts() -> Key {
    Key::new(Kind::Texts)
}

/// A list of quantities above zero.
pub const fn series(dimension: Dimension) -> Key {
    Key::new(Kind::Series(dimension))
}

/// A table.
pub const fn table_of(keys: Keys) -> Key {
    Key::new(Kind::Table(keys))
}

/// A table of tables with free names.
pub const fn tables_of(keys: Keys) -> Key {
    Key::new(Kind::Tables(keys))
}

/// A list of tables.
pub const fn list_of(keys: Keys) -> Key {
    Key::new(Kind::List(keys))
}

/// The table of an effect.
pub const fn effect(keys: Keys) -> Key {
    Key::new(Kind::Effect(keys))
}

/// What is read by hand.
pub const fn any(keys: Keys) -> Key {
    Key::new(Kind::Any(keys))
}

/// Values that have a word each.
pub trait Word: Copy + 'static {
    /// The words, in any case.
    const WORDS: &'static [(&'static str, Self)];
}

fn names<T: Word>() -> Vec<&'static str> {
    T::WORDS.iter().map(|(word, _)| *word).collect()
}

/// A table being read.
#[derive(Clone)]
pub struct TableReader<'a> {
    pub(super) entries: &'a Rc<Entries>,
    place: &'a SourceLocation,
    path: String,
    problems: &'a Problems,
}

impl<'a> TableReader<'a> {
    /// The table in `node`, whose path is `path`; anything else is a problem, as is a key that is
    /// not among `keys`.
    pub fn of(node: &'a Node, path: &str, keys: Keys, problems: &'a Problems) -> Option<Self> {
        let Value::Table(entries) = &node.value else {
            problems.push(&node.place, path, node.describe(), format!("a table [{path}]"));
            return None;
        };
        let table = Self { entries, place: &node.place, path: path.to_owned(), problems };
        table.refuse_unknown(keys);
        Some(table)
    }

    /// The path of `key` from the top.
    pub fn path_of(&self, key: &str) -> String {
        let dot = if self.path.is_empty() || key.is_empty() { "" } else { "." };
        [&self.path, dot, key].concat()
    }

    /// Place of the value of `key`, or of the table without it.
    pub fn place_of(&self, key: &str) -> &'a SourceLocation {
        self.entries.get(key).map_or(self.place, |entry| &entry.node.place)
    }

    /// The problems of the file.
    pub fn problems(&self) -> &'a Problems {
        self.problems
    }

    /// Notes a problem with the value of `key`.
    pub fn problem(&self, key: &str, found: impl Into<String>, expected: impl Into<String>) {
        self.problems.push(self.place_of(key), &self.path_of(key), found, expected);
    }

    /// Notes a problem at a place inside the value of `key`.
    pub fn problem_at(&self, place: &SourceLocation, key: &str, found: String, expected: String) {
        self.problems.push(place, &self.path_of(key), found, expected);
    }

    /// Notes that `key` is missing.
    pub fn missing(&self, key: &str, expected: impl Into<String>) {
        self.problem(key, MISSING, expected);
    }

    /// Whether `key` is there.
    pub fn has(&self, key: &str) -> bool {
        self.entries.contains_key(key)
    }

    /// Whether `key` is in the table's own file, and not in that of a model or base.
    pub fn is_own(&self, key: &str) -> bool {
        self.entries.get(key).is_some_and(|e| e.node.place.file() == self.place.file())
    }

    /// The value of `key` in the tree.
    pub fn node(&self, key: &str) -> Option<&'a Node> {
        self.entries.get(key).map(|entry| &entry.node)
    }

    /// Whether `key` is there and an empty list.
    pub fn is_empty_list(&self, key: &str) -> bool {
        matches!(self.node(key).map(|n| &n.value), Some(Value::List(items)) if items.is_empty())
    }

    /// Whether `key` is `false`, as that of an effect that is switched off.
    pub fn is_off(&self, key: &str) -> bool {
        matches!(self.node(key).map(|n| &n.value), Some(Value::Flag(false)))
    }

    /// The value of a declared key; `None` if it is absent without a default, or wrong, which
    /// leaves a problem.
    pub fn get<T: FromKey<'a>>(&self, key: &'static Key) -> Option<T> {
        match self.node(key.name) {
            Some(node) => T::from_node(self, key, node),
            None if key.is_required => {
                self.missing(key.name, key.expected());
                None
            }
            None => T::from_default(key.default?),
        }
    }

    /// Says that `key`, declared among `keys`, is missing if it is.
    pub fn require(&self, keys: &'static [Key], key: &str) {
        if let Some(key) = keys.iter().find(|known| known.name == key)
            && !self.has(key.name)
        {
            self.missing(key.name, key.expected());
        }
    }

    fn refuse_unknown(&self, keys: Keys) {
        let known = || keys.iter().flat_map(|keys| keys.iter()).map(|key| key.name);
        for (name, entry) in self.entries.iter() {
            if known().any(|known| known == &**name) {
                continue;
            }
            if &**name == SOURCE {
                let _: Option<&str> = Text::from_node(self, &SOURCE_KEY, &entry.node);
                continue;
            }
            if !self.problems.takes_more() {
                continue;
            }
            let mut known: Vec<&str> = known().collect();
            known.sort_unstable();
            known.dedup();
            let found = match similar(name, &known) {
                Some(similar) => format!("the unknown key `{name}` (did you mean `{similar}`?)"),
                None => match vocabulary::answer(name) {
                    Some(answer) => format!("the unknown key `{name}` ({answer})"),
                    None => format!("the unknown key `{name}`"),
                },
            };
            let expected = if known.is_empty() {
                "nothing here".to_owned()
            } else {
                format!("one of {}", known.join(", "))
            };
            self.problems.push(&entry.key_place, &self.path_of(name), found, expected);
        }
    }

    /// Notes that `node` is not what `key` takes.
    pub(super) fn refuse<T>(&self, key: &Key, node: &Node) -> Option<T> {
        let path = self.path_of(key.name);
        self.problems.push(&node.place, &path, node.describe(), key.expected_value());
        None
    }

    fn number(&self, key: &Key, node: &Node, dimension: Dimension, bound: Bound) -> Option<f64> {
        let parse = match key.kind {
            Kind::Difference(..) => quantity::parse_difference,
            _ => quantity::parse,
        };
        let problem = |found, expected| {
            self.problem_at(&node.place, key.name, found, expected);
            None
        };
        let value = match &node.value {
            Value::Text(text) => match parse(text, dimension) {
                Ok(value) => value,
                Err(error) => {
                    if let Some(point) = with_decimal_point(text) {
                        let found = format!("\"{text}\", a decimal comma");
                        return problem(found, format!("a decimal point: \"{point}\""));
                    }
                    let found = match error {
                        QuantityError::WrongDimension { .. } | QuantityError::NotFinite { .. } => {
                            error.to_string()
                        }
                        _ => format!("\"{text}\" ({error})"),
                    };
                    return problem(found, key.expected_value());
                }
            },
            Value::Number { value, .. } if dimension == Dimension::NONE && value.is_finite() => {
                *value
            }
            Value::Number { typed, value, .. } if value.is_finite() => {
                let found = format!("the number {typed} without a unit");
                if !bound.takes_sign_of(*value) {
                    return problem(found, key.expected_value());
                }
                let unit = usual_unit(dimension);
                let bound = bound.words();
                return problem(
                    found,
                    format!("{dimension}{bound}, typed like \"{typed} {unit}\""),
                );
            }
            _ => return problem(node.describe(), key.expected_value()),
        };
        if bound.holds(value) {
            return Some(value);
        }
        problem(node.describe(), format!("{dimension}{}", bound.broken_by(value)))
    }
}

const SOURCE_KEY: Key = text().named(SOURCE, "");

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
    // A long key cannot be within two letters of a short one.
    let near = known.iter().copied().filter(|name| key.len() <= 4 * (name.len() + 2));
    let near = near.min_by_key(|name| distance(name))?;
    (distance(near) <= 2 && 2 * distance(near) < key.chars().count().max(2)).then_some(near)
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

/// A type that the value of a key is read as.
pub trait FromKey<'a>: Sized {
    /// The value of `key`; `None`, and a problem, if it is wrong.
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self>;

    /// A declared default.
    fn from_default(text: &'static str) -> Option<Self> {
        let _ = text;
        None
    }
}

type Text<'a> = &'a str;

impl<'a> FromKey<'a> for &'a Node {
    fn from_node(_: &TableReader<'a>, _: &'static Key, node: &'a Node) -> Option<Self> {
        Some(node)
    }
}

impl<'a> FromKey<'a> for &'a str {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        if let Value::Text(text) = &node.value { Some(text) } else { table.refuse(key, node) }
    }

    fn from_default(text: &'static str) -> Option<Self> {
        Some(text)
    }
}

impl<'a> FromKey<'a> for String {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        Text::from_node(table, key, node).map(str::to_owned)
    }

    fn from_default(text: &'static str) -> Option<Self> {
        Some(text.to_owned())
    }
}

impl<'a> FromKey<'a> for bool {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        if let Value::Flag(flag) = node.value { Some(flag) } else { table.refuse(key, node) }
    }

    fn from_default(text: &'static str) -> Option<Self> {
        text.parse().ok()
    }
}

impl<'a> FromKey<'a> for f64 {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        match key.kind {
            Kind::Quantity(dimension, bound) | Kind::Difference(dimension, bound) => {
                table.number(key, node, dimension, bound)
            }
            _ => table.refuse(key, node),
        }
    }

    fn from_default(text: &'static str) -> Option<Self> {
        text.parse::<Quantity>().ok().map(|quantity| quantity.value)
    }
}

macro_rules! whole_numbers {
    ($($type:ty),*) => {$(
        impl<'a> FromKey<'a> for $type {
            fn from_node(
                table: &TableReader<'a>,
                key: &'static Key,
                node: &'a Node,
            ) -> Option<Self> {
                match (key.kind, &node.value) {
                    (Kind::Count(least, most), Value::Number { value, whole: true, .. })
                        if (least as f64..=most as f64).contains(value) =>
                    {
                        Self::try_from(*value as u64).ok()
                    }
                    _ => table.refuse(key, node),
                }
            }

            fn from_default(text: &'static str) -> Option<Self> {
                text.parse().ok()
            }
        }
    )*};
}

whole_numbers!(u8, u32, u64, usize);

/// Declares the words of an enum's values.
macro_rules! words {
    ($type:ident { $($word:expr => $value:ident),* $(,)? }) => {
        impl $crate::scene::table::Word for $type {
            const WORDS: &'static [(&'static str, Self)] = &[$(($word, Self::$value)),*];
        }

        impl<'a> $crate::scene::table::FromKey<'a> for $type {
            fn from_node(
                table: &$crate::scene::table::TableReader<'a>,
                key: &'static $crate::scene::table::Key,
                node: &'a $crate::scene::document::Node,
            ) -> Option<Self> {
                node.as_text()
                    .and_then($crate::scene::table::value_of)
                    .or_else(|| table.refuse(key, node))
            }

            fn from_default(text: &'static str) -> Option<Self> {
                $crate::scene::table::value_of(text)
            }
        }
    };
}
pub(super) use words;

/// The value of a word, in any case.
pub(super) fn value_of<T: Word>(text: &str) -> Option<T> {
    T::WORDS.iter().find(|(word, _)| word.eq_ignore_ascii_case(text)).map(|(_, value)| *value)
}

/// A list of texts, each with its place.
pub type Places<'a> = Vec<(&'a str, &'a SourceLocation)>;

impl<'a> FromKey<'a> for Places<'a> {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        let Value::List(items) = &node.value else {
            return table.refuse(&Key { kind: Kind::Texts, ..*key }, node);
        };
        let mut texts = Vec::with_capacity(items.len());
        for item in &**items {
            if let Value::Text(text) = &item.value {
                texts.push((&**text, &item.place));
            } else {
                table.problem_at(&item.place, key.name, item.describe(), "a name".to_owned());
            }
        }
        Some(texts)
    }
}

/// Ascending quantities (unit).
impl<'a> FromKey<'a> for Vec<f64> {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        let Kind::Series(dimension) = key.kind else { return table.refuse(key, node) };
        if table.is_empty_list(key.name) {
            table.problem(key.name, "an empty list", key.expected());
        }
        let mut values = Vec::new();
        for (text, place) in Places::from_node(table, key, node)? {
            match quantity::parse(text, dimension) {
                Ok(value) if value > 0.0 => values.push(value),
                _ => {
                    let expected = format!("{dimension} above zero");
                    table.problem_at(place, key.name, format!("\"{text}\""), expected);
                }
            }
        }
        values.sort_by(f64::total_cmp);
        (!values.is_empty()).then_some(values)
    }
}

/// The two ends of a range (unit).
impl<'a> FromKey<'a> for (f64, f64) {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        match Vec::from_node(table, key, node)?.as_slice() {
            [least, most] => Some((*least, *most)),
            other => {
                let found = format!("{} values", other.len());
                table.problem(key.name, found, "two, the least and the most");
                None
            }
        }
    }
}

impl<'a> FromKey<'a> for TableReader<'a> {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        if !matches!(node.value, Value::Table(_)) && !key.needs.is_empty() && !key.is_required {
            return table.refuse(key, node);
        }
        TableReader::of(node, &table.path_of(key.name), key.below(), table.problems)
    }
}

impl<'a, T: FromTable<'a>> FromKey<'a> for T {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        T::from_table(&TableReader::from_node(table, key, node)?)
    }
}

/// Tables with free names, in the order of the names.
pub type NamedTables<'a> = Vec<(&'a str, TableReader<'a>)>;

impl<'a> FromKey<'a> for NamedTables<'a> {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        let path = table.path_of(key.name);
        let Value::Table(entries) = &node.value else {
            let expected = format!("a table [{path}]");
            table.problem(key.name, node.describe(), expected);
            return None;
        };
        let named = entries.iter().filter_map(|(name, entry)| {
            let path = format!("{path}.{name}");
            let inner = TableReader::of(&entry.node, &path, key.below(), table.problems)?;
            Some((&**name, inner))
        });
        Some(named.collect())
    }
}

impl<'a> FromKey<'a> for Vec<TableReader<'a>> {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        let path = table.path_of(key.name);
        let Value::List(items) = &node.value else {
            table.problem(key.name, node.describe(), format!("a list of tables, [[{path}]]"));
            return None;
        };
        let tables = (1..).zip(&**items).filter_map(|(number, item): (usize, _)| {
            TableReader::of(item, &format!("{path}.{number}"), key.below(), table.problems)
        });
        Some(tables.collect())
    }
}

/// A type that a table is read as.
pub trait FromTable<'a>: Sized {
    /// Reads all keys.
    fn from_table(table: &TableReader<'a>) -> Option<Self>;
}

/// Declares the keys of a table, see the module.
///
/// `struct Name<'a> { key: Type = kind, ... }` makes a struct with a reader, `table`, and an
/// `Option<Type>` for each key. `Keys => Type { key = kind, ... }` reads `Type`, all of whose
/// fields are required keys, perhaps of another name: `field "key" = kind`.
macro_rules! table {
    (@name $key:ident) => { stringify!($key) };
    (@name $key:ident $name:literal) => { $name };
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident<$life:lifetime> {
            $($(#[doc = $help:literal])* $key:ident: $type:ty = $spec:expr,)*
        }
    ) => {
        $(#[$meta])*
        #[allow(dead_code, missing_docs, reason = "some keys are only checked; help is documentation")]
        $vis struct $name<$life> {
            /// The table.
            pub table: $crate::scene::table::TableReader<$life>,
            $($(#[doc = $help])* pub $key: Option<$type>,)*
        }

        impl<$life> $name<$life> {
            /// The declared keys.
            pub const KEYS: &'static [$crate::scene::table::Key] =
                &[$($spec.named(stringify!($key), concat!($($help),*)),)*];

            /// Reads all keys.
            #[allow(unused_mut, unused_variables, reason = "a table may have no keys")]
            pub fn read(table: &$crate::scene::table::TableReader<$life>) -> Self {
                let mut keys = Self::KEYS.iter();
                Self {
                    $($key: keys.next().and_then(|key| table.get(key)),)*
                    table: table.clone(),
                }
            }
        }

        impl<$life> $crate::scene::table::FromTable<$life> for $name<$life> {
            fn from_table(table: &$crate::scene::table::TableReader<$life>) -> Option<Self> {
                Some(Self::read(table))
            }
        }
    };
    (
        $(#[$meta:meta])*
        $vis:vis $name:ident => $type:ident {
            $($(#[doc = $help:literal])* $key:ident $($name_in_file:literal)? = $spec:expr,)*
        }
    ) => {
        $(#[$meta])*
        $vis struct $name;

        impl $name {
            /// The declared keys.
            pub const KEYS: &'static [$crate::scene::table::Key] =
                &[$($spec.required().named(
                    $crate::scene::table::table!(@name $key $($name_in_file)?),
                    concat!($($help),*),
                ),)*];

            /// Reads all keys.
            pub fn read(table: &$crate::scene::table::TableReader<'_>) -> Option<$type> {
                let mut keys = Self::KEYS.iter();
                $(let $key = keys.next().and_then(|key| table.get(key));)*
                Some($type { $($key: $key?),* })
            }
        }

        impl<'a> $crate::scene::table::FromTable<'a> for $type {
            fn from_table(table: &$crate::scene::table::TableReader<'a>) -> Option<Self> {
                $name::read(table)
            }
        }
    };
}
pub(crate) use table;
