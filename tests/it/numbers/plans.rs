//! Calibrations: local gravity, scatter, non-linearity, plans that contradict themselves, and the
//! chain in the sensor's file.

use assert_cmd::Command;
use hertzscope::calibrate::equation::SpeedSource;
use hertzscope::calibrate::simulation::BlindCalibration;
use hertzscope::calibrate::{Calibration, Draws, calibrate};
use hertzscope::recording::mcap;
use hertzscope::scene::{plan, sensors};
use std::path::Path;

use crate::calibration::BENCH;

fn calibrated(blind: &BlindCalibration) -> Calibration {
    calibrate(&blind.strikes, &blind.common, Draws { seed: 0, count: 0 }).expect("a calibration")
}

/// The design's test as files, its plan changed by `edit`.
fn write(folder: &Path, edit: impl FnOnce(String) -> String) {
    let test = BENCH.designer.test(&BENCH.candidate).expect("a test");
    for (name, set) in &test.recordings {
        mcap::write(&folder.join(name), set).expect("a recording");
    }
    std::fs::write(folder.join("plan.toml"), edit(test.plan)).expect("a plan");
}

fn hertzscope(folder: &Path, arguments: &[&str]) -> assert_cmd::assert::Assert {
    let mut command = Command::cargo_bin("hertzscope").expect("the program");
    command.current_dir(folder).args(arguments).assert()
}

/// Without a statement gravity is the standard value, and may be any on the ground: 9.780 to 9.832
/// m/s^2, 0.27 % around it. A statement says its uncertainty.
#[test]
fn gravity_has_an_uncertainty() {
    let folder = tempfile::tempdir().expect("a folder");
    let without = |plan: String| {
        plan.lines().filter(|line| !line.starts_with("gravity")).collect::<Vec<_>>().join("\n")
    };
    write(folder.path(), without);
    let file = folder.path().join("plan.toml");
    let gravity = plan::load(&file).expect("a plan").gravity;
    assert_eq!(gravity.value, 9.80665);
    assert!((gravity.u / (9.80665 * 0.0027 / 3f64.sqrt()) - 1.0).abs() < 1e-9, "{gravity:?}");
    write(folder.path(), |plan| format!("gravity = \"9.81 m/s^2\"\n{}", without(plan)));
    let told = plan::load(&file).expect_err("no uncertainty").to_string();
    assert!(told.contains("gravity_u"), "{told}");
}

/// Records through a dividing probe, and a plan that has the scope's own input as the load: ten
/// megohms beside one, another time constant.
#[test]
fn a_probe_that_the_plan_does_not_know_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), |plan| plan);
    let file = folder.path().join("impact-1.mcap");
    let mut set = mcap::read(&file).expect("a recording");
    for shot in &mut set.shots {
        shot.captures.iter_mut().for_each(|capture| capture.waveform.vertical.probe = 10.0);
    }
    mcap::write(&file, &set).expect("a recording");
    let refused = hertzscope(folder.path(), &["calibrate", "plan.toml", "--quiet"]).code(2);
    let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(told.contains("a probe of 10 x") && told.contains("input_resistance"), "{told}");
}

/// Readings that scatter more than their stated uncertainties: 400 calibrations each, whose
/// coverage scatters by 1.1 %.
#[test]
fn intervals_hold_where_impacts_scatter_more_than_stated() {
    let truth = BENCH.designer.circuit().expect("a circuit").sensitivity;
    for times in [1.0, 1.8, 3.0] {
        let mut inside = 0;
        for repeat in 0..400 {
            let mut blind = BENCH.blind(1000 + repeat);
            for strike in &mut blind.strikes {
                for speed in [&mut strike.motion.incoming, &mut strike.motion.rebound] {
                    match speed {
                        SpeedSource::Speed(q) | SpeedSource::Height(q) => q.u /= times,
                        _ => panic!("a speed or a height"),
                    }
                }
            }
            let found = calibrated(&blind);
            inside += i32::from((found.sensitivity - truth).abs() <= found.expanded);
        }
        let coverage = f64::from(inside) / 400.0;
        assert!((0.93..=0.98).contains(&coverage), "scatter {times} times: {coverage}");
    }
}

/// A sensor whose sensitivity rises by 4 % up to the highest force, 60 times: the interval holds
/// its sensitivity at that force.
#[test]
fn a_non_linearity_that_is_found_counts() {
    let (inside, found_it, _) = bent(0.04);
    // Where noise hides it, nothing can be counted.
    assert!(inside >= found_it - 3, "{inside} of {found_it}");
    assert!(found_it > 30, "{found_it} found");
}

/// One of 2 % is hidden by noise more often than not: of 60 certificates 13 contain the sensitivity
/// at the highest force, and 6 find that it changes. A note on the others says how much it may be.
#[test]
fn a_non_linearity_that_noise_hides_is_told() {
    let (inside, found_it, told) = bent(0.02);
    println!("{inside} inside, {found_it} found, {told} inside, found or told");
    // 57 of 60 on average; fewer than 52 in 0.3 % of all cases.
    assert!(told >= 52, "{told} of 60");
}

/// Of 60 calibrations of a sensor whose sensitivity rises by the share `bend` up to the highest
/// force: how many contain the sensitivity there, how many find that it changes, and how many do
/// either, or say that it may.
fn bent(bend: f64) -> (i32, i32, i32) {
    let circuit = BENCH.designer.circuit().expect("a circuit");
    let highest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let top = BENCH.truths.iter().map(|t| highest(&t.force.values)).fold(0.0, f64::max);
    let mut truths = BENCH.truths.clone();
    for force in truths.iter_mut().flat_map(|truth| &mut truth.force.values) {
        *force *= 1.0 + bend * *force / top;
    }
    let (mut inside, mut found_it, mut told) = (0, 0, 0);
    for repeat in 0..60 {
        let setup = (&BENCH.setup, 3000 + repeat);
        let found = calibrated(&BENCH.designer.blind(&BENCH.striker, &truths, circuit, setup));
        let there = (1.0 + bend) * circuit.sensitivity;
        let is_found = found.nonlinearity.is_some_and(|line| line.is_found());
        let is_inside = (found.sensitivity - there).abs() <= found.expanded;
        let is_told = found.notes.iter().any(|note| note.contains("ends of the range of forces"));
        found_it += i32::from(is_found);
        inside += i32::from(is_inside);
        told += i32::from(is_inside || is_found || is_told);
    }
    (inside, found_it, told)
}

/// Half of the heights ten times too large: the impacts contradict each other. No certificate, exit
/// code 1; `--force` certifies all the same. So do rebounds that are faster than the fall.
#[test]
fn a_plan_that_contradicts_itself_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    write(at, |plan| {
        let ten = |line: &str| {
            let number: f64 = line
                .split('"')
                .nth(1)
                .and_then(|t| t.split(' ').next())
                .expect("m")
                .parse()
                .expect("a number");
            format!("height = \"{:e} m\"", 10.0 * number)
        };
        let mut heights = 0;
        let mut line = |line: &str| {
            heights += i32::from(line.starts_with("height ="));
            let wrong = line.starts_with("height =") && heights <= 3;
            if wrong { ten(line) } else { line.to_owned() }
        };
        plan.lines().map(&mut line).collect::<Vec<_>>().join("\n")
    });
    let refused = hertzscope(at, &["calibrate", "plan.toml", "-o", "out"]).code(1);
    let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(told.contains("impacts scatter") && told.contains("--force"), "{told}");
    assert!(!at.join("out").exists());
    hertzscope(at, &["calibrate", "plan.toml", "-o", "out", "--force"]).success();
    assert!(at.join("out/certificate.md").exists());
    // Half of what the readings scatter by as their uncertainties: a Birge ratio between 2.2 and 5.
    write(at, |plan| {
        let half = |line: &str| {
            let (key, value) = line.split_once(" = \"").expect("a text");
            let (number, unit) = value.split_once(' ').expect("a unit");
            format!("{key} = \"{:e} {unit}", 0.5 * number.parse::<f64>().expect("a number"))
        };
        let line = |line: &str| {
            let is_reading = line.starts_with("height_u") || line.starts_with("rebound_speed_u");
            if is_reading { half(line) } else { line.to_owned() }
        };
        plan.lines().map(line).collect::<Vec<_>>().join("\n")
    });
    let refused = hertzscope(at, &["calibrate", "plan.toml", "-o", "half", "--json"]).code(1);
    let found: serde_json::Value =
        serde_json::from_slice(&refused.get_output().stdout).expect("JSON");
    let ratio = found["birge_ratio"].as_f64().expect("a ratio");
    assert!((2.2..5.0).contains(&ratio), "{ratio}");
    assert!(!at.join("half").exists());
    write(at, |plan| plan.replace("rebound_speed = \"", "rebound_speed = \"1"));
    let refused = hertzscope(at, &["calibrate", "plan.toml"]).code(1);
    let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(told.contains("faster than it came"), "{told}");
}

/// A sensor that was calibrated with its channel says so in its file, and is read back so.
#[test]
fn the_sensors_file_carries_channel_and_range() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    write(at, |plan| plan);
    hertzscope(at, &["calibrate", "plan.toml", "-o", "out"]).success();
    let file = at.join("out/pzt-5a-710pf-calibrated.toml").display().to_string();
    let sensor = sensors::load(&file).expect("readable").expect("a sensor");
    let chain = sensor.measured.chain.expect("a chain");
    assert_eq!((chain.channel, chain.range), (1, 2.0));
    // Used at 2 V/div nothing is added; through another range of a scope that nobody knows, both
    // gains count.
    let wire = format!("CH1={file}");
    let json = hertzscope(at, &["force", "impact-1.mcap", "--sensor", &wire, "--json"]).success();
    let found: serde_json::Value = serde_json::from_slice(&json.get_output().stdout).expect("JSON");
    assert_eq!(found["channels"][0]["gain_u_relative"], 0.0, "the same channel and range");
    let text = std::fs::read_to_string(&file)
        .expect("a file")
        .replace("range = \"2 V/div\"", "range = \"5 V/div\"");
    std::fs::write(&file, text).expect("a file");
    let page = hertzscope(at, &["force", "impact-1.mcap", "--sensor", &wire]).success();
    let page = String::from_utf8_lossy(&page.get_output().stdout).into_owned();
    assert!(page.contains("u = 2.45 %") && page.contains("CH1 at 5.00 V/div"), "{page}");
}

/// Behind a charge amplifier the sensitivity is its gain times the charge; the sensor's file names
/// no input, so that it holds for any.
#[test]
fn a_charge_amplifier_is_a_load() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    write(at, |plan| {
        let plan: Vec<&str> = plan.lines().filter(|line| !line.starts_with("input_")).collect();
        plan.join("\n").replace("[scope]", "[scope]\ncharge_amplifier = \"10 mV/pC\"")
    });
    let output = hertzscope(at, &["calibrate", "plan.toml", "-o", "out", "--json"]).success();
    let found: serde_json::Value =
        serde_json::from_slice(&output.get_output().stdout).expect("JSON");
    let number = |key: &str| found[key].as_f64().expect("a number");
    // 10 mV/pC is 1e10 V/C.
    let charge = number("sensitivity_v_per_n") / 1e10;
    assert!((number("charge_sensitivity_c_per_n") / charge - 1.0).abs() < 1e-12);
    let file = at.join("out/pzt-5a-710pf-calibrated.toml").display().to_string();
    let sensor = sensors::load(&file).expect("readable").expect("a sensor");
    assert_eq!(sensor.measured.load, None);
    let certificate = std::fs::read_to_string(at.join("out/certificate.md")).expect("a page");
    assert!(certificate.contains("a charge amplifier of 10 mV/pC"), "{certificate}");
}

/// A plate below 1 g of 8 g that move as a whole feels 7/8 of the momentum: the plan's masses give
/// back the sensor's own sensitivity, and their uncertainty counts.
#[test]
fn what_stays_above_the_plate_is_taken_off() {
    let circuit = BENCH.designer.circuit().expect("a circuit");
    let mut truths = BENCH.truths.clone();
    truths.iter_mut().flat_map(|t| &mut t.force.values).for_each(|force| *force *= 0.875);
    let mut blind = BENCH.designer.blind(&BENCH.striker, &truths, circuit, (&BENCH.setup, 1));
    let without = calibrated(&blind);
    assert!((without.sensitivity / circuit.sensitivity / 0.875 - 1.0).abs() < 0.01);
    let folder = tempfile::tempdir().expect("a folder");
    let masses = "mass_above = \"1 g\"\nmass_above_u = \"4 %\"\nmass_moved = \"8 g\"\nmass_moved_u = \"3 %\"\n";
    write(folder.path(), |plan| plan.replace("[sensor]\n", &format!("[sensor]\n{masses}")));
    let read = plan::load(&folder.path().join("plan.toml")).expect("a plan").above;
    assert!((read.value - 0.125).abs() < 1e-12 && (read.u / 0.125 - 0.05).abs() < 1e-12);
    blind.common.above = read;
    let found = calibrated(&blind);
    let off = (found.sensitivity - circuit.sensitivity).abs();
    assert!(off < found.expanded && off < 0.01 * circuit.sensitivity, "{off}");
    // u of the share over what is left: 0.05 * 0.125/0.875.
    let line = found.budget.iter().find(|line| line.name == "inertia above the plate");
    let share = line.expect("a line").contribution.abs() / found.sensitivity;
    assert!((share / (0.05 * 0.125 / 0.875) - 1.0).abs() < 0.01, "{share}");
    write(folder.path(), |plan| plan.replace("[sensor]\n", "[sensor]\nmass_above = \"1 g\"\n"));
    let told = plan::load(&folder.path().join("plan.toml")).expect_err("half of it").to_string();
    assert!(told.contains("mass_above_u") || told.contains("mass_moved"), "{told}");
}

/// A laboratory's own striker, heights, gates and scope make the design; what is wrong in its file
/// is told with its place.
#[test]
fn a_design_uses_what_the_laboratory_has() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let lab = "gravity = \"9.8115 m/s^2\"\ngravity_u = \"0.0005 m/s^2\"\nheights = [\"12 mm\"]\nspeed_u = \"0.5 %\"\nflight_time_u = \"0.1 ms\"\n\
        [scope]\nmodel = \"tds2024\"\ngain_limit = \"3 %\"\n\
        [strikers.\"our ball\"]\nmaterial = \"brass\"\ndiameter = \"5 mm\"\nmass = \"0.556 g\"\nmass_u = \"1 mg\"\n";
    std::fs::write(at.join("lab.toml"), lab).expect("a file");
    let design = ["calibrate", "--simulate", "pzt-5a-710pf", "--lab", "lab.toml", "-o", "test"];
    let printed = hertzscope(at, &[&design[..], &["--json", "-q"]].concat()).success();
    let found: serde_json::Value =
        serde_json::from_slice(&printed.get_output().stdout).expect("JSON");
    for candidate in found["candidates"].as_array().expect("candidates") {
        assert_eq!(candidate["striker"], "our ball");
        assert_eq!(candidate["height_m"], 12e-3);
    }
    let plan = std::fs::read_to_string(at.join("test/plan.toml")).expect("a plan");
    for line in
        ["gain_limit = 0.03", "gravity = \"9.811500e0 m/s^2\"", "flight_time_u = ", "\nspeed_u = "]
    {
        assert!(plan.contains(line), "{line}: {plan}");
    }
    let certified = hertzscope(at, &["calibrate", "test/plan.toml", "--json"]).success();
    let found: serde_json::Value =
        serde_json::from_slice(&certified.get_output().stdout).expect("JSON");
    let number = |key: &str| found[key].as_f64().expect("a number");
    let truth = BENCH.designer.circuit().expect("a circuit").sensitivity;
    let off = (number("sensitivity_v_per_n") - truth).abs();
    assert!(off < number("U95_v_per_n"), "{off} {found}");
    for (right, wrong, told) in [
        ("\"12 mm\"", "\"12 g\"", "lab.toml:3"),
        ("speed_u = \"0.5 %\"\n", "", "one of height_u, speed_u"),
        ("mass_u = \"1 mg\"", "", "mass_u"),
        ("flight_time_u", "rebound_u = \"1 %\"\nflight_time_u", "2 of them"),
    ] {
        std::fs::write(at.join("lab.toml"), lab.replace(right, wrong)).expect("a file");
        let refused = hertzscope(at, &design).code(2);
        let error = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(error.contains(told), "{wrong}: {error}");
    }
}

/// All heights ten times too large contradict nothing, but strikers then seem to keep a third of
/// their speed: the certificate says so.
#[test]
fn strikers_that_lose_most_of_their_speed_are_noted() {
    let notes = |factor: f64| {
        let folder = tempfile::tempdir().expect("a folder");
        let edit = |line: &str| match line.strip_prefix("height = \"") {
            Some(rest) => {
                let (number, unit) = rest.split_once(' ').expect("a unit");
                let height: f64 = number.parse().expect("a number");
                format!("height = \"{} {unit}", factor * height)
            }
            None => line.to_owned(),
        };
        write(folder.path(), |plan| plan.lines().map(edit).collect::<Vec<_>>().join("\n"));
        let arguments = ["calibrate", "plan.toml", "--json", "--force", "--quiet"];
        let printed = hertzscope(folder.path(), &arguments);
        let found: serde_json::Value =
            serde_json::from_slice(&printed.get_output().stdout).expect("JSON");
        found["notes"].to_string()
    };
    assert!(!notes(1.0).contains("strikers leave"), "{}", notes(1.0));
    assert!(notes(10.0).contains("strikers leave"), "{}", notes(10.0));
}
