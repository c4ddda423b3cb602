//! Numbers that someone signs: distances, uncertainties that cover, and refusals of what is not
//! determined.

mod coverage;
mod distances;
mod fits;
mod forward;
mod meaning;
mod plans;
mod pulses;
mod sensors;
mod time_bases;
pub mod uncertain;

use hertzscope::experiment::{Integration, facts, run};
use hertzscope::measurement::arrivals::{Survey, survey};
use hertzscope::recording::TraceSet;
use hertzscope::scene::Scene;

/// A scene that stands on the shipped one `base`.
fn scene(base: &str, text: &str) -> Scene {
    let text = format!("base = \"{base}\"\n{text}");
    Scene::from_text("test", "test.toml", &text).expect("a scene without problems")
}

/// What the bench keeps of one shot, its scene along.
fn recorded(scene: &Scene, accuracy: f64) -> TraceSet {
    let integration = Integration::Accuracy(accuracy);
    let outcome = run(scene, integration, 1, &mut |_| ()).expect("a run");
    facts::recording(scene, integration, [outcome]).expect("facts")
}

fn surveyed(set: &TraceSet) -> Survey {
    survey(set, &set.shots[0])
}
