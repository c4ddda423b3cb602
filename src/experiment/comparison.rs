//! Runs of one scene by different methods, held against each other in terms of what a user reads.

use std::time::Instant;

use super::bench::Grid;
use super::outcome::EnergyLedger;
use super::outcome::Reading;
use super::{read_places, sample_grid, scene_bench};
use crate::chain::simd::Refinement;
use crate::integrate::{IntegrateError, Method, Work};
use crate::scene::{Scene, input_load};
use crate::scope::waveform::LEVELS_PER_DIVISION;

/// A run reduced to what is compared.
#[derive(Debug, Clone)]
pub struct Run {
    /// Peaks and arrivals, one a watched place.
    pub readings: Vec<Reading>,
    /// Forces at the scope's sample times, one a watched place (N).
    pub traces: Vec<Vec<f64>>,
    /// Where the energy went.
    pub energy: EnergyLedger,
    /// Its cost.
    pub work: Work,
    /// Steps tried in which contacts opened or closed; none where the method does not ask.
    pub contact_changes: Option<u64>,
    /// Wall time (s).
    pub wall_s: f64,
}

/// A method, as it is or without one of the vector path's refinements.
pub type Treated = (Method, Option<Refinement>);

/// Runs `scene` by `method` to the end of its duration.
///
/// # Errors
/// The integrator's.
pub fn run(scene: &Scene, method: Method) -> Result<Run, IntegrateError> {
    run_without(scene, (method, None), u64::MAX)
}

/// The same without one of the vector path's refinements, and given up when it has taken more than
/// `most` evaluations of all forces.
///
/// # Errors
/// The integrator's.
pub fn run_without(
    scene: &Scene,
    (method, refinement): Treated,
    most: u64,
) -> Result<Run, IntegrateError> {
    sampled(scene, (method, refinement), most, sample_grid(scene, 1), &mut |_| ())
}

/// The same with samples at the times of `grid`; `progress` is called with the time that is reached
/// (s).
///
/// # Errors
/// The integrator's.
pub fn sampled(
    scene: &Scene,
    (method, refinement): Treated,
    most: u64,
    grid: Grid,
    progress: &mut dyn FnMut(f64),
) -> Result<Run, IntegrateError> {
    let started = Instant::now();
    let mut bench =
        scene_bench(scene, &scene.initial_velocities, method, grid, Grid::NEVER).within(most);
    if let Some(refinement) = refinement {
        bench = bench.without(refinement);
    }
    bench.run_until(scene.duration, true, progress)?;
    let wall_s = started.elapsed().as_secs_f64();
    let (before, after) = bench.energies();
    Ok(Run {
        readings: read_places(scene, &bench),
        traces: bench.watches().iter().map(|w| w.samples.clone()).collect(),
        energy: EnergyLedger::new(before, after, bench.dissipated()),
        work: bench.work(),
        contact_changes: bench.contact_changes(),
        wall_s,
    })
}

/// The larger of the largest errors of peaks and arrivals; none if a pulse was lost (1).
pub fn worst(found: &Run, exact: &Run) -> Option<f64> {
    let peak = compare(found, exact, peak_error)?;
    Some(peak.max(compare(found, exact, arrival_error)?))
}

/// Readings of all probes, the wall last, in a run of `scene` by `method` without samples.
///
/// # Errors
/// The integrator's.
pub fn readings(scene: &Scene, method: Method) -> Result<Vec<Reading>, IntegrateError> {
    let mut bench = scene_bench(scene, &scene.initial_velocities, method, Grid::NEVER, Grid::NEVER);
    bench.run_until(scene.duration, true, &mut |_| ())?;
    Ok(read_places(scene, &bench))
}

/// Largest of `error` over all places that felt a pulse in the reference; none if one of them felt
/// none here (1).
pub fn compare(
    found: &Run,
    exact: &Run,
    error: fn(&Reading, &Reading) -> Option<f64>,
) -> Option<f64> {
    compare_readings(&found.readings, &exact.readings, error)
}

/// The same of readings alone (1).
pub fn compare_readings(
    found: &[Reading],
    exact: &[Reading],
    error: fn(&Reading, &Reading) -> Option<f64>,
) -> Option<f64> {
    let felt = found.iter().zip(exact).filter(|(_, e)| e.first_peak.is_some());
    let mut largest = 0.0;
    for (found, exact) in felt {
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

/// Largest deviation of the force at any of the first `places` that felt a pulse, relative to its
/// largest; none where no place did (1).
pub fn trace_error(found: &Run, exact: &Run, places: usize) -> Option<f64> {
    let felt = exact.readings.iter().take(places).map(|reading| reading.first_peak.is_some());
    let of = |run: &Run| -> Vec<Vec<f64>> {
        let traces = run.traces.iter().zip(felt.clone()).filter(|(_, felt)| *felt);
        traces.map(|(trace, _)| trace.clone()).collect()
    };
    let exact = of(exact);
    (!exact.is_empty()).then(|| deviation(&of(found), &exact, f64::INFINITY).0)
}

/// Largest deviation of any trace from its `exact` one, relative to the largest force in that (1),
/// and the first sample in which one deviates by more than `limit` (1). A trace that is not a
/// number deviates infinitely, for it compares with nothing.
pub fn deviation(found: &[Vec<f64>], exact: &[Vec<f64>], limit: f64) -> (f64, Option<usize>) {
    let (mut largest, mut first) = (0.0_f64, None::<usize>);
    for (found, exact) in found.iter().zip(exact) {
        let scale = exact.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        for (index, (a, b)) in found.iter().zip(exact).enumerate().filter(|_| scale > 0.0) {
            let off = (a - b).abs() / scale;
            let off = if off.is_finite() { off } else { f64::INFINITY };
            largest = largest.max(off);
            if off > limit {
                first = Some(first.map_or(index, |first| first.min(index)));
            }
        }
    }
    (largest, first)
}

/// The smallest digitiser level relative to the first peak at its channel's sensor (1).
pub fn level(scene: &Scene, exact: &Run) -> Option<f64> {
    level_of(scene, &exact.readings)
}

/// The same from readings alone (1).
pub fn level_of(scene: &Scene, readings: &[Reading]) -> Option<f64> {
    let mut smallest: Option<f64> = None;
    for channel in scene.scope.channels.iter().flatten() {
        let wired = scene.sensors.iter().zip(readings);
        let Some((sensor, reading)) =
            wired.into_iter().find(|(s, _)| Some(&s.name) == channel.input.as_ref())
        else {
            continue;
        };
        let circuit = sensor.sensor.connect(input_load(&scene.scope.model, channel));
        let Some(peak) = reading.first_peak else { continue };
        let volts = channel.vertical.scale / LEVELS_PER_DIVISION;
        let relative = volts / (circuit.sensitivity * peak.dynamic_n);
        smallest = Some(smallest.map_or(relative, |s| s.min(relative)));
    }
    smallest
}
