//! Many mistakes at once: each is told once, in the order of their places.

use super::{BENCH, problems};

#[test]
fn all_mistakes_are_told_at_once_and_in_order() {
    let wrong = [
        ("title = \"A bench with every kind of key\"", "title = 4"),
        ("duration = \"2 ms\"", "duration = \"2 kg\""),
        ("accuracy = 1e-6", "accuracy = 3"),
        ("poissons_ratio = 0.46", "poissons_ratio = 0.5"),
        ("diameter = \"4.76 mm\"", "diameter = nan"),
        ("mass = \"0.485 g\"", "mass = \"-1 g\""),
        ("[\"ball\"]", "[\"ball\", \"cube\"]"),
        ("mass = \"0.61 g\"", "mass = 0.61\ncolour = \"red\""),
        ("force = \"2.38 N\"", "force = \"2.38\""),
        ("rms = \"0.02 div\"", "rms = \"0.02 V\""),
        ("host = \"can\"", "host = \"ball\""),
        ("thickness = \"0.5 mm\"\n", ""),
        ("time_base = \"250 us/div\"", "time_base = \"240 us/div\""),
        ("slope = \"rise\"", "slope = \"up\""),
        ("bandwidth_limit = false", "bandwidth_limit = 0"),
        ("input = \"floor\"", "input = \"ceiling\""),
    ];
    let mut text = BENCH.to_owned();
    for (old, new) in wrong {
        assert_eq!(text.matches(old).count(), 1, "{old}");
        text = text.replacen(old, new, 1);
    }
    let told = problems(&text);
    let keys: Vec<&str> = told.iter().map(|p| p.key.as_str()).collect();
    let expected = [
        "title",
        "duration",
        "accuracy",
        "materials.plastic.poissons_ratio",
        "particles.ball.diameter",
        "particles.can.mass",
        "chain.segments.2.particles",
        "striker.mass",
        "striker.colour",
        "effects.magnet_preload.force",
        "effects.scope_noise.rms",
        "sensors.p14.thickness",
        "sensors.p14.host",
        "scope.time_base",
        "scope.trigger.slope",
        "scope.ch1.bandwidth_limit",
        "scope.ch3.input",
    ];
    assert_eq!(keys, expected, "{told:#?}");
    let places: Vec<(usize, usize)> = told.iter().map(|p| (p.line, p.column)).collect();
    assert!(places.is_sorted(), "{places:?}");
}

/// A material that two bodies are made of is read twice; what is wrong with its file is told once.
#[test]
fn a_mistake_that_is_met_twice_is_told_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let metal = "youngs_modulus = \"193\"\npoissons_ratio = 2\n";
    std::fs::write(folder.path().join("metal.toml"), metal).expect("a temporary file");
    let text = BENCH.replace("\"stainless_steel\"", "\"metal.toml\"");
    assert_eq!(text.matches("metal.toml").count(), 2);
    match super::load_in(folder.path(), &text) {
        Err(hertzscope::scene::SceneError::Problems(told)) => {
            let keys: Vec<&str> = told.iter().map(|p| p.key.as_str()).collect();
            assert_eq!(keys, ["youngs_modulus", "poissons_ratio"], "{told:#?}");
            assert!(told.iter().all(|p| p.file.ends_with("metal.toml")), "{told:#?}");
        }
        other => panic!("{other:?}"),
    }
}

/// Without a model nothing can be said about what the instrument offers, but about everything else.
#[test]
fn a_scope_without_model_is_checked_all_the_same() {
    let text = BENCH
        .replacen("model = \"tds2014\"\n", "", 1)
        .replacen("slope = \"rise\"", "slope = \"up\"", 1)
        .replacen("input = \"p14\"", "input = \"p99\"", 1)
        .replacen("scale = \"1 V/div\"", "scale = \"1 V\"", 1);
    let keys: Vec<String> = problems(&text).into_iter().map(|p| p.key).collect();
    assert_eq!(keys, ["scope.model", "scope.trigger.slope", "scope.ch1.scale", "scope.ch2.input"]);
}

/// The message that a user sees names everything and counts.
#[test]
fn the_message_has_a_line_for_each_problem() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text =
        BENCH.replacen("seed = 7", "seed = -7", 1).replacen("[striker]", "[striker]\nx = 1", 1);
    let error = super::load_in(folder.path(), &text).expect_err("two problems").to_string();
    let lines: Vec<&str> = error.lines().collect();
    assert_eq!(lines.len(), 3, "{error}");
    let file = folder.path().join("scene.toml").display().to_string();
    assert!(
        lines[0].starts_with(&format!("{file}:4:8: seed: found the number -7, expected ")),
        "{error}"
    );
    assert!(
        lines[1]
            .starts_with(&format!("{file}:33:1: striker.x: found the unknown key `x`, expected ")),
        "{error}"
    );
    assert_eq!(lines[2], "2 problems in the scene");
}
