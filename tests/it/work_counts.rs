//! Work and readings of the shipped scenes against those of an earlier version of this code, in
//! `tests/golden/work-counts.json`.
//!
//! This is a change detector: it shows what a change of the kernel does to step counts, force
//! evaluations, readings and final states. It is no reference of truth; `golden.rs` and
//! `fifty_scenes` compare with independent solutions.
//! `HERTZSCOPE_WRITE_GOLDEN=1 cargo test --test it work_counts::` writes the file anew.

use std::fmt::Write as _;
use std::path::PathBuf;

use hertzscope::chain::State;
use hertzscope::experiment::bench::{Bench, Grid};
use hertzscope::experiment::outcome::{Reading, Summary};
use hertzscope::experiment::{Integration, for_accuracy, run};
use hertzscope::motion::Method;
use hertzscope::scene::Scene;
use serde_json::{Map, Value, json};

/// Relative errors of first-peak forces and times that are asked for (1).
const ACCURACIES: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Accuracy of the run whose final state is compared (1).
const STATE_ACCURACY: f64 = 1e-9;
/// Tolerance of the run that shows how far the final state may be off (1).
const TIGHTER: f64 = 1e-12;
/// Relative change of step and evaluation counts that passes: instruction sets round differently,
/// so single steps may be added or rejected (1).
const COUNT_TOLERANCE: f64 = 0.02;
/// Change of step and evaluation counts that passes whatever their size: short runs have counts
/// below 100.
const COUNT_SLACK: f64 = 3.0;
/// Safety factor on the state's own uncertainty, which is a difference of two runs and may be small
/// by chance (1).
const STATE_FACTOR: f64 = 10.0;
/// A grid without samples within any run.
const NEVER: Grid = Grid { start: 1e9, interval: 1.0 };

/// What the file says of itself.
const ABOUT: &str = "Change detector: work counts, readings and final states of the shipped scenes, written by \
    `HERTZSCOPE_WRITE_GOLDEN=1 cargo test --test it work_counts::` with the code of its day. The code is compared with itself, \
    so that a change of the kernel shows what it changes; this is no reference of truth. SI units; first_peak is the dynamic \
    force; state_uncertainty is the largest difference from a run at a tolerance of 1e-12, relative to the largest displacement or speed.";

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden/work-counts.json")
}

fn summary(scene: &Scene, accuracy: f64) -> Summary {
    run(scene, Integration::Accuracy(accuracy), 1, &mut |_| ()).expect("a run").summary
}

/// State of the bodies at the end of the scene's duration.
fn final_state(scene: &Scene, method: Method) -> State {
    let velocities = scene.velocities(1);
    let mut bench = Bench::new(&scene.chain, &velocities, method, &[], NEVER, NEVER);
    bench.run_until(scene.duration, false, &mut |_| ()).expect("a run");
    let mut state = bench.state();
    state.position.truncate(velocities.len());
    state.velocity.truncate(velocities.len());
    state
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Largest difference of two vectors relative to the largest component of the second (1).
fn distance(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let off: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    largest(&off) / largest(expected)
}

/// Seventeen significant digits as text, so that no JSON writer rounds them.
fn digits(value: f64) -> Value {
    format!("{value:.16e}").into()
}

fn number(value: &Value) -> f64 {
    value.as_str().and_then(|text| text.parse().ok()).expect("digits as text")
}

fn reading(reading: &Reading) -> Value {
    let peak = reading.first_peak;
    json!({
        "first_peak": peak.map(|peak| digits(peak.dynamic_n)),
        "first_peak_time": peak.map(|peak| digits(peak.time_s)),
        "half_rise": reading.half_rise_s.map(digits),
    })
}

fn places(summary: &Summary) -> Map<String, Value> {
    let all = summary.sensors.iter().chain(&summary.wall);
    all.map(|place| (place.name.clone(), reading(place))).collect()
}

fn record(summary: &Summary) -> Value {
    json!({
        "method": summary.method,
        "steps": summary.steps,
        "rejected_steps": summary.rejected_steps,
        "force_evaluations": summary.force_evaluations,
        "readings": places(summary),
    })
}

/// A scene's entry; the uncertainty of its final state takes a run of its own, and is needed in the
/// file only.
fn record_scene(name: &str, writes: bool) -> Value {
    let scene = Scene::load(name).expect("a shipped scene");
    let runs = ACCURACIES.map(|accuracy| {
        let key = format!("{accuracy:e}");
        (key, record(&summary(&scene, accuracy)))
    });
    let state = final_state(&scene, for_accuracy(STATE_ACCURACY));
    let uncertainty = || {
        let exact = final_state(&scene, for_accuracy(TIGHTER));
        distance(&state.position, &exact.position).max(distance(&state.velocity, &exact.velocity))
    };
    let list = |values: &[f64]| Value::Array(values.iter().map(|value| digits(*value)).collect());
    json!({
        "runs": Map::from_iter(runs),
        "final_time": digits(scene.duration),
        "state_uncertainty": writes.then(|| format!("{:.1e}", uncertainty())),
        "position": list(&state.position),
        "velocity": list(&state.velocity),
    })
}

/// The file's text: one line for each run and each vector.
fn written(scenes: &Map<String, Value>) -> String {
    let mut text = format!("{{\n\"about\": {},\n\"scenes\": {{\n", Value::from(ABOUT));
    for (index, (name, scene)) in scenes.iter().enumerate() {
        let comma = if index + 1 < scenes.len() { "," } else { "" };
        let mut parts: Vec<String> = Vec::new();
        for (key, value) in scene.as_object().expect("a scene") {
            let part = if key == "runs" {
                let runs = value.as_object().expect("runs").iter();
                let runs: Vec<String> =
                    runs.map(|(accuracy, run)| format!("    \"{accuracy}\": {run}")).collect();
                format!("  \"runs\": {{\n{}\n  }}", runs.join(",\n"))
            } else {
                format!("  \"{key}\": {value}")
            };
            parts.push(part);
        }
        writeln!(text, "\"{name}\": {{\n{}\n}}{comma}", parts.join(",\n")).expect("text");
    }
    text + "}\n}\n"
}

/// Differences between this code and the file, one row each.
#[derive(Default)]
struct Table {
    rows: String,
    failures: usize,
}

impl Table {
    /// Adds a row where `found` differs; counts it as a failure where it differs by more than
    /// `limit`.
    fn compare(&mut self, what: &str, (found, golden): (f64, f64), limit: f64) {
        let difference = found - golden;
        if difference == 0.0 {
            return;
        }
        // A comparison with NaN must fail.
        let passes = difference.abs() <= limit;
        let relative = difference / golden;
        let verdict = if passes { "" } else { "  BEYOND THE LIMIT" };
        self.failures += usize::from(!passes);
        writeln!(
            self.rows,
            "{what:<58} {golden:>24.16e} {found:>24.16e} {relative:>9.1e}{verdict}"
        )
        .expect("text");
    }

    fn compare_text(&mut self, what: &str, found: &Value, golden: &Value) {
        if found != golden {
            self.failures += 1;
            writeln!(self.rows, "{what:<58} {golden:>24} {found:>24}  DIFFERENT").expect("text");
        }
    }

    fn compare_run(&mut self, what: &str, found: &Value, golden: &Value, accuracy: f64) {
        self.compare_text(&format!("{what} method"), &found["method"], &golden["method"]);
        let evaluations = golden["force_evaluations"].as_f64().expect("a count");
        let steps = golden["steps"].as_f64().expect("a count");
        // Rejected steps are few, and are measured by how many steps there are.
        let counts =
            [("steps", steps), ("rejected_steps", steps), ("force_evaluations", evaluations)];
        for (key, scale) in counts {
            let pair = [found, golden].map(|run| run[key].as_f64().expect("a count"));
            let per_step = if key == "force_evaluations" { evaluations / steps } else { 1.0 };
            let limit = (COUNT_TOLERANCE * scale).max(COUNT_SLACK * per_step);
            self.compare(&format!("{what} {key}"), pair.into(), limit);
        }
        let (found, golden) = (&found["readings"], &golden["readings"]);
        let names = |value: &Value| {
            Value::from(value.as_object().expect("readings").keys().cloned().collect::<Vec<_>>())
        };
        self.compare_text(&format!("{what} places"), &names(found), &names(golden));
        for (place, golden) in golden.as_object().expect("readings") {
            for (key, golden) in golden.as_object().expect("a reading") {
                let (what, found) = (format!("{what} {place} {key}"), &found[place][key]);
                if golden.is_null() || found.is_null() {
                    self.compare_text(&what, found, golden);
                } else {
                    let pair = (number(found), number(golden));
                    self.compare(&what, pair, accuracy * pair.1.abs());
                }
            }
        }
    }

    fn compare_state(&mut self, name: &str, found: &Value, golden: &Value) {
        let uncertainty: f64 = number(&golden["state_uncertainty"]);
        for key in ["position", "velocity"] {
            let [found, golden] = [found, golden].map(|scene| -> Vec<f64> {
                scene[key].as_array().expect("a vector").iter().map(number).collect()
            });
            if found.len() != golden.len() {
                self.compare_text(name, &found.len().into(), &golden.len().into());
                continue;
            }
            let scale = largest(&golden);
            let off = scale * distance(&found, &golden);
            let limit = scale * (STATE_FACTOR * uncertainty).max(STATE_ACCURACY);
            self.compare(&format!("{name} largest final {key}"), (scale + off, scale), limit);
        }
    }
}

#[test]
fn work_and_readings_are_those_of_the_file() {
    let names = Scene::names();
    let writes = std::env::var("HERTZSCOPE_WRITE_GOLDEN").is_ok_and(|value| value == "1");
    let found: Map<String, Value> =
        names.iter().map(|name| ((*name).to_owned(), record_scene(name, writes))).collect();
    if writes {
        std::fs::write(path(), written(&found)).expect("a file that can be written");
        return;
    }
    let text = std::fs::read_to_string(path()).expect("tests/golden/work-counts.json");
    let golden: Value = serde_json::from_str(&text).expect("JSON");
    let golden = golden["scenes"].as_object().expect("scenes");
    let mut table = Table::default();
    let listed =
        |scenes: &Map<String, Value>| Value::from(scenes.keys().cloned().collect::<Vec<_>>());
    table.compare_text("scenes", &listed(&found), &listed(golden));
    for (name, golden) in golden {
        let Some(found) = found.get(name) else { continue };
        for accuracy in ACCURACIES {
            let key = format!("{accuracy:e}");
            let what = format!("{name} at {key}");
            table.compare_run(&what, &found["runs"][&key], &golden["runs"][&key], accuracy);
        }
        table.compare_state(name, found, golden);
    }
    let Table { rows, failures } = &table;
    println!("{:<58} {:>24} {:>24} {:>9}\n{rows}", "differences", "file", "found", "relative");
    assert_eq!(
        *failures, 0,
        "{failures} differences are beyond their limits; if they are intended, run with HERTZSCOPE_WRITE_GOLDEN=1 and commit the file\n{rows}"
    );
}
