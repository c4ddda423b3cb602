//! The lowest minimum from several starts, each over ever longer parts of the records where the
//! direct way ends high.

use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;

use super::model::TraceModel;
use super::{FitError, FitOptions, STOP_CRITERIA};
use crate::analysis::least_squares::{LeastSquaresError, Minimum, StopCriteria, minimise};

/// Shares of the records over which a fit finds its way (1).
const STAGE_SHARES: [f64; 3] = [0.4, 0.6, 0.8];
/// On the way there, close is enough.
const COARSE_CRITERIA: StopCriteria = StopCriteria { reduction: 1e-4, steps: 20 };
/// Standard deviations that a residual variance is off by chance, and what is known of the noise
/// (1).
const VARIANCE_DEVIATIONS: f64 = 5.0;
/// Stream of the starting points.
const START_STREAM: u128 = 1 << 72;

/// The lowest minimum over all starts, and chi squared that each start came to; none for one that
/// came to nothing.
pub fn best(
    model: &mut TraceModel<'_>,
    options: &FitOptions,
) -> Result<(Minimum, Vec<Option<f64>>), FitError> {
    let mut numbers = Pcg64::new(u128::from(options.seed), START_STREAM);
    let mut lowest: Option<Minimum> = None;
    let mut failure = LeastSquaresError::NoStart;
    let mut starts = Vec::new();
    for number in 0..options.starts.max(1) {
        let mut factor = |_| {
            let share: f64 = StandardUniform.sample(&mut numbers);
            if number == 0 { 1.0 } else { 1.0 + options.spread * (2.0 * share - 1.0) }
        };
        let factors: Vec<f64> = (0..model.knobs.len()).map(&mut factor).collect();
        let start = model.start(&factors);
        let found = start.ok_or(LeastSquaresError::NoStart).and_then(|x| descend(model, x));
        starts.push(found.as_ref().ok().map(|minimum| minimum.chi_squared));
        match found {
            Ok(minimum) if lowest.as_ref().is_none_or(|l| minimum.chi_squared < l.chi_squared) => {
                lowest = Some(minimum);
            }
            Ok(_) => {}
            Err(error) => failure = error,
        }
    }
    Ok((lowest.ok_or(failure)?, starts))
}

/// The minimum of the valley below `start`: first with offsets at the baselines, since free ones
/// may lead into a false valley, and from there with all parameters.
fn descend(model: &mut TraceModel<'_>, start: Vec<f64>) -> Result<Minimum, LeastSquaresError> {
    if !model.offsets {
        return descend_held(model, start);
    }
    model.holds_offsets = true;
    let held = descend_held(model, start.clone());
    model.holds_offsets = false;
    minimise(model, &held.map_or(start, |minimum| minimum.x), STOP_CRITERIA)
}

/// The minimum of the valley below `start`; where that ends high or nowhere, the way over parts of
/// the records is tried as well, and the lower end counts.
fn descend_held(model: &mut TraceModel<'_>, start: Vec<f64>) -> Result<Minimum, LeastSquaresError> {
    let direct = minimise(model, &start, STOP_CRITERIA);
    if direct.as_ref().is_ok_and(is_chance) {
        return direct;
    }
    match (direct, staged(model, start)) {
        (Ok(direct), Ok(staged)) if staged.chi_squared < direct.chi_squared => Ok(staged),
        (Ok(direct), _) => Ok(direct),
        (Err(_), staged) => staged,
    }
}

/// Whether the residual variance may be one but for chance; in false valleys of a rattling chain it
/// was 1.1 to 1.3 where chance makes 1.01.
fn is_chance(minimum: &Minimum) -> bool {
    let deviation = (2.0 / minimum.degrees_of_freedom as f64).sqrt();
    minimum.variance() - 1.0 < VARIANCE_DEVIATIONS * deviation
}

/// The minimum over ever longer parts of the records, each from where the one before ended:
/// arrivals first, and what comes late, whose chi squared has many valleys, from close by.
fn staged(model: &mut TraceModel<'_>, start: Vec<f64>) -> Result<Minimum, LeastSquaresError> {
    let count = model.records.axis.count;
    let mut x = start;
    for share in STAGE_SHARES {
        model.horizon = (share * count as f64) as usize;
        // A part may determine too little; the whole record decides.
        if let Ok(found) = minimise(model, &x, COARSE_CRITERIA) {
            x = found.x;
        }
    }
    model.horizon = count;
    minimise(model, &x, STOP_CRITERIA)
}
