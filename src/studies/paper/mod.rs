//! Herbold et al. (2009), computed again: every figure and number of the paper that a calculation can give, held against what is printed.
//!
//! What the paper prints is data, `recordings/herbold-2009-claims.toml` and `herbold-2009-tables.toml`. Each statement gets one or more
//! candidates from the simulations, by conventions that the paper leaves open, and [`verdict`] holds them against the digits as printed.
//! Nothing is fitted but the one dashpot of [`tables`], and no verdict uses it but those on the paper's measured columns.

pub mod claims;
mod dispersion;
mod record;
mod spheres;
mod strikers;
pub mod tables;
pub mod verdict;
mod viscosity;

pub use claims::{Claim, Slip};
pub use record::Place;
pub use verdict::{Finding, Printed, Verdict};
pub use viscosity::Viscous;

use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::spectrum::{Spectrum, SpectrumError};
use crate::chain::ChainError;
use crate::experiment::{Integration, Outcome, RunError, run};
use crate::integrate::IntegrateError;
use crate::scene::problem::Problem;
use crate::scene::{Scene, SceneError};
use crate::trace::Trace;
use tables::SpeedStudy;
use verdict::{Answer, judge};

/// Figures that can be computed; 1 and 2 are drawings of the bench.
pub const FIGURES: std::ops::RangeInclusive<u8> = 3..=13;

/// Why the paper could not be computed: all of them this program's own mistakes.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// The statements in `recordings/`.
    #[error("recordings/herbold-2009: {}", .0.first().map_or_else(String::new, ToString::to_string))]
    Claims(Vec<Problem>),
    /// A shipped scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
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
        /// What was looked for.
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

/// A force somewhere, over time and over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Where.
    pub place: Place,
    /// The dynamic force (N).
    pub trace: Trace,
    /// Its spectrum in the paper's convention, over the whole record.
    pub spectrum: Spectrum,
}

/// How the paper arranges a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrangement {
    /// Frequency over wave number.
    Dispersion,
    /// A row for each force, its spectrum beside it.
    Rows,
    /// Forces far from the end above each other, and the spectra of two parts of one of them.
    Far,
    /// The sensors' forces above each other, their spectra beside them.
    Sensors,
}

/// What a figure shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Its number in the paper.
    pub number: u8,
    /// What it is about.
    pub title: String,
    /// How it is arranged.
    pub arrangement: Arrangement,
    /// The linear chain around its sensors: band edges.
    pub chain: DiatomicChain,
    /// The forces.
    pub signals: Vec<Signal>,
    /// Spectra of parts of the record, each with its name.
    pub parts: Vec<(String, Spectrum)>,
    /// What was run, with everything that belongs into a recording; none for the dispersion relation.
    pub run: Option<FigureRun>,
}

/// The run behind a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureRun {
    /// The scene.
    pub scene: Scene,
    /// How it was integrated.
    pub integration: Integration,
    /// Records and truth, the forces as the figure has them among it.
    pub outcome: Outcome,
}

/// The paper, computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// What became of each statement, in the paper's order.
    pub findings: Vec<Finding>,
    /// Misprints.
    pub slips: Vec<Slip>,
    /// The figures.
    pub figures: Vec<Figure>,
    /// Tables 1 and 2 with the best single dashpot, unless one figure alone was asked for.
    pub tables: Option<SpeedStudy>,
    /// What viscosity does to the incoming shock of Fig. 10.
    pub viscosity: Vec<Viscous>,
}

/// What is found on the way.
#[derive(Default)]
struct Found {
    answers: Vec<Answer>,
    figures: Vec<Figure>,
    viscosity: Vec<Viscous>,
}

/// Computes the paper, or one `figure` of it; `progress` hears the share of the work done, 0 to 1.
///
/// # Errors
/// [`PaperError`], which would be this program's own mistake.
pub fn study(figure: Option<u8>, progress: &mut dyn FnMut(f64)) -> Result<Study, PaperError> {
    let wanted = |number: u8| figure.is_none_or(|figure| figure == number);
    let (claims, slips) = claims::claims().map_err(PaperError::Claims)?;
    let mut found = Found::default();
    if wanted(3) {
        dispersion::figure_3(&claims, &mut found)?;
    }
    spheres::figures(&wanted, &mut found)?;
    progress(0.2);
    let tables = if wanted(10) {
        let study = tables::study(&mut |share| progress(0.2 + 0.6 * share))?;
        tables::answers(&study, &mut found.answers);
        Some(study)
    } else {
        None
    };
    strikers::figures(&wanted, &mut found)?;
    progress(0.9);
    if let Some(tables) = &tables {
        viscosity::answers(tables.dashpot, &mut found)?;
    }
    if figure.is_none() {
        dispersion::bench(&mut found.answers)?;
    }
    progress(1.0);
    let mut all = claims;
    if let Some(study) = &tables {
        all.extend(tables::claims(study));
    }
    let mut findings = Vec::new();
    for claim in all.iter().filter(|c| figure.is_none() || c.figure == figure) {
        let mut answers = found.answers.iter().filter(|answer| answer.item == claim.item);
        match (answers.next(), answers.count()) {
            (Some(answer), 0) => findings.push(judge(claim, answer)),
            (answer, more) => {
                let found = usize::from(answer.is_some()) + more;
                return Err(PaperError::Unanswered { item: claim.item.clone(), found });
            }
        }
    }
    found.figures.sort_by_key(|figure| figure.number);
    let Found { figures, viscosity, .. } = found;
    let tables = tables.filter(|_| figure.is_none());
    Ok(Study { findings, slips, figures, tables, viscosity })
}

/// Runs `scene` as `run` does, and puts the forces of `signals` into its truth, as long as the figure shows them.
fn record_run(scene: &Scene, signals: &[Signal]) -> Result<FigureRun, PaperError> {
    let integration = Integration::Accuracy(record::accuracy(scene));
    let mut outcome = run(scene, integration, 1, &mut |_| ())?;
    let truth = &mut outcome.shot.truth;
    truth.retain(|trace| !trace.name.starts_with("sensor/"));
    for signal in signals.iter().rev() {
        let name = format!("sensor/{}: dynamic force {}", signal.place.key(), signal.trace.name);
        truth.insert(0, Trace { name, ..signal.trace.clone() });
    }
    Ok(FigureRun { scene: scene.clone(), integration, outcome })
}
