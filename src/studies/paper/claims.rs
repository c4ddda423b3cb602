//! The paper's statements and numbers, read from `recordings/herbold-2009-claims.toml`.

use crate::data;
use crate::quantity::{Dimension, parse_any};
use crate::scene::document::Node;
use crate::scene::problem::Problem;
use crate::scene::reader::{Bound, Problems, TableReader};

const FILE: &str = "herbold-2009-claims.toml";
/// Figures that the paper has.
const LAST_FIGURE: u64 = 13;

/// The expected value of a statement.
#[derive(Debug, Clone, PartialEq)]
pub enum Expected {
    /// A number as printed.
    Printed {
        /// It, in the statement's unit (unit).
        value: f64,
        /// How far off a number that agrees may be: half of the last digit that counts, all of it
        /// for an "about" (unit).
        allowed: f64,
    },
    /// At least this much (unit).
    AtLeast(f64),
    /// At most this much (unit).
    AtMost(f64),
}

/// A statement of the paper that a calculation can answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// Its name.
    pub item: String,
    /// Where it stands.
    pub place: String,
    /// The figure it belongs to, if any.
    pub figure: Option<u8>,
    /// Its text.
    pub says: String,
    /// Its expected value.
    pub expected: Expected,
    /// Its unit, `kHz`; empty for a plain number.
    pub unit: String,
    /// How many SI units that is (unit).
    pub scale: f64,
    /// Why a statement without a number is put into this one, or why fewer digits count than are
    /// printed.
    pub because: String,
    /// Whether it is the paper's own measurement, which no calculation has to reproduce.
    pub measured: bool,
}

/// A contradiction in the paper.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Slip {
    /// Where.
    pub place: String,
    /// What.
    pub says: String,
}

/// All statements and misprints.
///
/// # Errors
/// Every problem of the file, which would be this program's own mistake.
pub fn claims() -> Result<(Vec<Claim>, Vec<Slip>), Vec<Problem>> {
    let bytes = data::recording(FILE).unwrap_or_default();
    let root = Node::parse(FILE, &String::from_utf8_lossy(bytes))?;
    let problems = Problems::default();
    let mut read = (Vec::new(), Vec::new());
    if let Some(root) = TableReader::of(&root, "", &problems) {
        let _ = root.node("provenance");
        read.0.extend(root.list("claim").into_iter().filter_map(claim));
        read.1.extend(root.list("slip").into_iter().filter_map(slip));
        root.finish();
    }
    let problems = problems.into_sorted();
    if problems.is_empty() { Ok(read) } else { Err(problems) }
}

fn text(row: &TableReader<'_>, key: &'static str) -> Option<String> {
    Some(row.required_text(key, "words")?.to_owned())
}

fn slip(row: TableReader<'_>) -> Option<Slip> {
    let slip = Slip { place: text(&row, "place")?, says: text(&row, "says")? };
    row.finish();
    Some(slip)
}

fn claim(row: TableReader<'_>) -> Option<Claim> {
    let (item, place, says) = (text(&row, "item")?, text(&row, "place")?, text(&row, "says")?);
    let figure = row.count("figure", 1, LAST_FIGURE).and_then(|number| u8::try_from(number).ok());
    let because = row.text("because").unwrap_or_default().to_owned();
    let at_least = row.quantity("at_least", Dimension::NONE, Bound::Positive);
    let at_most = row.quantity("at_most", Dimension::NONE, Bound::Positive);
    let about = row.flag("about").unwrap_or(false);
    let measured = row.flag("measured").unwrap_or(false);
    let counts_to = row.text("counts_to").map(Typed::of);
    let printed = row.text("printed").map(Typed::of);
    let unit = printed.as_ref().map_or("", |typed| typed.unit).to_owned();
    let expected = match (printed, at_least, at_most) {
        (Some(typed), None, None) => {
            let last = counts_to.map_or(typed.last_digit, |counts| counts.value);
            let share = if about { 1.0 } else { 0.5 };
            Expected::Printed { value: typed.value, allowed: share * last }
        }
        (None, Some(bound), None) => Expected::AtLeast(bound),
        (None, None, Some(bound)) => Expected::AtMost(bound),
        _ => {
            row.problem("printed", "not one of them", "one of printed, at_least, at_most");
            return None;
        }
    };
    let Ok((scale, _)) = parse_any(format!("1 {unit}").trim_end()) else {
        row.problem("printed", format!("the unit {unit}"), "a unit");
        return None;
    };
    row.finish();
    Some(Claim { item, place, figure, says, expected, unit, scale, because, measured })
}

/// A number with a unit, as typed.
pub(super) struct Typed<'a> {
    /// The number (unit).
    pub value: f64,
    /// Value of one unit of its last digit (unit).
    pub last_digit: f64,
    /// Its unit.
    pub unit: &'a str,
}

impl<'a> Typed<'a> {
    /// Takes `text` apart; what is no number becomes one that agrees with nothing.
    pub(super) fn of(text: &'a str) -> Self {
        let (number, unit) = text.split_once(' ').unwrap_or((text, ""));
        let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let last_digit = (0..decimals).fold(1.0, |digit, _| digit / 10.0);
        Self { value: number.parse().unwrap_or(f64::NAN), last_digit, unit }
    }
}
