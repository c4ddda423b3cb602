//! The work-precision study of a scene: what accuracy costs.
//!
//! First what an accuracy takes as `run` makes it, check runs included. Then every method over its
//! range of settings. First peaks, arrivals and traces are compared with a reference from another
//! family of methods than those that `--accuracy` goes by, as far as one comes to an end, which
//! carries its own error bar: the difference to a second tight solution. Force evaluations are
//! exact; wall times are informative, median and minimum of several rounds: each round takes every
//! point once, so that a busy spell of the machine touches all of them alike.

mod points;
mod table;

pub use table::{ChosenMethod, Order, Point, Reference};

use serde::Serialize;

use crate::experiment::estimate::level;
use crate::numeric::intervals::student_95;
use crate::numeric::statistics::StraightLine;
use crate::scene::Scene;
use points::{ChoiceTimes, WallTimes, choice, point, reference, settings};

/// Default number of timed runs of each point.
pub const TIMED_RUNS: u16 = 10;
/// Orders are fitted where the most work is at least so many times the least (1).
const MIN_WORK_RATIO: f64 = 2.0;
/// Orders are fitted where errors lie above this multiple of the reference's own error (1).
const ABOVE_REFERENCE: f64 = 100.0;

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostStudy {
    /// Scene name.
    pub scene: String,
    /// The reference of the errors.
    pub reference: Reference,
    /// One row a method and setting.
    pub points: Vec<Point>,
    /// Observed order of each method on this scene, contact openings included.
    pub orders: Vec<Order>,
    /// Choices of `--accuracy` at each decade, with the errors reached.
    pub chosen: Vec<ChosenMethod>,
    /// One digitiser level of the most sensitive channel, relative to its first peak; none without
    /// a wired sensor (1).
    pub level: Option<f64>,
    /// The scope's sample interval, relative to the earliest arrival compared (1).
    pub sample: f64,
}

impl CostStudy {
    /// The coarsest setting of each method that is as accurate as `accuracy` (1) in peaks and
    /// arrivals, as all its finer ones are; in traces to half of the digits, where what was chosen
    /// is.
    pub fn accurate(&self, accuracy: f64) -> impl Iterator<Item = &Point> {
        let late = move |error: Option<f64>| error.is_none_or(|error| error <= accuracy.sqrt());
        let same = |chosen: &&ChosenMethod| (chosen.accuracy / accuracy - 1.0).abs() < 1e-9;
        let traces = self.chosen.iter().find(same).is_some_and(|chosen| late(chosen.error_trace));
        let holds = move |point: &&Point| {
            let errors = [point.error_peak, point.error_arrival];
            !point.failed
                && errors.iter().all(|error| error.is_some_and(|e| e <= accuracy))
                && (!traces || late(point.error_trace))
        };
        self.points.chunk_by(|a, b| a.method == b.method).filter_map(move |points| {
            let mut points: Vec<&Point> = points.iter().collect();
            points.sort_by_key(|point| std::cmp::Reverse(point.force_evaluations));
            points.into_iter().take_while(holds).last()
        })
    }
}

/// Makes the study with `runs` timed runs of each point; `progress` is called with the share of the
/// work done.
///
/// # Errors
/// The integrator's error where even the reference fails, in words.
pub fn study(scene: &Scene, runs: u16, progress: &mut dyn FnMut(f64)) -> Result<CostStudy, String> {
    let (exact, reference) = reference(scene)?;
    let readings = exact.readings();
    if readings.iter().all(|reading| reading.first_peak.is_none()) {
        return Err("no pulse at any sensor or the wall to compare".to_owned());
    }
    let settings = settings(scene);
    let all = (settings.len() + decades().count()) * usize::from(runs.max(1));
    let mut done = 0;
    let mut report = || {
        progress(f64::from(done) / all as f64);
        done += 1;
    };
    let mut points: Vec<(Point, WallTimes)> = Vec::new();
    for method in &settings {
        report();
        // A method that has taken too much will take no less with a tighter tolerance.
        let last = points.last().map(|(point, _)| point);
        let before = last.filter(|last| last.method == method.name() && last.given_up);
        points.push(match before {
            Some(before) => {
                let failed = Point::failed(scene, *method, before.force_evaluations);
                (Point { given_up: true, ..failed }, WallTimes::default())
            }
            None => point(scene, *method, &exact),
        });
    }
    let mut chosen: Vec<(ChosenMethod, ChoiceTimes)> = Vec::new();
    for accuracy in decades() {
        report();
        chosen.push(choice(scene, accuracy, &exact).map_err(|error| error.to_string())?);
    }
    for _ in 1..runs {
        for ((point, walls), method) in points.iter_mut().zip(&settings) {
            report();
            if point.wall_s_min > 0.0 && walls.allow_another() {
                point.time_again(scene, *method, walls);
            }
        }
        for (chosen, times) in &mut chosen {
            report();
            if times.all.allow_another() {
                chosen.time_again(scene, times);
            }
        }
    }
    let points: Vec<Point> = points.into_iter().map(|(point, _)| point).collect();
    let earliest = readings.iter().filter_map(|r| r.half_rise_s).fold(f64::MAX, f64::min);
    Ok(CostStudy {
        scene: scene.name.clone(),
        orders: orders(&points, reference.error),
        reference,
        points,
        chosen: chosen.into_iter().map(|(chosen, _)| chosen).collect(),
        level: level(&exact),
        sample: scene.scope.model.sample_interval(scene.scope.time_base) / earliest,
    })
}

/// Accuracies at which the choice is shown (1).
fn decades() -> impl Iterator<Item = f64> {
    (2..=10).map(|decade| 10f64.powi(-decade))
}

/// Slopes of peak error against force evaluations, where neither the reference nor coarse steps
/// blur them.
fn orders(points: &[Point], reference: f64) -> Vec<Order> {
    let mut orders: Vec<Order> = Vec::new();
    for rows in points.chunk_by(|a, b| a.method == b.method) {
        let usable = rows.iter().filter(|p| !p.failed).filter_map(|p| {
            let error = p.error_peak.filter(|e| *e > ABOVE_REFERENCE * reference && *e < 1e-2)?;
            let evaluations = p.force_evaluations as f64;
            Some((evaluations.ln(), error.ln()))
        });
        let Some(first) = rows.first() else { continue };
        let usable: Vec<(f64, f64)> = usable.collect();
        let (observed, observed_u) = slope(&usable).map(|(slope, u)| (-slope, u)).unzip();
        let freedom = usable.len() as f64 - 2.0;
        let expanded = observed_u.map(|u| student_95(freedom) * u);
        let Point { method, source, order: nominal, .. } = *first;
        orders.push(Order { method, source, nominal, observed, observed_u, expanded });
    }
    orders
}

/// Slope of a straight line by least squares, and its standard error; none with fewer than three
/// points, or where stability and not accuracy chooses the steps, so that the work hardly differs.
fn slope(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let range = |(low, high): (f64, f64), p: &(f64, f64)| (low.min(p.0), high.max(p.0));
    let (least, most) = points.iter().fold((f64::MAX, f64::MIN), range);
    if points.len() < 3 || most - least < MIN_WORK_RATIO.ln() {
        return None;
    }
    let weighted: Vec<(f64, f64, f64)> = points.iter().map(|(x, y)| (*x, *y, 1.0)).collect();
    let line = StraightLine::through(&weighted)?;
    Some((line.slope, line.slope_u(points.len())))
}
