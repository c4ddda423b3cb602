//! Scenes with other numbers than the one they are made from: each what it would be if its file
//! said so.

use hertzscope::scene::adjust::Adjustable;
use hertzscope::scene::{Scene, SceneError};

/// The scene as a file has it, with this value at that path.
fn written(path: &str, value: &str) -> Result<Scene, SceneError> {
    let text = format!("base = \"magnet-0.61g\"\n{path} = {value:?}\n");
    Scene::from_text("adjusted", "adjusted.toml", &text)
}

#[test]
fn it_is_the_scene_that_a_file_would_make() {
    let mut scene = Adjustable::load("magnet-0.61g").expect("a scene");
    for (path, value) in [
        ("striker.speed", 0.5),
        ("duration", 3e-3),
        ("scope.time_base", 1e-4),
        ("scope.position", 2e-4),
        ("scope.ch1.scale", 2.0),
        ("scope.trigger.level", 0.25),
        ("scope.input_capacitance", 25e-12),
        ("sensors.p14.thickness", 0.4e-3),
        ("effects.scope_noise.rms", 0.1),
    ] {
        let knobs = scene.knobs(path).expect("a number");
        let [knob] = &knobs[..] else { panic!("{path}: {knobs:?}") };
        let found = scene.with(&[(knob, value)]).expect("a scene");
        let text = format!("{} {}", value / knob.scale, knob.unit);
        let written = written(path, &text).expect("a scene");
        assert_eq!(found.scope, written.scope, "{path}");
        assert_eq!(found.sensors, written.sensors, "{path}");
        assert_eq!(found.chain, written.chain, "{path}");
        assert_eq!(found.initial_velocities, written.initial_velocities, "{path}");
        assert_ne!((found.scope, found.sensors, found.initial_velocities, found.duration), {
            let base = scene.scene().expect("a scene");
            (base.scope, base.sensors, base.initial_velocities, base.duration)
        });
    }
}

#[test]
fn a_panel_that_does_not_fit_any_more_is_refused() {
    let mut scene = Adjustable::load("magnet-0.61g").expect("a scene");
    // One sample of the bench's time base.
    let knobs = scene.knobs("duration").expect("a number");
    let found = scene.with(&[(&knobs[0], 1e-6)]).expect_err("too short");
    let written = written("duration", "1 us").expect_err("too short");
    let problems = |error: SceneError| match error {
        SceneError::Problems(problems) => {
            problems.into_iter().map(|p| (p.key, p.found)).collect::<Vec<_>>()
        }
        other => panic!("{other}"),
    };
    let told = (problems(found), problems(written));
    assert_eq!(told.0, told.1);
    assert_eq!(told.0.len(), 1, "{told:?}");
}
