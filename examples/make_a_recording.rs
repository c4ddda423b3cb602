//! Makes a recording of a scene with three impacts, and reads it back.

#![allow(clippy::disallowed_macros, reason = "an example prints")]

use hertzscope::experiment::{Integration, facts};
use hertzscope::recording::{self, TraceSet};
use hertzscope::{Scene, run_to_accuracy};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::load("magnet-0.61g")?;
    let mut set = TraceSet {
        metadata: facts::facts(&scene, Integration::Accuracy(scene.accuracy))?,
        attachments: facts::scene_attachments(&scene),
        ..TraceSet::default()
    };
    for number in 1..=3 {
        let outcome = run_to_accuracy(&scene, scene.accuracy, number, &mut |_| ())?;
        set.notes.insert(number, facts::shot_notes(&scene, &outcome));
        set.shots.push(outcome.shot);
    }
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("three.mcap");
    recording::write(&file, &set)?;
    let read = recording::open(&file)?;
    println!("{} shots with {} channels", read.shots.len(), read.shots[0].captures.len());
    assert_eq!(read.shots[2].captures, set.shots[2].captures);
    Ok(())
}
