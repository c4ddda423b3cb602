//! Inputs and results of a calibration as data.

use super::budget::BudgetLine;
use super::exclusion::Exclusion;
use super::impact::{Impact, RawRecord};
use super::model::StrikerMotion;
use super::monte_carlo::MonteCarlo;
use crate::numeric::intervals::{NORMAL_95, expanded_95, student_95};

/// One impact as the plan tells it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedStrike {
    /// The record, or why it cannot be used.
    pub record: RawRecord,
    /// The striker's mass and speeds.
    pub motion: StrikerMotion,
}

/// Why there is no calibration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// Too little is left.
    #[error("found {used} usable impacts of {all}, expected at least 2:{}", listed(.reasons))]
    TooFew {
        /// Impacts that are left.
        used: usize,
        /// Impacts in the plan.
        all: usize,
        /// Why each of the others is not.
        reasons: Vec<(usize, Exclusion)>,
    },
    /// Nothing tells the time constant.
    #[error(
        "found no time constant: none is given, and no record goes on long enough behind its contact to show one"
    )]
    NoTimeConstant,
    /// An input whose uncertainty exceeds its value.
    #[error(
        "{input}: found {value:e} {unit} with a standard uncertainty of {u:e} {unit}, expected one below the value: nothing is known of it"
    )]
    UnknownInput {
        /// The input's name.
        input: String,
        /// Its estimate (unit).
        value: f64,
        /// Its standard uncertainty (unit).
        u: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A result that is not finite.
    #[error(
        "found a result that is not finite ({quantity}), expected a number: check masses, heights, speeds, their units and their uncertainties"
    )]
    NotFinite {
        /// Which result.
        quantity: String,
    },
}

pub(super) fn listed(reasons: &[(usize, Exclusion)]) -> String {
    let line = |(index, why): &(usize, Exclusion)| format!("\n  impact {}: {why}", index + 1);
    reasons.iter().map(line).collect::<Vec<_>>().concat()
}

/// Result of one impact.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactResult {
    /// Numbers from the record; none where it could not be evaluated.
    pub impact: Option<Impact>,
    /// Momentum handed over (N s).
    pub momentum: Option<f64>,
    /// Integral of the voltage with its droop undone (V s).
    pub integral: Option<f64>,
    /// Sensitivity of this impact alone (V/N).
    pub sensitivity: Option<f64>,
    /// Its standard uncertainty from this impact's own inputs (V/N).
    pub own_uncertainty: Option<f64>,
    /// Sensitivity by the raw voltage's integral, without the droop correction (V/N).
    pub naive: Option<f64>,
    /// Largest force (N).
    pub peak_force: Option<f64>,
    /// Why it is left out, if it is.
    pub exclusion: Option<Exclusion>,
}

/// How the sensitivity changes with force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NonLinearity {
    /// Change of the sensitivity from the lowest to the highest peak force, over the sensitivity,
    /// on the line that fits best (1).
    pub change: f64,
    /// Its standard uncertainty, from the scatter about that line where it is larger than the
    /// impacts' own (1).
    pub u: f64,
    /// Degrees of freedom of the line (1).
    pub freedom: f64,
    /// Largest distance of the line from the sensitivity within the range of forces, over it (1).
    pub largest: f64,
}

impl NonLinearity {
    /// Its expanded uncertainty for 95 % (1).
    pub fn expanded(&self) -> f64 {
        student_95(self.freedom) * self.u
    }

    /// Whether it is more than its expanded uncertainty.
    pub fn is_found(&self) -> bool {
        self.change.abs() > self.expanded()
    }
}

/// Result of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Voltage per force before any droop (V/N).
    pub sensitivity: f64,
    /// Its standard uncertainty (V/N).
    pub u: f64,
    /// Half-width of the evenly distributed part of that, a gain within a data sheet's limits
    /// (V/N).
    pub half_width: f64,
    /// Effective degrees of freedom of the other, normal part, by Welch and Satterthwaite (1).
    pub freedom: f64,
    /// Time constant (s).
    pub tau: f64,
    /// Its standard uncertainty (s).
    pub tau_u: f64,
    /// Whether tau was read off the records, instead of given.
    pub tau_fitted: bool,
    /// Sensitivity by the raw voltages' integrals (V/N).
    pub naive: f64,
    /// Whether all pulses were negative.
    pub negative: bool,
    /// All impacts of the plan in its order.
    pub impacts: Vec<ImpactResult>,
    /// Every input's part in the uncertainty.
    pub budget: Vec<BudgetLine>,
    /// The same by drawing inputs; none where no draws were asked for.
    pub monte_carlo: Option<MonteCarlo>,
    /// Residual non-linearity; none with fewer than three impacts or a single level of force.
    pub nonlinearity: Option<NonLinearity>,
    /// Number of levels of force.
    pub levels: usize,
    /// Lowest and highest peak force (N).
    pub force_range: [f64; 2],
    /// Scatter of the impacts over what their own inputs explain; 1 is as expected (1).
    pub birge_ratio: f64,
    /// Notes for the user.
    pub notes: Vec<String>,
}

impl Calibration {
    /// Coverage factor of 95 % (1).
    pub fn coverage_factor(&self) -> f64 {
        self.expanded() / self.u
    }

    /// Expanded uncertainty of the sensitivity for 95 % (V/N).
    ///
    /// By propagation of uncertainty, the normal part by Student's t, the even one by its limits.
    /// Where the Monte Carlo check does not confirm propagation, its interval takes the place
    /// (JCGM 101:2008, 8.2): the distance of its farther end, by Student's t, too.
    pub fn expanded(&self) -> f64 {
        let student = student_95(self.freedom) / NORMAL_95;
        if let Some(drawn) = self.unconfirmed() {
            let [low, high] = drawn.interval_95.map(|end| (end - self.sensitivity).abs());
            return low.max(high) * student;
        }
        let even = self.half_width / 3f64.sqrt();
        let normal = (self.u * self.u - even * even).max(0.0).sqrt();
        expanded_95(even.hypot(normal * student), self.half_width)
    }

    /// The draws, if they do not confirm the propagation of uncertainty.
    pub fn unconfirmed(&self) -> Option<MonteCarlo> {
        self.monte_carlo.filter(|drawn| !drawn.agrees)
    }

    /// Fails if any number of the result is not finite, or the uncertainty is zero.
    pub(super) fn check_finite(&self) -> Result<(), CalibrationError> {
        let whole = [
            ("sensitivity", self.sensitivity),
            // Zero is no uncertainty: its inverse is not finite.
            ("uncertainty of the sensitivity", 1.0 / self.u + self.u),
            ("expanded uncertainty", self.expanded()),
            ("time constant", self.tau),
            ("uncertainty of the time constant", self.tau_u),
            ("sensitivity by the raw voltage", self.naive),
            ("lowest peak force", self.force_range[0]),
            ("highest peak force", self.force_range[1]),
            ("Birge ratio", self.birge_ratio),
        ];
        let of_line = self.nonlinearity.into_iter().flat_map(|n| [n.change, n.u, n.largest]);
        let of_draws = self.monte_carlo.into_iter().flat_map(|drawn| {
            [drawn.u, drawn.mean, drawn.interval_95[0], drawn.interval_95[1], drawn.tolerance]
        });
        let of_impacts = self.impacts.iter().enumerate().flat_map(|(index, impact)| {
            let numbers = [
                impact.momentum,
                impact.integral,
                impact.sensitivity,
                impact.own_uncertainty,
                impact.naive,
                impact.peak_force,
            ];
            numbers.into_iter().flatten().map(move |n| (format!("impact {}", index + 1), n))
        });
        let named = |(name, number): (&str, f64)| (name.to_owned(), number);
        let all = whole
            .into_iter()
            .map(named)
            .chain(of_line.map(|n| named(("non-linearity", n))))
            .chain(of_draws.map(|n| named(("Monte Carlo interval", n))))
            .chain(self.budget.iter().map(|line| (line.name(), line.contribution + line.share)))
            .chain(of_impacts);
        match all.into_iter().find(|(_, number)| !number.is_finite()) {
            Some((quantity, _)) => Err(CalibrationError::NotFinite { quantity }),
            None => Ok(()),
        }
    }
}
