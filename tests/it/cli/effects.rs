//! `hertzscope effects`.

use serde_json::Value;

use super::{files, printed, refused, says, temporary};

const KEYS: [&str; 9] =
    ["effect", "state", "active", "criterion", "value", "reason", "run_times", "change", "verdict"];

#[test]
fn the_ledger_is_for_people_and_for_scripts() {
    let folder = temporary();
    let page = printed(folder.path(), &["effects", "--accuracy", "1e-3", "--quiet"]);
    assert!(page.lines().all(|line| line.chars().count() <= 80), "{page}");
    says(&page, &["gravity", "magnet_preload", "quantisation", "not tried", "needed", "no value"]);
    // One line an effect; numerics are none.
    assert!(
        page.lines().count() < 30 && !page.contains("kink") && !page.contains("quiet"),
        "{page}"
    );
    let why = ["effects", "--accuracy", "1e-3", "--quiet", "--why"];
    says(&printed(folder.path(), &why), &["weight of the chain", "the chain weighs"]);
    let text = printed(folder.path(), &["effects", "--accuracy", "1e-3", "--quiet", "--json"]);
    let entries: Vec<Value> = serde_json::from_str(&text).expect("a list");
    for entry in &entries {
        let keys: Vec<&String> = entry.as_object().expect("an object").keys().collect();
        assert!(KEYS.iter().all(|key| keys.iter().any(|k| k == key)), "{keys:?}");
        let (state, active) = (entry["state"].as_str().expect("a state"), &entry["active"]);
        let decided = [("on", true), ("off", false)];
        assert!(state == "auto" || decided.iter().any(|d| (state, active) == (d.0, &d.1.into())));
        assert!(page.contains(entry["effect"].as_str().expect("a name")));
        assert!(!entry["reason"].as_str().expect("a reason").is_empty());
    }
    assert_eq!(files(folder.path()), [""; 0]);
    says(&refused(folder.path(), &["effects", "nowhere"]), &["nowhere"]);
}

#[test]
fn a_run_tells_its_error_its_accuracy_and_what_auto_decided() {
    let folder = temporary();
    let scene = "base = \"magnet-0.61g\"\n[effects.dashpot]\nstate = \"auto\"\n\
        gamma = \"1e-12 N*s/m\"\nend_of_contact = \"zero_force\"\n";
    std::fs::write(folder.path().join("s.toml"), scene).expect("a file");
    let page = printed(folder.path(), &["run", "s.toml"]);
    says(&page, &["first peaks within", "dashpot is off"]);
    let text = printed(folder.path(), &["run", "s.toml", "--json"]);
    let summary: Value = serde_json::from_str(&text).expect("a summary");
    let accuracy = summary["accuracy"].as_f64().expect("a number");
    for key in ["peak", "arrival"] {
        let error = summary["error_estimate"][key].as_f64().expect("a number");
        assert!(error > 0.0 && error <= 2.0 * accuracy, "{key}: {error:e}");
    }
    assert!(summary["error_estimate"]["how"].as_str().expect("words").contains("second run"));
    assert!(!summary["effects"].as_array().expect("a list").iter().any(|e| e == "dashpot"));
}
