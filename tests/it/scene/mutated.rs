//! Scenes changed at random: a bench or problems with places, never a panic.

use hertzscope::quantity::{Dimension, parse};
use hertzscope::scene::SceneError;
use proptest::prelude::*;
use proptest::sample::{Index, select};

use super::{BENCH, load};
use crate::seeded;

/// One change of a text.
#[derive(Debug, Clone)]
enum Change {
    DeleteLine(Index),
    RepeatLine(Index, Index),
    SwapValues(Index, Index),
    SetValue(Index, String),
    Truncate(Index),
    Insert(Index, char),
}

fn change() -> impl Strategy<Value = Change> {
    let values = vec![
        "0",
        "-1",
        "nan",
        "inf",
        "1e308",
        "9223372036854775807",
        "true",
        "[]",
        "{}",
        "\"\"",
        "\"1e300 m\"",
        "\"nan kg\"",
        "\"free\"",
        "\"1e-300 s\"",
        "\"5 ns/div\"",
        "\"50 s/div\"",
        "\"CH4\"",
        "\"-1e200 N\"",
        "[\"ball\", \"ball\"]",
        "\"../x.toml\"",
        "2014-01-01",
    ];
    prop_oneof![
        any::<Index>().prop_map(Change::DeleteLine),
        any::<(Index, Index)>().prop_map(|(from, to)| Change::RepeatLine(from, to)),
        any::<(Index, Index)>().prop_map(|(a, b)| Change::SwapValues(a, b)),
        (any::<Index>(), select(values))
            .prop_map(|(at, value)| Change::SetValue(at, value.to_owned())),
        (any::<Index>(), "\\PC{0,12}").prop_map(|(at, value)| Change::SetValue(at, value)),
        any::<Index>().prop_map(Change::Truncate),
        any::<(Index, char)>().prop_map(|(at, c)| Change::Insert(at, c)),
    ]
}

/// Indices of the lines `key = value`.
fn settings(lines: &[String]) -> Vec<usize> {
    lines.iter().enumerate().filter(|(_, line)| line.contains(" = ")).map(|(i, _)| i).collect()
}

fn apply(text: &str, change: &Change) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    if lines.is_empty() {
        return String::new();
    }
    let set = settings(&lines);
    let value = |line: &str| line.split_once(" = ").map(|(_, v)| v.to_owned()).unwrap_or_default();
    let with = |line: &str, value: &str| {
        format!("{} = {value}", line.split_once(" = ").map_or("", |(key, _)| key))
    };
    match change {
        Change::DeleteLine(at) => {
            lines.remove(at.index(lines.len()));
        }
        Change::RepeatLine(from, to) => {
            let line = lines[from.index(lines.len())].clone();
            lines.insert(to.index(lines.len()), line);
        }
        Change::SwapValues(a, b) if !set.is_empty() => {
            let (a, b) = (set[a.index(set.len())], set[b.index(set.len())]);
            let (one, other) = (value(&lines[a]), value(&lines[b]));
            lines[a] = with(&lines[a].clone(), &other);
            lines[b] = with(&lines[b].clone(), &one);
        }
        Change::SetValue(at, new) if !set.is_empty() => {
            let at = set[at.index(set.len())];
            lines[at] = with(&lines[at].clone(), new);
        }
        Change::Truncate(at) => {
            let ends: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
            return text[..ends[at.index(ends.len())]].to_owned();
        }
        Change::Insert(at, c) => {
            let places: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
            let mut changed = text.to_owned();
            changed.insert(places[at.index(places.len())], *c);
            return changed;
        }
        Change::SwapValues(..) | Change::SetValue(..) => {}
    }
    lines.join("\n")
}

proptest! {
    #![proptest_config(seeded(256))]

    #[test]
    fn changed_scenes_are_benches_or_problems(changes in prop::collection::vec(change(), 1..5)) {
        let text = changes.iter().fold(BENCH.to_owned(), |text, change| apply(&text, change));
        match load(&text) {
            Ok(scene) => {
                let masses = scene.chain.bodies().iter().all(|b| b.mass > 0.0 && b.mass.is_finite());
                prop_assert!(masses && scene.duration > 0.0 && scene.accuracy > 0.0);
                let finite = scene.chain.contacts().iter().all(|c| c.static_overlap.is_finite());
                prop_assert!(finite, "a static state of numbers");
            }
            Err(SceneError::Problems(problems)) => {
                prop_assert!(!problems.is_empty());
                for problem in &problems {
                    prop_assert!(problem.line >= 1 && problem.line <= text.split('\n').count(), "{}", problem);
                    prop_assert!(problem.column >= 1);
                    prop_assert!(!problem.found.is_empty(), "{}", problem);
                    prop_assert!(problem.file.contains(".toml"));
                }
            }
            Err(error) => prop_assert!(false, "the file is there and small: {}", error),
        }
    }

    #[test]
    fn random_texts_are_no_scenes(text in "\\PC{0,200}") {
        prop_assert!(load(&text).is_err());
    }
}

proptest! {
    #![proptest_config(seeded(2000))]

    #[test]
    fn random_texts_are_quantities_or_errors(text in "\\PC{0,24}") {
        if let Ok(value) = parse(&text, Dimension::MASS) {
            prop_assert!(value.is_finite());
        }
    }

    /// Closer to what is valid: numbers, units, exponents and joints in any order.
    #[test]
    fn random_units_are_quantities_or_errors(
        parts in prop::collection::vec(select(vec![
            "1", "-", "+", ".", "e", "E9", "e400", "_", "nan", "inf", " ", "k", "g", "m", "µ", "µm", "s", "N", "/", "*", "·", "^", "^1.5",
            "^-40", "^1e9", "²", "³", "%", "°C", "div", "Ω",
        ]), 0..12)
    ) {
        let text = parts.concat();
        for dimension in [Dimension::MASS, Dimension::NONE, Dimension::HERTZ_STIFFNESS] {
            if let Ok(value) = parse(&text, dimension) {
                prop_assert!(value.is_finite(), "{}", text);
            }
        }
    }
}
