//! A force sensor's sensitivity from impacts of known momentum.
//!
//! A striker of mass `m` that arrives with `v_i` and leaves with `v_r` hands over `M = m (v_i +
//! v_r) + m g (t2 - t1)`, its weight during the contact included; the sensor's voltage `V`, with
//! its droop undone, integrates to `S M`: `S = integral (V + (1/tau) integral V) dt / M`.
//! [`plan_run`] reads a plan's recordings, [`impact`] evaluates one record, [`equation`] is that
//! equation with all its inputs and the budget of their uncertainties (GUM), [`monte_carlo`] checks
//! it by draws (GUM's first supplement), [`result`] and [`report`] are what the certificate
//! contains. [`design`] and [`blind`] try calibrations on simulated impacts ([`simulation`]). A
//! plate below a mass `m_a` in a host that moves as a whole, `m_t` with all that it takes along,
//! receives the share `1 - m_a/m_t` of `M`. Source: the balance of linear momentum; JCGM 100:2008;
//! JCGM 101:2008. Valid where the sensor measures the whole contact force and nothing else, and the
//! striker is rigid and falls freely but for the contact.

pub mod blind;
pub mod design;
mod disturbances;
#[doc(hidden)]
pub mod equation;
pub mod error;
mod files;
#[doc(hidden)]
pub mod impact;
#[doc(hidden)]
pub mod monte_carlo;
pub mod plan_run;
#[doc(hidden)]
pub mod record;
pub mod report;
pub mod result;
#[doc(hidden)]
pub mod simulation;
mod tail;

pub use error::CalibrationError;
pub use monte_carlo::Draws;
pub use plan_run::{PlanRunError, recording_hash, run};
pub use record::Exclusion;
pub use report::CalibrationReport;
pub use result::{Calibration, ImpactResult, NonLinearity, PlannedStrike};

use self::equation::{Common, MeasurementEquation};
use self::impact::Impact;
use self::record::{PreparedRecord, Surroundings};
use self::result::assemble;
use crate::analysis::baseline::scatter;
use crate::analysis::quiet_scope::MovingScatter;
use crate::numeric::statistics::median;

/// An impact this many standard uncertainties away from the others is left out (1).
pub const OUTLIER_DEVIATIONS: f64 = 5.0;
/// How often disturbances and time constant are found from each other.
const SEARCHES: u32 = 2;
/// Zeros of quiet records that are farther apart are not the same (1).
const MOST_ZERO_DEVIATIONS: f64 = 3.0;
/// Takes a median of absolute deviations to a standard deviation of normal numbers (1).
const MEDIAN_TO_DEVIATION: f64 = 1.4826;

/// Calibrates.
///
/// # Errors
/// [`CalibrationError`] where fewer than two impacts can be used or the time constant is
/// not determined.
pub fn calibrate(
    strikes: &[PlannedStrike],
    common: &Common,
    draws: Draws,
) -> Result<Calibration, CalibrationError> {
    let given = common.tau.map(|tau| tau.value);
    let known = surroundings(strikes, given);
    let each = || strikes.iter().map(|strike| &strike.record).zip(&known);
    let tails: Vec<_> = each().map(|(record, known)| tail::fit(record, known)).collect();
    let tau = given.or_else(|| tail::weighted_mean(&tails)).ok_or_else(|| no_tau(strikes))?;
    let read: Vec<Result<Impact, Exclusion>> =
        each().map(|(record, known)| Impact::read(record, known, tau)).collect();
    // What is left out scatters for reasons of its own.
    let sound = tails.into_iter().zip(&read).map(|(tail, read)| tail.filter(|_| read.is_ok()));
    let tails = tail::with_scatter(sound.collect());
    let mut used: Vec<usize> = (0..read.len()).filter(|i| read[*i].is_ok()).collect();
    let mut excluded: Vec<(usize, Exclusion)> = Vec::new();
    for (index, result) in read.iter().enumerate() {
        excluded.extend(result.as_ref().err().map(|why| (index, why.clone())));
    }
    let equation = loop {
        if used.len() < 2 {
            let (used, all) = (used.len(), strikes.len());
            return Err(CalibrationError::TooFew { used, all, reasons: excluded });
        }
        let impacts = used.iter().filter_map(|i| {
            let impact = read[*i].as_ref().ok()?;
            Some((*i, impact, &strikes[*i].motion, tails[*i].as_ref()))
        });
        let equation = MeasurementEquation::new(impacts, common)?;
        match outlier(&equation) {
            Some((position, times)) => {
                excluded.push((used.remove(position), Exclusion::Outlier { times }));
            }
            None => break equation,
        }
    };
    let calibration = assemble((strikes, common), read, &excluded, equation, draws);
    calibration.check_finite()?;
    Ok(calibration)
}

/// How the samples of each record scatter about a smooth curve: records of one range have one
/// noise, and tell it together.
fn scatters(strikes: &[PlannedStrike]) -> Vec<MovingScatter> {
    let one = |strike: &PlannedStrike| {
        (strike.record.level, scatter(&strike.record.trace, strike.record.level))
    };
    let each: Vec<(f64, MovingScatter)> = strikes.iter().map(one).collect();
    let same = |level: f64| {
        let same = each.iter().filter(move |(other, _)| other.to_bits() == level.to_bits());
        same.fold(MovingScatter::default(), |sum, (_, one)| sum.with(*one))
    };
    each.iter().map(|(level, _)| same(*level)).collect()
}

/// What all records of a range tell of each, with `tau` if it is given (s).
///
/// Several times: the first estimate of `tau` is a rough one.
fn surroundings(strikes: &[PlannedStrike], tau: Option<f64>) -> Vec<Surroundings> {
    let of_scatter = |scatter| Surroundings { scatter, ..Surroundings::default() };
    let mut known: Vec<Surroundings> = scatters(strikes).into_iter().map(of_scatter).collect();
    let mut zeros: Vec<(f64, f64)> = Vec::new();
    for (strike, known) in strikes.iter().zip(&mut known) {
        let Ok(prepared) = PreparedRecord::new(&strike.record, known) else { continue };
        known.is_dithered = prepared.rest.is_none();
        let sign = if prepared.negative { -1.0 } else { 1.0 };
        zeros.extend(prepared.rest.map(|rest| (sign * rest.zero(), rest.spread().variance)));
    }
    let has_common_zero = agree(&zeros);
    for known in &mut known {
        known.has_common_zero = has_common_zero;
    }
    for search in 0..SEARCHES {
        let each: Vec<_> = strikes.iter().map(|strike| &strike.record).zip(&known).collect();
        let fitted = || {
            let tails: Vec<_> =
                each.iter().map(|(record, known)| tail::fit(record, known)).collect();
            tail::weighted_mean(&tails)
        };
        let first = || disturbances::first_tau(&each);
        let found = tau.or_else(|| if search > 0 { fitted() } else { None }).or_else(first);
        let Some(tau) = found else { break };
        let found = disturbances::find(&each, tau);
        for (known, found) in known.iter_mut().zip(found) {
            known.disturbance = found;
        }
    }
    for known in &mut known {
        known.is_searched = true;
    }
    known
}

/// True if `zeros` with their variances agree: a scope at one range keeps its zero, and then what
/// rounding hides of it on a quiet one is the same in all records.
fn agree(zeros: &[(f64, f64)]) -> bool {
    let weights: f64 = zeros.iter().map(|(_, variance)| 1.0 / variance).sum();
    let mean = zeros.iter().map(|(zero, variance)| zero / variance).sum::<f64>() / weights;
    zeros.len() > 1
        && zeros.iter().all(|(zero, variance)| {
            (zero - mean).powi(2) <= MOST_ZERO_DEVIATIONS.powi(2) * (variance + 1.0 / weights)
        })
}

/// The reasons of impacts that could not be read; without any, the missing time constant.
fn no_tau(strikes: &[PlannedStrike]) -> CalibrationError {
    let guess = |strike: &PlannedStrike| {
        Impact::read(&strike.record, &Surroundings::default(), f64::INFINITY).err()
    };
    let reasons: Vec<(usize, Exclusion)> =
        strikes.iter().enumerate().filter_map(|(i, s)| Some((i, guess(s)?))).collect();
    if reasons.len() + 1 < strikes.len() {
        return CalibrationError::NoTimeConstant;
    }
    let used = strikes.len() - reasons.len();
    CalibrationError::TooFew { used, all: strikes.len(), reasons }
}

/// The impact farthest from the others, if it is too far: by its own uncertainty and by the others'
/// scatter.
fn outlier(equation: &MeasurementEquation) -> Option<(usize, f64)> {
    let values = equation.each();
    if values.len() < 3 {
        return None;
    }
    let middle = median(values.iter().map(|(s, _)| *s).collect());
    let scatter =
        MEDIAN_TO_DEVIATION * median(values.iter().map(|(s, _)| (s - middle).abs()).collect());
    let times = |(s, u): &(f64, f64)| (s - middle).abs() / u.max(scatter);
    let all = values.iter().map(times).enumerate();
    all.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, times)| *times > OUTLIER_DEVIATIONS)
}
