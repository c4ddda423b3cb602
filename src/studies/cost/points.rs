//! The points of the study: every method over its settings, and what `--accuracy` comes to.

use std::time::{Duration, Instant};

use super::{ChosenMethod, Point, Reference};
use crate::experiment::accuracy::climb;
use crate::experiment::bench::Grid;
use crate::experiment::estimate::{arrival_error, largest_error, peak_error, trace_error};
use crate::experiment::method_choice::serves;
use crate::experiment::run::Run;
use crate::experiment::{Integration, RunError, method};
use crate::motion::{IntegrateError, Method};
use crate::scene::Scene;

/// A point that has taken longer than this in all is not timed again: the study takes seconds.
const TIMING_BUDGET: Duration = Duration::from_millis(300);
/// Points that would take more force evaluations than this are left out: the study is for a coffee
/// break, not for lunch.
const MAX_FIXED_EVALUATIONS: f64 = 60_000.0;
/// A point under error control that takes more is given up; the lossless methods take shorter.
const MAX_LOSSY_EVALUATIONS: u64 = 120_000;
const MAX_LOSSLESS_EVALUATIONS: u64 = 1_000_000;
/// Most evaluations of a reference run.
const MAX_REFERENCE_EVALUATIONS: u64 = 2_000_000;
/// Tolerance of the reference's steps (1).
const REFERENCE_TOLERANCE: f64 = 1e-15;
/// The same where losses are so stiff that only the implicit method comes to an end (1).
const STIFF_TOLERANCE: f64 = 1e-12;
/// An error above this is no result (1).
const FAILED_ERROR: f64 = 1.0;

type Make = fn(f64) -> Method;

/// Methods of fixed steps.
const FIXED: [Make; 2] =
    [|step| Method::VelocityVerlet { step }, |step| Method::RungeKutta4 { step }];
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
pub fn settings(scene: &Scene) -> Vec<Method> {
    let (fixed, adaptive) = (FIXED, ADAPTIVE);
    let suits = |method: Method| serves(&scene.chain, method);
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
        while scene.duration / step * stages <= MAX_FIXED_EVALUATIONS {
            settings.push(make(step));
            step *= 0.5;
        }
    }
    for make in adaptive.into_iter().filter(|make| suits(make(1.0))) {
        settings.extend((1..=13).map(|decade| make(10f64.powi(-decade))));
    }
    settings
}

fn setting(method: Method) -> f64 {
    method.fixed_step().map_or_else(|| method.tolerance().unwrap_or(0.0), |(step, _)| step)
}

impl Point {
    /// Nothing found: in as many evaluations of all contact forces as fixed steps take, in
    /// `evaluations` otherwise.
    pub(super) fn failed(scene: &Scene, method: Method, evaluations: u64) -> Self {
        let all = |(step, _): (f64, f64)| {
            (scene.duration / step).ceil() as u64 * u64::from(method.stages())
        };
        Self {
            method: method.name(),
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

/// Wall times of a point (s).
#[derive(Debug, Clone, Default)]
pub struct WallTimes(Vec<f64>);

impl WallTimes {
    fn add(&mut self, seconds: f64) {
        self.0.push(seconds);
        self.0.sort_by(f64::total_cmp);
    }

    /// Whether the point may be timed again.
    pub fn allow_another(&self) -> bool {
        self.0.iter().sum::<f64>() < TIMING_BUDGET.as_secs_f64()
    }

    fn median(&self) -> f64 {
        self.0.get(self.0.len() / 2).copied().unwrap_or(0.0)
    }

    fn least(&self) -> f64 {
        self.0.first().copied().unwrap_or(0.0)
    }
}

/// A run of shot 1 of `scene` without frames, given up after so many evaluations of all forces.
fn bare(scene: &Scene, method: Method, most: u64) -> Result<Run<'_>, IntegrateError> {
    Run::with_frames(scene, 1, (method, most), Grid::NEVER, &mut |_| ())
}

/// A method at one setting, with its errors against `exact`, and its wall times.
pub fn point(scene: &Scene, by: Method, exact: &Run<'_>) -> (Point, WallTimes) {
    let (mut point, mut walls) = (Point::failed(scene, by, 0), WallTimes::default());
    let most = most_evaluations(by);
    let found = match bare(scene, by, most) {
        Ok(found) => found,
        Err(error) => {
            if matches!(error, IntegrateError::TooMuchWork { .. }) {
                (point.given_up, point.force_evaluations) = (true, most);
            }
            return (point, walls);
        }
    };
    let (readings, exact_readings) = (found.readings(), exact.readings());
    point.force_evaluations = found.work().force_evaluations;
    point.error_peak = largest_error(&readings, &exact_readings, peak_error);
    point.error_arrival = largest_error(&readings, &exact_readings, arrival_error);
    point.error_trace = trace_error(&found, exact);
    point.error_energy = Some(found.energy().drift.abs());
    let worst = [point.error_peak, point.error_arrival];
    let refused = method(scene, Integration::Method(by)).is_err();
    point.failed = refused || !worst.iter().all(|error| error.is_some_and(|e| e < FAILED_ERROR));
    walls.add(found.wall_s());
    point.set_times(&walls);
    (point, walls)
}

/// Most evaluations of all forces of a point.
fn most_evaluations(by: Method) -> u64 {
    if by.allows_losses() { MAX_LOSSY_EVALUATIONS } else { MAX_LOSSLESS_EVALUATIONS }
}

impl Point {
    fn set_times(&mut self, walls: &WallTimes) {
        (self.wall_s_median, self.wall_s_min) = (walls.median(), walls.least());
    }

    /// Times the point, whose method is `by`, once more.
    pub(super) fn time_again(&mut self, scene: &Scene, by: Method, walls: &mut WallTimes) {
        if let Ok(run) = bare(scene, by, most_evaluations(by)) {
            walls.add(run.wall_s());
            self.set_times(walls);
        }
    }
}

/// Wall times of an accuracy: of the run that is its result, and of all its runs.
#[derive(Debug, Clone, Default)]
pub struct ChoiceTimes {
    pub result: WallTimes,
    pub all: WallTimes,
}

/// Result of `--accuracy`: method, errors against `exact`, and wall times.
///
/// # Errors
/// [`RunError`] if the scene cannot be run.
pub fn choice(
    scene: &Scene,
    accuracy: f64,
    exact: &Run<'_>,
) -> Result<(ChosenMethod, ChoiceTimes), RunError> {
    let started = Instant::now();
    let run = climb(scene, accuracy, 1, &mut |_| ())?.run;
    let mut times = ChoiceTimes::default();
    times.result.add(run.wall_s());
    times.all.add(started.elapsed().as_secs_f64());
    let (readings, exact_readings) = (run.readings(), exact.readings());
    let error_peak = largest_error(&readings, &exact_readings, peak_error);
    let error_arrival = largest_error(&readings, &exact_readings, arrival_error);
    let by = run.method();
    let mut chosen = ChosenMethod {
        accuracy,
        method: by.name(),
        setting: setting(by),
        error: error_peak.zip(error_arrival).map(|(peak, arrival)| peak.max(arrival)),
        error_peak,
        error_arrival,
        error_trace: trace_error(&run, exact),
        error_energy: Some(run.energy().drift.abs()),
        force_evaluations: run.work().force_evaluations,
        wall_s_median: 0.0,
        wall_s_min: 0.0,
        wall_held_s_median: 0.0,
        simulated_over_wall: 0.0,
    };
    chosen.set_times(scene, &times);
    Ok((chosen, times))
}

impl ChosenMethod {
    fn set_times(&mut self, scene: &Scene, times: &ChoiceTimes) {
        (self.wall_s_median, self.wall_s_min) = (times.result.median(), times.result.least());
        self.wall_held_s_median = times.all.median();
        self.simulated_over_wall = scene.duration / self.wall_s_median;
    }

    /// Times the runs of the accuracy once more.
    pub(super) fn time_again(&mut self, scene: &Scene, times: &mut ChoiceTimes) {
        let started = Instant::now();
        if let Ok(climbed) = climb(scene, self.accuracy, 1, &mut |_| ()) {
            times.all.add(started.elapsed().as_secs_f64());
            times.result.add(climbed.run.wall_s());
            self.set_times(scene, times);
        }
    }
}

/// The reference, and what it says of itself. With losses it is by neither of the methods that
/// `--accuracy` goes by, unless the one of order 5 takes too much.
///
/// # Errors
/// The integrator's error where no two methods come to an end, in words.
pub fn reference(scene: &Scene) -> Result<(Run<'_>, Reference), String> {
    let tolerance = REFERENCE_TOLERANCE;
    let methods = if scene.chain.needs_explicit_method() {
        vec![Method::DormandPrince54 { tolerance }, Method::DormandPrince853 { tolerance }]
    } else if scene.chain.is_dissipative() {
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
        match bare(scene, method, MAX_REFERENCE_EVALUATIONS) {
            Ok(run) => Some((run, method.to_string())),
            Err(error) => {
                last = Some(error);
                None
            }
        }
    });
    if let (Some((exact, method)), Some((other, second))) = (found.next(), found.next()) {
        let (readings, exact_readings) = (other.readings(), exact.readings());
        let largest = |error| largest_error(&readings, &exact_readings, error);
        return match largest(peak_error).zip(largest(arrival_error)) {
            Some((peak, arrival)) => {
                let error_trace = trace_error(&other, &exact).unwrap_or(0.0);
                let error = peak.max(arrival);
                Ok((exact, Reference { method, second, error, error_trace }))
            }
            None => Err(format!("{method} and {second} find different pulses")),
        };
    }
    Err(last.map_or(String::new(), |error| error.to_string()))
}
