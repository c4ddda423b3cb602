//! Errors of building a chain: the scene loader's, and those of whatever computes the static
//! equilibrium.

use crate::quantity::engineering;

/// Errors of building a chain from bodies, and of finding its static equilibrium.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChainError {
    /// No bodies.
    #[error("a chain without particles: name at least one")]
    Empty,
    /// Two flat faces meet.
    #[error(
        "two flat faces touch, {upper} on {lower}: a Hertz contact needs at least one curved face"
    )]
    FlatOnFlat {
        /// The body above.
        upper: String,
        /// The body below.
        lower: String,
    },
    /// Cylinders that lie parallel, or one on a flat face.
    #[error(
        "{upper} and {lower} touch along a line: a Hertz contact needs an angle between lying cylinders, or a sphere"
    )]
    Line {
        /// The body above.
        upper: String,
        /// The body below.
        lower: String,
    },
    /// The striker would have to pass through a wall.
    #[error("both a striker and a wall are at the top: leave one out")]
    StrikerBehindWall,
    /// The static force of a contact is tensile.
    #[error(
        "no static equilibrium: the contact above {body} would need a tensile force of {}, but contacts only push",
        engineering(force.abs(), "N", 4)
    )]
    Pulling {
        /// The body below the contact.
        body: String,
        /// Static force (N).
        force: f64,
    },
    /// A contact without preload has zero stiffness and cannot be linearised.
    #[error(
        "the contact above {body} carries no static force: effects.linearised_contacts needs a preload on every contact"
    )]
    NothingToLinearise {
        /// The body below the contact.
        body: String,
    },
    /// A linearised contact never opens; a loss in it would act in tension, too, which the loss
    /// models do not describe.
    #[error(
        "the contact above {body} is linearised and has a loss: switch off effects.linearised_contacts or the loss"
    )]
    LinearisedWithLoss {
        /// The body below the contact.
        body: String,
    },
    /// What is made for Hertz's law meets a contact of another.
    #[error(
        "{what} is made for Hertz's law, but between {upper} and {lower} effects.contact_law holds: switch one of them off"
    )]
    OnlyForHertz {
        /// The body above the contact.
        upper: String,
        /// The body below it.
        lower: String,
        /// What is made for Hertz's law.
        what: &'static str,
    },
    /// A drive, a rod or a plate at an end without a wall.
    #[error(
        "a drive, rod or plate at the {end} needs a wall there whose material touches the chain"
    )]
    SupportWithoutWall {
        /// `top` or `bottom`.
        end: &'static str,
    },
    /// Loads do not balance and no wall takes the rest.
    #[error(
        "no static equilibrium: a net force of {} is left at the bottom; put a wall there or balance the forces",
        engineering(*net_force, "N", 4)
    )]
    Unbalanced {
        /// Net force (N).
        net_force: f64,
    },
    /// The particle is outside the magnet's force table.
    #[error(
        "the particle at rest is {} from the magnet's face, outside the magnet's force table: choose another distance",
        engineering(*distance, "m", 4)
    )]
    MagnetBeyondTable {
        /// Distance (m).
        distance: f64,
    },
    /// The displacement of the particle under load is unknown.
    #[error(
        "the magnet's distance is given before loading, but without a wall at the bottom the displacement under load is unknown: add a wall, or give the distance at rest"
    )]
    MagnetWithoutWall,
    /// At every displacement the magnet's attraction exceeds the chain's elastic force, or there is
    /// no attraction.
    #[error(
        "no static equilibrium: a magnet {} from the particle (before loading) pulls it in, or does not attract it; choose another distance",
        engineering(*distance, "m", 4)
    )]
    MagnetSnaps {
        /// Distance before anything presses (m).
        distance: f64,
    },
    /// An unstable equilibrium.
    #[error(
        "unstable equilibrium: the gradient of the magnet's force, {}, exceeds the stiffness of the chain, {}; increase the distance",
        engineering(*growth, "N/m", 4),
        engineering(*stiffness, "N/m", 4)
    )]
    MagnetUnstable {
        /// Gradient of the magnet's force (N/m).
        growth: f64,
        /// Stiffness of all contacts below the particle (N/m).
        stiffness: f64,
    },
    /// The magnet reaches a force at no distance.
    #[error(
        "a magnet force of {} is asked for; this magnet does not reach it at any distance",
        engineering(*force, "N", 4)
    )]
    MagnetTooWeak {
        /// Force (N).
        force: f64,
    },
}

impl ChainError {
    /// Whether the error is about the magnet's distance or strength.
    pub fn concerns_magnet(&self) -> bool {
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
