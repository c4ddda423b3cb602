//! Why two recordings cannot be compared.

use super::mapping::MappingError;
use crate::analysis::comparison::MIN_COMMON_SAMPLES;
use crate::quantity::engineering;

/// Why two recordings cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// No channel has a partner.
    #[error(transparent)]
    Mapping(#[from] MappingError),
    /// Records of different times.
    #[error(
        "{channel}: found fewer than {MIN_COMMON_SAMPLES} samples in common after a shift of {}, expected records of the same time",
        engineering(*shift_s, "s", 3)
    )]
    Apart {
        /// The measured channel.
        channel: String,
        /// The shift (s).
        shift_s: f64,
    },
    /// Units that no sensor's sensitivity turns into each other.
    #[error(
        "{channel} is measured in {unit}, {against} of the simulation in {other}: found no sensor's sensitivity that turns one into the other, expected one unit: leave it out with --channel, or compare with another channel (--map)"
    )]
    Units {
        /// The measured channel.
        channel: String,
        /// Its unit.
        unit: String,
        /// The simulated channel.
        against: String,
        /// Its unit.
        other: String,
    },
    /// A record without a level or without a change.
    #[error(
        "{channel}: found a simulated trace that never changes, expected a signal to compare with"
    )]
    Flat {
        /// The measured channel.
        channel: String,
    },
}
