//! Limits of numbers, in addition to their dimension.

/// Limits of numbers, in addition to their dimension.
#[derive(Debug, Clone, Copy)]
pub enum Bound {
    /// Any finite number.
    Any,
    /// Above zero.
    Positive,
    /// Zero or above.
    NotNegative,
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

/// Fastest that anything moves (m/s).
const MAX_SPEED: f64 = 1e5;

impl Bound {
    /// Of a mass (kg).
    pub const MASS: Self = Self::Bench(1e-18, 1e9);
    /// Of a length (m).
    pub const LENGTH: Self = Self::Bench(1e-9, 1e4);
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
            Self::Between(low, high) => low < value && value < high,
            Self::Bench(low, high) | Self::Within(low, high) => (low..=high).contains(&value),
        }
    }

    /// The bound that `value` breaks, in words to stand behind a dimension.
    pub(super) fn broken_by(self, value: f64) -> String {
        match self {
            Self::Bench(low, high) if value > 0.0 => Self::Within(low, high).words(),
            _ => self.words(),
        }
    }

    /// The bound in words, to stand behind a dimension.
    pub(super) fn words(self) -> String {
        match self {
            Self::Any => String::new(),
            Self::Positive | Self::Bench(..) => " above zero".to_owned(),
            Self::NotNegative => " of zero or more".to_owned(),
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
