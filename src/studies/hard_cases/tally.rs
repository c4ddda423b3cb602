//! Figures against their bounds.

use std::fmt;

/// A figure that must not exceed its bound.
#[derive(Debug, Clone, PartialEq)]
struct Check {
    what: String,
    found: f64,
    bound: f64,
}

impl Check {
    /// The figure as a share of its bound; infinite for what is no number (1).
    fn share(&self) -> f64 {
        let share = self.found.abs() / self.bound;
        if share.is_nan() { f64::INFINITY } else { share }
    }
}

/// The checks of one case: how many there were, and which came nearest to its bound.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CaseChecks {
    count: usize,
    worst: Option<Check>,
}

impl CaseChecks {
    /// Notes that `found` was reached where its magnitude may be `bound` at most, both in the same
    /// unit.
    pub fn check(&mut self, what: impl Into<String>, found: f64, bound: f64) {
        let check = Check { what: what.into(), found, bound };
        self.count += 1;
        if self.worst.as_ref().is_none_or(|worst| check.share() > worst.share()) {
            self.worst = Some(check);
        }
    }

    /// How many checks there were.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The figure nearest to its bound, and the bound (unit).
    pub fn tightest(&self) -> Option<(f64, f64)> {
        self.worst.as_ref().map(|worst| (worst.found.abs(), worst.bound))
    }

    /// Whether there were checks, and every one held.
    pub fn check_bound(&self) -> bool {
        self.worst.as_ref().is_some_and(|worst| worst.share() <= 1.0)
    }
}

impl fmt::Display for CaseChecks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(Check { what, found, bound }) = &self.worst else {
            return f.write_str("nothing was computed");
        };
        write!(f, "{what}: {:.1e} of {bound:.1e}", found.abs())?;
        if self.count > 1 {
            write!(f, ", the tightest of {} checks", self.count)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_or_not_there_is_not_right() {
        let mut tally = CaseChecks::default();
        assert!(!tally.check_bound());
        tally.check("a", 0.5, 1.0);
        assert!(tally.check_bound());
        tally.check("b", -0.9, 1.0);
        assert_eq!(tally.to_string(), "b: 9.0e-1 of 1.0e0, the tightest of 2 checks");
        tally.check("c", f64::NAN, 1.0);
        assert!(!tally.check_bound());
    }
}
