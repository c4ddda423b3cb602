//! Why the paper could not be computed.

use crate::analysis::spectrum::SpectrumError;
use crate::chain::ChainError;
use crate::experiment::RunError;
use crate::motion::IntegrateError;
use crate::predict::UncertaintyError;
use crate::scene::SceneError;
use crate::scene::adjust::AdjustError;
use crate::scene::problem::Problem;

/// Why the paper could not be computed: all of them this program's own mistakes.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// The statements in `recordings/`.
    #[error("recordings/herbold-2009: {}", .0.first().map_or_else(String::new, ToString::to_string))]
    Claims(Vec<Problem>),
    /// A shipped scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A shipped scene with other numbers.
    #[error(transparent)]
    Adjust(#[from] AdjustError),
    /// A shipped scene's uncertainty.
    #[error(transparent)]
    Uncertainty(#[from] UncertaintyError),
    /// A chain with another dashpot.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// A simulation.
    #[error(transparent)]
    Integrate(#[from] IntegrateError),
    /// A simulation with its recording.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A spectrum.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
    /// Something to be read off that is not there.
    #[error("found no {what} in {scene}, expected one")]
    Nothing {
        /// The scene's name.
        scene: String,
        /// The value sought.
        what: String,
    },
    /// A statement without an answer, or an answer without a statement.
    #[error("found {found} answers to the paper's statement {item}, expected one")]
    Unanswered {
        /// The statement.
        item: String,
        /// How many.
        found: usize,
    },
}
