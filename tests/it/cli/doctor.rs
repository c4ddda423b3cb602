//! The check of an installation.

use std::path::Path;

use hertzscope::cli::installation::{GOLDEN, examine};
use serde_json::Value;

use super::{printed, temporary};

#[test]
fn a_sound_installation_is_found_sound() {
    let folder = temporary();
    let report: Value =
        serde_json::from_str(&printed(folder.path(), &["doctor", "--json"])).expect("JSON");
    assert_eq!(report["sound"], true);
    let sets = report["instructions"].as_array().expect("a list").len();
    assert_eq!(report["checks"].as_array().expect("a list").len(), sets + 2);
    let text = printed(folder.path(), &["doctor"]);
    assert!(text.ends_with("all is well\n"), "{text}");
    assert_eq!(super::files(folder.path()), Vec::<String>::new());
}

/// What it holds the program against is the reference from outside, to the last digit but one.
#[test]
fn its_golden_is_the_reference() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/bench-goldens.json");
    let text = std::fs::read_to_string(path).expect("the reference");
    let goldens: Value = serde_json::from_str(&text).expect("JSON");
    let golden = &goldens["table_scenes"]["magnet_0.61g"];
    for (place, [force, time]) in ["p2", "p14", "p27", "wall"].into_iter().zip(GOLDEN) {
        let value = |key: &str| golden[place][key]["value"].as_f64().expect("a number");
        assert!((force / value("first_peak_F") - 1.0).abs() < 1e-15, "{place}");
        assert!((time / value("first_peak_t") - 1.0).abs() < 1e-15, "{place}");
    }
    assert!(examine().iter().all(|check| check.good));
}
