//! Why bodies cannot be put together to a chain.

/// Why bodies cannot be put together to a chain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChainError {
    /// No bodies.
    #[error("found a chain without particles, expected at least one")]
    Empty,
    /// Two flat faces meet.
    #[error(
        "found flat on flat between {upper} and {lower}, expected at least one curved face: a Hertz contact has a radius"
    )]
    FlatOnFlat {
        /// The body above.
        upper: String,
        /// The body below.
        lower: String,
    },
    /// The striker would have to pass through a wall.
    #[error("found both a striker and a wall at the top, expected one of them")]
    StrikerBehindWall,
    /// A contact would have to pull.
    #[error(
        "found no static state: the contact above {body} would have to bear {force:e} N, expected a force that presses"
    )]
    Pulling {
        /// The body below the contact.
        body: String,
        /// Static force (N).
        force: f64,
    },
    /// A contact without preload has no tangent.
    #[error(
        "found no static force above {body}, expected one: effects.linearised_contacts needs every contact precompressed"
    )]
    NothingToLinearise {
        /// The body below the contact.
        body: String,
    },
    /// A linearised contact never ends, so a loss in it has no end either.
    #[error(
        "found a loss in the linearised contact above {body}, expected one of the two: a linearised contact never opens"
    )]
    LossWithoutEnd {
        /// The body below the contact.
        body: String,
    },
    /// Loads do not balance and no wall takes the rest.
    #[error(
        "found no static state: {rest:e} N remain at the bottom, expected a wall there or balanced forces"
    )]
    Unbalanced {
        /// What is left (N).
        rest: f64,
    },
}
