//! The reference run: the same scene with much smaller errors, and the error estimate that follows
//! from the difference.

use super::comparison::{Run, arrival_error, compare_readings, deviation, peak_error, sampled};
use super::grid::Grid;
use super::method_choice::controlled_for;
use super::outcome::{ErrorEstimate, Reading};
use super::{Outcome, RunError, sample_grid};
use crate::recording::TrueSignal;
use crate::scene::{Scene, Site};
use crate::trace::Trace;

/// What readings are off by rounding, by which estimates are never smaller (1).
const ROUNDING_ERROR: f64 = 1e-12;
/// Smallest tolerance of a step: below, rounding would be mistaken for its error (1).
pub(super) const MIN_TOLERANCE: f64 = 1e-14;
/// Tolerance of the reference run, in terms of the accuracy asked or of the run's own tolerance
/// where that is smaller: so much smaller that both do not err alike (1).
const REFERENCE_FACTOR: f64 = 0.01;
/// Largest tolerance of the reference run: late in rattling chains, traces at 1e-3 and at 1e-5 may
/// be equally far off, and not differ (1).
const MAX_REFERENCE_TOLERANCE: f64 = 1e-6;
/// Safety factor on the reference run's own accuracy: with 3, estimates of extreme scenes came out
/// too small by up to a factor of 2.4, held against a solver of another kind
/// (`tests/it/fifty_scenes`) (1).
pub const REFERENCE_MARGIN: f64 = 10.0;
/// Safety factor on trace differences: the reference run diverges too, by a fourteenth of the
/// difference in the shipped scenes, and near rounding by more (1).
pub const TRACES: f64 = 2.0;

/// Compares shot `shot` of `scene` with its reference run, at the [`reference_tolerance`] of
/// `accuracy` (1). By the triangle inequality the error is at most their difference and what the
/// second run is off itself: [`REFERENCE_MARGIN`] times its own accuracy are added. Late in
/// rattling chains traces of the reference run are off by more than that, too: their error is
/// [`TRACES`] times the difference.
///
/// None where the two runs have different pulses, or pulses below the reference run's own error:
/// where steps are limited by the stiffest contact both runs may take the same ones, and err the
/// same way.
///
/// # Errors
/// [`RunError`] where the reference run cannot go on.
pub fn estimate(
    scene: &Scene,
    accuracy: f64,
    outcome: &Outcome,
) -> Result<Option<ErrorEstimate>, RunError> {
    let tolerance = reference_tolerance(accuracy);
    let reference = ReferenceRun::run(scene, tolerance, outcome.shot.number, &mut |_| ())?;
    Ok(reference.compare(outcome, accuracy))
}

/// Errors of a run of shot 1 of `scene` against an `exact` one: of peaks, arrivals and traces, as
/// an estimate gives them; none where it has other pulses.
pub fn errors(scene: &Scene, exact: &Run, outcome: &Outcome) -> Option<ErrorEstimate> {
    let exact =
        ReferenceRun::of(scene, exact.clone(), 0.0, sample_grid(scene, outcome.shot.number));
    let found = exact.compare(outcome, f64::INFINITY)?;
    Some(ErrorEstimate { trace: found.trace.map(|trace| trace / TRACES), ..found })
}

/// A run with much smaller errors.
pub(super) struct ReferenceRun {
    /// Its accuracy (1).
    pub(super) tolerance: f64,
    /// At the sensors inside, then at the wall.
    readings: Vec<Reading>,
    /// Its own error of a force, below which no pulse can be compared (N).
    faintest: f64,
    /// Static forces (N) and dynamic ones at the times of `grid` (N), of all sensors; none where no
    /// pulse was felt.
    traces: Vec<Option<(f64, Vec<f64>)>>,
    grid: Grid,
}

impl ReferenceRun {
    /// Runs shot `shot` of `scene` to an accuracy of `tolerance` (1).
    pub(super) fn run(
        scene: &Scene,
        tolerance: f64,
        shot: u32,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, RunError> {
        let method = controlled_for(&scene.chain, &scene.initial_velocities, tolerance);
        let grid = sample_grid(scene, shot);
        let mut share = |time: f64| progress(time / scene.duration);
        let found = sampled(scene, (method, None), u64::MAX, grid, &mut share)?;
        Ok(Self::of(scene, found, tolerance, grid))
    }

    /// A run of `scene` to an accuracy of `tolerance` (1), its traces sampled on `grid`.
    fn of(scene: &Scene, run: Run, tolerance: f64, grid: Grid) -> Self {
        let Run { readings: found, traces, .. } = run;
        let inside = scene.sensors.iter().zip(&found).filter(|(s, _)| s.site != Site::Wall);
        let wall = scene.chain.wall_contact().and_then(|_| found.last());
        let readings = inside.map(|(_, reading)| reading).chain(wall).cloned().collect();
        let faintest =
            REFERENCE_MARGIN * tolerance * scene.chain.impact_force(&scene.initial_velocities);
        let felt = |(reading, trace): (&Reading, Vec<f64>)| {
            reading.first_peak.map(|_| (reading.static_n, trace))
        };
        let traces = found.iter().zip(traces).map(felt).take(scene.sensors.len()).collect();
        Self { tolerance, readings, faintest, traces, grid }
    }

    /// How far off the run is, by [`estimate`], whose traces are to deviate by no more than `limit`
    /// (1).
    pub(super) fn compare(&self, outcome: &Outcome, limit: f64) -> Option<ErrorEstimate> {
        let Self { tolerance, readings: second, faintest, .. } = self;
        let summary = &outcome.summary;
        let first: Vec<Reading> = summary.sensors.iter().chain(&summary.wall).cloned().collect();
        let felt =
            |readings: &[Reading]| readings.iter().filter(|r| r.first_peak.is_some()).count();
        let mut peaks = second.iter().filter_map(|reading| reading.first_peak);
        if felt(&first) != felt(second) || peaks.any(|peak| peak.dynamic_n < *faintest) {
            return None;
        }
        let off = |error| {
            compare_readings(&first, second, error)
                .map(|off| off + (REFERENCE_MARGIN * tolerance).max(ROUNDING_ERROR))
        };
        let (peak, arrival) = (off(peak_error)?, off(arrival_error)?);
        let (trace, trace_holds_s) = self.trace(outcome, limit).unzip();
        let how = format!("estimated from a second run at accuracy {tolerance:.0e}");
        Some(ErrorEstimate { peak, arrival, trace, trace_holds_s: trace_holds_s.flatten(), how })
    }

    /// How far off traces are (1), and up to when by no more than `limit` (1, s).
    fn trace(&self, outcome: &Outcome, limit: f64) -> Option<(f64, Option<f64>)> {
        let Self { tolerance, traces, grid, .. } = self;
        let at_sensor =
            |trace: &&Trace| matches!(TrueSignal::of(trace), Some(TrueSignal::Force(_)));
        let recorded = outcome.shot.truth.iter().filter(at_sensor);
        let pairs = recorded.zip(traces).filter_map(|(trace, second)| {
            let (at_rest, exact) = second.as_ref()?;
            let dynamic: Vec<f64> = trace.values.iter().map(|force| force - at_rest).collect();
            Some((dynamic, exact.clone()))
        });
        let (found, exact): (Vec<_>, Vec<_>) = pairs.unzip();
        let own = REFERENCE_MARGIN * tolerance;
        let (off, first) = deviation(&found, &exact, (limit - own) / TRACES);
        let holds = |sample: usize| grid.time(sample.saturating_sub(1)).max(0.0);
        (!found.is_empty()).then(|| (TRACES * off + own, first.map(holds)))
    }
}

/// Tolerance of the reference run of one to `accuracy` (1).
pub fn reference_tolerance(accuracy: f64) -> f64 {
    (REFERENCE_FACTOR * accuracy).clamp(MIN_TOLERANCE, MAX_REFERENCE_TOLERANCE)
}
