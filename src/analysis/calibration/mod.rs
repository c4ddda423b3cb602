//! A force sensor's sensitivity from impacts of known momentum.
//!
//! Behind the scope, before `measurement`, which reads plans and recordings. A striker of mass `m` that comes with `v_i` and leaves with
//! `v_r` hands over `M = m (v_i + v_r) + m g (t2 - t1)`, its weight during the contact included; the sensor's voltage `V`, with its
//! droop undone, integrates to `S M`: `S = integral (V + (1/tau) integral V) dt / M`. [`impact`] reads one record, [`model`] is that
//! equation with all its inputs, [`budget`] propagates their uncertainties as the GUM says, [`monte_carlo`] as its first supplement.
//! Inputs that several impacts share, such as the scope's gain, tau or a striker's mass, are one input: they do not average out.
//! Source: the balance of linear momentum; JCGM 100:2008; JCGM 101:2008. Valid where the sensor feels the whole contact force
//! and nothing else, and the striker is rigid and falls freely but for the contact.

mod assemble;
pub mod budget;
pub mod impact;
mod inputs;
pub mod model;
pub mod monte_carlo;
mod prepared;
mod tail;

use self::assemble::assemble;
use self::budget::BudgetLine;
use self::impact::{Impact, Record};
use self::model::{Common, Model, Motion};
use self::monte_carlo::MonteCarlo;

/// An impact this many standard uncertainties away from the others is left out (1).
pub const OUTLYING: f64 = 5.0;
/// Takes a median of absolute deviations to a standard deviation of normal numbers (1).
const MEDIAN_TO_DEVIATION: f64 = 1.4826;
/// Coverage factor of a normal distribution's 95 % (1).
pub const COVERAGE_95: f64 = 1.959_963_984_540_054;

/// One impact as the plan tells it.
#[derive(Debug, Clone, PartialEq)]
pub struct Strike {
    /// The record; or why there is none.
    pub record: Record,
    /// What the striker did.
    pub motion: Motion,
}

/// Why an impact is left out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Exclusion {
    /// The converter was driven to its end.
    #[error("saturated: {samples} samples stand at the converter's ends")]
    Saturated {
        /// How many.
        samples: usize,
    },
    /// Nothing to take the baseline from.
    #[error(
        "no pre-trigger: {samples} samples before the contact are too few for a baseline, expected 20 % of the record"
    )]
    NoPreTrigger {
        /// How many there are.
        samples: usize,
    },
    /// The window or the record does not hold the whole pulse.
    #[error("the {what} cuts the pulse at {:.1} us", 1e6 * time)]
    Cut {
        /// `window` or `record`.
        what: &'static str,
        /// Where the cut is (s).
        time: f64,
    },
    /// Another pulse in the same record.
    #[error("two impacts in one record: a second pulse at {:.1} us", 1e6 * time)]
    TwoImpacts {
        /// Where the other one is (s).
        time: f64,
    },
    /// Nothing above the noise.
    #[error("no pulse above the noise")]
    NoPulse,
    /// Values that are no numbers, or a time axis that does not go on.
    #[error("values or an interval that are no numbers")]
    NotFinite,
    /// It contradicts the others.
    #[error("outlier: {times:.1} standard uncertainties away from the other impacts")]
    Outlier {
        /// How many standard uncertainties (1).
        times: f64,
    },
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
}

fn listed(reasons: &[(usize, Exclusion)]) -> String {
    let line = |(index, why): &(usize, Exclusion)| format!("\n  impact {}: {why}", index + 1);
    reasons.iter().map(line).collect::<Vec<_>>().concat()
}

/// What one impact gave.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactResult {
    /// What was read off the record; none where it could not be read.
    pub impact: Option<Impact>,
    /// Momentum handed over (N s).
    pub momentum: Option<f64>,
    /// Integral of the voltage with its droop undone (V s).
    pub integral: Option<f64>,
    /// Sensitivity of this impact alone (V/N).
    pub sensitivity: Option<f64>,
    /// Its standard uncertainty from this impact's own inputs (V/N).
    pub own_uncertainty: Option<f64>,
    /// What the raw voltage's integral would have given: it ignores the droop (V/N).
    pub naive: Option<f64>,
    /// Largest force (N).
    pub peak_force: Option<f64>,
    /// Why it is left out, if it is.
    pub exclusion: Option<Exclusion>,
}

/// How the sensitivity changes with force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NonLinearity {
    /// Change of the sensitivity from the lowest to the highest peak force, over the sensitivity, on the line that fits best (1).
    pub change: f64,
    /// Its standard uncertainty (1).
    pub u: f64,
}

/// What a calibration found.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Voltage per force before any droop (V/N).
    pub sensitivity: f64,
    /// Its standard uncertainty (V/N).
    pub u: f64,
    /// Time constant (s).
    pub tau: f64,
    /// Its standard uncertainty (s).
    pub tau_u: f64,
    /// Whether tau was read off the records, instead of given.
    pub tau_fitted: bool,
    /// What the raw voltages' integrals would have given (V/N).
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
    /// What the user should know.
    pub notes: Vec<String>,
}

/// How the Monte-Carlo part is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draws {
    /// Seed.
    pub seed: u64,
    /// Number of draws; 0 leaves the Monte-Carlo part out.
    pub count: usize,
}

/// Calibrates.
///
/// # Errors
/// [`CalibrationError`] where fewer than two impacts can be used or nothing tells the time constant.
pub fn calibrate(
    strikes: &[Strike],
    common: &Common,
    draws: Draws,
) -> Result<Calibration, CalibrationError> {
    let given = common.tau.map(|tau| tau.value);
    let tails: Vec<_> = strikes.iter().map(|s| tail::fit(&s.record)).collect();
    let tau = given.or_else(|| tail::together(&tails)).ok_or_else(|| no_tau(strikes))?;
    let read: Vec<Result<Impact, Exclusion>> =
        strikes.iter().map(|strike| Impact::read(&strike.record, tau)).collect();
    let mut used: Vec<usize> = (0..read.len()).filter(|i| read[*i].is_ok()).collect();
    let mut excluded: Vec<(usize, Exclusion)> = Vec::new();
    for (index, result) in read.iter().enumerate() {
        excluded.extend(result.as_ref().err().map(|why| (index, why.clone())));
    }
    let model = loop {
        if used.len() < 2 {
            let (used, all) = (used.len(), strikes.len());
            return Err(CalibrationError::TooFew { used, all, reasons: excluded });
        }
        let impacts = used.iter().filter_map(|i| {
            let impact = read[*i].as_ref().ok()?;
            Some((*i, impact, &strikes[*i].motion, tails[*i].as_ref()))
        });
        let model = Model::new(impacts, common).ok_or(CalibrationError::NoTimeConstant)?;
        match outlier(&model) {
            Some((position, times)) => {
                excluded.push((used.remove(position), Exclusion::Outlier { times }));
            }
            None => break model,
        }
    };
    Ok(assemble((strikes, common), read, &excluded, &model, draws))
}

/// Without any impact that could be read, that is what has to be told.
fn no_tau(strikes: &[Strike]) -> CalibrationError {
    let guess = |strike: &Strike| Impact::read(&strike.record, f64::INFINITY).err();
    let reasons: Vec<(usize, Exclusion)> =
        strikes.iter().enumerate().filter_map(|(i, s)| Some((i, guess(s)?))).collect();
    if reasons.len() + 1 < strikes.len() {
        return CalibrationError::NoTimeConstant;
    }
    let used = strikes.len() - reasons.len();
    CalibrationError::TooFew { used, all: strikes.len(), reasons }
}

/// The impact farthest from the others, if it is too far: by its own uncertainty and by the others' scatter.
fn outlier(model: &Model) -> Option<(usize, f64)> {
    let values = model.each();
    if values.len() < 3 {
        return None;
    }
    let middle = median(values.iter().map(|(s, _)| *s).collect());
    let scatter =
        MEDIAN_TO_DEVIATION * median(values.iter().map(|(s, _)| (s - middle).abs()).collect());
    let times = |(s, u): &(f64, f64)| (s - middle).abs() / u.max(scatter);
    let all = values.iter().map(times).enumerate();
    all.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, times)| *times > OUTLYING)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match (values.get(middle.wrapping_sub(1)), values.get(middle)) {
        (Some(below), Some(above)) if values.len().is_multiple_of(2) => 0.5 * (below + above),
        (_, Some(value)) => *value,
        _ => 0.0,
    }
}
