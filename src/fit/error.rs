//! Why there is no fit.

use super::options::MAX_DURATIONS;
use crate::analysis::least_squares::LeastSquaresError;
use crate::measurement::compare::mapping::MappingError;
use crate::quantity::engineering;
use crate::scene::SceneError;

/// Why there is no fit.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// No channel belongs to the scene.
    #[error(transparent)]
    Mapping(#[from] MappingError),
    /// Channels that were not taken together.
    #[error(
        "{channel}: found other sample times than in the first channel, expected records of one trigger"
    )]
    Times {
        /// The channel.
        channel: String,
    },
    /// Nothing to fit.
    #[error("{channel}: found no sample to fit, expected some")]
    NoSamples {
        /// The channel.
        channel: String,
    },
    /// Records of another time scale than the scene's.
    #[error("found samples {} apart for a scene of {}, expected 16 to 200000 of them in its duration", engineering(*interval, "s", 3), engineering(*duration, "s", 3))]
    TimeScale {
        /// From one sample to the next (s).
        interval: f64,
        /// The scene's duration (s).
        duration: f64,
    },
    /// Records that go on long after the scene has ended.
    #[error("found records of {}, expected at most {MAX_DURATIONS} durations of the scene, {}: --to leaves the rest out", engineering(*length, "s", 3), engineering(*duration, "s", 3))]
    TooLong {
        /// Length of the records (s).
        length: f64,
        /// The scene's duration (s).
        duration: f64,
    },
    /// A number to free that starts at zero.
    #[error("found {path} to start at zero, expected another start: --free \"{path}=VALUE\"")]
    Zero {
        /// The number's path.
        path: String,
    },
    /// A number that is freed twice.
    #[error("found {path} twice among the numbers to free, expected it once")]
    Twice {
        /// The number's path.
        path: String,
    },
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// No minimum from any start.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
    /// Traces do not tell a parameter.
    #[error(
        "these traces do not determine {parameter}{with}: free less, or take records of this scene"
    )]
    Undetermined {
        /// The parameter.
        parameter: String,
        /// The parameters that it depends on.
        with: String,
    },
}

impl FitError {
    /// Whether measurement and scene could be fitted and the answer is that nothing is determined.
    pub fn is_undetermined(&self) -> bool {
        use LeastSquaresError::NotConverged;
        matches!(self, Self::Undetermined { .. } | Self::LeastSquares(NotConverged { .. }))
    }
}
