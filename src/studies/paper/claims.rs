//! The paper's statements and numbers, read from `recordings/herbold-2009-claims.toml`.

use crate::data;
use crate::quantity::{Dimension, Quantity};
use crate::scene::document::Node;
use crate::scene::problem::Problem;
use crate::scene::table::{
    Problems, TableReader, any, count, flag, list_of, positive, table, text,
};

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
    let read = TableReader::of(&root, "", &[FileKeys::KEYS], &problems).map(|table| {
        let keys = FileKeys::read(&table);
        let (claims, slips) = (keys.claim.unwrap_or_default(), keys.slip.unwrap_or_default());
        let claims = claims.iter().filter_map(|row| claim(ClaimKeys::read(row)));
        (claims.collect(), slips.iter().filter_map(SlipKeys::read).collect())
    });
    problems.finish(read)
}

table! {
    /// The file.
    struct FileKeys<'a> {
        provenance: &'a Node = any(&[]),
        claim: Vec<TableReader<'a>> = list_of(&[ClaimKeys::KEYS]),
        slip: Vec<TableReader<'a>> = list_of(&[SlipKeys::KEYS]),
    }
}

table! {
    /// One of `[[slip]]`.
    SlipKeys => Slip {
        place = text().needs("words"),
        says = text().needs("words"),
    }
}

table! {
    /// One of `[[claim]]`.
    struct ClaimKeys<'a> {
        item: String = text().required().needs("words"),
        place: String = text().required().needs("words"),
        says: String = text().required().needs("words"),
        figure: u8 = count(1, LAST_FIGURE),
        because: String = text().or(""),
        at_least: f64 = positive(Dimension::NONE),
        at_most: f64 = positive(Dimension::NONE),
        about: bool = flag().or("false"),
        measured: bool = flag().or("false"),
        counts_to: &'a str = text(),
        printed: &'a str = text(),
    }
}

fn claim(keys: ClaimKeys<'_>) -> Option<Claim> {
    let row = &keys.table;
    let counts_to = keys.counts_to.map(Typed::of);
    let printed = keys.printed.map(Typed::of);
    let unit = printed.as_ref().map_or("", |typed| typed.unit).to_owned();
    let expected = match (printed, keys.at_least, keys.at_most) {
        (Some(typed), None, None) => {
            let last = counts_to.map_or(typed.last_digit, |counts| counts.value);
            let share = if keys.about? { 1.0 } else { 0.5 };
            Expected::Printed { value: typed.value, allowed: share * last }
        }
        (None, Some(bound), None) => Expected::AtLeast(bound),
        (None, None, Some(bound)) => Expected::AtMost(bound),
        _ => {
            row.problem("printed", "not one of them", "one of printed, at_least, at_most");
            return None;
        }
    };
    let Ok(Quantity { value: scale, .. }) = format!("1 {unit}").parse() else {
        row.problem("printed", format!("the unit {unit}"), "a unit");
        return None;
    };
    Some(Claim {
        item: keys.item?,
        place: keys.place?,
        figure: keys.figure,
        says: keys.says?,
        expected,
        unit,
        scale,
        because: keys.because?,
        measured: keys.measured?,
    })
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
