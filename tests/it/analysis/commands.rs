//! `hertzscope spectrum` and `hertzscope arrivals` on recordings.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

fn hertzscope(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("hertzscope").expect("the program");
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(arguments);
    command
}

fn json(arguments: &[&str]) -> Value {
    let output = hertzscope(arguments).assert().success().get_output().stdout.clone();
    serde_json::from_slice(&output).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// The shipped recording of gravity-0.61g: speeds from 14 to 27 as two other solvers have them, 136.2 and 129.4 m/s, rounded.
#[test]
fn speeds_of_the_shipped_recording() {
    let surveys = json(&["arrivals", "recordings/gravity-0.61g.mcap", "--json"]);
    let speeds = surveys[0]["speeds"].as_array().expect("speeds");
    for (estimator, expected) in [("half_rise", 136.2), ("peak", 129.4)] {
        let speed = speeds.iter().find(|s| s["from"] == "CH2" && s["estimator"] == estimator);
        let speed = &speed.expect("a speed")["m_per_s"];
        let off = (number(&speed["value"]) - expected).abs();
        // Three deviations, since this is one draw and stays the same.
        assert!(off <= 3.0 * number(&speed["u"]) + 0.05, "{estimator}: {speed}");
    }
    assert_eq!(speeds.len(), 15, "three pairs, four estimators and the correlation");
    let text = hertzscope(&["arrivals", "recordings/gravity-0.61g.mcap"]).assert().success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(text.contains("CH2 -> CH3  51.212 mm"), "{text}");
}

/// The linear chain's source in the gap, its band edges, and the picture.
#[test]
fn spectrum_of_the_linear_chain() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (file, picture) = (path("linear.mcap"), path("linear.svg"));
    hertzscope(&["run", "linear-300-cells", "--quiet", "--output", &file]).assert().success();
    let found = json(&["spectrum", &file, "--truth", "contact12", "--json", "--plot", &picture]);
    for (key, expected) in
        [("f1_hz", 7122.383196957213), ("f2_hz", 14166.121749900058), ("f3_hz", 15855.830089821533)]
    {
        assert!((number(&found[key]) / expected - 1.0).abs() < 1e-12, "{key}");
    }
    let peak = &found["peaks"][0];
    assert_eq!(peak["band"], "gap");
    let off = (number(&peak["frequency_hz"]) - 11_211.765).abs();
    assert!(off <= number(&peak["uncertainty_hz"]), "{peak}");
    assert_eq!(number(&found["padded"]), 5.0 * number(&found["samples"]));
    let svg = std::fs::read_to_string(&picture).expect("a picture");
    assert!(svg.starts_with("<svg") && svg.contains("f2, the gap's upper edge"));
    let settings = ["--window", "hann", "--convention", "density", "--from", "1ms", "--to", "3ms"];
    let gated = json(&[&["spectrum", &file, "--channel", "ch4", "--json"], &settings[..]].concat());
    assert_eq!(gated["unit"], "V/sqrt(Hz)");
    // 500 us/div on 10 divisions and 2500 points: 2 us.
    assert_eq!(number(&gated["samples"]), 1000.0);
}

/// A real scope's file knows nothing of the chain, and says so; what cannot be done exits with 2.
#[test]
fn what_is_not_known_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let lab = folder.path().join("lab");
    let out = lab.display().to_string();
    hertzscope(&["convert", "recordings/gravity-0.61g.mcap", &out]).assert().success();
    let file = Path::new(&lab).join("ALL0000/F0000CH2.CSV").display().to_string();
    let surveys = json(&["arrivals", &file, "--json"]);
    assert_eq!(surveys[0]["channels"][0]["droop_undone"], false);
    assert_eq!(surveys[0]["notes"].as_array().expect("notes").len(), 2);
    let page = hertzscope(&["spectrum", &file]).assert().success();
    let page = String::from_utf8_lossy(&page.get_output().stdout).into_owned();
    assert!(page.contains("no band edges"), "{page}");
    let recording = "recordings/gravity-0.61g.mcap";
    for (wrong, told) in [
        (vec!["spectrum", recording, "--channel", "CH9"], "CH1, CH2, CH3, CH4"),
        (vec!["spectrum", recording, "--truth", "nothing"], "sensor/p14"),
        (vec!["spectrum", recording, "--from", "1s"], "at least 2"),
        (vec!["spectrum", recording, "--from", "1kg"], "a mass"),
        (vec!["spectrum", recording, "--shot", "7"], "number 7"),
    ] {
        let failed = hertzscope(&wrong).assert().code(2);
        let error = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(error.contains(told), "{wrong:?}: {error}");
    }
}
