//! A statement of the paper against what comes out here.
//!
//! A printed number agrees with a computed one that rounds to it: they differ by no more than half
//! of the last digit that counts, or all of it where the paper says "about". The first candidate
//! that agrees decides; one that the paper's own words describe is plain, any other is a convention
//! and named.

use std::fmt::Write as _;

use serde::{Serialize, Serializer};

use super::claims::{Claim, Expected};

/// Rounding of the comparison itself, in units of the printed number (1).
const ROUNDING: f64 = 1e-9;

/// Result for a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
pub enum ClaimVerdict {
    /// It comes out as the paper words it.
    #[serde(rename = "agrees")]
    Agrees,
    /// It comes out by a convention that the paper does not name.
    #[serde(rename = "agrees under convention")]
    AgreesUnder,
    /// It does not come out.
    #[serde(rename = "does not hold")]
    DoesNotHold,
}

impl ClaimVerdict {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::AgreesUnder => "agrees under convention",
            Self::DoesNotHold => "does not hold",
        }
    }
}

/// The value that the paper prints.
#[derive(Debug, Clone, PartialEq)]
pub enum PrintedValue {
    /// A number, in the unit of the finding (unit).
    Number(f64),
    /// Words, put into a bound.
    Words(String),
}

impl Serialize for PrintedValue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(number) => serializer.serialize_f64(*number),
            Self::Words(words) => serializer.serialize_str(words),
        }
    }
}

/// A statement with its verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClaimFinding {
    /// Name of the statement.
    pub item: String,
    /// Where the paper makes it.
    pub place: String,
    /// Its text.
    pub says: String,
    /// The printed value.
    pub paper: PrintedValue,
    /// The computed value (unit).
    pub here: f64,
    /// Computed over printed, less one; none for words (1).
    pub difference: Option<f64>,
    /// Unit of both.
    pub unit: String,
    /// By which convention.
    pub convention: String,
    /// The verdict.
    pub verdict: ClaimVerdict,
    /// Why.
    pub reason: String,
    /// Whether it is the paper's own measurement, listed apart from its calculations.
    pub measured: bool,
    /// The figure it belongs to.
    #[serde(skip)]
    pub figure: Option<u8>,
}

/// A reading of the statement.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Interpretation {
    /// In words.
    pub convention: String,
    /// The computed value, in SI units (unit).
    pub value: f64,
    /// Whether the paper's own words describe it.
    pub plain: bool,
}

/// Computed values for a statement.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ClaimResult {
    /// Name of the statement.
    pub item: String,
    /// Readings of the statement, the most likely first.
    pub candidates: Vec<Interpretation>,
    /// Remarks.
    pub note: String,
    /// Least distance of two lines that the record separates, if a line is read: `1/T` (Hz).
    pub resolution: f64,
    /// Whether there is what the statement speaks of.
    pub is_there: bool,
}

impl ClaimResult {
    /// An answer without candidates yet.
    pub(super) fn to(item: &str) -> Self {
        let (candidates, note) = (Vec::new(), String::new());
        Self { item: item.to_owned(), candidates, note, resolution: 0.0, is_there: true }
    }

    /// The value that the statement's text describes.
    pub(super) fn plain(self, convention: &str, value: f64) -> Self {
        self.with(convention, value, true)
    }

    /// The value under a convention that the paper does not name.
    pub(super) fn or(self, convention: &str, value: f64) -> Self {
        self.with(convention, value, false)
    }

    fn with(mut self, convention: &str, value: f64, plain: bool) -> Self {
        self.candidates.push(Interpretation { convention: convention.to_owned(), value, plain });
        self
    }

    /// The value is a line in the spectrum of a record of `duration` (s), which tells lines apart
    /// by `1/T`.
    pub(super) fn line_of(self, duration: f64) -> Self {
        Self { resolution: 1.0 / duration, ..self }
    }

    /// The statement speaks of something that may not be there.
    pub(super) fn only_if(self, is_there: bool) -> Self {
        Self { is_there, ..self }
    }

    /// Something else to be said.
    pub(super) fn note(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }
}

/// The verdict on `claim` from the answer to it.
pub(super) fn judge(claim: &Claim, answer: &ClaimResult) -> ClaimFinding {
    let here = |candidate: &Interpretation| candidate.value / claim.scale;
    let agrees = |candidate: &&Interpretation| match claim.expected {
        Expected::Printed { value, allowed } => {
            let allowed = allowed.max(answer.resolution / claim.scale);
            (here(candidate) - value).abs() <= allowed + ROUNDING * value.abs()
        }
        Expected::AtLeast(bound) => here(candidate) >= bound,
        Expected::AtMost(bound) => here(candidate) <= bound,
    };
    let found = answer.candidates.iter().find(agrees).filter(|_| answer.is_there);
    let verdict = match found {
        Some(candidate) if candidate.plain => ClaimVerdict::Agrees,
        Some(_) => ClaimVerdict::AgreesUnder,
        None => ClaimVerdict::DoesNotHold,
    };
    let chosen = found.or(answer.candidates.first());
    ClaimFinding {
        item: claim.item.clone(),
        place: claim.place.clone(),
        says: claim.says.clone(),
        paper: match claim.expected {
            Expected::Printed { value, .. } => PrintedValue::Number(value),
            Expected::AtLeast(bound) => PrintedValue::Words(format!("at least {bound}")),
            Expected::AtMost(bound) => PrintedValue::Words(format!("at most {bound}")),
        },
        here: chosen.map_or(f64::NAN, here),
        difference: match claim.expected {
            Expected::Printed { value, .. } if value != 0.0 => {
                chosen.map(|c| here(c) / value - 1.0)
            }
            _ => None,
        },
        measured: claim.measured,
        unit: claim.unit.clone(),
        convention: chosen.map_or_else(String::new, |c| c.convention.clone()),
        verdict,
        reason: reason(claim, answer, chosen),
        figure: claim.figure,
    }
}

/// Reasons for the result: the bound or the digits, the other candidates, and what else is known.
fn reason(claim: &Claim, answer: &ClaimResult, chosen: Option<&Interpretation>) -> String {
    let deviation = |value: f64| match claim.expected {
        Expected::Printed { value: printed, .. } if printed != 0.0 => {
            format!(" ({:+.1} %)", 100.0 * (value / claim.scale / printed - 1.0))
        }
        _ => String::new(),
    };
    let mut text = match claim.expected {
        Expected::Printed { allowed, .. } if answer.resolution > allowed * claim.scale => {
            let apart = summary_text(answer.resolution / claim.scale);
            format!("the spectrum resolves {apart}")
        }
        Expected::Printed { allowed, .. } => {
            format!("digits as printed allow {} either way", summary_text(allowed))
        }
        Expected::AtLeast(_) | Expected::AtMost(_) => String::new(),
    };
    let mut add = |words: &str| {
        if !words.is_empty() {
            let gap = if text.is_empty() { "" } else { "; " };
            let _ = write!(text, "{gap}{words}");
        }
    };
    add(&claim.because);
    if let Some(chosen) = chosen {
        add(deviation(chosen.value).trim().trim_matches(['(', ')']));
    }
    for other in answer.candidates.iter().filter(|other| Some(*other) != chosen) {
        let value = summary_text(other.value / claim.scale);
        add(&format!("{}: {value}{}", other.convention, deviation(other.value)));
    }
    add(&answer.note);
    text
}

/// A number with five significant digits, without zeros behind them.
fn summary_text(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    rounded.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claim(expected: Expected, unit: &str, scale: f64) -> Claim {
        Claim {
            item: "item".to_owned(),
            place: "place".to_owned(),
            figure: None,
            says: "says".to_owned(),
            expected,
            unit: unit.to_owned(),
            scale,
            because: String::new(),
            measured: false,
        }
    }

    /// 171 m/s as printed.
    fn printed() -> Claim {
        claim(Expected::Printed { value: 171.0, allowed: 0.5 }, "m/s", 1.0)
    }

    #[test]
    fn what_rounds_to_the_printed_number_agrees() {
        let verdict =
            |value| judge(&printed(), &ClaimResult::to("item").plain("as worded", value)).verdict;
        assert_eq!([170.5, 170.9, 171.5].map(verdict), [ClaimVerdict::Agrees; 3]);
        assert_eq!([170.499, 171.501, f64::NAN].map(verdict), [ClaimVerdict::DoesNotHold; 3]);
    }

    #[test]
    fn the_first_candidate_that_agrees_decides_and_the_others_are_told() {
        let answer =
            ClaimResult::to("item").plain("peak", 164.5).or("half-rise", 170.9).note("a note");
        let found = judge(&printed(), &answer);
        assert_eq!((found.verdict, found.here), (ClaimVerdict::AgreesUnder, 170.9));
        assert_eq!(found.convention, "half-rise");
        for words in ["peak: 164.5 (-3.8 %)", "-0.1 %", "0.5 either way", "a note"] {
            assert!(found.reason.contains(words), "{words} in {}", found.reason);
        }
        let answer = ClaimResult::to("item").plain("peak", 164.5).or("10 %", 175.4);
        let found = judge(&printed(), &answer);
        assert_eq!((found.verdict, found.here), (ClaimVerdict::DoesNotHold, 164.5));
    }

    #[test]
    fn a_line_may_be_off_by_what_its_record_tells_apart_and_must_be_there() {
        let kilohertz = claim(Expected::Printed { value: 7.7, allowed: 0.05 }, "kHz", 1e3);
        let line = |hertz| ClaimResult::to("item").plain("line", hertz).line_of(2e-3);
        assert_eq!(judge(&kilohertz, &line(7210.0)).verdict, ClaimVerdict::Agrees);
        assert_eq!(judge(&kilohertz, &line(7190.0)).verdict, ClaimVerdict::DoesNotHold);
        let faint = judge(&kilohertz, &line(7700.0).only_if(false));
        assert_eq!((faint.verdict, faint.difference), (ClaimVerdict::DoesNotHold, Some(0.0)));
    }

    #[test]
    fn bounds_and_units() {
        let kilohertz = claim(Expected::Printed { value: 11.0, allowed: 0.5 }, "kHz", 1e3);
        let found = judge(&kilohertz, &ClaimResult::to("item").plain("line", 11213.0));
        assert_eq!((found.verdict, found.here), (ClaimVerdict::Agrees, 11.213));
        let verdict = |expected, value| {
            judge(&claim(expected, "", 1.0), &ClaimResult::to("item").plain("share", value)).verdict
        };
        assert_eq!(verdict(Expected::AtLeast(0.5), 0.4), ClaimVerdict::DoesNotHold);
        assert_eq!(verdict(Expected::AtMost(0.5), 0.4), ClaimVerdict::Agrees);
    }
}
