//! Errors of fitting a scene to traces.

use super::options::MAX_DURATIONS;
use crate::analysis::least_squares::LeastSquaresError;
use crate::measurement::compare::mapping::MappingError;
use crate::quantity::engineering;
use crate::scene::SceneError;
use crate::scene::random_inputs::RandomInputsError;

/// Errors of fitting a scene's numbers to measured traces.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// Errors of assigning channels to sensors.
    #[error(transparent)]
    Mapping(#[from] MappingError),
    /// Channels with other sample times.
    #[error(
        "{channel}: its sample times differ from the first channel's: use channels of one shot"
    )]
    Times {
        /// The channel.
        channel: String,
    },
    /// No channel in volts, the unit that a scene's scope records.
    #[error(
        "{channel}: the record is in {unit}: a scene's scope records volts, and its parameters are fitted to them"
    )]
    NotVolts {
        /// The channel.
        channel: String,
        /// The unit of its values.
        unit: String,
    },
    /// No samples in the fitted time range.
    #[error("{channel}: no sample lies in the fitted time range: check --from and --to")]
    NoSamples {
        /// The channel.
        channel: String,
    },
    /// Records of another time scale than the scene's.
    #[error("a sample interval of {} does not fit the scene's duration of {}, which must hold 16 to 200000 samples", engineering(*interval, "s", 3), engineering(*duration, "s", 3))]
    TimeScale {
        /// From one sample to the next (s).
        interval: f64,
        /// The scene's duration (s).
        duration: f64,
    },
    /// Records that go on long after the scene has ended.
    #[error("the record is {} long, more than {MAX_DURATIONS} times the scene's duration of {}: shorten it with --to", engineering(*length, "s", 3), engineering(*duration, "s", 3))]
    TooLong {
        /// Length of the records (s).
        length: f64,
        /// The scene's duration (s).
        duration: f64,
    },
    /// A parameter that starts at zero: it is varied by shares of its start.
    #[error(
        "{path} is zero in the scene, and is varied by shares of its start: give one with --free \"{path}=VALUE\""
    )]
    Zero {
        /// The number's path.
        path: String,
    },
    /// A number that is freed twice.
    #[error("{path} is freed twice: name it once")]
    Twice {
        /// The number's path.
        path: String,
    },
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The scene's `[uncertainty]` is wrong.
    #[error(transparent)]
    Inputs(#[from] RandomInputsError),
    /// No minimum from any start.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
    /// The traces do not determine a parameter.
    #[error(
        "these traces do not determine {parameter}{with}: free fewer parameters, or use a record of this scene{why}"
    )]
    Undetermined {
        /// The parameter.
        parameter: String,
        /// The parameters that it depends on.
        with: String,
        /// What is known of the reason; may be empty.
        why: &'static str,
    },
}

impl FitError {
    /// Whether the fit ran but gave no result: not converged, or a parameter undetermined.
    pub fn has_no_result(&self) -> bool {
        use LeastSquaresError::NotConverged;
        matches!(self, Self::Undetermined { .. } | Self::LeastSquares(NotConverged { .. }))
    }
}
