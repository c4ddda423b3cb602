//! Herbold et al. (2009), recomputed: every figure and number of the paper that a calculation can
//! give, compared with what is printed.
//!
//! The paper's statements are data, `recordings/herbold-2009-claims.toml` and
//! `herbold-2009-tables.toml`. Each statement gets one or more candidates from the simulations, by
//! conventions that the paper leaves open, and [`verdict`] holds them against the digits as
//! printed. Nothing is fitted but the one dashpot of [`tables`], and no verdict uses it but those
//! on the paper's measured columns.

pub mod claims;
mod dispersion;
mod error;
mod figure;
mod record;
mod spheres;
mod strikers;
pub mod tables;
pub mod verdict;
mod viscosity;

pub use claims::{Claim, Slip};
pub use error::PaperError;
pub use figure::{Arrangement, Figure, FigureRun, ForceLocation, ForceSignal, Viscous};
pub use verdict::{ClaimFinding, ClaimVerdict, PrintedValue};

use figure::IntermediateResults;
use record::record_run;
use tables::SpeedStudy;
use verdict::judge;

/// Figures that can be computed; 1 and 2 are drawings of the bench.
pub const FIGURES: std::ops::RangeInclusive<u8> = 3..=13;

/// The paper, computed.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperStudy {
    /// Results of all statements, in the paper's order.
    pub findings: Vec<ClaimFinding>,
    /// Misprints.
    pub slips: Vec<Slip>,
    /// The figures.
    pub figures: Vec<Figure>,
    /// Tables 1 and 2 with the best single dashpot, unless one figure alone was asked for.
    pub tables: Option<SpeedStudy>,
    /// Effect of viscosity on the incoming shock of Fig. 10.
    pub viscosity: Vec<Viscous>,
}

/// Computes the paper, or one `figure` of it; `progress` is called with the share of the work done,
/// 0 to 1.
///
/// # Errors
/// [`PaperError`], which would be this program's own mistake.
pub fn study(figure: Option<u8>, progress: &mut dyn FnMut(f64)) -> Result<PaperStudy, PaperError> {
    let wanted = |number: u8| figure.is_none_or(|figure| figure == number);
    let (claims, slips) = claims::claims().map_err(PaperError::Claims)?;
    let mut found = IntermediateResults::default();
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
    let IntermediateResults { figures, viscosity, .. } = found;
    let tables = tables.filter(|_| figure.is_none());
    Ok(PaperStudy { findings, slips, figures, tables, viscosity })
}
