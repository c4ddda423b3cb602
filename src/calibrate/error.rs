//! Why there is no calibration.

use super::record::Exclusion;

/// Why there is no calibration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// Too little is left.
    #[error("found {used} usable impacts of {all}, expected at least 2:{}", listed(.reasons))]
    TooFew {
        /// Impacts that are left.
        used: usize,
        /// Impacts in the plan.
        all: usize,
        /// Why each of the others is not.
        reasons: Vec<(usize, Exclusion)>,
    },
    /// The time constant is not determined.
    #[error(
        "found no time constant: none is given, and no record goes on long enough behind its contact to show one"
    )]
    NoTimeConstant,
    /// An input whose uncertainty exceeds its value.
    #[error(
        "{input}: found {value:e} {unit} with a standard uncertainty of {u:e} {unit}, expected one below the value: nothing is known of it"
    )]
    UnknownInput {
        /// The input's name.
        input: String,
        /// Its estimate (unit).
        value: f64,
        /// Its standard uncertainty (unit).
        u: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A result that is not finite.
    #[error(
        "found a result that is not finite ({quantity}), expected a number: check masses, heights, speeds, their units and their uncertainties"
    )]
    NotFinite {
        /// Which result.
        quantity: String,
    },
}

fn listed(reasons: &[(usize, Exclusion)]) -> String {
    let line = |(index, why): &(usize, Exclusion)| format!("\n  impact {}: {why}", index + 1);
    reasons.iter().map(line).collect::<Vec<_>>().concat()
}
