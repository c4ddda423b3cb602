//! Runs with a step or a tolerance by hand: nothing limits their errors, so these are estimated and
//! noted.

use super::accuracy::known_until;
use super::error::rounded_down;
use super::outcome::{Assessment, ErrorEstimate};
use super::reference::{REFERENCE_MARGIN, estimate, reference_tolerance};
use super::{Integration, Outcome, RunError, run};
use crate::integrate::Method;
use crate::note::Note;
use crate::quantity::engineering;
use crate::scene::{Scene, TIGHTEST_ACCURACY};

/// Readings with larger errors are noted (1).
const TOLERABLE: f64 = 0.01;
/// Accuracies of the reference runs, until an estimate is clearly above what the reference run adds
/// to it (1).
const REFERENCE_ACCURACIES: [f64; 3] = [0.01, 1e-6, TIGHTEST_ACCURACY];
/// A reference run whose own error is less than the estimate by this factor changes it by a
/// hundredth at most (1).
const CLEAR_FACTOR: f64 = 100.0;
/// Settings that are tried for advice. Steps: half of the one that does not do, or a quarter of the
/// longest stable one, and halves from there on.
const MAX_SETTINGS: i32 = 6;
/// Tolerances: each so many times the one before (1).
const TIGHTENING: f64 = 0.1;
/// Contact forces that finding advice may take: seconds (1).
const MAX_CONTACT_FORCES: f64 = 1e9;

/// Runs `scene` by `method`, with its setting by hand, error estimate included; notes say where
/// readings are far off, where the method has made energy, and up to when the motion is known.
///
/// # Errors
/// Those of [`run`](fn@run).
pub fn run_by_hand(
    scene: &Scene,
    method: Method,
    shot: u32,
    progress: &mut dyn FnMut(f64),
) -> Result<Outcome, RunError> {
    let mut outcome = run(scene, Integration::Method(method), shot, progress)?;
    let own = &*scene.of_shot(shot);
    let found = estimate_by_hand(own, &outcome);
    let found = match found {
        Ok(found) => found,
        Err(error) => {
            // This run came to its end: its readings are kept.
            let sentence = format!("no error estimate: {error}");
            outcome.summary.notes.push(Note::new("no_error_estimate", sentence));
            return Ok(outcome);
        }
    };
    let worst = found.as_ref().map_or(f64::INFINITY, ErrorEstimate::worst);
    let (mut notes, mut chaotic) = (Vec::new(), None);
    if worst > TOLERABLE {
        let far = match found {
            Some(_) => format!("readings may be off by {worst:.1e}"),
            None => "an accurate run detects other pulses than this one".to_owned(),
        };
        let advice = advice(own, method).map_or(String::new(), |advice| format!("; {advice}"));
        let note = Note::new("setting_too_coarse", format!("{}: {far}{advice}", too_much(method)));
        notes.push(note.with("error", worst));
    } else {
        // That of a motion as accurate as this one.
        let accuracy = worst.max(TIGHTEST_ACCURACY);
        let accurate = run(own, Integration::Accuracy(accuracy), 1, &mut |_| ());
        let changes = accurate.ok().map(|accurate| accurate.summary.contact_changes);
        let from = changes.and_then(|changes| known_until(own, accuracy, changes));
        chaotic = from.map(|time| (time, accuracy));
    }
    outcome.summary.assess(Assessment {
        estimate: found,
        notes,
        energy_advice: too_much(method),
        chaotic,
        wall_held_s: None,
    });
    Ok(outcome)
}

/// The error estimate of the run, from ever tighter reference runs until one has clearly smaller
/// errors.
fn estimate_by_hand(scene: &Scene, outcome: &Outcome) -> Result<Option<ErrorEstimate>, RunError> {
    let mut found = None;
    for accuracy in REFERENCE_ACCURACIES {
        found = estimate(scene, accuracy, outcome)?;
        let of_reference = REFERENCE_MARGIN * reference_tolerance(accuracy);
        if found.as_ref().is_some_and(|found| found.worst() > CLEAR_FACTOR * of_reference) {
            break;
        }
    }
    // No accuracy was asked for up to which traces could hold.
    Ok(found.map(|found| ErrorEstimate { trace_holds_s: None, ..found }))
}

/// What is wrong with a setting, in words.
fn too_much(method: Method) -> &'static str {
    if method.fixed_step().is_some() {
        "the step is too long"
    } else {
        "the tolerance is too loose"
    }
}

/// A step or a tolerance with which `method` would read `scene` well, in words; none where none was
/// found in reasonable time.
pub fn advice(scene: &Scene, method: Method) -> Option<String> {
    let Some((step, reach)) = method.fixed_step() else {
        let tighter = (1..=MAX_SETTINGS).map(|tries| TIGHTENING.powi(tries));
        // What is named is what was tried.
        let tolerances =
            tighter.filter_map(|share| Some(rounded_down(share * method.tolerance()?, 1)));
        return tolerances.filter(|tolerance| *tolerance >= TIGHTEST_ACCURACY).find_map(
            |setting| {
                let words = reads_within(scene, with_setting(method, setting))?;
                Some(format!("a tolerance of {setting:.0e} {words}"))
            },
        );
    };
    let limit = scene.chain.stability_limit(&scene.initial_velocities, reach)?;
    let longest = 0.5 * step.min(0.5 * limit.step);
    (0..MAX_SETTINGS).find_map(|halvings| {
        let step = rounded_down(longest * 0.5_f64.powi(halvings), 2);
        let steps = scene.duration / step * f64::from(method.stages());
        let contacts = scene.chain.contacts().len() as f64;
        if steps * contacts > MAX_CONTACT_FORCES {
            return None;
        }
        let words = reads_within(scene, with_setting(method, step))?;
        Some(format!("a step of {} {words}", engineering(step, "s", 2)))
    })
}

/// How well `method` reads `scene`, in words, if it does.
fn reads_within(scene: &Scene, method: Method) -> Option<String> {
    let found = run(scene, Integration::Method(method), 1, &mut |_| ()).ok()?;
    let worst = estimate(scene, TOLERABLE, &found).ok()??.worst();
    let words = || {
        let worst = -rounded_down(-worst, 2);
        format!("reads first peaks and arrivals within {worst:.1e}")
    };
    (worst <= TOLERABLE).then(words)
}

/// Up to where steps of `method` could be stable, in words, for one that was not.
pub fn edge(scene: &Scene, method: Method) -> Option<String> {
    let (_, reach) = method.fixed_step()?;
    let limit = scene.chain.stability_limit(&scene.initial_velocities, reach)?;
    Some(format!(
        "the contact between {} and {} limits steps to {} where it is pressed as the impact presses it, and to less beyond",
        limit.upper,
        limit.lower,
        engineering(limit.step, "s", 3)
    ))
}

/// `method` with another step (s), or another tolerance (1).
fn with_setting(method: Method, setting: f64) -> Method {
    let (step, tolerance) = (setting, setting);
    match method {
        Method::VelocityVerlet { .. } => Method::VelocityVerlet { step },
        Method::ForceGradient { .. } => Method::ForceGradient { step },
        Method::TwoStepForceGradient { .. } => Method::TwoStepForceGradient { tolerance },
        Method::RungeKutta4 { .. } => Method::RungeKutta4 { step },
        Method::DormandElMikkawyPrince86 { .. } => Method::DormandElMikkawyPrince86 { tolerance },
        Method::DormandPrince54 { .. } => Method::DormandPrince54 { tolerance },
        Method::DormandPrince853 { .. } => Method::DormandPrince853 { tolerance },
        Method::Rodas { .. } => Method::Rodas { tolerance },
    }
}
