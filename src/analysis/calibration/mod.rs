//! A force sensor's sensitivity from impacts of known momentum.
//!
//! Behind the scope, before `measurement`, which reads plans and recordings. A striker of mass `m`
//! that comes with `v_i` and leaves with `v_r` hands over `M = m (v_i + v_r) + m g (t2 - t1)`, its
//! weight during the contact included; the sensor's voltage `V`, with its droop undone, integrates
//! to `S M`: `S = integral (V + (1/tau) integral V) dt / M`. [`impact`] reads one record, [`model`]
//! is that equation with all its inputs, [`budget`] propagates their uncertainties as the GUM says,
//! [`monte_carlo`] as its first supplement. Inputs that several impacts share, such as the scope's
//! gain, tau or a striker's mass, are one input: they do not average out. A plate below a mass
//! `m_a` in a host that moves as a whole, `m_t` with all that it takes along, feels the share
//! `1 - m_a/m_t` of `M`: what is above the plate keeps the rest. Source: the balance of linear
//! momentum; JCGM 100:2008; JCGM 101:2008. Valid where the sensor feels the whole contact force and
//! nothing else, and the striker is rigid and falls freely but for the contact.

mod assemble;
pub mod budget;
mod data;
mod exclusion;
pub mod impact;
mod inputs;
pub mod model;
pub mod monte_carlo;
mod prepared;
mod record;
mod tail;

pub use data::{Calibration, CalibrationError, ImpactResult, NonLinearity, PlannedStrike};
pub use exclusion::Exclusion;
pub use monte_carlo::Draws;

use self::assemble::assemble;
use self::impact::Impact;
use self::model::{Common, MeasurementEquation};
use crate::analysis::baseline::scatter;
use crate::analysis::rounding::MovingScatter;
use crate::numeric::statistics::median;

/// An impact this many standard uncertainties away from the others is left out (1).
pub const OUTLIER_DEVIATIONS: f64 = 5.0;
/// Takes a median of absolute deviations to a standard deviation of normal numbers (1).
const MEDIAN_TO_DEVIATION: f64 = 1.4826;

/// Calibrates.
///
/// # Errors
/// [`CalibrationError`] where fewer than two impacts can be used or nothing tells the time
/// constant.
pub fn calibrate(
    strikes: &[PlannedStrike],
    common: &Common,
    draws: Draws,
) -> Result<Calibration, CalibrationError> {
    let given = common.tau.map(|tau| tau.value);
    let scatters = scatters(strikes);
    let each = || strikes.iter().map(|strike| &strike.record).zip(scatters.iter().copied());
    let tails: Vec<_> = each().map(|(record, scatter)| tail::fit(record, scatter)).collect();
    let tau = given.or_else(|| tail::weighted_mean(&tails)).ok_or_else(|| no_tau(strikes))?;
    let read: Vec<Result<Impact, Exclusion>> =
        each().map(|(record, scatter)| Impact::read(record, scatter, tau)).collect();
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
        let model =
            MeasurementEquation::new(impacts, common).ok_or(CalibrationError::NoTimeConstant)?;
        model.check_inputs()?;
        match outlier(&model) {
            Some((position, times)) => {
                excluded.push((used.remove(position), Exclusion::Outlier { times }));
            }
            None => break model,
        }
    };
    let calibration = assemble((strikes, common), read, &excluded, model, draws);
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

/// Without any impact that could be read, that is what has to be told.
fn no_tau(strikes: &[PlannedStrike]) -> CalibrationError {
    let guess = |strike: &PlannedStrike| {
        Impact::read(&strike.record, MovingScatter::default(), f64::INFINITY).err()
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
fn outlier(model: &MeasurementEquation) -> Option<(usize, f64)> {
    let values = model.each();
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
