//! Errors of a run: its differences from a more accurate one, in first peaks, arrivals and traces.

use super::outcome::{ErrorEstimate, Reading};
use super::run::Run;
use crate::scene::input_load;

/// Relative rounding error of readings; estimates are never smaller (1).
const ROUNDING_ERROR: f64 = 1e-12;
/// Safety factor on the reference run's own tolerance: with 3, estimates of extreme scenes were too
/// small by up to a factor of 2.4 (`tests/it/fifty_scenes`) (1).
const REFERENCE_MARGIN: f64 = 10.0;
/// Safety factor on differences of traces, in which the reference run diverges too: by a fourteenth
/// of the difference in the shipped scenes (1).
const TRACE_MARGIN: f64 = 2.0;

/// Errors of `run`: its differences from a `reference` at a smaller `tolerance` (1), plus what
/// that one may be off itself. None if the two have different pulses, or pulses below the
/// reference's own error.
pub fn estimate(run: &Run<'_>, reference: &Run<'_>, tolerance: f64) -> Option<ErrorEstimate> {
    let own = REFERENCE_MARGIN * tolerance;
    let (first, second) = (run.readings(), reference.readings());
    let pulses = |readings: &[Reading]| {
        readings.iter().filter(|reading| reading.first_peak.is_some()).count()
    };
    let faintest = own * run.impact_force();
    let mut peaks = second.iter().filter_map(|reading| reading.first_peak);
    if pulses(&first) != pulses(&second) || peaks.any(|peak| peak.dynamic_n < faintest) {
        return None;
    }
    let largest = |error| Some(largest_error(&first, &second, error)? + own.max(ROUNDING_ERROR));
    Some(ErrorEstimate {
        peak: largest(peak_error)?,
        arrival: largest(arrival_error)?,
        trace: trace_error(run, reference).map(|error| TRACE_MARGIN * error + own),
        trace_holds_s: None,
        how: format!("estimated from a second run at accuracy {tolerance:.0e}"),
    })
}

/// Relative error of the reference runs that an estimate adds for a reference at `tolerance` (1).
pub fn reference_error(tolerance: f64) -> f64 {
    REFERENCE_MARGIN * tolerance
}

/// Time after which a trace of `run` deviates from that of `reference`, at `tolerance` (1), by more
/// than the share `limit` (1) of its largest force, safety factors included; none if none does (s).
pub fn deviates_from(
    run: &Run<'_>,
    reference: &Run<'_>,
    tolerance: f64,
    limit: f64,
) -> Option<f64> {
    let allowed = (limit - REFERENCE_MARGIN * tolerance) / TRACE_MARGIN;
    let first = deviations(run, reference).filter(|(_, share)| *share > allowed);
    let sample = first.map(|(sample, _)| sample).min()?;
    Some(run.sample_time(sample.saturating_sub(1)).max(0.0))
}

/// Largest deviation of the force at any sensor with a pulse, relative to its largest; none if no
/// sensor has one (1).
pub fn trace_error(run: &Run<'_>, exact: &Run<'_>) -> Option<f64> {
    deviations(run, exact).map(|(_, share)| share).reduce(f64::max)
}

/// Deviations of the force at all sensors with pulses: number of the sample, and share of the
/// largest force (1). What is not a number deviates infinitely.
fn deviations(run: &Run<'_>, exact: &Run<'_>) -> impl Iterator<Item = (usize, f64)> {
    let pairs = run.forces().zip(exact.forces()).zip(exact.readings());
    pairs.filter(|(_, reading)| reading.first_peak.is_some()).flat_map(|((found, exact), _)| {
        let scale = exact.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        let share = move |(sample, (found, exact)): (usize, (&f64, &f64))| {
            let share = (found - exact).abs() / scale;
            (sample, if share.is_finite() { share } else { f64::INFINITY })
        };
        found.iter().zip(exact).enumerate().filter(move |_| scale > 0.0).map(share)
    })
}

/// An error of one reading against the exact one; none if a pulse is missing (1).
pub type ReadingError = fn(&Reading, &Reading) -> Option<f64>;

/// Largest `error` of all places with a pulse in the exact readings; none if one of them has none
/// among those that were `found` (1).
pub fn largest_error(found: &[Reading], exact: &[Reading], error: ReadingError) -> Option<f64> {
    let with_pulse = found.iter().zip(exact).filter(|(_, exact)| exact.first_peak.is_some());
    let mut largest = 0.0;
    for (found, exact) in with_pulse {
        largest = error(found, exact)?.max(largest);
    }
    Some(largest)
}

fn relative(found: f64, exact: f64) -> f64 {
    (found / exact - 1.0).abs()
}

/// Relative error of the first peak's dynamic force (1).
pub fn peak_error(found: &Reading, exact: &Reading) -> Option<f64> {
    Some(relative(found.first_peak?.dynamic_n, exact.first_peak?.dynamic_n))
}

/// Largest relative error of first-peak time, half-rise and tenth (1).
pub fn arrival_error(found: &Reading, exact: &Reading) -> Option<f64> {
    let peak = relative(found.first_peak?.time_s, exact.first_peak?.time_s);
    let rise = relative(found.half_rise_s?, exact.half_rise_s?);
    let foot = relative(found.ten_percent_s?, exact.ten_percent_s?);
    Some(peak.max(rise).max(foot))
}

/// Smallest digitiser level relative to the first peak at its channel's sensor; none without a
/// channel that is wired to one (1).
pub fn level(run: &Run<'_>) -> Option<f64> {
    let (scene, readings) = (run.scene(), run.readings());
    let of_channel = |channel: &crate::scope::ChannelSetup| {
        let wired = scene.sensors.iter().zip(&readings);
        let (sensor, reading) =
            wired.into_iter().find(|(s, _)| Some(&s.name) == channel.input.as_ref())?;
        let circuit = sensor.sensor.connect(input_load(&scene.scope.model, channel));
        let volts = scene.scope.model.level(channel.vertical.scale);
        Some(volts / (circuit.sensitivity * reading.first_peak?.dynamic_n))
    };
    scene.scope.channels.iter().flatten().filter_map(of_channel).reduce(f64::min)
}
