//! From text to a bench or to the list of everything wrong with it: every kind of mistake, at its
//! place.

mod acquired;
mod adjusted;
mod files;
mod limits;
mod losses;
mod materials;
mod mistakes;
mod mutated;
mod scope;
mod shown;
mod tapered;
mod together;

use std::path::Path;

use hertzscope::scene::{Problem, Scene, SceneError};

/// A sound scene that uses every kind of key.
const BENCH: &str = include_str!("scene/bench.toml");
/// Stands in a test's text where the problem is expected; the program never sees it.
const MARK: char = '¦';

/// Puts `scene.toml` with this text into `folder` and loads it.
fn load_in(folder: &Path, text: &str) -> Result<Scene, SceneError> {
    let file = folder.join("scene.toml");
    std::fs::write(&file, text).expect("a temporary file");
    Scene::load(file.to_str().expect("a path in UTF-8"))
}

fn load(text: &str) -> Result<Scene, SceneError> {
    load_in(tempfile::tempdir().expect("a temporary folder").path(), text)
}

/// The problems of a text that has some.
fn problems(text: &str) -> Vec<Problem> {
    match load(text) {
        Err(SceneError::Problems(problems)) => problems,
        other => panic!("expected problems, found {other:?} for\n{text}"),
    }
}

/// Takes the mark out of `text`; returns the rest and the mark's line and column.
fn unmarked(text: &str) -> (String, usize, usize) {
    let (before, after) = text.split_once(MARK).expect("a mark");
    let line = before.split('\n').count();
    let column = before.rsplit('\n').next().expect("a last line").chars().count() + 1;
    (format!("{before}{after}"), line, column)
}

/// The bench with `old`, which stands in it exactly once, replaced.
fn bench_with(old: &str, new: &str) -> String {
    assert_eq!(BENCH.matches(old).count(), 1, "`{old}` must stand once in the bench");
    BENCH.replacen(old, new, 1)
}

/// One mistake: what is replaced, by what (with the mark), and what must be said about it.
struct Mistake<'a> {
    old: &'a str,
    new: &'a str,
    key: &'a str,
    found: &'a str,
    expected: &'a str,
}

impl Mistake<'_> {
    /// This mistake is the only thing told, once, at its place.
    fn is_told(&self) {
        let (text, line, column) = unmarked(&bench_with(self.old, self.new));
        let told = problems(&text);
        let [problem] = told.as_slice() else {
            panic!("`{}`: expected one problem, found {told:#?}", self.new);
        };
        let place = (problem.line, problem.column, problem.key.as_str());
        assert_eq!(place, (line, column, self.key), "`{}`: {problem}", self.new);
        assert!(problem.found.contains(self.found), "`{}`: {problem}", self.new);
        assert!(problem.expected.contains(self.expected), "`{}`: {problem}", self.new);
        assert!(problem.file.ends_with("scene.toml"), "{problem}");
    }
}

/// Rows of `old, new, key, found, expected`.
fn all_told(rows: &[[&str; 5]]) {
    for [old, new, key, found, expected] in rows {
        Mistake { old, new, key, found, expected }.is_told();
    }
}

#[test]
fn the_bench_of_these_tests_is_sound() {
    let scene = load(BENCH).expect("no problem");
    assert_eq!(scene.chain.particles(), 39);
    assert_eq!(scene.sensors.len(), 3);
    assert_eq!(scene.seed, 7);
    assert_eq!(scene.name, "scene");
}

#[test]
fn every_shipped_scene_is_sound() {
    let names = Scene::names();
    assert!(names.contains(&"magnet-0.61g"), "{names:?}");
    for name in names {
        let scene = Scene::load(name).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(scene.name, name);
    }
}
