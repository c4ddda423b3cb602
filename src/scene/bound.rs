//! What a number must be beyond having the right unit.

/// What a number must be beyond having the right unit.
#[derive(Debug, Clone, Copy)]
pub enum Bound {
    /// Any finite number.
    Any,
    /// Above zero.
    Positive,
    /// Zero or above.
    NotNegative,
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

impl Bound {
    /// Whether `value` keeps to it.
    pub(super) fn holds(self, value: f64) -> bool {
        match self {
            Self::Any => true,
            Self::Positive => value > 0.0,
            Self::NotNegative => value >= 0.0,
            Self::Between(low, high) => low < value && value < high,
            Self::Within(low, high) => (low..=high).contains(&value),
        }
    }

    /// The bound in words, to stand behind a dimension.
    pub(super) fn words(self) -> String {
        match self {
            Self::Any => String::new(),
            Self::Positive => " above zero".to_owned(),
            Self::NotNegative => " of zero or more".to_owned(),
            Self::Between(low, high) => format!(" above {low} and below {high}"),
            // A long row of zeros is hard to count.
            Self::Within(low, high) if low > 0.0 && low < 1e-4 => {
                format!(" from {low:e} to {high}")
            }
            Self::Within(low, high) => format!(" from {low} to {high}"),
        }
    }
}
