//! Which accuracy a run is held to where nobody names one, and how far off what the user reads may be.

use std::cell::{Cell, LazyCell};
use std::time::Instant;

use super::attempts::{Attempt, Attempts, has_two_lengths, reference_tolerance};
use super::bench::Grid;
use super::comparison::{
    Run, arrival_error, compare_readings, deviation, level_of, peak_error, readings, sampled,
};
use super::energy::MOST;
use super::horizon::horizon;
use super::method_choice::controlled_for;
pub use super::outcome::ErrorEstimate;
use super::outcome::Reading;
use super::{Integration, Outcome, RunError, method, run, sample_grid};
use crate::integrate::IntegrateError;
use crate::quantity::engineering;
use crate::scene::{DEFAULT_ACCURACY, LOOSEST_ACCURACY, Scene, Site, TIGHTEST_ACCURACY};

/// Accuracy of the run that finds out how large peaks are and when they come (1).
const COARSE: f64 = 1e-3;
/// Share of a digitiser level and of a sample interval that may be wrong where nobody names an accuracy (1).
const SHARE: f64 = 0.1;
/// Safety factor on the reference run's own accuracy: with 3, estimates of extreme scenes came out too small by up to a factor of 2.4, held against
/// a solver of another kind (`tests/it/fifty_scenes`) (1).
pub const REFERENCE_MARGIN: f64 = 10.0;
/// Differences between traces count so many times: what amplifies the first run's errors amplifies the second's, too, which has come to a
/// fourteenth of the first's in the shipped scenes, and near rounding to more (1).
pub const TRACES: f64 = 2.0;

/// An accuracy and where it is from.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenAccuracy {
    /// Relative error of first-peak forces and times (1).
    pub value: f64,
    /// Why this one.
    pub reason: String,
}

/// The accuracy that the scope calls for: a tenth of a digitiser level of the most sensitive channel in first peaks, a tenth of a
/// sample interval in arrivals, whichever is less; both follow from a coarse run. Without a pulse it is [`DEFAULT_ACCURACY`].
///
/// # Errors
/// [`RunError`] where the chain cannot be followed.
pub fn of_scope(scene: &Scene) -> Result<ChosenAccuracy, RunError> {
    let found = readings(scene, method(scene, Integration::Accuracy(COARSE))?)?;
    let arrivals = found.iter().filter_map(|r| Some(r.half_rise_s?.max(r.first_peak?.time_s)));
    let latest = arrivals.fold(0.0, f64::max);
    if latest == 0.0 {
        let reason = "no pulse arrives that scope and accuracy could be measured by".to_owned();
        return Ok(ChosenAccuracy { value: DEFAULT_ACCURACY, reason });
    }
    let interval = scene.scope.model.sample_interval(scene.scope.time_base);
    let by_time = SHARE * interval / latest;
    let time_words = format!(
        "a tenth of the sample interval of {} at the latest arrival, {}",
        engineering(interval, "s", 3),
        engineering(latest, "s", 3)
    );
    let by_level = level_of(scene, &found).map(|level| SHARE * level);
    let (value, words) = match by_level {
        Some(value) if value < by_time => {
            let words =
                "a tenth of a digitiser level of the most sensitive channel, in its first peak";
            (value, words.to_owned())
        }
        _ => (by_time, time_words),
    };
    let reason = format!("the scene names none; {words}");
    Ok(ChosenAccuracy { value: value.clamp(TIGHTEST_ACCURACY, LOOSEST_ACCURACY), reason })
}

/// The accuracy to run `scene` with: its own, or the one that its scope calls for.
///
/// # Errors
/// [`RunError`] where the chain cannot be followed.
pub fn of_scene(scene: &Scene) -> Result<ChosenAccuracy, RunError> {
    match scene.accuracy {
        Some(value) => Ok(ChosenAccuracy { value, reason: "the scene's".to_owned() }),
        None => of_scope(scene),
    }
}

/// Runs `scene` so that first peaks and arrivals are as accurate as asked (1), estimate included: the steps of a run are held to an
/// accuracy, which says nothing of what the chain makes of their errors. So each run is held against a tighter one
/// ([`estimate`]), and taken again with tighter steps where they differ by too much ([`attempted_methods`](super::attempted_methods)), or where it has made or lost more than [`MOST`] of
/// the energy in motion. Traces are held to half of the digits, an error of `sqrt(accuracy)`, unless it is told from when on they are not. `progress` hears the share of the work, 0 to 1: the first run is taken for half of it, the next for half of the rest, and so on.
///
/// # Errors
/// [`RunError`] where the chain cannot be followed.
pub fn run_to_accuracy(
    scene: &Scene,
    accuracy: f64,
    shot: u32,
    progress: &mut dyn FnMut(f64),
) -> Result<Outcome, RunError> {
    let (own, started) = (&*scene.of_shot(shot), Instant::now());
    let mut tries = Attempts::of(own, accuracy);
    let mut second: Option<ReferenceRun> = None;
    let mut makes_energy = false;
    let left = Cell::new(1.0);
    let next = || left.set(0.5 * left.get());
    let mut progress = |share: f64| progress(1.0 - left.get() * (2.0 - share));
    loop {
        let Some(attempt @ Attempt { method, steps }) = tries.next() else {
            unreachable!("the last that is tried is taken as it is")
        };
        next();
        let by = Integration::Attempt { method, accuracy };
        let mut outcome = match run(scene, by, shot, &mut progress) {
            Err(RunError::Integrate(IntegrateError::NotFinite { .. }))
                if has_two_lengths(method) =>
            {
                continue;
            }
            found => found?,
        };
        if !tries.is_over() && !outcome.summary.energy.is_kept(MOST) {
            makes_energy = true;
            continue;
        }
        let against = match second.take() {
            Some(second) if second.tighter <= reference_tolerance(steps) => second,
            _ => {
                next();
                ReferenceRun::run(own, steps.min(accuracy), shot, &mut progress)?
            }
        };
        let estimate = second.insert(against).holds(&outcome, accuracy);
        let late = LazyCell::new(|| known_until(own, steps, outcome.summary.contact_changes));
        let held = estimate.as_ref().is_some_and(|estimate| {
            let traces = tries.holds_traces(attempt, estimate.trace, || late.is_some());
            estimate.worst() <= accuracy && traces
        });
        if !held && !tries.is_over() {
            continue;
        }
        let late = *late;
        let summary = &mut outcome.summary;
        if steps < accuracy {
            let why = if makes_energy {
                "longer ones have made or lost more than a tenth of the energy in motion"
            } else {
                "longer ones left it uncertain whether readings are as accurate as asked, and traces to half of the digits"
            };
            summary.notes.push(format!("steps are held to {steps:.0e}: {why}"));
        }
        summary.notes.extend(doubt(estimate.as_ref(), accuracy));
        summary.error_estimate = estimate.filter(|_| summary.has_pulse());
        summary.note_energy("a tighter accuracy keeps it better");
        if let Some(time) = late {
            summary.note_horizon(time, steps);
            summary.note_undecided();
        }
        summary.wall_held_s = Some(started.elapsed().as_secs_f64());
        return Ok(outcome);
    }
}

/// From when on the motion of `scene` at `accuracy` (1) is not known to half of its digits, where contacts may have changed sides: others amplify no errors (s).
pub(crate) fn known_until(scene: &Scene, accuracy: f64, changes: Option<u64>) -> Option<f64> {
    let setting = (scene.duration, accuracy);
    let amplifies = changes != Some(0) && !scene.chain.is_linear();
    // A motion that cannot be computed has been refused already.
    amplifies.then(|| horizon(&scene.chain, &scene.initial_velocities, setting).ok())??
}

/// Compares shot `shot` of `scene` with its reference run, at the [`reference_tolerance`] of `accuracy` (1). By the triangle inequality the error is at
/// most their difference and what the second run is off itself: [`REFERENCE_MARGIN`] times its own accuracy are added. Late in rattling chains traces of the second are
/// off by more than that, too: theirs is twice the difference.
///
/// None where the second run feels other pulses than the first, or none that are louder than what it may be off itself: where steps are held to
/// the stiffest contact both runs may take the same ones, and err the same way.
///
/// # Errors
/// [`RunError`] where the second run cannot go on.
pub fn estimate(
    scene: &Scene,
    accuracy: f64,
    outcome: &Outcome,
) -> Result<Option<ErrorEstimate>, RunError> {
    let second = ReferenceRun::run(scene, accuracy, outcome.shot.number, &mut |_| ())?;
    Ok(second.holds(outcome, accuracy))
}

/// Errors of a run of shot 1 of `scene` against an `exact` one: of peaks, arrivals and traces, as an estimate gives them; none where it has other pulses.
pub fn errors(scene: &Scene, exact: &Run, outcome: &Outcome) -> Option<ErrorEstimate> {
    let exact =
        ReferenceRun::of(scene, exact.clone(), 0.0, sample_grid(scene, outcome.shot.number));
    let found = exact.holds(outcome, f64::INFINITY)?;
    Some(ErrorEstimate { trace: found.trace.map(|trace| trace / TRACES), ..found })
}

/// What runs are held against.
struct ReferenceRun {
    /// Its accuracy (1).
    tighter: f64,
    /// At the sensors inside, then at the wall.
    readings: Vec<Reading>,
    /// What it may be off itself (N).
    faintest: f64,
    /// Static forces (N) and dynamic ones at the times of `grid` (N), of all sensors; none where no pulse was felt.
    traces: Vec<Option<(f64, Vec<f64>)>>,
    grid: Grid,
}

impl ReferenceRun {
    fn run(
        scene: &Scene,
        accuracy: f64,
        shot: u32,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, RunError> {
        let tighter = reference_tolerance(accuracy);
        let method = controlled_for(&scene.chain, &scene.initial_velocities, tighter);
        let grid = sample_grid(scene, shot);
        let mut share = |time: f64| progress(time / scene.duration);
        let found = sampled(scene, (method, None), (u64::MAX, grid), &mut share)?;
        Ok(Self::of(scene, found, tighter, grid))
    }

    /// A run of `scene` to an accuracy of `tighter` (1), its traces sampled on `grid`.
    fn of(scene: &Scene, run: Run, tighter: f64, grid: Grid) -> Self {
        let Run { readings: found, traces, .. } = run;
        let inside = scene.sensors.iter().zip(&found).filter(|(s, _)| s.site != Site::Wall);
        let wall = scene.chain.wall_contact().and_then(|_| found.last());
        let readings = inside.map(|(_, reading)| reading).chain(wall).cloned().collect();
        let faintest =
            REFERENCE_MARGIN * tighter * scene.chain.impact_force(&scene.initial_velocities);
        let felt = |(reading, trace): (&Reading, Vec<f64>)| {
            reading.first_peak.map(|_| (reading.static_n, trace))
        };
        let traces = found.iter().zip(traces).map(felt).take(scene.sensors.len()).collect();
        Self { tighter, readings, faintest, traces, grid }
    }

    /// How far off the run is, as [`estimate`] has it, whose traces are to deviate by no more than `limit` (1).
    fn holds(&self, outcome: &Outcome, limit: f64) -> Option<ErrorEstimate> {
        let Self { tighter, readings: second, faintest, .. } = self;
        let summary = &outcome.summary;
        let first: Vec<Reading> = summary.sensors.iter().chain(&summary.wall).cloned().collect();
        let felt =
            |readings: &[Reading]| readings.iter().filter(|r| r.first_peak.is_some()).count();
        let mut peaks = second.iter().filter_map(|reading| reading.first_peak);
        if felt(&first) != felt(second) || peaks.any(|peak| peak.dynamic_n < *faintest) {
            return None;
        }
        let off = |error| {
            compare_readings(&first, second, error).map(|off| off + REFERENCE_MARGIN * tighter)
        };
        let (peak, arrival) = (off(peak_error)?, off(arrival_error)?);
        let (trace, trace_holds_s) = self.trace(outcome, limit).unzip();
        let how = format!("estimated from a second run at accuracy {tighter:.0e}");
        Some(ErrorEstimate { peak, arrival, trace, trace_holds_s: trace_holds_s.flatten(), how })
    }

    /// How far off traces are (1), and up to when by no more than `limit` (1, s).
    fn trace(&self, outcome: &Outcome, limit: f64) -> Option<(f64, Option<f64>)> {
        let Self { tighter, traces, grid, .. } = self;
        let recorded = outcome.shot.truth.iter().filter(|trace| trace.name.starts_with("sensor/"));
        let pairs = recorded.zip(traces).filter_map(|(trace, second)| {
            let (at_rest, exact) = second.as_ref()?;
            let dynamic: Vec<f64> = trace.values.iter().map(|force| force - at_rest).collect();
            Some((dynamic, exact.clone()))
        });
        let (found, exact): (Vec<_>, Vec<_>) = pairs.unzip();
        let own = REFERENCE_MARGIN * tighter;
        let (off, first) = deviation(&found, &exact, (limit - own) / TRACES);
        let holds = |sample: usize| grid.time(sample.saturating_sub(1)).max(0.0);
        (!found.is_empty()).then(|| (TRACES * off + own, first.map(holds)))
    }
}

/// What the user has to hear of an estimate that is missing, or beyond the `accuracy` (1) that was asked for.
pub fn doubt(estimate: Option<&ErrorEstimate>, accuracy: f64) -> Option<String> {
    let Some(estimate) = estimate else {
        return Some(
            "a tighter run feels other pulses than this one, or some too faint to tell: how far off these readings are is not known"
                .to_owned(),
        );
    };
    let worst = estimate.worst();
    (worst > accuracy).then(|| {
        format!("readings may be off by {worst:.1e}, more than the accuracy of {accuracy:.1e} that was asked for")
    })
}
