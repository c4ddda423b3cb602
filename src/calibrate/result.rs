//! Result of a calibration: each impact, the whole, the non-linearity, and notes for the user.

use serde::{Serialize, Serializer};

use super::equation::{
    BudgetLine, Common, InputKind, MeasurementEquation, StrikerMotion, finite_or_null,
};
use super::error::CalibrationError;
use super::impact::Impact;
use super::monte_carlo::{self, Draws, MonteCarlo};
use super::record::{Exclusion, RawRecord};
use crate::numeric::intervals::{NORMAL_95, expanded_95, student_95};
use crate::numeric::statistics::StraightLine;

/// One impact of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedStrike {
    /// The record, or why it cannot be used.
    pub record: RawRecord,
    /// The striker's mass and speeds.
    pub motion: StrikerMotion,
}

/// A recording as evidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingEvidence {
    /// File or folder as the plan names it.
    pub recording: String,
    /// SHA-256 of the file, or over a folder's captures in order of name, in hexadecimal.
    pub sha256: String,
    /// Channel.
    pub channel: String,
    /// Shot.
    pub shot: u32,
    /// Vertical scale, probe included (V/div).
    pub volts_per_div: f64,
    /// Time base (s/div).
    pub seconds_per_div: f64,
    /// The probe's attenuation (1).
    pub probe: f64,
    /// The instrument, if the file names it.
    pub instrument: Option<String>,
}

/// Result of one impact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImpactResult {
    /// Number in the plan, from 1.
    pub number: usize,
    /// Its recording, if a plan names one.
    #[serde(flatten)]
    pub evidence: Option<RecordingEvidence>,
    /// Whether it was used.
    pub used: bool,
    /// Why it was left out.
    #[serde(rename = "excluded", serialize_with = "in_words")]
    pub exclusion: Option<Exclusion>,
    /// The striker's name.
    pub striker: String,
    /// Momentum handed over (N s).
    #[serde(rename = "momentum_n_s")]
    pub momentum: Option<f64>,
    /// Integral of the voltage with its droop undone (V s).
    #[serde(rename = "integral_v_s")]
    pub integral: Option<f64>,
    /// Sensitivity of this impact alone (V/N).
    #[serde(rename = "sensitivity_v_per_n")]
    pub sensitivity: Option<f64>,
    /// Its standard uncertainty from this impact's own inputs (V/N).
    #[serde(rename = "own_u_v_per_n")]
    pub own_uncertainty: Option<f64>,
    /// Sensitivity by the raw voltage's integral, without the droop correction (V/N).
    #[serde(rename = "naive_v_per_n")]
    pub naive: Option<f64>,
    /// Largest force (N).
    #[serde(rename = "peak_force_n")]
    pub peak_force: Option<f64>,
    /// Numbers from the record; none if it could not be evaluated.
    #[serde(flatten)]
    pub impact: Option<Impact>,
}

#[allow(clippy::ref_option, reason = "serde's signature")]
fn in_words<S: Serializer>(why: &Option<Exclusion>, serializer: S) -> Result<S::Ok, S::Error> {
    why.as_ref().map(ToString::to_string).serialize(serializer)
}

/// How the sensitivity changes with force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NonLinearity {
    /// Change of the sensitivity from the lowest to the highest peak force, over the sensitivity,
    /// on the line that fits best (1).
    #[serde(rename = "nonlinearity")]
    pub change: f64,
    /// Its standard uncertainty, from the scatter about that line where it is larger than the
    /// impacts' own (1).
    #[serde(rename = "nonlinearity_u")]
    pub u: f64,
    /// Its expanded uncertainty for 95 % (1).
    #[serde(rename = "nonlinearity_U95")]
    pub expanded: f64,
    /// Largest distance of the line from the sensitivity within the range of forces, over the
    /// change (1).
    #[serde(skip)]
    pub reach: f64,
}

impl NonLinearity {
    /// Whether it is more than its expanded uncertainty.
    pub fn is_found(&self) -> bool {
        self.change.abs() > self.expanded
    }

    /// Largest distance of the line from the sensitivity within the range of forces, over it (1).
    pub fn largest(&self) -> f64 {
        self.change.abs() * self.reach
    }

    /// The same where the change is as large as its 95 % interval allows (1).
    pub fn largest_possible(&self) -> f64 {
        (self.change.abs() + self.expanded) * self.reach
    }
}

/// Result of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Calibration {
    /// Voltage per force before any droop (V/N).
    #[serde(rename = "sensitivity_v_per_n")]
    pub sensitivity: f64,
    /// Its standard uncertainty (V/N).
    #[serde(rename = "u_v_per_n")]
    pub u: f64,
    /// Half-width of the evenly distributed part of that, a gain within a data sheet's limits
    /// (V/N).
    #[serde(skip)]
    pub half_width: f64,
    /// Effective degrees of freedom of the other, normal part, by Welch and Satterthwaite; infinite
    /// where impacts scatter no more than their inputs explain (1).
    #[serde(rename = "effective_degrees_of_freedom", serialize_with = "finite_or_null")]
    pub freedom: f64,
    /// Expanded uncertainty over the standard one (1).
    pub coverage_factor: f64,
    /// Expanded uncertainty of the sensitivity for 95 % (V/N).
    ///
    /// By propagation of uncertainty, the normal part by Student's t, the even one by its limits.
    /// Where the Monte Carlo check does not confirm propagation, its interval takes the place
    /// (JCGM 101:2008, 8.2): the distance of its farther end, by Student's t, too.
    #[serde(rename = "U95_v_per_n")]
    pub expanded: f64,
    /// The same over the sensitivity (1).
    #[serde(rename = "U95_relative")]
    pub expanded_relative: f64,
    /// Sensitivity less and plus its expanded uncertainty (V/N).
    #[serde(rename = "interval_95_v_per_n")]
    pub interval_95: [f64; 2],
    /// Time constant (s).
    #[serde(rename = "tau_s")]
    pub tau: f64,
    /// Its standard uncertainty (s).
    #[serde(rename = "tau_u_s")]
    pub tau_u: f64,
    /// Its expanded uncertainty for 95 % (s).
    #[serde(rename = "tau_U95_s")]
    pub tau_expanded: f64,
    /// Whether tau was read off the records, instead of given.
    #[serde(rename = "tau_source", serialize_with = "source_of_tau")]
    pub tau_fitted: bool,
    /// Lowest and highest peak force (N).
    #[serde(rename = "force_range_n")]
    pub force_range: [f64; 2],
    /// Number of levels of force.
    pub levels: usize,
    /// Residual non-linearity; none with fewer than three impacts or a single level of force.
    #[serde(flatten)]
    pub nonlinearity: Option<NonLinearity>,
    /// Sensitivity by the raw voltages' integrals (V/N).
    #[serde(rename = "naive_v_per_n")]
    pub naive: f64,
    /// Whether all pulses were negative.
    #[serde(rename = "negative_polarity")]
    pub negative: bool,
    /// Scatter of the impacts over what their own inputs explain; 1 is as expected (1).
    pub birge_ratio: f64,
    /// All impacts of the plan in its order.
    pub impacts: Vec<ImpactResult>,
    /// Every input's part in the uncertainty.
    pub budget: Vec<BudgetLine>,
    /// The same by drawing inputs; none where no draws were asked for.
    pub monte_carlo: Option<MonteCarlo>,
    /// Notes for the user.
    pub notes: Vec<String>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
fn source_of_tau<S: Serializer>(is_fitted: &bool, serializer: S) -> Result<S::Ok, S::Error> {
    if *is_fitted { "read off the records" } else { "given" }.serialize(serializer)
}

impl Calibration {
    /// Sets what follows from the standard uncertainty: the expanded one and its interval.
    fn expand(&mut self) {
        let student = student_95(self.freedom) / NORMAL_95;
        if let Some(drawn) = self.unconfirmed() {
            let ends = drawn.interval_95.map(|end| (end - self.sensitivity).abs());
            self.u = drawn.u;
            self.expanded = ends[0].max(ends[1]) * student;
        } else {
            let even = self.half_width / 3f64.sqrt();
            let normal = (self.u * self.u - even * even).max(0.0).sqrt();
            self.expanded = expanded_95(even.hypot(normal * student), self.half_width);
        }
        self.coverage_factor = self.expanded / self.u;
        self.expanded_relative = self.expanded / self.sensitivity;
        self.interval_95 = [self.sensitivity - self.expanded, self.sensitivity + self.expanded];
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
            ("expanded uncertainty", self.expanded),
            ("time constant", self.tau),
            ("uncertainty of the time constant", self.tau_u),
            ("sensitivity by the raw voltage", self.naive),
            ("lowest peak force", self.force_range[0]),
            ("highest peak force", self.force_range[1]),
            ("Birge ratio", self.birge_ratio),
        ];
        let of_line =
            self.nonlinearity.into_iter().flat_map(|n| [n.change, n.u, n.expanded, n.reach]);
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
            .chain(
                self.budget.iter().map(|line| (line.name.clone(), line.contribution + line.share)),
            )
            .chain(of_impacts);
        match all.into_iter().find(|(_, number)| !number.is_finite()) {
            Some((quantity, _)) => Err(CalibrationError::NotFinite { quantity }),
            None => Ok(()),
        }
    }
}

/// Impacts that a calibration should have, and levels of force among them.
const RECOMMENDED_COUNTS: (usize, usize) = (5, 3);
/// Forces further apart than this are two levels (1).
const LEVEL_STEP: f64 = 0.1;

/// The result of `equation` and the records.
pub(super) fn assemble(
    (strikes, common): (&[PlannedStrike], &Common),
    read: Vec<Result<Impact, Exclusion>>,
    excluded: &[(usize, Exclusion)],
    mut equation: MeasurementEquation,
    draws: Draws,
) -> Calibration {
    let (sensitivity, tau) = (equation.sensitivity(), equation.tau());
    let mut impacts: Vec<ImpactResult> = Vec::new();
    for (index, (impact, strike)) in read.into_iter().zip(strikes).enumerate() {
        let why = excluded.iter().find(|(i, _)| *i == index).map(|(_, why)| why.clone());
        impacts.push(result_of((index, impact.ok()), &strike.motion, common, tau, why));
    }
    for (place, (_, own)) in equation.places().iter().zip(equation.each()) {
        if let Some(result) = impacts.get_mut(*place) {
            result.own_uncertainty = Some(own);
        }
    }
    let used = || impacts.iter().filter(|impact| impact.exclusion.is_none());
    let count = used().count() as f64;
    let peaks: Vec<f64> = used().filter_map(|impact| impact.peak_force).collect();
    let low = peaks.iter().copied().fold(f64::INFINITY, f64::min);
    let shape = used().filter_map(|i| i.impact.as_ref()).map(mean_share).sum::<f64>() / count;
    let nonlinearity = nonlinearity(&equation, &peaks, shape);
    if let Some(line) = nonlinearity.filter(NonLinearity::is_found) {
        // Anywhere between the line and the mean, evenly.
        equation.set_u(InputKind::NonLinearity, line.largest() * sensitivity / 3f64.sqrt());
    }
    let budget = equation.budget();
    let u = budget.iter().map(|line| line.contribution.powi(2)).sum::<f64>().sqrt();
    let half_width = equation.half_width();
    let normal = (u * u - half_width * half_width / 3.0).max(0.0).sqrt();
    let tau_u = equation.tau_u();
    let mut calibration = Calibration {
        sensitivity,
        u,
        half_width,
        freedom: equation.freedom(normal),
        coverage_factor: 0.0,
        expanded: 0.0,
        expanded_relative: 0.0,
        interval_95: [0.0; 2],
        tau,
        tau_u,
        tau_expanded: NORMAL_95 * tau_u,
        tau_fitted: common.tau.is_none(),
        naive: used().filter_map(|impact| impact.naive).sum::<f64>() / count,
        negative: used().all(|i| i.impact.as_ref().is_some_and(|impact| impact.negative)),
        monte_carlo: monte_carlo::run(&equation, draws),
        budget,
        nonlinearity,
        levels: levels(&peaks),
        force_range: [low, peaks.iter().copied().fold(0.0, f64::max)],
        birge_ratio: equation.birge_ratio(),
        impacts,
        notes: Vec::new(),
    };
    calibration.expand();
    calibration.notes = notes(&calibration, common, equation.tail_tau());
    calibration
}

fn result_of(
    (index, impact): (usize, Option<Impact>),
    motion: &StrikerMotion,
    common: &Common,
    tau: f64,
    exclusion: Option<Exclusion>,
) -> ImpactResult {
    let integral = impact.as_ref().map(|impact| impact.integral(tau));
    let momentum = impact.as_ref().map(|impact| common.momentum(motion, impact.duration));
    let over = |integral: Option<f64>| Some(integral? / momentum? * common.gain.value);
    let sensitivity = over(integral);
    ImpactResult {
        number: index + 1,
        evidence: None,
        used: exclusion.is_none(),
        striker: common
            .strikers
            .get(motion.striker)
            .map_or(String::new(), |(name, _)| name.clone()),
        naive: over(impact.as_ref().map(Impact::naive_integral)),
        peak_force: impact.as_ref().zip(sensitivity).map(|(i, s)| i.peak * common.gain.value / s),
        impact,
        momentum,
        integral,
        sensitivity,
        own_uncertainty: None,
        exclusion,
    }
}

/// Groups of forces within a tenth of each other.
fn levels(peaks: &[f64]) -> usize {
    let mut sorted = peaks.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut first = f64::NEG_INFINITY;
    let mut count = 0;
    for peak in sorted {
        if count == 0 || peak > (1.0 + LEVEL_STEP) * first {
            (first, count) = (peak, count + 1);
        }
    }
    count
}

/// The force that counts in an impact's integral over its peak:
/// `integral N^2 dt / (N_peak integral N dt)`, by which a sensitivity that is straight in the force
/// enters (1).
fn mean_share(impact: &Impact) -> f64 {
    let values = &impact.restored.values;
    let squares: f64 = values.iter().map(|v| v * v).sum();
    squares / (impact.peak * values.iter().sum::<f64>())
}

/// The straight line through the sensitivities over force, each impact with its own uncertainty.
fn nonlinearity(equation: &MeasurementEquation, peaks: &[f64], shape: f64) -> Option<NonLinearity> {
    if peaks.len() < 3 || levels(peaks) < 2 {
        return None;
    }
    let points: Vec<(f64, f64, f64)> =
        peaks.iter().zip(equation.each()).map(|(p, (s, u))| (*p, s, u.powi(-2))).collect();
    let StraightLine { mean: (force, _), slope, spread, residual } =
        StraightLine::through(&points)?;
    let low = peaks.iter().copied().fold(f64::INFINITY, f64::min);
    let high = peaks.iter().copied().fold(0.0, f64::max);
    let freedom = (points.len() - 2) as f64;
    let scatter = (residual / freedom).sqrt().max(1.0);
    let whole = equation.sensitivity();
    let u = spread.powf(-0.5) * scatter * (high - low) / whole;
    Some(NonLinearity {
        change: slope * (high - low) / whole,
        u,
        expanded: student_95(freedom) * u,
        reach: (high / shape - force).max(force - low / shape) / (high - low),
    })
}

fn notes(found: &Calibration, common: &Common, tail: Option<(f64, f64)>) -> Vec<String> {
    let mut notes = Vec::new();
    let used = found.impacts.iter().filter(|impact| impact.exclusion.is_none());
    let (impacts, levels) = RECOMMENDED_COUNTS;
    let count = used.clone().count();
    if count < impacts || found.levels < levels {
        notes.push(format!(
            "{count} usable impacts at {} levels of force: the non-linearity needs at least {impacts} impacts at {levels} levels",
            found.levels
        ));
    }
    let is_short = |impact: &&ImpactResult| {
        impact.impact.as_ref().is_some_and(|impact| impact.pre_trigger < 0.2)
    };
    let short: Vec<String> =
        used.clone().filter(is_short).map(|impact| impact.number.to_string()).collect();
    if !short.is_empty() {
        notes.push(format!(
            "less than 20 % pre-trigger in the record of impact {}: its baseline is less certain",
            short.join(", ")
        ));
    }
    let disturbances =
        used.clone().filter_map(|i| i.impact.as_ref()?.baseline.disturbance.as_ref());
    if let Some(disturbance) = disturbances.clone().find(|disturbance| disturbance.is_found()) {
        notes.push(format!(
            "found {} in the records: predicted under each contact, with its uncertainty; earth the probe, trigger on line or let the scope warm up to be without",
            disturbance.words()
        ));
    }
    let mixed = used.filter_map(|i| i.impact.as_ref()).any(|i| i.negative != found.negative);
    if mixed {
        notes.push("some pulses are positive and some negative: check the polarity".to_owned());
    }
    let hidden =
        |line: &NonLinearity| !line.is_found() && line.largest_possible() > found.expanded_relative;
    if let Some(line) = found.nonlinearity.filter(hidden) {
        notes.push(format!(
            "the impacts leave open whether the sensitivity at the ends of the range of forces differs by up to {:.2} %, which the expanded uncertainty of {:.2} % does not contain: more impacts there tell",
            100.0 * line.largest_possible(),
            100.0 * found.expanded_relative
        ));
    }
    if let Some(line) = found.nonlinearity.filter(NonLinearity::is_found) {
        notes.push(format!(
            "the sensitivity changes by {:.2} % over the range of forces, more than its expanded uncertainty of {:.2} %: counted as an input",
            100.0 * line.change,
            100.0 * line.expanded
        ));
    }
    if let (Some(given), Some((tau, u))) = (common.tau, tail)
        && (tau - given.value).abs() > 3.0 * u.hypot(given.u)
    {
        notes.push(format!(
            "the records' ends give a time constant of {:.4} ms, {:.1} standard uncertainties from the {:.4} ms given",
            1e3 * tau,
            (tau - given.value).abs() / u.hypot(given.u),
            1e3 * given.value
        ));
    }
    notes
}
