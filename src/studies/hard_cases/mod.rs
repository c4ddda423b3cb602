//! The catalogue of hard cases: what breaks integrators of granular chains, and what this one makes of it.
//!
//! Each case holds what the program computes against something from outside: a closed form, a conservation law, or a solution by
//! another family of methods at a tighter tolerance. Nothing but three answers is possible: right within the stated bound,
//! refused with a named cause, or wrong.

mod benches;
mod chaos;
mod collisions;
mod edges;
mod endurance;
mod losses;
mod openings;
mod pulses;
mod tally;

use serde::Serialize;

pub use tally::Tally;

/// What became of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Within its bound.
    Right,
    /// Not computed, and the cause was named.
    Refused,
    /// Neither.
    Wrong,
}

impl Verdict {
    /// As it is printed.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Refused => "refused",
            Self::Wrong => "wrong",
        }
    }
}

/// One case of the catalogue.
#[derive(Debug, Clone, Copy)]
pub struct HardCase {
    /// Its name.
    pub name: &'static str,
    /// What makes it hard.
    pub why: &'static str,
    /// What is demanded, and where that comes from.
    pub bound: &'static str,
    /// Computes it: the figures against their bounds, or the cause why there are none.
    compute: fn(&mut Tally) -> Result<(), String>,
}

/// What a case came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Name of the case.
    pub case: &'static str,
    /// What makes it hard.
    pub why: &'static str,
    /// What is demanded, and where that comes from.
    pub bound: &'static str,
    /// What was reached, next to its bound, in words.
    pub figure: String,
    /// What became of it.
    pub verdict: Verdict,
}

impl HardCase {
    /// Computes the case and judges it.
    #[must_use]
    pub fn judge(&self) -> Finding {
        let mut tally = Tally::default();
        let (verdict, figure) = match (self.compute)(&mut tally) {
            Err(cause) => (Verdict::Refused, cause),
            Ok(()) if tally.holds() => (Verdict::Right, tally.to_string()),
            Ok(()) => (Verdict::Wrong, tally.to_string()),
        };
        Finding { case: self.name, why: self.why, bound: self.bound, figure, verdict }
    }
}

/// All cases, in a fixed order.
#[must_use]
pub fn catalogue() -> Vec<HardCase> {
    [
        pulses::CASES,
        collisions::CASES,
        openings::CASES,
        losses::CASES,
        endurance::CASES,
        edges::CASES,
        chaos::CASES,
    ]
    .concat()
}

/// Judges the whole catalogue; `progress` hears the share of the work done, 0 to 1.
pub fn judge_all(progress: &mut dyn FnMut(f64)) -> Vec<Finding> {
    let cases = catalogue();
    #[allow(clippy::cast_precision_loss, reason = "a dozen cases")]
    let mut report = |done: usize| progress(done as f64 / cases.len() as f64);
    let judge = |(done, case): (usize, &HardCase)| {
        report(done);
        case.judge()
    };
    cases.iter().enumerate().map(judge).collect()
}
