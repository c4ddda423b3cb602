//! Why bodies cannot be put together to a chain.

use crate::quantity::engineering;

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
        "found no static state: the contact above {body} would have to bear {}, expected a force that presses",
        engineering(*force, "N", 4)
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
        "found no static state: {} remain at the bottom, expected a wall there or balanced forces",
        engineering(*rest, "N", 4)
    )]
    Unbalanced {
        /// What is left (N).
        rest: f64,
    },
    /// The particle stands where the magnet's table ends.
    #[error(
        "found the particle at rest {} from the magnet's face, expected a distance within the magnet's table",
        engineering(*distance, "m", 4)
    )]
    MagnetBeyondTable {
        /// Distance (m).
        distance: f64,
    },
    /// Nothing says how far the particle sinks.
    #[error(
        "found a magnet's distance from an unloaded chain without a wall at the bottom, expected a wall there, or the distance at rest"
    )]
    MagnetWithoutWall,
    /// Wherever the particle sinks to, the magnet pulls harder than the chain, or not at all.
    #[error(
        "found no static state: a magnet {} from the unloaded particle pulls it in or does not attract it, expected another distance",
        engineering(*distance, "m", 4)
    )]
    MagnetSnaps {
        /// Distance before anything presses (m).
        distance: f64,
    },
    /// A static state from which the smallest push leads away.
    #[error(
        "found a static state that does not last: the magnet's force grows by {} as the particle sinks, expected less than the chain's {}",
        engineering(*growth, "N/m", 4),
        engineering(*stiffness, "N/m", 4)
    )]
    MagnetUnstable {
        /// Growth of the magnet's force (N/m).
        growth: f64,
        /// Stiffness of all contacts below the particle (N/m).
        stiffness: f64,
    },
    /// The magnet pulls nowhere as hard as is wanted.
    #[error(
        "found {}, expected a force that the magnet reaches somewhere",
        engineering(*force, "N", 4)
    )]
    MagnetTooWeak {
        /// Force (N).
        force: f64,
    },
}

impl ChainError {
    /// Whether it is the magnet that stands wrong.
    pub fn is_of_magnet(&self) -> bool {
        matches!(
            self,
            Self::MagnetBeyondTable { .. }
                | Self::MagnetWithoutWall
                | Self::MagnetSnaps { .. }
                | Self::MagnetUnstable { .. }
                | Self::MagnetTooWeak { .. }
        )
    }
}
