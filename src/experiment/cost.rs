//! The work-precision study of a scene: what accuracy costs.
//!
//! Every method runs over its range of settings; its first peaks, arrivals and traces are held against a reference from
//! another family of methods, which carries its own error bar: the difference to a second tight solution. Force evaluations
//! are exact; wall times are informative, median and minimum of several runs.

use serde::Serialize;

use super::accuracy::{OWN, TIGHTER, steps_tried};
use super::comparison::{
    Run, arrival_error, compare, level, peak_error, run, run_without, trace_error, worst,
};
use super::{Integration, method};
use crate::chain::stepper::Refinement;
use crate::integrate::{Method, Scheme};
use crate::scene::Scene;

/// Runs of each point that are timed where nobody says otherwise.
pub const TIMED_RUNS: u16 = 10;
/// Points that would take more force evaluations than this are left out: the study is for a coffee break, not for lunch.
const MOST_EVALUATIONS: f64 = 60_000.0;
/// Tolerance of the reference's steps (1).
const REFERENCE_TOLERANCE: f64 = 1e-15;
/// Names of the pairs without what is done about contacts that open and close.
const UNTREATED: [&str; 2] = [
    "dormand-el-mikkawy-prince-64, kinks as they are",
    "dormand-el-mikkawy-prince-86, kinks as they are",
];
/// An error above this is no result (1).
const FAILED: f64 = 1.0;
/// Orders are fitted where errors lie above this multiple of the reference's own error (1).
const ABOVE_REFERENCE: f64 = 100.0;

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    /// Scene name.
    pub scene: String,
    /// What errors are measured against.
    pub reference: Reference,
    /// One row a method and setting.
    pub points: Vec<Point>,
    /// Observed order of each method on this scene, kinks and all.
    pub orders: Vec<Order>,
    /// What `--accuracy` chooses at each decade, and what it reaches.
    pub chosen: Vec<Chosen>,
    /// One digitiser level of the most sensitive channel, relative to its first peak; none without a wired sensor (1).
    pub level: Option<f64>,
    /// The scope's sample interval, relative to the earliest arrival compared (1).
    pub sample: f64,
}

/// The reference solution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reference {
    /// Its method and setting.
    pub method: String,
    /// Its distance from a second tight solution by another method: largest relative difference of peaks and arrivals (1).
    pub error: f64,
}

/// One method at one setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Method name.
    pub method: &'static str,
    /// Order on smooth problems.
    #[serde(skip)]
    pub order: u8,
    /// Step (s) of a fixed-step method, tolerance (1) of an adaptive one (unit).
    pub setting: f64,
    /// Whether the run stopped, lost its first peaks, or was more than 100 % off.
    pub failed: bool,
    /// Largest relative error of first-peak dynamic forces (1).
    pub error_peak: Option<f64>,
    /// Largest relative error of first-peak times and half-rises (1).
    pub error_arrival: Option<f64>,
    /// Largest deviation of any sensor's force at the scope's sample times, relative to its largest (1).
    pub error_trace: Option<f64>,
    /// Energy drift relative to the energy of the impact (1).
    pub error_energy: Option<f64>,
    /// Evaluations of all contact forces.
    pub force_evaluations: u64,
    /// Median wall time (s).
    pub wall_s_median: f64,
    /// Shortest wall time (s).
    pub wall_s_min: f64,
}

/// Observed order of convergence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Order {
    /// Method name.
    pub method: &'static str,
    /// Order on smooth problems.
    pub nominal: u8,
    /// Exponent of peak error against force evaluations, by least squares; none with fewer than three points (1).
    pub observed: Option<f64>,
}

/// What an accuracy leads to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Chosen {
    /// Accuracy asked for (1).
    pub accuracy: f64,
    /// Method that was chosen.
    pub method: &'static str,
    /// Its setting (unit).
    pub setting: f64,
    /// Largest relative error of peaks and arrivals (1).
    pub error: Option<f64>,
    /// Evaluations of all contact forces.
    pub force_evaluations: u64,
}

/// Makes the study with `runs` timed runs of each point; `progress` hears the share of the work done.
///
/// # Errors
/// The integrator's error where even the reference fails, in words.
pub fn study(scene: &Scene, runs: u16, progress: &mut dyn FnMut(f64)) -> Result<Study, String> {
    let reference = Method::DormandPrince853 { tolerance: REFERENCE_TOLERANCE };
    let second = if scene.chain.is_dissipative() {
        Method::DormandPrince54 { tolerance: REFERENCE_TOLERANCE }
    } else {
        Method::DormandElMikkawyPrince86 { tolerance: REFERENCE_TOLERANCE }
    };
    let exact = run(scene, reference)?;
    if exact.readings.iter().all(|reading| reading.first_peak.is_none()) {
        return Err("no sensor and no wall felt a pulse that could be compared".to_owned());
    }
    let error = worst(&run(scene, second)?, &exact).unwrap_or(f64::NAN);
    let settings = settings(scene);
    let all = settings.len() + decades().count();
    #[allow(clippy::cast_precision_loss, reason = "a few dozen points")]
    let mut report = |done: usize| progress(done as f64 / all as f64);
    let mut points = Vec::new();
    for (done, treated) in settings.iter().enumerate() {
        report(done);
        points.push(point(scene, *treated, (&exact, runs)));
    }
    let mut chosen = Vec::new();
    for (done, accuracy) in decades().enumerate() {
        report(settings.len() + done);
        chosen.extend(choice(scene, accuracy, &exact));
    }
    let earliest = exact.readings.iter().filter_map(|r| r.half_rise_s).fold(f64::MAX, f64::min);
    Ok(Study {
        scene: scene.name.clone(),
        reference: Reference { method: reference.to_string(), error },
        orders: orders(&points, error),
        points,
        chosen,
        level: level(scene, &exact),
        sample: scene.scope.model.sample_interval(scene.scope.time_base) / earliest,
    })
}

/// Accuracies at which the choice is shown (1).
fn decades() -> impl Iterator<Item = f64> {
    (1..=11).map(|decade| 10f64.powi(-decade))
}

/// A method at one setting, as it is or without what the stepper does about contacts that open and close.
type Treated = (Method, Option<Refinement>);

/// What stands behind the name of a method whose kinks are left as they are; those that are treated in no way have no such second row.
fn name(method: Method, without: Option<Refinement>) -> &'static str {
    match (without, method) {
        (Some(_), Method::DormandElMikkawyPrince64 { .. }) => UNTREATED[0],
        (Some(_), Method::DormandElMikkawyPrince86 { .. }) => UNTREATED[1],
        _ => method.name(),
    }
}

/// Every method over its range: steps from the edge of stability down, tolerances from coarse to tight.
fn settings(scene: &Scene) -> Vec<Treated> {
    type Make = fn(f64) -> Method;
    let fixed: [Make; 5] = [
        |step| Method::VelocityVerlet { step },
        |step| Method::Pefrl { step },
        |step| Method::BlanesMoan { step },
        |step| Method::ForceGradient { step },
        |step| Method::RungeKutta4 { step },
    ];
    let adaptive: [Make; 5] = [
        |tolerance| Method::DormandElMikkawyPrince64 { tolerance },
        |tolerance| Method::DormandElMikkawyPrince86 { tolerance },
        |tolerance| Method::DormandPrince54 { tolerance },
        |tolerance| Method::DormandPrince853 { tolerance },
        |tolerance| Method::Rodas { tolerance },
    ];
    let suits = |method: Method| method.suits(scene.chain.is_dissipative());
    let mut settings = Vec::new();
    for make in fixed.into_iter().filter(|make| suits(make(1.0))) {
        let (_, reach) = make(1.0).fixed_step().unwrap_or((1.0, 2.0));
        let limit = scene.chain.stability_limit(&scene.initial_velocities, reach);
        // From twice the limit, so that the edge is seen, in factors of two.
        let mut step = limit.map_or(1e-6, |limit| 2.0 * limit.step);
        let stages = f64::from(make(step).stages());
        while scene.duration / step * stages <= MOST_EVALUATIONS {
            settings.push((make(step), None));
            step *= 0.5;
        }
    }
    for make in adaptive.into_iter().filter(|make| suits(make(1.0))) {
        let range = || (1..=13).map(|decade| make(10f64.powi(-decade)));
        settings.extend(range().map(|method| (method, None)));
        if let Some(Scheme::Pair(..)) = make(1.0).scheme() {
            settings.extend(range().map(|method| (method, Some(Refinement::KinkCorrection))));
        }
    }
    settings
}

fn setting(method: Method) -> f64 {
    method.fixed_step().map_or_else(|| method.tolerance().unwrap_or(0.0), |(step, _)| step)
}

fn point(scene: &Scene, (method, without): Treated, (exact, runs): (&Run, u16)) -> Point {
    let mut point = Point {
        method: name(method, without),
        order: method.order(),
        setting: setting(method),
        failed: true,
        error_peak: None,
        error_arrival: None,
        error_trace: None,
        error_energy: None,
        force_evaluations: 0,
        wall_s_median: 0.0,
        wall_s_min: 0.0,
    };
    let run = || run_without(scene, method, without);
    let Ok(found) = run() else { return point };
    let mut walls = vec![found.wall_s];
    walls.extend((1..runs).filter_map(|_| run().ok()).map(|r| r.wall_s));
    walls.sort_by(f64::total_cmp);
    point.wall_s_min = walls.first().copied().unwrap_or(0.0);
    point.wall_s_median = walls.get(walls.len() / 2).copied().unwrap_or(0.0);
    point.force_evaluations = found.work.force_evaluations;
    point.error_peak = compare(&found, exact, peak_error);
    point.error_arrival = compare(&found, exact, arrival_error);
    point.error_trace = Some(trace_error(&found, exact));
    point.error_energy = Some(found.drift.abs());
    let worst = [point.error_peak, point.error_arrival, point.error_trace];
    point.failed = !worst.iter().all(|error| error.is_some_and(|e| e < FAILED));
    point
}

/// What `--accuracy` comes to: the first run that is off by no more, with what the run it is held against may be off itself.
fn choice(scene: &Scene, accuracy: f64, exact: &Run) -> Option<Chosen> {
    steps_tried(accuracy).find_map(|steps| {
        let method = method(scene, Integration::Accuracy(steps)).ok()?;
        let found = run(scene, method).ok()?;
        let error = worst(&found, exact);
        let force_evaluations = found.work.force_evaluations;
        let (setting, method) = (setting(method), method.name());
        let held =
            error.is_some_and(|error| error + OWN * TIGHTER * steps.min(accuracy) <= accuracy);
        held.then_some(Chosen { accuracy, method, setting, error, force_evaluations })
    })
}

/// Slopes of peak error against force evaluations, where neither the reference nor coarse steps blur them.
fn orders(points: &[Point], reference: f64) -> Vec<Order> {
    let mut orders: Vec<Order> = Vec::new();
    for rows in points.chunk_by(|a, b| a.method == b.method) {
        let usable = rows.iter().filter(|p| !p.failed).filter_map(|p| {
            let error = p.error_peak.filter(|e| *e > ABOVE_REFERENCE * reference && *e < 1e-2)?;
            #[allow(clippy::cast_precision_loss, reason = "counts far below 2^53")]
            let evaluations = p.force_evaluations as f64;
            Some((evaluations.ln(), error.ln()))
        });
        let Some(first) = rows.first() else { continue };
        let usable: Vec<(f64, f64)> = usable.collect();
        orders.push(Order {
            method: first.method,
            nominal: first.order,
            observed: slope(&usable).map(|slope| -slope),
        });
    }
    orders
}

/// Slope of a straight line by least squares; none with fewer than three points.
fn slope(points: &[(f64, f64)]) -> Option<f64> {
    if points.len() < 3 {
        return None;
    }
    #[allow(clippy::cast_precision_loss, reason = "a few points")]
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let variance: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    (variance > 0.0).then(|| covariance / variance)
}
