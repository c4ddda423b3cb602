//! Losses of the contacts: closed forms, a solution made elsewhere, the ledger, and what losses do
//! to the bench.

mod accuracy;
mod bench;
mod collision;
mod ledger;
mod order;
mod probes;
mod tolerances;

use hertzscope::experiment::outcome::Summary;
use hertzscope::experiment::{Integration, run};
use hertzscope::scene::Scene;

/// A shipped scene with more at its end.
fn scene_with(base: &str, more: &str) -> Scene {
    let text = format!("base = \"{base}\"\n{more}");
    Scene::from_text("lossy", "lossy.toml", &text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// A shipped scene with a dashpot in every contact (N s/m).
fn dashpot(base: &str, gamma: f64, end: &str) -> Scene {
    scene_with(
        base,
        &format!("[effects.dashpot]\ngamma = \"{gamma} N*s/m\"\nend_of_contact = \"{end}\"\n"),
    )
}

/// A shipped scene with Kuwabara and Kono's loss in every contact (s).
fn viscoelastic(base: &str, eta: f64, end: &str) -> Scene {
    scene_with(
        base,
        &format!("[effects.kuwabara_kono]\neta = \"{eta:e} s\"\nend_of_contact = \"{end}\"\n"),
    )
}

fn simulate(scene: &Scene, accuracy: f64) -> Summary {
    run(scene, Integration::Accuracy(accuracy), 1, &mut |_| ()).expect("a run").summary
}
