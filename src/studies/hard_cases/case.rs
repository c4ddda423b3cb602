//! A case of the catalogue, and what it came to.

use serde::Serialize;

use super::tally::CaseChecks;

/// Result of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CaseVerdict {
    /// Within its bound.
    Right,
    /// Not computed, and the cause was named.
    Refused,
    /// Neither.
    Wrong,
}

impl CaseVerdict {
    /// As it is printed.
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
    /// The difficulty.
    pub why: &'static str,
    /// The bound, and its source.
    pub bound: &'static str,
    /// Computes it: the figures against their bounds, or why they could not be computed.
    pub(super) compute: fn(&mut CaseChecks) -> Result<(), String>,
}

/// Result of a case, with its text.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CaseResult {
    /// Name of the case.
    pub case: &'static str,
    /// The difficulty.
    pub why: &'static str,
    /// The bound, and its source.
    pub bound: &'static str,
    /// The tightest figure next to its bound, as text; the cause where the case was refused.
    pub figure: String,
    /// The tightest figure; none where the case was refused (unit).
    pub found: Option<f64>,
    /// Its bound (unit).
    pub limit: Option<f64>,
    /// Number of figures with bounds.
    pub checks: usize,
    /// The result.
    pub verdict: CaseVerdict,
}

impl HardCase {
    /// Computes the case and judges it.
    pub fn run(&self) -> CaseResult {
        let mut tally = CaseChecks::default();
        let (verdict, figure) = match (self.compute)(&mut tally) {
            Err(cause) => (CaseVerdict::Refused, cause),
            Ok(()) if tally.check_bound() => (CaseVerdict::Right, tally.to_string()),
            Ok(()) => (CaseVerdict::Wrong, tally.to_string()),
        };
        let (found, limit) = tally.tightest().filter(|_| verdict != CaseVerdict::Refused).unzip();
        let found = found.filter(|figure: &f64| figure.is_finite());
        let (case, checks) = (self.name, tally.count());
        CaseResult { case, why: self.why, bound: self.bound, figure, found, limit, checks, verdict }
    }
}
