//! Puts a calibration's answers together: each impact, the whole, the non-linearity, and what the
//! user should know.

use super::budget::propagate;
use super::impact::Impact;
use super::model::{Common, InputKind, MeasurementEquation, StrikerMotion};
use super::{
    Calibration, Draws, Exclusion, ImpactResult, NonLinearity, PlannedStrike, monte_carlo,
};
use crate::numeric::statistics::StraightLine;

/// Impacts that a calibration should have, and levels of force among them.
pub const RECOMMENDED_COUNTS: (usize, usize) = (5, 3);
/// Forces further apart than this are two levels (1).
const LEVEL_STEP: f64 = 0.1;
/// Everything that `model` and the records tell.
pub fn assemble(
    (strikes, common): (&[PlannedStrike], &Common),
    read: Vec<Result<Impact, Exclusion>>,
    excluded: &[(usize, Exclusion)],
    mut model: MeasurementEquation,
    draws: Draws,
) -> Calibration {
    let (sensitivity, tau) = (model.sensitivity(), model.tau());
    let mut impacts: Vec<ImpactResult> = Vec::new();
    for (index, (impact, strike)) in read.into_iter().zip(strikes).enumerate() {
        let why = excluded.iter().find(|(i, _)| *i == index).map(|(_, why)| why.clone());
        impacts.push(result_of(impact.ok(), &strike.motion, common, tau, why));
    }
    for (place, (_, own)) in model.places().iter().zip(model.each()) {
        if let Some(result) = impacts.get_mut(*place) {
            result.own_uncertainty = Some(own);
        }
    }
    let used = || impacts.iter().filter(|impact| impact.exclusion.is_none());
    let count = used().count() as f64;
    let peaks: Vec<f64> = used().filter_map(|impact| impact.peak_force).collect();
    let low = peaks.iter().copied().fold(f64::INFINITY, f64::min);
    let shape = used().filter_map(|i| i.impact.as_ref()).map(mean_share).sum::<f64>() / count;
    let nonlinearity = nonlinearity(&model, &peaks, shape);
    if let Some(line) = nonlinearity.filter(NonLinearity::is_found) {
        // Anywhere between the line and the mean, evenly.
        model.set_u(InputKind::NonLinearity, line.largest * sensitivity / 3f64.sqrt());
    }
    let budget = propagate(&model);
    let u = budget.iter().map(|line| line.contribution.powi(2)).sum::<f64>().sqrt();
    let half_width = model.half_width(&model.contributions_to_sensitivity());
    let normal = (u * u - half_width * half_width / 3.0).max(0.0).sqrt();
    let mut calibration = Calibration {
        sensitivity,
        u,
        half_width,
        freedom: model.freedom(normal),
        tau,
        tau_u: model.tau_u(),
        tau_fitted: common.tau.is_none(),
        naive: used().filter_map(|impact| impact.naive).sum::<f64>() / count,
        negative: used().all(|i| i.impact.as_ref().is_some_and(|impact| impact.negative)),
        monte_carlo: monte_carlo::run(&model, draws),
        budget,
        nonlinearity,
        levels: levels(&peaks),
        force_range: [low, peaks.iter().copied().fold(0.0, f64::max)],
        birge_ratio: model.birge_ratio(),
        impacts,
        notes: Vec::new(),
    };
    if let Some(drawn) = calibration.unconfirmed() {
        calibration.u = drawn.u;
    }
    calibration.notes = notes(&calibration, common, model.tail_tau());
    calibration
}

fn result_of(
    impact: Option<Impact>,
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
fn nonlinearity(model: &MeasurementEquation, peaks: &[f64], shape: f64) -> Option<NonLinearity> {
    if peaks.len() < 3 || levels(peaks) < 2 {
        return None;
    }
    let points: Vec<(f64, f64, f64)> =
        peaks.iter().zip(model.each()).map(|(p, (s, u))| (*p, s, u.powi(-2))).collect();
    let StraightLine { mean: (force, _), slope, spread, residual } =
        StraightLine::through(&points)?;
    let low = peaks.iter().copied().fold(f64::INFINITY, f64::min);
    let high = peaks.iter().copied().fold(0.0, f64::max);
    let freedom = (points.len() - 2) as f64;
    let scatter = (residual / freedom).sqrt().max(1.0);
    let whole = model.sensitivity();
    Some(NonLinearity {
        change: slope * (high - low) / whole,
        u: spread.powf(-0.5) * scatter * (high - low) / whole,
        freedom,
        largest: slope.abs() * (high / shape - force).max(force - low / shape) / whole,
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
    let short = used.clone().filter_map(|i| i.impact.as_ref()).any(|i| i.pre_trigger < 0.2);
    if short {
        notes.push(
            "a record has less than 20 % pre-trigger: its baseline is less certain".to_owned(),
        );
    }
    let mixed = used.filter_map(|i| i.impact.as_ref()).any(|i| i.negative != found.negative);
    if mixed {
        notes.push("some pulses are positive and some negative: check the polarity".to_owned());
    }
    if let Some(line) = found.nonlinearity.filter(NonLinearity::is_found) {
        notes.push(format!(
            "the sensitivity changes by {:.2} % over the range of forces, more than its expanded uncertainty of {:.2} %: counted as an input",
            100.0 * line.change,
            100.0 * line.expanded()
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
