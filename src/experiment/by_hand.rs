//! Runs with a step or a tolerance by hand: nothing holds them to an accuracy, so what they are off is found out and told.

use super::accuracy::{ErrorEstimate, estimate, known_until};
use super::error::rounded_down;
use super::{Integration, Outcome, RunError, reference_tolerance, run};
use crate::integrate::Method;
use crate::quantity::engineering;
use crate::scene::{Scene, TIGHTEST_ACCURACY};

/// Readings that are off by more are not taken for what the bench would show without a word (1).
const TOLERABLE: f64 = 0.01;
/// The first run that one by hand is held against is tighter than this (1).
const FIRST: f64 = 0.01;
/// The next is so much tighter, where the first could not tell (1).
const NEXT: f64 = 1e-4;
/// An estimate that exceeds what it adds for the second run by this factor is of the first (1).
const TELLING: f64 = 10.0;
/// Two estimates of the same run agree where the later one is at least this share of the one before (1).
const AGREE: f64 = 0.5;
/// Settings that are tried for advice. Steps: half of the one that does not do, or a quarter of the longest stable one, and halves from there on.
const TRIES: i32 = 6;
/// Tolerances: each so many times the one before (1).
const TIGHTER_BY: f64 = 0.1;
/// Contact forces that finding advice may take: seconds (1).
const MOST_FORCES: f64 = 1e9;

/// Runs `scene` by `method`, with its setting by hand, error estimate included; notes tell where readings are far off, where the method has made
/// energy, and how far ahead the motion is known.
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
    // Nobody has asked for the accuracy that second runs go by.
    let told = told(own, &outcome)
        .map(|found| found.map(|found| ErrorEstimate { trace_holds_s: None, ..found }));
    let summary = &mut outcome.summary;
    let found = match told {
        Ok(found) => found,
        Err(error) => {
            // This run came to its end: what it has found is not thrown away.
            summary.notes.push(format!("how far off readings are is not known: {error}"));
            return Ok(outcome);
        }
    };
    let worst = found.as_ref().map_or(f64::INFINITY, ErrorEstimate::worst);
    if worst > TOLERABLE {
        let far = match found {
            Some(_) => format!("readings may be off by {worst:.1e}"),
            None => "an accurate run feels other pulses than this one".to_owned(),
        };
        let advice = advice(own, method).map_or(String::new(), |advice| format!("; {advice}"));
        summary.notes.push(format!("{}: {far}{advice}", too_much(method)));
    } else {
        // That of a motion as accurate as this one.
        let accuracy = worst.max(TIGHTEST_ACCURACY);
        let accurate = run(own, Integration::Accuracy(accuracy), 1, &mut |_| ());
        let changes = accurate.ok().map(|accurate| accurate.summary.contact_changes);
        if let Some(time) = changes.and_then(|changes| known_until(own, accuracy, changes)) {
            summary.note_horizon(time, accuracy);
        }
    }
    summary.note_energy(too_much(method));
    summary.error_estimate = found.filter(|_| summary.has_pulse());
    Ok(outcome)
}

/// How far off the run is of which `summary` tells, by ever tighter second runs until two in turn say the same: one that is itself off by
/// more than it should be would be taken for the first run's fault.
fn told(scene: &Scene, outcome: &Outcome) -> Result<Option<ErrorEstimate>, RunError> {
    let (mut accuracy, mut before) = (FIRST, f64::INFINITY);
    loop {
        let found = estimate(scene, accuracy, outcome)?;
        let worst = found.as_ref().map_or(f64::INFINITY, ErrorEstimate::worst);
        let tells = worst > TELLING * reference_tolerance(accuracy) && worst > AGREE * before;
        if accuracy <= TIGHTEST_ACCURACY || tells {
            return Ok(found);
        }
        before = worst;
        accuracy = (NEXT * accuracy).max(TIGHTEST_ACCURACY);
    }
}

/// What is wrong with a setting, in words.
fn too_much(method: Method) -> &'static str {
    if method.fixed_step().is_some() {
        "the step is too long"
    } else {
        "the tolerance is too loose"
    }
}

/// A step or a tolerance with which `method` would read `scene` well, in words; none where none was found in reasonable time.
pub fn advice(scene: &Scene, method: Method) -> Option<String> {
    let Some((step, reach)) = method.fixed_step() else {
        let tighter = (1..=TRIES).map(|tries| TIGHTER_BY.powi(tries));
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
    (0..TRIES).find_map(|halvings| {
        let step = rounded_down(longest * 0.5_f64.powi(halvings), 2);
        let steps = scene.duration / step * f64::from(method.stages());
        #[allow(clippy::cast_precision_loss, reason = "far fewer than 2^53 contacts")]
        let contacts = scene.chain.contacts().len() as f64;
        if steps * contacts > MOST_FORCES {
            return None;
        }
        let words = reads_within(scene, with_setting(method, step))?;
        Some(format!("a step of {} {words}", engineering(step, "s", 2)))
    })
}

/// How well `method` reads `scene`, in words, if it does.
fn reads_within(scene: &Scene, method: Method) -> Option<String> {
    let found = run(scene, Integration::Method(method), 1, &mut |_| ()).ok()?;
    let worst = estimate(scene, FIRST, &found).ok()??.worst();
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
