//! What the README shows is what the program prints and takes.

use std::path::Path;

use hertzscope::experiment::{Integration, run};
use hertzscope::report;
use hertzscope::scene::Scene;

/// The fenced blocks of one language.
fn blocks(language: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let text = std::fs::read_to_string(path).expect("the README");
    let mut parts = text.split("```").skip(1).step_by(2);
    let blocks: Vec<String> =
        parts.by_ref().filter_map(|b| Some(b.strip_prefix(language)?.to_owned())).collect();
    assert!(!blocks.is_empty(), "a block of {language}");
    blocks
}

#[test]
fn the_summary_shown_is_printed() {
    let scene = Scene::load("magnet-0.61g").expect("the default scene");
    let integration = Integration::Accuracy(scene.accuracy.expect("named"));
    let outcome = run(&scene, integration, 1, &mut |_| ()).expect("a run");
    let printed = report::summary(&outcome.summary);
    for block in blocks("text") {
        assert!(printed.contains(block.trim()), "the README shows\n{block}\nprinted is\n{printed}");
    }
}

/// `$ hertzscope ...`, and what it prints or a part of that.
#[test]
fn the_answers_shown_are_given() {
    for block in blocks("console") {
        let (command, shown) = block.trim().split_once('\n').expect("a command and its output");
        let arguments = command.strip_prefix("$ hertzscope ").expect("a command").split(' ');
        let output = assert_cmd::Command::cargo_bin("hertzscope")
            .expect("the program")
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args(arguments)
            .output()
            .expect("output");
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(printed.contains(shown), "the README shows\n{shown}\nprinted is\n{printed}");
    }
}

#[test]
fn the_scenes_shown_are_scenes() {
    for (number, block) in blocks("toml").iter().enumerate() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join(format!("scene-{number}.toml"));
        std::fs::write(&file, block).expect("a scene file");
        let scene = Scene::load(&file.display().to_string()).expect("a scene without problems");
        let integration = Integration::Accuracy(1e-3);
        let outcome = run(&scene, integration, 1, &mut |_| ()).expect("a run");
        // These pulses do exceed what PTFE bears; nothing else is to be said.
        let (yields, others): (Vec<_>, Vec<_>) =
            outcome.summary.notes.iter().partition(|note| note.contains("body yield"));
        assert_eq!((yields.len(), others.len()), (1, 0), "{:?}", outcome.summary.notes);
    }
}

#[test]
fn the_papers_tables_are_whole() {
    let rows = hertzscope::experiment::paper::speeds().expect("no problems");
    let scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    assert_eq!(rows.len(), 8);
    assert!(scenes.iter().all(|scene| Scene::names().contains(scene)), "{scenes:?}");
    let sum: f64 = rows.iter().map(|r| r.experiment_m_per_s + r.numerics_m_per_s).sum();
    // 175+177+181+179 + 171+173+176+169 + 118+121+122+115 + 134+141+146+138, as printed.
    assert!((sum - 2436.0).abs() < 1e-9, "{sum}");
}
