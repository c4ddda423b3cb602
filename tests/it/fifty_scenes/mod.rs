//! More than fifty scenes that no constant of the library was tuned on, against a solver that
//! shares no code with it.
//!
//! For each accuracy that is asked for, first peaks and arrivals differ from the reference by no
//! more than that accuracy, and by no more than the error estimate that the run prints. The solver
//! itself is compared with the goldens, with closed forms, and with a looser run of its own.
#![allow(clippy::too_many_lines, reason = "lists of scenes")]
#![allow(clippy::needless_range_loop, reason = "small counts; a table by row and column")]

mod reference;
mod scenes;
mod setup;
mod solver;

use std::collections::BTreeSet;

use hertzscope::experiment::accuracy::run_to_accuracy;
use hertzscope::experiment::outcome::{Reading as Found, Summary};
use hertzscope::scene::Scene;

use reference::{Control, Reading, Reference};
use setup::Setup;

/// The reference run.
const FINE: Control = Control { tolerance: 1e-14, phase: 0.3 };
/// A looser run, whose difference shows the reference's own error: its tolerance is ten times as
/// large.
const COARSE: Control = Control { tolerance: 1e-13, phase: 0.4 };
/// Relative errors that are asked for (1).
const ACCURACIES: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Largest error of a reference, relative to the accuracy that is tested with it (1).
const REFERENCE_SHARE: f64 = 0.1;
/// Test functions over which the scenes are spread.
const PARTS: usize = 4;
/// Scenes and accuracies that are not run: Rodas takes 55,332 evaluations at 1e-6, and had not
/// ended after 100 s at 1e-9.
const NOT_RUN: [(&str, f64); 1] = [("bead of 50 ug among strong dashpots", 1e-9)];

/// Processors round differently: measured ratios above 1 may come out so many times as large (1).
const KNOWN_MARGIN: f64 = 1.1;

/// A failure that is known, with the measured error relative to the accuracy asked for, and to the
/// error estimate of the run.
struct Known {
    scene: &'static str,
    accuracy: f64,
    error_ratio: f64,
    estimate_ratio: f64,
}

/// Scenes in which readings miss the accuracy, or the estimate misses the error, each with what was
/// measured. Entries go when the code is mended; their figures must not grow.
const KNOWN: [Known; 7] = [
    known("feather-light striker of 0.05 mg", 1e-6, 0.02, 1.01),
    known("feather-light striker of 0.05 mg", 1e-9, 0.02, 1.72),
    known("bead of 1.6 mg with a magnet and a strong dashpot", 1e-3, 0.653, 1.149),
    known("bead of 1.6 mg with a magnet and a strong dashpot", 1e-9, 0.209, 2.153),
    known("bead of 50 ug among strong dashpots", 1e-3, 0.125, 1.034),
    known("faint dashpot that never pulls", 1e-6, 0.208, 1.008),
    known("faint dashpot that never pulls", 1e-9, 0.258, 1.003),
];

const fn known(scene: &'static str, accuracy: f64, error_ratio: f64, estimate_ratio: f64) -> Known {
    Known { scene, accuracy, error_ratio, estimate_ratio }
}

fn all() -> Vec<Setup> {
    let mut all = scenes::lossless();
    all.extend(scenes::dissipative());
    all.extend(scenes::found_by_search());
    all
}

fn scene(setup: &Setup) -> Scene {
    let text = setup.text();
    let mut scene = Scene::from_text("own", "own.toml", &text)
        .unwrap_or_else(|error| panic!("{}: {error}\n{text}", setup.name));
    // A record about as long as the motion.
    let bases = &scene.scope.model.time_bases;
    scene.scope.time_base =
        bases.iter().copied().find(|base| 10.0 * base > setup.duration).expect("a time base");
    scene
}

/// Readings of all places, the wall last.
fn found(summary: &Summary) -> Vec<Option<Reading>> {
    let reading = |place: &Found| {
        let peak = place.first_peak?;
        let half_rise = place.half_rise_s.expect("a rise");
        Some(Reading { force: peak.dynamic_n, time: peak.time_s, half_rise })
    };
    summary.sensors.iter().chain(&summary.wall).map(reading).collect()
}

/// Largest relative errors of first-peak forces, and of first-peak times and half-rises; infinite
/// where a pulse is in one of them only (1).
fn errors(found: &[Option<Reading>], exact: &[Option<Reading>]) -> [f64; 2] {
    assert_eq!(found.len(), exact.len());
    let off = |a: f64, b: f64| if a == b { 0.0 } else { (a / b - 1.0).abs() };
    let of_place = |(found, exact): (&Option<Reading>, &Option<Reading>)| match (found, exact) {
        (None, None) => [0.0; 2],
        (Some(a), Some(b)) => {
            [off(a.force, b.force), off(a.time, b.time).max(off(a.half_rise, b.half_rise))]
        }
        _ => [f64::INFINITY; 2],
    };
    // What is not a number must not pass for no error.
    let larger = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) };
    let places = found.iter().zip(exact).map(of_place);
    places.fold([0.0; 2], |most, error| [larger(most[0], error[0]), larger(most[1], error[1])])
}

/// The worst of many scenes: figure and scene.
#[derive(Clone, Copy)]
struct Worst(f64, &'static str);

impl Worst {
    fn take(&mut self, figure: f64, name: &'static str) {
        if figure > self.0 || figure.is_nan() {
            *self = Self(figure, name);
        }
    }
}

/// Reference readings of a scene and their own error (1).
fn exact(setup: &Setup) -> (Vec<Option<Reading>>, f64) {
    let [fine, coarse] = [FINE, COARSE].map(|control| Reference::run(setup, control).readings());
    let [force, time] = errors(&coarse, &fine);
    (fine, force.max(time))
}

/// Scenes of one part of the suite.
fn part(part: usize) -> Vec<Setup> {
    all().into_iter().skip(part).step_by(PARTS).collect()
}

fn readings_are_as_accurate_as_asked(part: &str, setups: Vec<Setup>) {
    let nothing = Worst(0.0, "none");
    let mut worst = [[nothing; 2]; ACCURACIES.len()];
    let (mut failures, mut own_worst, mut scenes) = (Vec::new(), nothing, 0);
    for setup in setups {
        let name = setup.name;
        let (exact, own) = exact(&setup);
        own_worst.take(own, name);
        scenes += 1;
        assert!(exact.iter().any(Option::is_some), "{name}: no pulse anywhere");
        let scene = scene(&setup);
        for (accuracy, worst) in ACCURACIES.into_iter().zip(&mut worst) {
            if NOT_RUN.contains(&(name, accuracy)) {
                println!("not run: {name} at {accuracy:e}");
                continue;
            }
            assert!(
                own <= REFERENCE_SHARE * accuracy,
                "{name}: the reference is off by {own:.1e}, too much for {accuracy:e}"
            );
            let summary = match run_to_accuracy(&scene, accuracy, 1, &mut |_| ()) {
                Ok(outcome) => outcome.summary,
                Err(error) => {
                    failures.push(format!("{name} at {accuracy:e}: {error}"));
                    continue;
                }
            };
            let [force, time] = errors(&found(&summary), &exact);
            let Some(estimate) = &summary.error_estimate else {
                failures.push(format!("{name} at {accuracy:e}: no error estimate"));
                continue;
            };
            let error_ratio = force.max(time) / accuracy;
            // What the reference is off itself is not held against the estimate.
            let beyond = |error: f64, told: f64| (error - own).max(0.0) / told;
            let estimate_ratio = beyond(force, estimate.peak).max(beyond(time, estimate.arrival));
            worst[0].take(error_ratio, name);
            worst[1].take(estimate_ratio, name);
            let known = KNOWN.iter().find(|k| k.scene == name && k.accuracy == accuracy);
            let limits = known.map_or([1.0; 2], |k| [k.error_ratio, k.estimate_ratio]);
            let limits = limits.map(|ratio| if ratio > 1.0 { KNOWN_MARGIN * ratio } else { 1.0 });
            let line = format!(
                "{name} at {accuracy:e} by {}: force off by {force:.1e}, told {:.1e}; times off by {time:.1e}, told {:.1e}; {error_ratio:.3} of the accuracy, {estimate_ratio:.3} of the estimate",
                summary.method, estimate.peak, estimate.arrival
            );
            if !(error_ratio <= limits[0] && estimate_ratio <= limits[1]) {
                failures.push(line);
            } else if known.is_some() {
                println!("known: {line}");
            }
        }
    }
    for (accuracy, [error, estimate]) in ACCURACIES.iter().zip(worst) {
        println!(
            "{part}, {scenes} scenes at {accuracy:e}: largest error {:.2} of the accuracy ({}), {:.2} of the estimate ({})",
            error.0, error.1, estimate.0, estimate.1
        );
    }
    println!("{part}: the reference is off by {:.1e} at most ({})", own_worst.0, own_worst.1);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn readings_are_as_accurate_as_asked_part_0() {
    readings_are_as_accurate_as_asked("part 0", part(0));
}

#[test]
fn readings_are_as_accurate_as_asked_part_1() {
    readings_are_as_accurate_as_asked("part 1", part(1));
}

#[test]
fn readings_are_as_accurate_as_asked_part_2() {
    readings_are_as_accurate_as_asked("part 2", part(2));
}

#[test]
fn readings_are_as_accurate_as_asked_part_3() {
    readings_are_as_accurate_as_asked("part 3", part(3));
}

#[test]
#[ignore = "a quarter of a minute: Rodas takes 55,332 evaluations where losses are near the border of stiffness"]
fn readings_of_slow_scenes_are_as_accurate_as_asked() {
    readings_are_as_accurate_as_asked("slow scenes", scenes::slow());
}

#[test]
fn there_are_at_least_fifty_scenes_of_different_names() {
    let mut all = all();
    assert!(all.len() >= 50, "{}", all.len());
    all.extend(scenes::slow());
    let names: BTreeSet<&str> = all.iter().map(|setup| setup.name).collect();
    assert!(names.len() == all.len(), "{} of {}", names.len(), all.len());
    for known in KNOWN {
        assert!(names.contains(known.scene), "{}", known.scene);
    }
}
