//! Runs a scene to an accuracy and estimates the error of the result.
//!
//! The runs form a ladder: each has a hundredth of the tolerance of the one before. The error of a
//! run is its difference from the next one. The first run whose error is at most the accuracy is
//! the result. If none of `MAX_RUNS` is, the last one is, with a note.

use std::time::Instant;

use super::auto_effects::resolve_auto_effects;
use super::estimate::{deviates_from, estimate, reference_error};
use super::method_choice::{controlled_for, method_for};
use super::outcome::{Assessment, ErrorEstimate, MAX_ENERGY_DRIFT};
use super::run::Run;
use super::{Integration, Outcome, RunError, method};
use crate::motion::Method;
use crate::note::Note;
use crate::scene::{Scene, TIGHTEST_ACCURACY};

/// Runs in the ladder at most, without the reference run of the last one.
const MAX_RUNS: u32 = 3;
/// Tolerance of a run over that of the run before (1).
const TIGHTENING: f64 = 0.01;
/// Smallest tolerance of a run: below, rounding errors exceed those of the steps (1).
const MIN_TOLERANCE: f64 = 1e-14;
/// Largest tolerance of a reference run: late in rattling chains, traces at 1e-3 and at 1e-5 may
/// have errors of the same size (1).
const MAX_REFERENCE_TOLERANCE: f64 = 1e-6;
/// Tolerances of the reference runs of a method by hand, tried until the estimate is clearly above
/// the reference's own error (1).
const BY_HAND_TOLERANCES: [f64; 2] = [1e-8, TIGHTEST_ACCURACY];
/// An estimate above so many times the reference's own error does not change with a tighter
/// reference by more than a hundredth (1).
const CLEAR_FACTOR: f64 = 100.0;
/// Errors of a method by hand above which a note warns (1).
const NOTED_ERROR: f64 = 0.01;

/// Tolerance of the reference run for one at `tolerance` (1).
pub fn reference_tolerance(tolerance: f64) -> f64 {
    (TIGHTENING * tolerance).clamp(MIN_TOLERANCE, MAX_REFERENCE_TOLERANCE)
}

/// Simulates shot `shot` of `scene` until first peaks and arrivals are accurate to `accuracy`
/// (relative, 1), and the energy in motion to a tenth. `progress` is called with the share of the
/// work done, 0 to 1.
///
/// # Errors
/// [`RunError`] if a run fails: a state that is not finite, steps that become too short.
pub fn run_to_accuracy(
    scene: &Scene,
    accuracy: f64,
    shot: u32,
    progress: &mut dyn FnMut(f64),
) -> Result<Outcome, RunError> {
    let started = Instant::now();
    let scene = &*resolve_auto_effects(scene, Integration::Accuracy(accuracy));
    let Climbed { run, assessment } = climb(scene, accuracy, shot, progress)?;
    Ok(run.complete(Some(accuracy), &mut |_| ())?.assessed(assessment, started))
}

/// The run that [`climb`] ends with.
pub struct Climbed<'a> {
    /// The run, to the end of the scene's duration.
    pub run: Run<'a>,
    /// Its errors.
    pub assessment: Assessment,
}

/// Climbs the ladder for `scene`, whose effects are decided, up to a run that is accurate to
/// `accuracy` (1), or to the last one.
///
/// # Errors
/// [`RunError`] if a run fails.
pub fn climb<'a>(
    scene: &'a Scene,
    accuracy: f64,
    shot: u32,
    progress: &mut dyn FnMut(f64),
) -> Result<Climbed<'a>, RunError> {
    let velocities = scene.velocities(shot);
    let mut simulate = |number: u32, method: Method| {
        let (before, share) = (1.0 - 0.5_f64.powi(number as i32), 0.5_f64.powi(number as i32 + 1));
        let mut report = |time: f64| progress(before + share * time / scene.duration);
        Run::new(scene, shot, method, &mut report)
    };
    let mut tolerance = accuracy;
    let mut run = simulate(0, method_for(&scene.chain, &velocities, tolerance))?;
    let mut runs = 1;
    loop {
        let tighter = reference_tolerance(tolerance);
        let reference = simulate(runs, controlled_for(&scene.chain, &velocities, tighter))?;
        let found = estimate(&run, &reference, tighter);
        let is_accurate = found.as_ref().is_some_and(|error| error.worst() <= accuracy)
            && run.energy().is_kept(MAX_ENERGY_DRIFT);
        if is_accurate || runs == MAX_RUNS || tighter <= MIN_TOLERANCE {
            let since = |limit: f64| deviates_from(&run, &reference, tighter, limit);
            let notes = shorter_steps(tolerance, accuracy);
            let assessment = Assessment {
                notes: notes.into_iter().chain(doubt(found.as_ref(), accuracy)).collect(),
                estimate: found.map(|e| ErrorEstimate { trace_holds_s: since(accuracy), ..e }),
                energy_advice: "a tighter accuracy",
                unreliable: since(accuracy.sqrt()).map(|time| (time, accuracy.sqrt())),
            };
            return Ok(Climbed { run, assessment });
        }
        (run, tolerance) = (reference, tighter);
        runs += 1;
    }
}

/// Simulates shot `shot` of `scene` by a method and a step or tolerance set by hand, and estimates
/// the errors from a tighter run. `progress` is called with the share of the work done, 0 to 1.
///
/// # Errors
/// [`RunError`] if the method is not for the scene, or its run fails.
pub fn run_by_hand(
    scene: &Scene,
    by_hand: Method,
    shot: u32,
    progress: &mut dyn FnMut(f64),
) -> Result<Outcome, RunError> {
    let started = Instant::now();
    let integration = Integration::Method(by_hand);
    let scene = &*resolve_auto_effects(scene, integration);
    let run = Run::new(scene, shot, method(scene, integration)?, &mut |time| {
        progress(time / scene.duration);
    })?;
    let velocities = scene.velocities(shot);
    let (mut found, mut unreliable, mut notes) = (None, None, Vec::new());
    for tolerance in BY_HAND_TOLERANCES {
        let method = controlled_for(&scene.chain, &velocities, tolerance);
        let reference = match Run::new(scene, shot, method, &mut |_| ()) {
            Ok(reference) => reference,
            Err(error) => {
                let sentence = format!("no error estimate: the reference run failed: {error}");
                notes.push(Note::new("no_error_estimate", sentence));
                break;
            }
        };
        found = estimate(&run, &reference, tolerance);
        let worst = found.as_ref().map_or(f64::INFINITY, ErrorEstimate::worst);
        let limit = worst.max(TIGHTEST_ACCURACY).sqrt();
        let since = deviates_from(&run, &reference, tolerance, limit);
        unreliable = since.filter(|_| worst <= NOTED_ERROR).map(|time| (time, limit));
        if worst.is_finite() && worst > CLEAR_FACTOR * reference_error(tolerance) {
            break;
        }
    }
    let is_fixed = by_hand.fixed_step().is_some();
    let setting = if is_fixed { "step" } else { "tolerance" };
    notes.extend(too_coarse(setting, found.as_ref()).filter(|_| notes.is_empty()));
    let assessment = Assessment {
        estimate: found,
        notes,
        energy_advice: if is_fixed { "a shorter step" } else { "a tighter tolerance" },
        unreliable,
    };
    Ok(run.complete(None, &mut |_| ())?.assessed(assessment, started))
}

/// The note on a `setting` by hand with errors above [`NOTED_ERROR`].
fn too_coarse(setting: &str, estimate: Option<&ErrorEstimate>) -> Option<Note> {
    let (worst, error) = match estimate {
        Some(found) if found.worst() <= NOTED_ERROR => return None,
        Some(found) => (found.worst(), format!("readings may be off by {:.1e}", found.worst())),
        None => (f64::INFINITY, "an accurate run detects other pulses than this one".to_owned()),
    };
    let sentence = format!(
        "the {setting} is too large: {error}; a smaller one, or --accuracy, gives better ones"
    );
    Some(Note::new("setting_too_coarse", sentence).with("error", worst))
}

/// The note on a run at a `tolerance` (1) below the `accuracy` (1).
fn shorter_steps(tolerance: f64, accuracy: f64) -> Option<Note> {
    (tolerance < accuracy).then(|| {
        let sentence = format!(
            "steps are chosen for an accuracy of {tolerance:.0e}: with longer ones the error estimate exceeded the accuracy asked for, or the energy error a tenth of the energy in motion"
        );
        Note::new("shorter_steps", sentence).with("steps_for", tolerance)
    })
}

/// The note on an estimate that is missing, or above the `accuracy` (1) asked for.
pub fn doubt(estimate: Option<&ErrorEstimate>, accuracy: f64) -> Option<Note> {
    let Some(estimate) = estimate else {
        let sentence = "no error estimate: the reference run detects different pulses, or pulses below its own error";
        return Some(Note::new("no_error_estimate", sentence));
    };
    let worst = estimate.worst();
    (worst > accuracy).then(|| {
        let sentence = format!(
            "readings may be off by {worst:.1e}, more than the accuracy of {accuracy:.1e} that was asked for"
        );
        Note::new("accuracy_missed", sentence).with("error", worst).with("accuracy", accuracy)
    })
}
