//! Fits the striker's speed to a measurement: here the trace of a twin whose striker is 5 % faster.

#![allow(clippy::disallowed_macros, reason = "an example prints")]

use hertzscope::experiment::{Integration, facts};
use hertzscope::fit::{FitOptions, fit};
use hertzscope::measurement::compare::ComparedShot;
use hertzscope::run_to_accuracy;
use hertzscope::scene::adjust::Adjustable;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = Adjustable::load("magnet-0.61g")?;
    let knobs = scene.knobs("striker.speed")?;
    let stated = knobs[0].value;

    let faster = scene.with(&[(&knobs[0], 1.05 * stated)])?;
    let outcome = run_to_accuracy(&faster, faster.accuracy, 1, &mut |_| ())?;
    let measured = facts::recording(&faster, Integration::Accuracy(faster.accuracy), [outcome])?;

    let side =
        ComparedShot { name: "measured", set: &measured, shot: &measured.shots[0], scene: None };
    let found = fit((&scene, &knobs), side, &[], &FitOptions::default(), &mut |_| ())?.report;
    let speed = &found.parameters[0];
    println!("{}: {:.4} ± {:.4} m/s (k = 1)", speed.path, speed.value, speed.u);
    println!("stated {stated:.4} m/s, true {:.4} m/s", 1.05 * stated);
    Ok(())
}
