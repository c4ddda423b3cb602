//! Plans with numbers that nobody has measured: none is certified as exact, as not a number, or
//! with an interval that the Monte Carlo check contradicts.

use std::path::Path;

use assert_cmd::Command;
use hertzscope::calibrate::{self, CalibrationReport};
use hertzscope::recording::mcap;
use hertzscope::recording::tek_csv::TableColumns;
use hertzscope::scene::plan;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;

use super::BENCH;

/// The design's test as files; the plan's text.
fn written(folder: &Path) -> String {
    let test = BENCH.designer.test(&BENCH.candidate).expect("a test");
    for (name, set) in &test.recordings {
        mcap::write(&folder.join(name), set).expect("a recording");
    }
    test.plan
}

/// `plan` with every line of `key` saying `value` instead.
fn with(plan: &str, key: &str, value: &str) -> String {
    let start = format!("{key} = ");
    assert!(plan.lines().any(|line| line.starts_with(&start)), "{key} in\n{plan}");
    let line = |line: &str| {
        if line.starts_with(&start) { format!("{start}{value}") } else { line.to_owned() }
    };
    plan.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// An uncertainty above its value, or one that is not finite, determines nothing, and neither do
/// numbers that no double can multiply: exit code 2, and no file.
#[test]
fn uncertainties_above_their_values_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let plan = written(at);
    for (key, value) in [
        ("gravity_u", "\"9.9 m/s^2\""),
        ("gravity_u", "\"101 %\""),
        ("gravity_u", "1e100"),
        ("gravity_u", "inf"),
        ("mass_u", "inf"),
        ("mass_u", "\"1 kg\""),
        ("mass_u", "\"1e200 kg\""),
        ("mass_u", "\"1e-2 kg\""),
        ("rebound_speed_u", "inf"),
        ("rebound_speed_u", "\"10 m/s\""),
        ("height", "\"1e308 mm\""),
        ("mass", "\"1e308 kg\""),
    ] {
        std::fs::write(at.join("plan.toml"), with(&plan, key, value)).expect("a plan");
        let mut command = Command::cargo_bin("hertzscope").expect("the program");
        let done = command.current_dir(at).args(["calibrate", "plan.toml", "-o", "out"]).assert();
        let output = done.get_output();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{key} = {value}: {said}");
        assert!(!at.join("out").exists(), "{key} = {value} left a folder");
        assert!(said.contains(key.trim_end_matches("_u")), "{key} = {value}: {said}");
    }
}

/// A laboratory's, likewise: no design is ranked by an uncertainty of zero.
#[test]
fn a_laboratory_with_an_impossible_uncertainty_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.toml");
    let mut command = Command::cargo_bin("hertzscope").expect("the program");
    let printed = command.args(["help", "lab"]).assert().success();
    let lab = String::from_utf8_lossy(&printed.get_output().stdout).into_owned();
    for (key, value) in
        [("gravity_u", "\"100 m/s^2\""), ("gravity_u", "inf"), ("rebound_u", "\"150 %\"")]
    {
        std::fs::write(&file, with(&lab, key, value)).expect("a laboratory");
        let mut command = Command::cargo_bin("hertzscope").expect("the program");
        let arguments = ["calibrate", "--simulate", "pzt-5a-710pf", "--striker", "0.61g", "--lab"];
        let done = command.args(arguments).arg(&file).arg("-q").assert().code(2);
        let said = String::from_utf8_lossy(&done.get_output().stderr).into_owned();
        assert!(said.contains(key), "{key} = {value}: {said}");
    }
}

fn calibrated(at: &Path, plan: &str) -> Result<CalibrationReport, String> {
    let file = at.join("plan.toml");
    std::fs::write(&file, plan).expect("a plan");
    let plan = plan::load(&file).map_err(|error| error.to_string())?;
    let found = calibrate::run(&plan, &TableColumns::default());
    found.map_err(|error| error.to_string())
}

/// `S` goes with one over the mass, so that its own distribution is skew for a mass known to 10 %:
/// 95 % of `1/m` lie between `1/(1 + 1.96 * 0.1)` and `1/(1 - 1.96 * 0.1)`, that is from 16.4 %
/// below to 24.4 % above, where propagation says 19.6 % either way. The certified interval reaches
/// as far as the drawn one.
#[test]
fn a_skew_distribution_is_certified_by_its_draws() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = with(&written(folder.path()), "mass_u", "\"10 %\"");
    let report = calibrated(folder.path(), &plan).expect("a calibration");
    let [low, high] = report.result.interval_95.map(|end| end / report.result.sensitivity - 1.0);
    // The other inputs add 0.5 % in squares; 200,000 draws place an end to 0.1 %.
    assert!((0.240..0.26).contains(&high) && low < -0.16, "{low} {high}");
    assert!(report.contradictions.is_empty(), "{:?}", report.contradictions);
}

/// `S` goes with one over the speeds: what they share adds to its relative uncertainty in squares.
#[test]
fn the_speeds_common_uncertainty_counts_in_full() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = written(folder.path());
    let relative = |text: &str| {
        let result = calibrated(folder.path(), text).expect("a calibration").result;
        result.u / result.sensitivity
    };
    let (alone, scaled) =
        (relative(&plan), relative(&format!("{plan}\n[speeds]\nscale_u = \"3 %\"\n")));
    let share = (scaled.powi(2) - alone.powi(2)).sqrt();
    assert!((share / 0.03 - 1.0).abs() < 0.01, "{share}");
}

/// Plans with one to three numbers multiplied by a power of ten or replaced by a hostile one: each
/// is refused, or every number of its certificate is finite, its interval is not zero and reaches
/// as far as the drawn one.
#[test]
fn mutated_plans_are_refused_or_honestly_certified() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let plan = format!("draws = 30000\n{}", written(at));
    let lines: Vec<&str> = plan.lines().collect();
    let numbers: Vec<usize> = (0..lines.len()).filter(|i| mutable(lines[*i])).collect();
    let trials = if std::env::var_os("HERTZSCOPE_LONG").is_some() { 10_000 } else { 500 };
    let (mut certified, mut refused, mut drawn) = (0, 0, 0);
    for trial in 0..trials {
        let mut random = Pcg64::new(trial, 7);
        let mut even = || -> f64 { StandardUniform.sample(&mut random) };
        let mut changed: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        for _ in 0..=(3.0 * even()) as usize {
            let line = numbers[(numbers.len() as f64 * even()) as usize];
            changed[line] = mutated(lines[line], &mut even);
        }
        let text = changed.join("\n");
        let Ok(report) = calibrated(at, &text) else {
            refused += 1;
            continue;
        };
        if !report.contradictions.is_empty() {
            refused += 1;
            continue;
        }
        certified += 1;
        let changes: Vec<&str> =
            changed.iter().zip(&lines).filter(|(a, b)| a != b).map(|(a, _)| a.as_str()).collect();
        let json = serde_json::to_string(&report).expect("JSON");
        let value: serde_json::Value = serde_json::from_str(&json).expect("JSON");
        for key in ["sensitivity_v_per_n", "u_v_per_n", "coverage_factor", "U95_v_per_n", "tau_s"] {
            let number = value[key].as_f64().unwrap_or_else(|| panic!("{key}: {changes:?}"));
            assert!(number > 0.0, "{key} = {number}: {changes:?}");
        }
        let [low, high] = report.result.interval_95;
        let check = report.result.monte_carlo.as_ref().expect("draws");
        let [drawn_low, drawn_high] = check.interval_95;
        assert!(
            low <= drawn_low + check.tolerance && high >= drawn_high - check.tolerance,
            "{low} to {high}, drawn {drawn_low} to {drawn_high}: {changes:?}"
        );
        drawn += i32::from(!check.agrees);
    }
    println!("{certified} certified, {drawn} of them by draws, {refused} refused");
    assert!(certified > trials as i32 / 20 && refused > trials as i32 / 4);
}

/// Whether `line` has a number that a mutation may change.
fn mutable(line: &str) -> bool {
    let Some((key, value)) = line.split_once(" = ").filter(|_| !line.starts_with('#')) else {
        return false;
    };
    key != "draws" && value.trim_start_matches('"').starts_with(|c: char| c.is_ascii_digit())
}

fn mutated(line: &str, even: &mut dyn FnMut() -> f64) -> String {
    let (key, value) = line.split_once(" = ").expect("a key");
    let text = value.trim_matches('"');
    let (number, unit) = text.split_once(' ').map_or((text, ""), |(n, u)| (n, u));
    let number: f64 = number.parse().expect("a number");
    let hostile = ["inf", "nan", "-inf", "0", "1e308", "1e-308", "-1", "1e100"];
    let place = (hostile.len() as f64 * even()) as usize;
    if even() < 0.2 {
        return format!("{key} = {}", hostile[place]);
    }
    let factor = 10f64.powf(12.0 * even() - 4.0);
    let factor = if even() < 0.5 { factor } else { 10f64.powf(2.0 * even() - 1.0) };
    format!("{key} = \"{:e} {unit}\"", number * factor)
}
