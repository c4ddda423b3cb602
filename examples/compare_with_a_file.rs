//! Compares a file of a scope with the simulation of its scene. The file is that of another strike
//! of the same bench; give the name of your own and of its scene instead.

#![allow(clippy::disallowed_macros, reason = "an example prints")]

use std::path::PathBuf;

use hertzscope::experiment::{Integration, facts};
use hertzscope::measurement::compare::score_limits::ScoreLimits;
use hertzscope::measurement::compare::{Align, ComparedShot, compare};
use hertzscope::recording::{self, TraceSet};
use hertzscope::{Scene, run_to_accuracy};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = tempfile::tempdir()?;
    let (file, scene) = if let [file, scene] = arguments.as_slice() {
        (PathBuf::from(file), Scene::load(scene)?)
    } else {
        let (file, scene) = (folder.path().join("measured.mcap"), Scene::load("magnet-0.61g")?);
        recording::write(&file, &simulated(&scene, 2)?)?;
        (file, scene)
    };
    let measured = recording::open(&file)?;
    let twin = simulated(&scene, 1)?;
    let measured =
        ComparedShot { name: "measured", set: &measured, shot: &measured.shots[0], scene: None };
    let twin = ComparedShot { name: "twin", set: &twin, shot: &twin.shots[0], scene: Some(&scene) };
    let limits = ScoreLimits::default();
    let found = compare(measured, twin, (Align::default(), &[]), &limits)?.comparison;
    for channel in &found.channels {
        println!("{}: {:.1} levels apart (RMS)", channel.name, channel.rms_lsb);
    }
    Ok(())
}

/// Shot `number` of a scene.
fn simulated(scene: &Scene, number: u32) -> Result<TraceSet, Box<dyn std::error::Error>> {
    let outcome = run_to_accuracy(scene, scene.accuracy, number, &mut |_| ())?;
    Ok(facts::recording(scene, Integration::Accuracy(scene.accuracy), [outcome])?)
}
