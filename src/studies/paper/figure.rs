//! Figures as data: their signals and the runs behind them.

use super::verdict::ClaimResult;
use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::spectrum::Spectrum;
use crate::chain::{Chain, ForceProbe};
use crate::experiment::{Integration, Outcome};
use crate::scene::Scene;
use crate::trace::Trace;

/// A force somewhere, over time and over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceSignal {
    /// Where.
    pub place: ForceLocation,
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

/// Contents of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Its number in the paper.
    pub number: u8,
    /// Its subject.
    pub title: String,
    /// How it is arranged.
    pub arrangement: Arrangement,
    /// The linear chain around its sensors: band edges.
    pub chain: DiatomicChain,
    /// The forces.
    pub signals: Vec<ForceSignal>,
    /// Spectra of parts of the record, each with its name.
    pub parts: Vec<(String, Spectrum)>,
    /// The run behind the figure, with everything for a recording; none for the dispersion
    /// relation.
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

/// Intermediate results.
#[derive(Default)]
pub(super) struct IntermediateResults {
    pub(super) answers: Vec<ClaimResult>,
    pub(super) figures: Vec<Figure>,
    pub(super) viscosity: Vec<Viscous>,
}

/// Place of a force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceLocation {
    /// Inside a particle: the mean of its two contacts.
    Inside(usize),
    /// In the contact below a particle.
    Below(usize),
    /// At the wall.
    Wall,
}

impl ForceLocation {
    /// A short name for files, `p2`.
    pub fn key(self) -> String {
        match self {
            Self::Inside(particle) => format!("p{particle}"),
            Self::Below(particle) => format!("contact{particle}{}", particle + 1),
            Self::Wall => "wall".to_owned(),
        }
    }

    pub(super) fn probe(self, chain: &Chain) -> Option<ForceProbe> {
        match self {
            Self::Inside(particle) => ForceProbe::inside(chain, particle, 0.0),
            Self::Below(particle) => ForceProbe::inside(chain, particle, 0.5),
            Self::Wall => chain.wall_contact().and_then(|j| ForceProbe::contact(chain, j)),
        }
    }

    pub(super) fn words(self, chain: &Chain) -> String {
        match self {
            Self::Inside(particle) => {
                let body = chain.bodies().get(chain.body_of(particle));
                let kind = body.map_or_else(String::new, |body| {
                    body.name.replace('_', " ").replace("ptfe", "PTFE")
                });
                format!("inside particle {particle}, {kind}")
            }
            Self::Below(particle) => format!("between particles {particle} and {}", particle + 1),
            Self::Wall => "at the wall".to_owned(),
        }
    }
}

/// The incoming shock with a dashpot in every contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Viscous {
    /// The dashpot (N s/m).
    pub dashpot: f64,
    /// Mean frequency over the first four periods inside particle 2 (Hz).
    pub frequency: f64,
    /// The force there.
    pub signal: ForceSignal,
}
