//! Uncertain scenes: intervals that hold, shares that one-at-a-time runs confirm, and comparisons
//! by what both sides know.

use assert_cmd::Command;
use hertzscope::experiment::outcome::Speed;
use hertzscope::experiment::prediction::{Prediction, predict};
use hertzscope::measurement::compare::score_limits::ScoreLimits;
use hertzscope::measurement::compare::{Align, ComparedShot, compare};
use hertzscope::predict::{SampleOptions, judge, uncertain_prediction};
use hertzscope::scene::Scene;
use hertzscope::scene::adjust::{Adjustable, AdjustableNumber};
use hertzscope::scope::Deviation;

use super::recorded;

const SHORT: &str = "base = \"magnet-0.61g\"\nduration = \"400 us\"\n\
    [[chain.segments]]\nparticles = [\"ferromagnetic_sphere\", \"ptfe_sphere\"]\n\
    [[chain.segments]]\nrepeat = 4\nparticles = [\"steel_cylinder\", \"ptfe_sphere\"]\n\
    [sensors.p14]\nparticle = 6\n[sensors.p27]\nparticle = 9\nhost = \"steel_cylinder\"\n\
    [scope]\ntime_base = \"50 us/div\"\nposition = \"200 us\"\n";

/// What the shipped scene states, none of which varies here but `stated`.
pub fn only(stated: &[(&str, &str)]) -> String {
    let inherited = [
        "striker.speed",
        "striker.mass",
        "effects.magnet_preload.force",
        "materials.ptfe.youngs_modulus",
        "materials.ptfe.poissons_ratio",
        "materials.stainless_steel.youngs_modulus",
        "materials.stainless_steel.poissons_ratio",
        "particles.ptfe_sphere.mass",
        "particles.steel_cylinder.mass",
        "particles.ferromagnetic_sphere.mass",
        "\"sensors.*.host_mass\"",
        "\"sensors.*.offset\"",
    ];
    let is_stated = |path: &&&str| !stated.iter().any(|(other, _)| other == *path);
    let zero = inherited.iter().filter(is_stated).map(|path| format!("{path} = \"0 %\"\n"));
    let stated = stated.iter().map(|(path, spread)| format!("{path} = {spread}\n"));
    format!("[uncertainty]\n{}", zero.chain(stated).collect::<String>())
}

fn adjustable(folder: &tempfile::TempDir, text: &str) -> (Adjustable, String) {
    let file = folder.path().join("short.toml");
    std::fs::write(&file, format!("{SHORT}{text}")).expect("a scene");
    let name = file.display().to_string();
    (Adjustable::load(&name).expect("a scene"), name)
}

/// Changes with one standard uncertainty against runs with that input alone moved by half of one to
/// either side; shares add up to what is explained.
#[test]
fn a_budget_agrees_with_one_input_at_a_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = only(&[
        ("striker.speed", "\"1 %\""),
        ("materials.ptfe.youngs_modulus", "\"2 %\""),
        ("effects.magnet_preload.force", "{ half_width = \"0.1 N\" }"),
    ]);
    let (mut scene, _) = adjustable(&folder, &text);
    let options = SampleOptions { samples: 300, seed: 3 };
    let found = uncertain_prediction(&mut scene, options, false, &|_| ()).expect("a prediction");
    assert_eq!(found.failed, 0);
    for path in ["striker.speed", "materials.ptfe.youngs_modulus", "effects.magnet_preload.force"] {
        let knob = scene.knobs(path).expect("a knob").remove(0);
        let u = found.inputs.iter().find(|input| input.name == path).expect("an input").u;
        let speed = |by: f64| {
            let moved = scene.with(&[(&knob, knob.value + by)]).expect("a scene");
            let found = predict(&moved, 1e-5, false).expect("a run");
            value_of("p14 -> p27 half-rise", &found).expect("a speed")
        };
        let alone = speed(0.5 * u) - speed(-0.5 * u);
        let output = found.outputs.iter().find(|o| o.name == "p14 -> p27 half-rise");
        let output = output.expect("an output");
        let part = output.inputs.iter().find(|share| share.input == path).expect("a share");
        // Residuals of the regression scatter by a few per cent of the largest change.
        let largest = output.inputs.iter().map(|i| i.change.abs()).fold(0.0, f64::max);
        assert!((part.change - alone).abs() < 0.05 * largest, "{path}: {} {alone}", part.change);
        let shares: f64 = output.inputs.iter().map(|input| input.share).sum();
        assert!((shares - output.explained).abs() < 1e-9 && output.explained > 0.98, "{output:?}");
    }
}

/// Sixteen inputs of a hundred samples go together by chance: shares of a first peak added up to
/// more than 100 % before. And a mass that may only be larger has an interval on one side: both
/// ends are told, none is behind a `±`.
#[test]
fn shares_are_parts_of_one_and_lopsided_intervals_have_two_ends() {
    let mut scene = Adjustable::load("magnet-0.61g").expect("a scene");
    let options = SampleOptions { samples: 100, seed: 1 };
    let found = uncertain_prediction(&mut scene, options, false, &|_| ()).expect("a prediction");
    for output in &found.outputs {
        let shares: f64 = output.inputs.iter().map(|input| input.share).sum();
        assert!(shares <= 1.0 + 1e-9, "{}: {shares}", output.name);
    }
    let folder = tempfile::tempdir().expect("a folder");
    let text = only(&[("striker.speed", "{ between = [\"0.44 m/s\", \"0.46 m/s\"] }")]);
    let (_, name) = adjustable(&folder, &text);
    let run = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("hertzscope").expect("the program");
        command.current_dir(folder.path()).args(arguments).assert()
    };
    let page = run(&["budget", &name, "-q", "--samples", "60"]).success();
    let page = String::from_utf8_lossy(&page.get_output().stdout).into_owned();
    let line = page.lines().find(|line| line.contains("p14 first peak")).expect("a peak");
    assert!(line.contains(" to ") && !line.contains('±'), "{line}");
    // 95 % from 0.4405 to 0.4595 m/s: 0.458 is inside, 0.425 outside though within 95 % of 0.44 by
    // a symmetric one.
    for (speed, agrees) in [("0.458 m/s", true), ("0.425 m/s", false)] {
        let text = format!("base = {name:?}\nstriker.speed = \"{speed}\"\n");
        std::fs::write(folder.path().join("other.toml"), text).expect("a scene");
        let recording = format!("{agrees}.mcap");
        run(&["run", "other.toml", "-q", "-o", &recording]).success();
        let compare = ["compare", &recording, &name, "--json", "-q", "--samples", "60"];
        let output = run(&compare);
        let found: serde_json::Value =
            serde_json::from_slice(&output.get_output().stdout).expect("JSON");
        let errors = found["normalised_errors"].as_array().expect("errors");
        let peak = errors.iter().find(|e| e["quantity"] == "CH4 first peak").expect("a peak");
        println!("{speed}: {peak}");
        assert_eq!(peak["E_n"].as_f64().expect("a number") <= 1.0, agrees, "{peak}");
    }
}

/// Limits that leave out the scene's own value contradict it.
#[test]
fn limits_hold_the_scenes_own_value() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = only(&[("striker.speed", "{ between = [\"0.45 m/s\", \"0.46 m/s\"] }")]);
    let (mut scene, _) = adjustable(&folder, &text);
    let options = SampleOptions { samples: 30, seed: 1 };
    let refused = uncertain_prediction(&mut scene, options, false, &|_| ());
    let words = refused.expect_err("a contradiction").to_string();
    assert!(words.contains("striker.speed") && words.contains("440.0 mm/s"), "{words}");
}

/// Gains and zeros that a run draws from its seed are inputs of a prediction: its values are those
/// of an exact scope, in the middle of their intervals, and a measured reading that is held against
/// them has no gain of its own.
#[test]
fn gains_count_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = only(&[("striker.speed", "\"1 %\"")]);
    let (_, exact) = adjustable(&folder, &text);
    let drawn = folder.path().join("drawn.toml");
    let own = format!("base = {exact:?}\n[effects.scope_errors]\n");
    std::fs::write(&drawn, own).expect("a scene");
    let drawn = drawn.display().to_string();
    let mut scene = Adjustable::load(&drawn).expect("a scene");
    let options = SampleOptions { samples: 200, seed: 1 };
    let found = uncertain_prediction(&mut scene, options, false, &|_| ()).expect("a prediction");
    let of_scope = found.outputs.iter().filter(|output| output.unit == "V");
    for output in of_scope {
        let off = (output.value - output.middle()).abs();
        // The data sheet's gain is 3 % at most: half of the interval is about that.
        assert!(off < 0.1 * output.expanded && output.expanded > 0.02 * output.value, "{output:?}");
    }
    let run = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("hertzscope").expect("the program");
        let done = command.current_dir(folder.path()).args(arguments).assert();
        done.get_output().stdout.clone()
    };
    run(&["run", &exact, "-q", "-o", "measured.mcap"]);
    run(&["convert", "measured.mcap", "measured", "-q"]);
    let measured = |scene: &str| {
        let asked = ["compare", "measured/ALL0000", scene, "--json", "-q", "--samples", "60"];
        let found: serde_json::Value = serde_json::from_slice(&run(&asked)).expect("JSON");
        let errors = found["normalised_errors"].as_array().expect("errors");
        let peak = errors.iter().find(|e| e["quantity"] == "CH4 first peak").expect("a peak");
        peak["measured"]["u"].as_f64().expect("a number")
            / peak["measured"]["value"].as_f64().expect("a number")
    };
    assert!((measured(&exact) - 0.03 / 3f64.sqrt()).abs() < 2e-3, "{}", measured(&exact));
    assert!(measured(&drawn) < 0.01, "{}", measured(&drawn));
}

/// A speed or a first peak of a bench by the name of the output.
fn value_of(name: &str, drawn: &Prediction) -> Option<f64> {
    if let Some(sensor) = name.strip_suffix(" first peak") {
        let reading = drawn.readings.iter().find(|reading| reading.name == sensor)?;
        return Some(reading.first_peak?.dynamic_n);
    }
    let (from, to) = name.split_once(" -> ")?;
    let (to, estimator) = to.split_once(' ')?;
    let estimator = estimator.replace('-', "_");
    let of = |s: &&Speed| s.from_sensor == from && s.to_sensor == to && s.estimator == estimator;
    Some(drawn.speeds.iter().find(of)?.m_per_s)
}

/// Benches drawn from the stated distribution by another generator: 95 % of their peaks and speeds
/// lie in the intervals, and 95 % of the traces' points in the bands.
#[test]
fn intervals_and_bands_hold_drawn_benches() {
    const DRAWN: u32 = 1000;
    let folder = tempfile::tempdir().expect("a folder");
    let text = only(&[
        ("striker.speed", "\"2 %\""),
        ("materials.ptfe.youngs_modulus", "\"2 %\""),
        ("particles.ptfe_sphere.mass", "{ between = [\"0.120 g\", \"0.1252 g\"] }"),
    ]);
    let (mut scene, _) = adjustable(&folder, &text);
    let options = SampleOptions { samples: 1000, seed: 5 };
    let found = uncertain_prediction(&mut scene, options, true, &|_| ()).expect("a prediction");
    let knobs: Vec<_> =
        ["striker.speed", "materials.ptfe.youngs_modulus", "particles.ptfe_sphere.mass"]
            .iter()
            .flat_map(|path| scene.knobs(path).expect("a knob"))
            .collect();
    // Box and Muller on a linear congruence: nothing of the study's own draws.
    let mut state = 77_u64;
    let mut even = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    let (mut inside, mut all, mut points, mut within) = (0.0, 0.0, 0.0, 0.0);
    for _ in 0..DRAWN {
        let radius = (-2.0 * even().ln()).sqrt();
        let angle = std::f64::consts::TAU * even();
        let speed = knobs[0].value * (1.0 + 0.02 * radius * angle.cos());
        let modulus = knobs[1].value * (1.0 + 0.02 * radius * angle.sin());
        let mass = 0.120e-3 + 0.0052e-3 * even();
        let values = [(&knobs[0], speed), (&knobs[1], modulus), (&knobs[2], mass)];
        let drawn = predict(&scene.with(&values).expect("a scene"), 1e-5, true).expect("a run");
        for output in &found.outputs {
            let Some(value) = value_of(&output.name, &drawn) else { continue };
            let [low, high] = output.interval_95;
            all += 1.0;
            inside += f64::from(u8::from((low..=high).contains(&value)));
        }
        for (band, trace) in found.bands.iter().zip(&drawn.traces) {
            for ((low, high), volts) in band.low_v.iter().zip(&band.high_v).zip(&trace.values) {
                // Before the pulse the band has no width.
                if high - low > 1e-3 {
                    points += 1.0;
                    within += f64::from(u8::from((*low..=*high).contains(volts)));
                }
            }
        }
    }
    assert!(all > 8.0 * f64::from(DRAWN));
    let (share, covered): (f64, f64) = (inside / all, within / points);
    println!("{share:.4} of peaks and speeds, {covered:.4} of the traces' points");
    // Outputs of one bench go together: a thousand benches tell 95 % to 0.7 %.
    assert!((0.93..=0.97).contains(&share), "{share}");
    assert!((0.93..=0.97).contains(&covered), "{covered}");
}

/// Ends of intervals by the samples that are drawn without being told, against ten times as many:
/// within 2 % of the interval's half-width.
#[test]
fn percentiles_are_those_of_ten_times_as_many_samples() {
    let mut scene = Adjustable::load("magnet-0.61g").expect("a scene");
    let few = SampleOptions::default();
    let many = SampleOptions { samples: 10 * few.samples, seed: 9 };
    let [few, many] = [few, many].map(|options| {
        uncertain_prediction(&mut scene, options, false, &|_| ()).expect("a prediction")
    });
    assert_eq!(few.outputs.len(), many.outputs.len());
    let mut failed = Vec::new();
    for (few, many) in few.outputs.iter().zip(&many.outputs) {
        let off = |end: usize| (few.interval_95[end] - many.interval_95[end]) / many.expanded;
        println!("{:30} {:+.4} {:+.4} explained {:.3}", few.name, off(0), off(1), few.explained);
        if off(0).abs().max(off(1).abs()) > 0.02 {
            failed.push(&few.name);
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

/// A scope at 200 mV/div: the bands end where the converter does, and the page says that recordings
/// are clipped.
#[test]
fn bands_end_where_the_converter_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut scene, name) = adjustable(&folder, "[scope.ch2]\nscale = \"200 mV/div\"\n");
    let options = SampleOptions { samples: 40, seed: 1 };
    let found = uncertain_prediction(&mut scene, options, true, &|_| ()).expect("a prediction");
    let channel = scene.scene().expect("a scene").scope.channels[1].clone().expect("CH2");
    // 127 levels of 25 a division above the centre.
    let highest = 0.2 * (127.0 / 25.0 - channel.vertical.position);
    let band = found.bands.iter().find(|band| band.channel == "CH2").expect("a band");
    assert_eq!(band.clipped_share, 1.0);
    assert!(band.high_v.iter().all(|volts| *volts <= highest));
    assert!(band.low_v.contains(&highest));
    let mut command = Command::cargo_bin("hertzscope").expect("the program");
    let arguments = ["run", &name, "--bands", "--samples", "40", "-o", "clipped.mcap"];
    let printed = command.current_dir(folder.path()).args(arguments).assert().success();
    let page = String::from_utf8_lossy(&printed.get_output().stdout).into_owned();
    assert!(page.contains("CH2: 100 % of the traces leave the converter's range"), "{page}");
}

/// Numbers of one group move together: with two inputs that cancel, nothing is left.
#[test]
fn inputs_of_one_group_vary_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let spread = |text: &str| {
        let (mut scene, _) = adjustable(&folder, text);
        let options = SampleOptions { samples: 60, seed: 1 };
        let found =
            uncertain_prediction(&mut scene, options, false, &|_| ()).expect("a prediction");
        (
            found.inputs.len(),
            found
                .outputs
                .iter()
                .find(|o| o.name == "CH2 first peak, droop undone")
                .expect("an output")
                .u,
        )
    };
    let both =
        |spread: &str| only(&[("striker.speed", spread), ("sensors.p14.sensitivity", spread)]);
    let apart = spread(&both("\"1 %\""));
    let together = spread(&both("{ standard = \"1 %\", group = \"scale\" }"));
    assert_eq!((apart.0, together.0), (2, 1));
    // Of changes a and b: the root of a^2 + b^2 apart, a + b together; a is about 1.2 b.
    assert!(together.1 > 1.3 * apart.1, "{apart:?} {together:?}");
}

/// What is stated wrongly is told with its place.
#[test]
fn mistakes_in_an_uncertainty_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    for (text, told) in
        [("striker.sped = \"1 %\"", "striker.sped"), ("striker.speed = \"1 kg\"", "a speed (m/s)")]
    {
        let file = folder.path().join("short.toml");
        std::fs::write(&file, format!("{SHORT}[uncertainty]\n{text}\n")).expect("a scene");
        let name = file.display().to_string();
        let mut command = Command::cargo_bin("hertzscope").expect("the program");
        let failed = command.args(["budget", &name, "-q"]).assert().code(2);
        let error = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(error.contains(told) && error.contains("short.toml:"), "{text}: {error}");
    }
    for (text, told) in [
        ("striker.speed = \"-1 %\"", "uncertainty.striker.speed"),
        ("striker.speed = { standard = \"1 %\", half_width = \"1 %\" }", "one of them"),
        ("striker.speed = { between = [\"2 m/s\", \"1 m/s\"] }", "the lower first"),
        ("striker.speed = { standard = \"1 %\", colour = \"red\" }", "colour"),
    ] {
        let text = format!("base = \"magnet-0.61g\"\n[uncertainty]\n{text}\n");
        let error = Scene::from_text("test", "test.toml", &text).expect_err(&text).to_string();
        assert!(error.contains(told), "{text}: {error}");
    }
}

/// The shipped scenes state what the paper leaves open, each with its source; gravity scenes leave
/// the magnet out.
#[test]
fn shipped_scenes_state_their_uncertainty() {
    for (name, has_magnet) in
        [("magnet-0.61g", true), ("magnet-17.81g", true), ("gravity-2.75g", false)]
    {
        let mut scene = Adjustable::load(name).expect("a scene");
        let options = SampleOptions { samples: 40, seed: 1 };
        let found =
            uncertain_prediction(&mut scene, options, false, &|_| ()).expect("a prediction");
        assert!(
            found.inputs.iter().all(|input| input.source.is_some() && input.u > 0.0),
            "{found:?}"
        );
        let magnet = found.inputs.iter().any(|input| input.name.starts_with("effects.magnet"));
        assert_eq!(magnet, has_magnet, "{name}");
        let hosts = found.inputs.iter().filter(|input| input.name.ends_with("host_mass")).count();
        assert_eq!(hosts, 3, "{name}");
        assert_eq!(found.failed, 0, "{name}");
    }
}

/// `E_n` of a bench from within the stated distribution stays below 1, and is above 1 for a striker
/// that is four of its standard uncertainties too fast, whose move is named.
#[test]
fn comparisons_go_by_what_both_sides_know() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let text = "[uncertainty]\nstriker.speed = \"1 %\"\nmaterials.ptfe.youngs_modulus = \"1 %\"\n";
    let (_, name) = adjustable(&folder, text);
    let run = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("hertzscope").expect("the program");
        command.current_dir(at).args(arguments).assert()
    };
    for (file, speed) in [("inside.toml", "0.443 m/s"), ("outside.toml", "0.4576 m/s")] {
        let text = format!("base = {name:?}\nseed = 4\nstriker.speed = \"{speed}\"\n");
        std::fs::write(at.join(file), text).expect("a scene");
        let recording = file.replace("toml", "mcap");
        run(&["run", file, "-q", "-o", &recording]).success();
    }
    let found = |recording: &str, code: i32| {
        let output =
            run(&["compare", recording, &name, "--json", "-q", "--samples", "200"]).code(code);
        let found: serde_json::Value =
            serde_json::from_slice(&output.get_output().stdout).expect("JSON");
        found["normalised_errors"].as_array().expect("errors").clone()
    };
    let e_n = |error: &serde_json::Value| error["E_n"].as_f64().expect("a number");
    let inside = found("inside.mcap", 0);
    assert!(inside.len() > 6 && inside.iter().all(|error| e_n(error) < 1.0), "{inside:?}");
    for quantity in ["CH2 trace", "CH2 -> CH3 delay", "CH2 -> CH3 half-rise"] {
        assert!(inside.iter().any(|error| error["quantity"] == quantity), "{quantity}: {inside:?}");
    }
    let outside = found("outside.mcap", 1);
    let peak = outside.iter().find(|error| error["quantity"] == "CH2 first peak").expect("a peak");
    assert!(e_n(peak) > 1.0, "{peak}");
    let first = &peak["moves"][0];
    assert_eq!(first["input"], "striker.speed", "{peak}");
    // 4 % are four of its own uncertainties, of which the modulus takes a share.
    let by = first["by_u"].as_f64().expect("a number");
    assert!((2.0..5.0).contains(&by), "{peak}");
}

/// Benches drawn from the stated distribution by another generator, each recorded by a scope with
/// its own noise and errors of gain and zero within the data sheet: 95 % pass; of those whose
/// striker is two, three and four of its standard uncertainties too fast a share is found. Before,
/// with a verdict for each quantity, 58 % passed.
#[test]
fn benches_that_are_as_stated_pass_at_the_stated_level() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = only(&[
        ("striker.speed", "\"1 %\""),
        ("materials.ptfe.youngs_modulus", "\"2 %\""),
        ("particles.ptfe_sphere.mass", "\"1 %\""),
    ]);
    let (mut scene, _) = adjustable(&folder, &text);
    let options = SampleOptions { samples: 400, seed: 5 };
    let predicted = uncertain_prediction(&mut scene, options, true, &|_| ()).expect("a prediction");
    let mut nominal = scene.scene().expect("a scene");
    let knobs: Vec<_> =
        ["striker.speed", "materials.ptfe.youngs_modulus", "particles.ptfe_sphere.mass"]
            .iter()
            .flat_map(|path| scene.knobs(path).expect("a knob"))
            .collect();
    let mut state = 99_u64;
    let mut normal = || {
        let mut even = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        (-2.0 * even().ln()).sqrt() * (std::f64::consts::TAU * even()).cos()
    };
    let mut passed = |trials: u64, faster: f64| {
        let passes = (0..trials).filter(|trial| {
            let mut of = |place: usize, u: f64, off: f64| {
                let knob: &AdjustableNumber = &knobs[place];
                (knob, knob.value * (1.0 + u * (normal() + off)))
            };
            let values = [of(0, 0.01, faster), of(1, 0.02, 0.0), of(2, 0.01, 0.0)];
            let mut drawn = scene.with(&values).expect("a scene");
            drawn.seed = 1000 + trial;
            for (number, channel) in (1..).zip(&mut drawn.scope.channels) {
                if let Some(channel) = channel {
                    channel.deviation = Deviation::drawn(drawn.seed, number);
                }
            }
            let measured = recorded(&drawn, 1e-5);
            // The simulated side, too, has its noise anew.
            nominal.seed = 100_000 + trial;
            let simulated = recorded(&nominal, 1e-5);
            let side = |name, set, scene| ComparedShot { name, set, shot: &set.shots[0], scene };
            let sides =
                (side("measured", &measured, None), side("simulated", &simulated, Some(&nominal)));
            let how = (Align::default(), &[][..]);
            let mut compared =
                compare(sides.0, sides.1, how, &ScoreLimits::default()).expect("a comparison");
            let (_, joint) = judge(&mut compared, &predicted);
            assert!(joint.expect("a test").quantities >= 10);
            compared.comparison.verdict == "pass"
        });
        let passes = passes.count();
        println!("{passes} of {trials} pass, striker {faster} u off");
        passes
    };
    let full = std::env::var_os("HERTZSCOPE_FULL").is_some();
    let trials = if full { 1000 } else { 300 };
    let as_stated = passed(trials, 0.0);
    let [two, three, four] = [2.0, 3.0, 4.0].map(|off| passed(60, off));
    // 93 to 97 %, and two standard deviations of the binomial.
    let share = as_stated as f64 / trials as f64;
    let chance = 2.0 * (0.95 * 0.05 / trials as f64).sqrt();
    assert!((0.93 - chance..=0.97 + chance).contains(&share), "{as_stated} of {trials}");
    assert!(two < 60 && three < two && four < three, "{two}, {three}, {four} of 60 pass");
}

/// Numbers in JSON are in SI units, and so are the units beside them: a striker of 0.61 g is
/// 0.00061 kg.
#[test]
fn units_in_json_are_those_of_the_numbers() {
    let mut command = assert_cmd::Command::cargo_bin("hertzscope").expect("the program");
    let arguments = ["budget", "magnet-0.61g", "--samples", "40", "--json", "-q"];
    let printed = command.args(arguments).assert().success();
    let found: serde_json::Value =
        serde_json::from_slice(&printed.get_output().stdout).expect("JSON");
    let inputs = found["inputs"].as_array().expect("inputs");
    let of = |name: &str| {
        let input = inputs.iter().find(|input| input["name"] == name).expect(name);
        (input["value"].as_f64().expect("a number"), input["unit"].as_str().expect("a unit"))
    };
    assert_eq!(of("striker.mass"), (0.61e-3, "kg"));
    assert_eq!(of("striker.speed"), (0.44, "m/s"));
}
