//! The points of the study: every method over its settings, and what `--accuracy` comes to.

use std::time::{Duration, Instant};

use super::{ChosenMethod, Point, Reference};
use crate::chain::simd::Refinement;
use crate::experiment::accuracy::run_to_accuracy;
use crate::experiment::comparison::{
    Run, Treated, arrival_error, compare, peak_error, run_without, trace_error, worst,
};
use crate::experiment::outcome::ErrorEstimate;
use crate::experiment::reference::errors;
use crate::experiment::{Integration, RunError, method};
use crate::integrate::{IntegrateError, Method, Scheme};
use crate::scene::Scene;

/// Runs of an accuracy are not repeated for longer than this: the study takes seconds.
const TIMING_BUDGET: Duration = Duration::from_millis(300);
/// Points that would take more force evaluations than this are left out: the study is for a coffee
/// break, not for lunch.
const MOST_EVALUATIONS: f64 = 60_000.0;
/// A point under error control that takes more is given up; the lossless methods take shorter.
const MOST_CONTROLLED: u64 = 120_000;
const MOST_OWN: u64 = 1_000_000;
/// Most evaluations of a reference run.
const MOST_REFERENCE: u64 = 2_000_000;
/// Tolerance of the reference's steps (1).
const REFERENCE_TOLERANCE: f64 = 1e-15;
/// The same where losses are so stiff that only the implicit method comes to an end (1).
const STIFF_TOLERANCE: f64 = 1e-12;
/// Name of the pair without the correction at contact opening and closing.
const UNCORRECTED: &str = "dormand-el-mikkawy-prince-86, uncorrected";
/// An error above this is no result (1).
const FAILED: f64 = 1.0;

/// The method's name; the pair without the correction at contact opening and closing has one of its
/// own.
pub fn name((method, without): Treated) -> &'static str {
    match (without, method) {
        (Some(_), Method::DormandElMikkawyPrince86 { .. }) => UNCORRECTED,
        _ => method.name(),
    }
}

type Make = fn(f64) -> Method;

/// Methods of fixed steps.
const FIXED: [Make; 3] = [
    |step| Method::VelocityVerlet { step },
    |step| Method::ForceGradient { step },
    |step| Method::RungeKutta4 { step },
];
/// Methods that choose their steps.
const ADAPTIVE: [Make; 5] = [
    |tolerance| Method::TwoStepForceGradient { tolerance },
    |tolerance| Method::DormandElMikkawyPrince86 { tolerance },
    |tolerance| Method::DormandPrince54 { tolerance },
    |tolerance| Method::DormandPrince853 { tolerance },
    |tolerance| Method::Rodas { tolerance },
];

/// Every method over its range: steps from the edge of stability down, tolerances from coarse to
/// tight.
pub fn settings(scene: &Scene) -> Vec<Treated> {
    let (fixed, adaptive) = (FIXED, ADAPTIVE);
    let suits = |method: Method| method.suits(scene.chain.is_dissipative());
    let mut settings = Vec::new();
    for make in fixed.into_iter().filter(|make| suits(make(1.0))) {
        let (_, reach) = make(1.0).fixed_step().unwrap_or((1.0, 2.0));
        let velocities = &scene.initial_velocities;
        let elastic = scene.chain.stability_limit(velocities, reach);
        let decay = make(1.0).decay_reach();
        let lossy = decay.and_then(|reach| scene.chain.decay_limit(velocities, reach));
        let limit = [elastic, lossy].into_iter().flatten().map(|limit| limit.step).reduce(f64::min);
        // From twice the limit, so that the edge is seen, in factors of two.
        let mut step = limit.map_or(1e-6, |limit| 2.0 * limit);
        let stages = f64::from(make(step).stages());
        while scene.duration / step * stages <= MOST_EVALUATIONS {
            settings.push((make(step), None));
            step *= 0.5;
        }
    }
    for make in adaptive.into_iter().filter(|make| suits(make(1.0))) {
        let range = || (1..=13).map(|decade| make(10f64.powi(-decade)));
        settings.extend(range().map(|method| (method, None)));
        if let Some(Scheme::Nystrom(_)) = make(1.0).scheme() {
            settings.extend(range().map(|method| (method, Some(Refinement::OpeningCorrection))));
        }
    }
    settings
}

fn setting(method: Method) -> f64 {
    method.fixed_step().map_or_else(|| method.tolerance().unwrap_or(0.0), |(step, _)| step)
}

impl Point {
    /// Nothing found: in as many evaluations of all contact forces as fixed steps take, in
    /// `evaluations` otherwise.
    pub(super) fn failed(scene: &Scene, treated: Treated, evaluations: u64) -> Self {
        let (method, _) = treated;
        let all = |(step, _): (f64, f64)| {
            (scene.duration / step).ceil() as u64 * u64::from(method.stages())
        };
        Self {
            method: name(treated),
            source: method.source(),
            order: method.order(),
            setting: setting(method),
            failed: true,
            given_up: false,
            error_peak: None,
            error_arrival: None,
            error_trace: None,
            error_energy: None,
            force_evaluations: method.fixed_step().map_or(evaluations, all),
            wall_s_median: 0.0,
            wall_s_min: 0.0,
        }
    }
}

/// A method at one setting, held against `exact`; so many `runs` are timed.
pub fn point(scene: &Scene, treated: Treated, exact: &Run, runs: u16) -> Point {
    let own = treated.0.scheme().is_some() && scene.chain.is_plain();
    let most = if own { MOST_OWN } else { MOST_CONTROLLED };
    let mut point = Point::failed(scene, treated, 0);
    let run = || run_without(scene, treated, most);
    let found = match run() {
        Ok(found) => found,
        Err(error) => {
            if matches!(error, IntegrateError::TooMuchWork { .. }) {
                (point.given_up, point.force_evaluations) = (true, most);
            }
            return point;
        }
    };
    let mut walls = vec![found.wall_s];
    walls.extend((1..runs).filter_map(|_| run().ok()).map(|r| r.wall_s));
    walls.sort_by(f64::total_cmp);
    point.wall_s_min = walls.first().copied().unwrap_or(0.0);
    point.wall_s_median = walls.get(walls.len() / 2).copied().unwrap_or(0.0);
    point.force_evaluations = found.work.force_evaluations;
    point.error_peak = compare(&found, exact, peak_error);
    point.error_arrival = compare(&found, exact, arrival_error);
    point.error_trace = trace_error(&found, exact, scene.sensors.len());
    point.error_energy = Some(found.energy.drift.abs());
    let worst = [point.error_peak, point.error_arrival];
    let refused = method(scene, Integration::Method(treated.0)).is_err();
    point.failed = refused || !worst.iter().all(|error| error.is_some_and(|e| e < FAILED));
    point
}

/// Result of `--accuracy`: the complete run, with its check runs, so many times or as often as
/// [`TIMING_BUDGET`] allows.
///
/// # Errors
/// [`RunError`] where the scene cannot be run.
pub fn choice(
    scene: &Scene,
    accuracy: f64,
    exact: &Run,
    runs: u16,
) -> Result<ChosenMethod, RunError> {
    let started = Instant::now();
    let outcome = run_to_accuracy(scene, accuracy, 1, &mut |_| ())?;
    let summary = &outcome.summary;
    let mut walls = vec![[summary.wall_s, summary.wall_held_s.unwrap_or(summary.wall_s)]];
    while walls.len() < usize::from(runs) && started.elapsed() < TIMING_BUDGET {
        let again = run_to_accuracy(scene, accuracy, 1, &mut |_| ())?.summary;
        walls.push([again.wall_s, again.wall_held_s.unwrap_or(again.wall_s)]);
    }
    let sorted = |which: usize| {
        let mut values: Vec<f64> = walls.iter().map(|wall| wall[which]).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let (alone, held) = (sorted(0), sorted(1));
    let wall_s_median = alone[alone.len() / 2];
    let errors = errors(scene, exact, &outcome);
    Ok(ChosenMethod {
        accuracy,
        method: method_name(&summary.method),
        setting: summary.step_s.or(summary.tolerance).unwrap_or(0.0),
        error: errors.as_ref().map(ErrorEstimate::worst),
        error_peak: errors.as_ref().map(|errors| errors.peak),
        error_arrival: errors.as_ref().map(|errors| errors.arrival),
        error_trace: errors.and_then(|errors| errors.trace),
        error_energy: Some(summary.energy.drift.abs()),
        force_evaluations: summary.force_evaluations,
        wall_s_median,
        wall_s_min: alone[0],
        wall_held_s_median: held[held.len() / 2],
        simulated_over_wall: summary.simulated_s / wall_s_median,
    })
}

/// The name as the table of marks has it.
fn method_name(name: &str) -> &'static str {
    let mut all = FIXED.iter().chain(&ADAPTIVE).map(|make| make(1.0).name());
    all.find(|known| *known == name).unwrap_or("another method")
}

/// The reference, and what it says of itself. With losses it is by neither of the methods that
/// `--accuracy` goes by, unless the one of order 5 takes too much.
///
/// # Errors
/// The integrator's error where no two methods come to an end, in words.
pub fn reference(scene: &Scene) -> Result<(Run, Reference), String> {
    let tolerance = REFERENCE_TOLERANCE;
    let methods = if scene.chain.is_dissipative() {
        vec![
            Method::DormandPrince54 { tolerance },
            Method::DormandPrince853 { tolerance },
            Method::Rodas { tolerance: STIFF_TOLERANCE },
            Method::Rodas { tolerance: 10.0 * STIFF_TOLERANCE },
        ]
    } else {
        vec![Method::DormandPrince853 { tolerance }, Method::DormandElMikkawyPrince86 { tolerance }]
    };
    let mut last = None;
    let mut found = methods.into_iter().filter_map(|method| {
        match run_without(scene, (method, None), MOST_REFERENCE) {
            Ok(run) => Some((run, method.to_string())),
            Err(error) => {
                last = Some(error);
                None
            }
        }
    });
    if let (Some((exact, method)), Some((other, second))) = (found.next(), found.next()) {
        return match worst(&other, &exact) {
            Some(error) => {
                let error_trace = trace_error(&other, &exact, usize::MAX).unwrap_or(0.0);
                Ok((exact, Reference { method, second, error, error_trace }))
            }
            None => Err(format!("{method} and {second} find different pulses")),
        };
    }
    Err(last.map_or(String::new(), |error| error.to_string()))
}
