//! One meaning of `±` and of `U95`: the expanded uncertainty for 95 %, in every output.

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;

fn printed(folder: &Path, arguments: &[&str]) -> String {
    let mut command = Command::cargo_bin("hertzscope").expect("the program");
    let output = command.current_dir(folder).args(arguments).output().expect("output");
    // An answer of no is an answer.
    assert!(matches!(output.status.code(), Some(0 | 1)), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).expect("text")
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&printed(folder, &[arguments, &["--json"]].concat())).expect("JSON")
}

/// Every `u` has its `U95`: from 1.65 times as much, where even limits outweigh the rest, to
/// Student's 12.71 of one degree of freedom.
fn check(value: &Value, what: &str, count: &mut usize) {
    match value {
        Value::Array(list) => list.iter().for_each(|value| check(value, what, count)),
        // An input with its source is as the scene states it.
        Value::Object(fields) if fields.contains_key("source") => {}
        Value::Object(fields) => {
            let number = |key: &str| fields.get(key).and_then(Value::as_f64);
            for (u, expanded) in [("u", "U95"), ("u_hz", "U95_hz")] {
                let Some(u) = number(u).filter(|u| *u > 0.0) else { continue };
                let expanded = number(expanded).unwrap_or_else(|| panic!("{what}: {value}"));
                assert!((1.64..12.72).contains(&(expanded / u)), "{what}: {value}");
                *count += 1;
            }
            fields.values().for_each(|value| check(value, what, count));
        }
        _ => {}
    }
}

#[test]
fn every_output_means_95_per_cent() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let text = "base = \"magnet-0.61g\"\n[uncertainty]\n\"sensors.*.offset\" = 0.0\n";
    std::fs::write(at.join("bench.toml"), text).expect("a scene");
    printed(at, &["run", "bench.toml", "-q", "-o", "one.mcap"]);
    let commands: [&[&str]; 6] = [
        &["arrivals", "one.mcap"],
        &["compare", "one.mcap", "bench.toml", "-q", "--samples", "60"],
        &["fit", "one.mcap", "bench.toml", "--free", "striker.speed", "--starts", "1", "-q"],
        &["spectrum", "one.mcap", "--channel", "CH2"],
        &["budget", "bench.toml", "-q", "--samples", "60"],
        &["run", "bench.toml", "--bands", "--samples", "60", "-o", "three.mcap"],
    ];
    for command in commands {
        let page = printed(at, command);
        assert!(page.contains('±') && page.contains("95 %"), "{command:?}: {page}");
        let command: Vec<&str> =
            command.iter().map(|word| word.replace("three", "four").leak() as &str).collect();
        let mut count = 0;
        check(&json(at, &command), &command.join(" "), &mut count);
        assert!(count > 0, "{command:?}");
    }
    // The same record's speed has the same interval, whoever reads it.
    let speed = |found: &Value, key: &str| {
        let is_half = |s: &&Value| s["estimator"] == "half_rise" && s["from"] == "CH2";
        let speeds = found["speeds"].as_array().expect("speeds");
        speeds.iter().find(is_half).expect("a speed")[key]["U95"].as_f64().expect("U95")
    };
    let survey = json(at, &["arrivals", "one.mcap"]);
    let read = speed(&survey["shots"][0], "m_per_s");
    let compared = speed(&json(at, commands[1]), "measured_m_per_s");
    assert!((read / compared - 1.0).abs() < 1e-9, "{read} {compared}");
    let page = printed(at, commands[1]);
    // Two digits of the uncertainty are printed.
    let decimals = (1.0 - read.log10().floor()).max(0.0) as usize;
    assert!(page.contains(&format!("± {read:.decimals$} m/s")), "{read}: {page}");
}
