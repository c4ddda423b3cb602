//! Scenes with other numbers than the one they are made from: each what it would be if its file
//! said so.

use std::path::Path;

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

/// Rust's `{:?}` escapes a no-break space as `\u{a0}` and a combining accent as `\u{301}`, which
/// TOML does not know.
#[test]
fn a_derived_scene_can_be_read_whatever_its_names() {
    for name in ["lab\u{a0}data", "re\u{301}sultats", "a\"b", "del\u{7f}ete", "back\\slash", "左"]
    {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path().join(name);
        std::fs::create_dir(&folder).expect("a folder");
        let file = folder.join("s.toml");
        let text = format!(
            "base = \"magnet-0.61g\"\n[sensors.{}]\nmodel = \"pzt-5a-710pf\"\nparticle = 5\n",
            hertzscope::scene::document::quoted(name)
        );
        std::fs::write(&file, text).expect("a file");
        let mut scene = Adjustable::load(file.to_str().expect("a path")).expect("a scene");
        let mut knobs = scene.knobs("striker.speed").expect("a number");
        if !name.contains('.') {
            knobs.extend(scene.knobs(&format!("sensors.{name}.offset")).expect("a number"));
        }
        let values: Vec<_> = knobs.iter().map(|knob| (knob, 0.25, 6)).collect();
        let new = folder.join("derived.toml");
        let derived = scene.derived(&values, name, &new);
        std::fs::write(&new, &derived).expect("a file");
        let derived =
            Scene::load(&new).unwrap_or_else(|error| panic!("{name}: {error}\n{derived}"));
        assert_eq!(derived.title, name);
        assert!((derived.initial_velocities[0] - 0.25).abs() < 1e-12);
    }
}

/// A folder with a scene and one derived from it can be moved; written elsewhere, the derived scene
/// names the whole path.
#[test]
fn a_folder_of_derived_scenes_can_be_moved() {
    let root = tempfile::tempdir().expect("a folder");
    let (lab, moved) = (root.path().join("lab"), root.path().join("moved"));
    std::fs::create_dir_all(lab.join("fits")).expect("folders");
    let base = lab.join("s.toml");
    std::fs::write(&base, "base = \"magnet-0.61g\"\nduration = \"1 ms\"\n").expect("a file");
    let mut scene = Adjustable::load(&base).expect("a scene");
    let knobs = scene.knobs("striker.speed").expect("a number");
    let values: Vec<_> = knobs.iter().map(|knob| (knob, 0.25, 6)).collect();
    let elsewhere = scene.derived(&values, "t", &lab.join("fits/new.toml"));
    let whole = std::fs::canonicalize(&base).expect("a path").display().to_string();
    assert!(elsewhere.starts_with(&format!("base = \"{whole}\"\n")), "{elsewhere}");
    let beside = scene.derived(&values, "t", &lab.join("new.toml"));
    assert!(beside.starts_with("base = \"./s.toml\"\n"), "{beside}");
    std::fs::write(lab.join("new.toml"), beside).expect("a file");
    std::fs::rename(&lab, &moved).expect("a moved folder");
    let scene = Scene::load(moved.join("new.toml")).expect("the moved scene");
    assert!((scene.initial_velocities[0] - 0.25).abs() < 1e-12);
    assert!((scene.duration - 1e-3).abs() < 1e-15);
}

/// A change of 5 °C is 5 K; its standard uncertainty of 1 K is that of 5 K.
#[test]
fn a_change_in_degrees_is_a_difference() {
    let text = "base = \"magnet-0.61g\"\n[effects.sensor_tolerance]\nspread = \"1 %\"\ntemperature_change = \"5 °C\"\npermittivity_coefficient = \"0.3 %/°C\"\nd33_coefficient = \"0.001 /K\"\n";
    let mut scene = Adjustable::from_text("t", "t.toml", text).expect("a scene");
    let knobs = scene.knobs("effects.sensor_tolerance.temperature_change").expect("a number");
    assert!((knobs[0].value - 5.0).abs() < 1e-12, "{}", knobs[0].value);
    // Shown and written in the unit as typed.
    assert_eq!((knobs[0].unit.as_str(), knobs[0].scale), ("°C", 1.0));
    let derived = scene.derived(&[(&knobs[0], 7.0, 1)], "warmer", Path::new("warmer.toml"));
    assert!(derived.contains("temperature_change = \"7.0 °C\""), "{derived}");
    let tolerance = |scene: &Scene| scene.sensor_tolerance.expect("a tolerance");
    let found = tolerance(&scene.scene().expect("a scene"));
    assert!((found.temperature - 5.0).abs() < 1e-12);
    assert!((found.permittivity_coefficient - 3e-3).abs() < 1e-15);
    let changed = scene.with(&[(&knobs[0], 7.0)]).expect("a scene");
    assert!((tolerance(&changed).temperature - 7.0).abs() < 1e-12);
}
