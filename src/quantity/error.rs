//! Why a text is no quantity.

use super::Dimension;

/// Why a text is no quantity of the wanted dimension.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum QuantityError {
    /// The text does not begin with a number.
    #[error("no number at the start of `{text}`")]
    NoNumber {
        /// The text as typed.
        text: String,
    },
    /// The number is infinite or not a number.
    #[error("`{text}` is not a finite number")]
    NotFinite {
        /// The text as typed.
        text: String,
    },
    /// The unit contains a symbol that is not known.
    #[error("unknown unit `{unit}`")]
    UnknownUnit {
        /// The symbol that was not recognised.
        unit: String,
    },
    /// The unit is known, but measures something else.
    #[error("`{text}` is {found}")]
    WrongDimension {
        /// The text as typed.
        text: String,
        /// Dimension of the text's unit.
        found: Dimension,
    },
}
