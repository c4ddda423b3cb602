//! Makes a recording of a scene with three impacts, and reads it back.

#![allow(clippy::disallowed_macros, reason = "an example prints")]

use hertzscope::experiment::{Integration, facts};
use hertzscope::recording;
use hertzscope::{Scene, run_to_accuracy};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::load("magnet-0.61g")?;
    let impacts: Result<Vec<_>, _> = (1..=3)
        .map(|number| run_to_accuracy(&scene, scene.accuracy, number, &mut |_| ()))
        .collect();
    let set = facts::recording(&scene, Integration::Accuracy(scene.accuracy), impacts?)?;
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("three.mcap");
    recording::write(&file, &set)?;
    let read = recording::open(&file)?;
    println!("{} shots with {} channels", read.shots.len(), read.shots[0].captures.len());
    assert_eq!(read.shots[2].captures, set.shots[2].captures);
    Ok(())
}
