//! Which accuracy a run is held to where nobody names one, and how far off what the user reads may
//! be.

use std::cell::{Cell, LazyCell};
use std::time::Instant;

use super::comparison::{level_of, readings};
use super::horizon::horizon;
use super::method_choice::{Attempt, controlled, first_attempt_at, first_controlled};
use super::outcome::MOST;
use super::outcome::{Assessment, ErrorEstimate};
use super::reference::{MIN_TOLERANCE, ReferenceRun, reference_tolerance};
use super::{Integration, Outcome, RunError, method, run};
use crate::integrate::{IntegrateError, Method};
use crate::note::Note;
use crate::quantity::engineering;
use crate::scene::{DEFAULT_ACCURACY, LOOSEST_ACCURACY, Scene, TIGHTEST_ACCURACY};

/// Accuracy of the run that finds out how large peaks are and when they come (1).
const COARSE: f64 = 1e-3;
/// Share of a digitiser level and of a sample interval that may be wrong where nobody names an
/// accuracy (1).
const SHARE: f64 = 0.1;
/// A run is repeated with tighter steps as often as this has entries. Errors go about as the
/// tolerance does; steps aim at this share of what is allowed, the last ones so that little is left
/// to chance (1).
const AIMS: [f64; 2] = [0.3, 0.05];
/// Where it is not known by how much errors are too large, steps are made for this share (1).
const UNKNOWN_ERROR_SHARE: f64 = 0.02;

/// An accuracy and where it is from.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenAccuracy {
    /// Relative error of first-peak forces and times (1).
    pub value: f64,
    /// Why this one.
    pub reason: String,
}

/// The accuracy that the scope calls for: a tenth of a digitiser level of the most sensitive
/// channel in first peaks, a tenth of a sample interval in arrivals, whichever is less; both follow
/// from a coarse run. Without a pulse it is [`DEFAULT_ACCURACY`].
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
        Some(value) => Ok(ChosenAccuracy { value, reason: "from the scene".to_owned() }),
        None => of_scope(scene),
    }
}

/// Runs `scene` so that first peaks and arrivals are as accurate as asked (1), by the error
/// estimate: a run is compared with a tighter reference run, and repeated with tighter steps, twice
/// at most, where its errors may exceed the accuracy, those of traces `sqrt(accuracy)` before the
/// time from which they are said to be chaotic, or where it has made or lost more than [`MOST`] of
/// the energy in motion. What the last run lacks is noted. `progress` is called with the share of
/// the work done, 0 to 1: the first run counts as half of it, the next as half of the rest, and so
/// on.
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
    let remaining = Cell::new(1.0);
    let next = || remaining.set(0.5 * remaining.get());
    let mut progress = |share: f64| progress(1.0 - remaining.get() * (2.0 - share));
    let mut attempt = first_attempt_at(own, accuracy);
    let mut aims = AIMS.into_iter();
    let mut reference: Option<ReferenceRun> = None;
    let mut makes_energy = false;
    loop {
        next();
        let Attempt { method, steps } = attempt;
        let has_two_lengths = matches!(method, Method::TwoStepForceGradient { .. });
        let is_last = !has_two_lengths && (aims.len() == 0 || steps <= MIN_TOLERANCE);
        let mut outcome =
            match run(scene, Integration::Attempt { method, accuracy }, shot, &mut progress) {
                Err(RunError::Integrate(IntegrateError::NotFinite { .. })) if has_two_lengths => {
                    attempt = first_controlled(own, accuracy);
                    continue;
                }
                found => found?,
            };
        let keeps_energy = outcome.summary.energy.is_kept(MOST);
        makes_energy |= !keeps_energy;
        let (mut estimate, mut share) = (None, UNKNOWN_ERROR_SHARE);
        let changes = outcome.summary.contact_changes;
        let chaotic_from = LazyCell::new(|| known_until(own, steps, changes));
        if keeps_energy || is_last {
            let tolerance = reference_tolerance(steps.min(accuracy));
            let against = match reference.take() {
                Some(reference) if reference.tolerance <= tolerance => reference,
                _ => {
                    next();
                    ReferenceRun::run(own, tolerance, shot, &mut progress)?
                }
            };
            estimate = reference.insert(against).compare(&outcome, accuracy);
            if let Some(estimate) = &estimate {
                share = accuracy / estimate.worst();
                let of_traces = accuracy.sqrt() / estimate.trace.unwrap_or(0.0);
                if of_traces < share.min(1.0) && chaotic_from.is_none() {
                    share = of_traces;
                }
            }
        }
        if share < 1.0 && !is_last {
            attempt = if has_two_lengths {
                first_controlled(own, accuracy)
            } else {
                let aim = aims.next().unwrap_or(1.0);
                controlled(own, (aim * share * steps).max(MIN_TOLERANCE))
            };
            continue;
        }
        let mut notes = Vec::new();
        if steps < accuracy {
            let why = if makes_energy {
                "longer ones made or lost more than a tenth of the kinetic energy"
            } else {
                "with longer ones the error estimate was above the accuracy asked for, or above its square root in the traces"
            };
            let sentence = format!("steps are chosen for an accuracy of {steps:.0e}: {why}");
            notes.push(Note::new("shorter_steps", sentence).with("steps_for", steps));
        }
        notes.extend(doubt(estimate.as_ref(), accuracy));
        outcome.summary.assess(Assessment {
            estimate,
            notes,
            energy_advice: "a tighter accuracy keeps it better",
            chaotic: chaotic_from.map(|time| (time, steps)),
            wall_held_s: Some(started.elapsed().as_secs_f64()),
        });
        return Ok(outcome);
    }
}

/// From when on the motion of `scene` at `accuracy` (1) is not known to half of its digits, where
/// contacts may have changed sides: others amplify no errors (s).
pub(crate) fn known_until(scene: &Scene, accuracy: f64, changes: Option<u64>) -> Option<f64> {
    let amplifies = changes != Some(0) && !scene.chain.is_linear();
    // A motion that cannot be computed has been refused already.
    amplifies.then(|| {
        horizon(&scene.chain, &scene.initial_velocities, scene.duration, accuracy).ok()
    })??
}

/// The note on an estimate that is missing, or beyond the `accuracy` (1) that was asked for.
pub fn doubt(estimate: Option<&ErrorEstimate>, accuracy: f64) -> Option<Note> {
    let Some(estimate) = estimate else {
        let sentence = "no error estimate: the reference run detects different pulses, or pulses below its own error";
        return Some(Note::new("no_error_estimate", sentence));
    };
    let worst = estimate.worst();
    (worst > accuracy).then(|| {
        let sentence = format!("readings may be off by {worst:.1e}, more than the accuracy of {accuracy:.1e} that was asked for");
        Note::new("accuracy_missed", sentence).with("error", worst).with("accuracy", accuracy)
    })
}
