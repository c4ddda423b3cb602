//! `hertzscope run`.

use serde_json::{Value, json};

use super::{COULD_NOT, QUICK, files, hertzscope, printed, refused, says, temporary};

#[test]
fn without_arguments_it_records_the_default_scene() {
    let folder = temporary();
    let page = printed(folder.path(), &["run"]);
    says(
        &page,
        &[
            "magnet-0.61g:",
            "particle 2",
            "particle 14",
            "particle 27",
            "wall",
            "m/s",
            "recording   magnet-0.61g.mcap",
        ],
    );
    assert_eq!(files(folder.path()), ["magnet-0.61g.mcap"]);
    says(
        &printed(folder.path(), &["info", "magnet-0.61g.mcap"]),
        &["CH1", "CH4", "2500", "scene_sha256"],
    );
}

/// Each shot's trigger is another fraction of a sample late; times in the recording are in the
/// order of the shots.
#[test]
fn shots_come_in_their_order() {
    let folder = temporary();
    let run = [&["run", "-o", "shots.mcap", "--shots", "6"][..], &QUICK].concat();
    printed(folder.path(), &run);
    let page: Value =
        serde_json::from_str(&printed(folder.path(), &["info", "shots.mcap", "--json"]))
            .expect("JSON");
    let of = |key: &str| -> Vec<u64> {
        let shots = page["shots"].as_array().expect("a list").iter();
        shots.map(|shot| shot[key].as_u64().expect("a number")).collect()
    };
    assert_eq!(of("number"), [1, 2, 3, 4, 5, 6]);
    assert!(of("timestamp_ns").is_sorted());
}

/// As many frames as asked for, over the scene's 2.25 ms and the rest of the record; sensors'
/// forces stay at the scope's samples.
#[test]
fn frames_are_kept_as_asked() {
    let folder = temporary();
    let samples = |frames: &str, signal: &str| {
        let asked = [&["run", "-q", "-o", "f.mcap", "--frames", frames][..], &QUICK].concat();
        printed(folder.path(), &asked);
        let asked = ["spectrum", "f.mcap", "--truth", signal, "--json"];
        let found: Value = serde_json::from_str(&printed(folder.path(), &asked)).expect("JSON");
        found["samples"].as_u64().expect("a number")
    };
    for (frames, wanted) in [("50", 50), ("2000", 2000)] {
        let found = samples(frames, "contact/12");
        assert!((wanted..=wanted + wanted / 5).contains(&found), "{frames}: {found}");
    }
    assert_eq!(samples("50", "p14"), samples("2000", "p14"));
    says(&hertzscope(folder.path(), &["run", "--frames", "1"]).stderr, &["2..=50000"]);
}

#[test]
fn a_second_run_overwrites_nothing() {
    let folder = temporary();
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("a recording");
    let run = [&["run"][..], &QUICK].concat();
    says(&printed(folder.path(), &run), &["recording   magnet-0.61g.mcap"]);
    let first = read("magnet-0.61g.mcap");
    says(&printed(folder.path(), &run), &["recording   magnet-0.61g-2.mcap"]);
    let seeded = [&run[..], &["--seed", "7"]].concat();
    says(&printed(folder.path(), &seeded), &["recording   magnet-0.61g-3.mcap"]);
    assert_eq!(read("magnet-0.61g.mcap"), first);
    assert_eq!(read("magnet-0.61g-2.mcap"), first, "the same seed, the same bytes");
    assert_ne!(read("magnet-0.61g-3.mcap"), first, "another seed, other bytes");
}

#[test]
fn a_named_output_is_overwritten() {
    let folder = temporary();
    let run = [&["run", "-o", "deep/down/x.mcap", "--quiet"][..], &QUICK].concat();
    assert_eq!(printed(folder.path(), &run), "");
    let file = folder.path().join("deep/down/x.mcap");
    let first = std::fs::read(&file).expect("a recording");
    std::fs::write(&file, vec![0; 2 * first.len()]).expect("something longer");
    assert_eq!(printed(folder.path(), &run), "");
    assert_eq!(std::fs::read(&file).expect("a recording"), first);
}

fn is_number(value: &Value) -> bool {
    value.as_f64().is_some_and(f64::is_finite)
}

#[test]
fn the_summary_as_json_has_its_keys() {
    let folder = temporary();
    let run = [&["run", "--json", "--quiet"][..], &QUICK].concat();
    let json: Value = serde_json::from_str(&printed(folder.path(), &run)).expect("JSON alone");
    assert_eq!(json["scene"], "magnet-0.61g");
    assert_eq!(json["recording"], "magnet-0.61g.mcap");
    assert_eq!(json["accuracy"], 1e-3);
    assert!(json["method"].as_str().is_some_and(|m| !m.is_empty()), "{json}");
    for key in ["force_evaluations", "steps"] {
        assert!(json[key].as_u64().is_some_and(|n| n > 0), "{key}: {json}");
    }
    for key in ["wall_s", "wall_held_s", "simulated_s"] {
        assert!(is_number(&json[key]), "{key}: {json}");
    }
    // The record goes on to 9 divisions of 250 us behind the trigger, past the scene's 2 ms.
    assert!(json["simulated_s"].as_f64().is_some_and(|t| t > 2.25e-3), "{json}");
    let effects: Vec<&str> =
        json["effects"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    assert!(effects.contains(&"gravity") && effects.contains(&"magnet_preload"), "{effects:?}");
    for key in ["initial", "final", "dissipated", "drift"] {
        assert!(is_number(&json["energy"][key]), "energy.{key}: {json}");
    }
    let sensors = json["sensors"].as_array().expect("a list");
    let particles: Vec<u64> = sensors.iter().filter_map(|s| s["particle"].as_u64()).collect();
    assert_eq!(particles, [2, 14, 27]);
    for sensor in sensors {
        assert!(is_number(&sensor["static_n"]) && is_number(&sensor["half_rise_s"]), "{sensor}");
        for key in ["total_n", "dynamic_n", "time_s"] {
            assert!(is_number(&sensor["first_peak"][key]), "{key}: {sensor}");
        }
        // The static force is the magnet's 2.38 N and some weight; the total is what is static and
        // what is not.
        let number = |value: &Value| value.as_f64().expect("a number");
        let peak = &sensor["first_peak"];
        let sum = number(&sensor["static_n"]) + number(&peak["dynamic_n"]);
        assert!((number(&peak["total_n"]) - sum).abs() < 1e-12 * sum, "{sensor}");
    }
    assert!(is_number(&json["wall"]["first_peak"]["total_n"]), "{json}");
    let speeds = json["speeds"].as_array().expect("a list");
    assert!(!speeds.is_empty());
    for speed in speeds {
        assert!(is_number(&speed["distance_m"]) && is_number(&speed["m_per_s"]), "{speed}");
        assert!(
            speed["from"].is_u64() && speed["to"].is_u64() && speed["estimator"].is_string(),
            "{speed}"
        );
    }
}

#[test]
fn a_step_of_ones_own() {
    let folder = temporary();
    let run = ["run", "--method", "velocity-verlet", "--step", "100ns", "--json"];
    let json: Value = serde_json::from_str(&printed(folder.path(), &run)).expect("JSON");
    assert_eq!(json["accuracy"], Value::Null);
    assert_eq!(json["step_s"], 1e-7);
    assert!(json["method"].as_str().is_some_and(|m| m.contains("verlet")), "{json}");
}

/// Methods that choose their steps take a tolerance; the implicit one needs losses.
#[test]
fn a_tolerance_of_ones_own() {
    let folder = temporary();
    let text = "base = \"magnet-0.61g\"\n[effects.dashpot]\ngamma = \"1 N s/m\"\nend_of_contact = \"zero_force\"\n";
    std::fs::write(folder.path().join("lossy.toml"), text).expect("a file");
    for (scene, method) in [
        ("magnet-0.61g", "dormand-el-mikkawy-prince-86"),
        ("magnet-0.61g", "dormand-prince-54"),
        ("magnet-0.61g", "dormand-prince-853"),
        ("lossy.toml", "dormand-prince-54"),
        ("lossy.toml", "dormand-prince-853"),
        ("lossy.toml", "rodas"),
    ] {
        let run = ["run", scene, "--method", method, "--tolerance", "1e-6", "--json"];
        let json: Value = serde_json::from_str(&printed(folder.path(), &run)).expect("JSON");
        let known = [&json["method"], &json["tolerance"], &json["accuracy"], &json["step_s"]];
        assert_eq!(known, [&json!(method), &json!(1e-6), &Value::Null, &Value::Null]);
        let worst = json["error_estimate"]["peak"].as_f64().expect("a number");
        assert!(worst < 1e-4, "{scene}, {method}: {worst:e}");
    }
    let loose = ["run", "--method", "dormand-prince-54", "--tolerance", "5e-2"];
    let text = printed(folder.path(), &loose);
    says(&text, &["step tolerance 5e-2 by hand", "the tolerance is too large", "--accuracy"]);
    let stiff = ["run", "--method", "rodas", "--tolerance", "1e-6"];
    says(&refused(folder.path(), &stiff), &["rodas", "without losses", "expected"]);
}

/// The option counts, whatever the scene says.
#[test]
fn an_accuracy_of_ones_own() {
    let folder = temporary();
    std::fs::write(
        folder.path().join("own.toml"),
        "base = \"magnet-0.61g\"\naccuracy = \"1e-9\"\n",
    )
    .expect("a file");
    let run = |more: &[&str]| -> Value {
        let run = [&["run", "own.toml", "--json"][..], more].concat();
        serde_json::from_str(&printed(folder.path(), &run)).expect("JSON")
    };
    assert_eq!(run(&[])["accuracy"], json!(1e-9));
    assert_eq!(run(&["--accuracy", "1e-4"])["accuracy"], json!(1e-4));
}

#[test]
fn quiet_names_the_recording_on_standard_error_alone() {
    let folder = temporary();
    let done = hertzscope(folder.path(), &[&["run", "-q"][..], &QUICK].concat());
    let said = (done.code, done.stdout.as_str(), done.stderr.as_str());
    assert_eq!(said, (0, "", "recording   magnet-0.61g.mcap\n"));
    // The next free number is taken, and told.
    let done = hertzscope(folder.path(), &[&["run", "-q"][..], &QUICK].concat());
    assert_eq!(done.stderr, "recording   magnet-0.61g-2.mcap\n");
    assert_eq!(files(folder.path()), ["magnet-0.61g-2.mcap", "magnet-0.61g.mcap"]);
}

#[test]
fn a_bad_scene_is_told_with_places_and_leaves_nothing() {
    let folder = temporary();
    let text = "base = \"magnet-0.61g\"\nseed = -1\n\n[striker]\nmass = \"0 g\"\n";
    std::fs::write(folder.path().join("bad.toml"), text).expect("a file");
    for arguments in [&["run", "bad.toml"][..], &["run", "bad.toml", "-o", "x.mcap", "--json"]] {
        let error = refused(folder.path(), arguments);
        says(&error, &["bad.toml:2:8: seed: found the number -1, expected"]);
        says(
            &error,
            &["bad.toml:5:8: striker.mass: found \"0 g\", expected a mass (kg) above zero"],
        );
        says(&error, &["2 problems in the scene"]);
        assert_eq!(files(folder.path()), ["bad.toml"]);
    }
    says(&refused(folder.path(), &["run", "nothing.toml"]), &["nothing.toml"]);
    says(&refused(folder.path(), &["run", "magnet-9g"]), &["magnet-9g", "magnet-0.61g"]);
    assert_eq!(files(folder.path()), ["bad.toml"]);
}

#[test]
fn options_out_of_range_are_refused() {
    let folder = temporary();
    for (arguments, words) in [
        (&["run", "--accuracy", "1e-12"][..], &["1e-12", "1e-11"][..]),
        (&["run", "--accuracy", "0.2"], &["0.1"]),
        (&["run", "--accuracy", "nan"], &["nan"]),
        (&["run", "--accuracy", "1 m"], &["a length"]),
        (&["run", "--accuracy=-1"], &["expected"]),
        (&["run", "--accuracy", "much"], &["much"]),
        (&["run", "--method", "rodas", "--tolerance", "0"], &["found 0", "1e-15"]),
        (&["run", "--method", "rodas", "--step", "1us"], &["rodas", "--tolerance"]),
        (
            &["run", "--method", "force-gradient", "--tolerance", "1e-6"],
            &["force-gradient", "--step"],
        ),
        (&["run", "--tolerance", "1e-6"], &["--method"]),
        (&["run", "--step", "50ns"], &["--method"]),
        (&["run", "--method", "velocity-verlet"], &["--step"]),
        (&["run", "--method", "euler", "--step", "1ns"], &["euler", "velocity-verlet"]),
        (&["run", "--method", "velocity-verlet", "--step", "0s"], &["above zero"]),
        (&["run", "--method", "velocity-verlet", "--step", "50"], &["50ns"]),
        (&["run", "--method", "velocity-verlet", "--step", "1kg"], &["a mass"]),
        (
            &["run", "--accuracy", "1e-6", "--method", "velocity-verlet", "--step", "1ns"],
            &["--accuracy"],
        ),
        (&["run", "--seed", "-1"], &["-1"]),
    ] {
        let error = refused(folder.path(), arguments);
        says(&error, words);
    }
    assert_eq!(files(folder.path()), [""; 0]);
}

#[test]
fn an_unstable_step_is_refused_with_its_contact_and_limit() {
    let folder = temporary();
    let step = ["run", "--method", "velocity-verlet", "--step", "1ms"];
    let error = refused(folder.path(), &step);
    says(
        &error,
        &["1.000000 ms", "expected at most", "the contact between striker and", "unstable"],
    );
    assert_eq!(files(folder.path()), [""; 0]);
    // An output that is there stays as it was.
    std::fs::write(folder.path().join("old.mcap"), "precious").expect("a file");
    refused(folder.path(), &[&step[..], &["-o", "old.mcap"]].concat());
    assert_eq!(std::fs::read(folder.path().join("old.mcap")).expect("the file"), b"precious");
}

/// Methods that take forces for functions of position, and steps too long for a loss.
#[test]
fn methods_that_losses_rule_out_are_refused() {
    let folder = temporary();
    let scene = |gamma: &str| {
        let text = format!(
            "base = \"magnet-0.61g\"\n[effects.dashpot]\ngamma = \"{gamma}\"\nend_of_contact = \"zero_force\"\n"
        );
        std::fs::write(folder.path().join("lossy.toml"), text).expect("a file");
    };
    scene("1 N s/m");
    for method in ["velocity-verlet", "force-gradient"] {
        let error =
            refused(folder.path(), &["run", "lossy.toml", "--method", method, "--step", "50ns"]);
        says(
            &error,
            &[method, "dashpot", "expected", "depend on velocity", "runge-kutta-4", "rodas"],
        );
    }
    // 2.785/(20437 gamma), and the light sphere at the end is as fast.
    scene("1000 N s/m");
    let long = ["run", "lossy.toml", "--method", "runge-kutta-4", "--step", "140ns"];
    says(&refused(folder.path(), &long), &["140.0000 ns", "at most 136.4 ns", "decay"]);
    assert_eq!(files(folder.path()), ["lossy.toml"]);
    scene("1 N s/m");
    let done = hertzscope(
        folder.path(),
        &["run", "lossy.toml", "--method", "runge-kutta-4", "--step", "200ns"],
    );
    assert_eq!(done.code, 0, "{}", done.stderr);
    let booked =
        ["dissipated", "dashpot", "left in contacts", "a contact ends at zero force", "yield"];
    says(&done.stdout, &booked);
}

/// A run that fails on its way: nothing was triggered, so nothing is left, and what was there
/// before is there still.
#[test]
fn a_run_that_fails_leaves_nothing_and_takes_nothing() {
    let folder = temporary();
    std::fs::write(folder.path().join("old.mcap"), "precious").expect("a file");
    let run = ["run", "monatomic-vacuum", "--method", "velocity-verlet", "--step", "30us"];
    let refused = |output: &[&str]| refused(folder.path(), &[&run, output].concat());
    says(&refused(&[]), &["body", "stopped being a number"]);
    refused(&["-o", "old.mcap"]);
    refused(&["-o", "new.mcap"]);
    assert_eq!(files(folder.path()), ["old.mcap"]);
    assert_eq!(std::fs::read(folder.path().join("old.mcap")).expect("the file"), b"precious");
}

/// At first steps of this length the striker goes further than any contact is ever pressed.
#[test]
fn steps_that_blow_up_are_refused_with_time_and_reason() {
    let folder = temporary();
    let run = ["run", "monatomic-vacuum", "--method", "velocity-verlet", "--step", "30us"];
    let error = refused(folder.path(), &run);
    says(&error, &["stopped being a number", "at t = ", "the step is too long"]);
    assert_eq!(files(folder.path()), [""; 0]);
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let folder = temporary();
    std::fs::write(folder.path().join("file"), "").expect("a file");
    std::fs::create_dir(folder.path().join("folder.mcap")).expect("a folder");
    for (output, words) in [
        ("x.csv", &["x.csv", "expected", "hertzscope convert"][..]),
        ("x", &["x:", ".mcap"]),
        ("folder.mcap", &["folder.mcap"]),
        ("file/x.mcap", &["file"]),
    ] {
        says(&refused(folder.path(), &["run", "-o", output]), words);
    }
    assert_eq!(files(folder.path()), ["file", "folder.mcap"]);
}

/// A disk that is full, as Linux offers one.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let folder = temporary();
    std::os::unix::fs::symlink("/dev/full", folder.path().join("full.mcap")).expect("a link");
    let error = refused(folder.path(), &[&["run", "-o", "full.mcap"][..], &QUICK].concat());
    says(&error, &["full.mcap", "No space left"]);
}

/// Whoever reads through `head` has seen enough.
#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = temporary();
    let program = assert_cmd::cargo::cargo_bin("hertzscope");
    let mut child = std::process::Command::new(program)
        .args(["completions", "bash"])
        .current_dir(folder.path())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the program ends");
    assert_ne!(output.status.code(), Some(COULD_NOT));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

/// Steps that are stable and too long all the same: a note says so, and not of a tenth of them.
#[test]
fn a_step_that_reads_wrong_is_told() {
    let folder = temporary();
    let run = |step: &str| {
        let asked = ["run", "--method", "velocity-verlet", "--step", step, "--json"];
        serde_json::from_str::<Value>(&printed(folder.path(), &asked)).expect("a summary")
    };
    let notes = |summary: &Value| {
        let notes = summary["notes"].as_array().expect("a list").iter();
        notes
            .map(|note| note["sentence"].as_str().expect("words").to_owned())
            .collect::<Vec<_>>()
            .join("\n")
    };
    let wrong = run("7.13us");
    let told = notes(&wrong);
    says(&told, &["the step is too large: readings may be off by", "has made energy"]);
    assert!(wrong["error_estimate"]["peak"].as_f64().expect("a number") > 0.5, "{wrong}");
    assert!(wrong["energy"]["drift"].as_f64().expect("a number") > 0.5, "{wrong}");
    let right = run("0.713us");
    assert!(!notes(&right).contains("too large"), "{}", notes(&right));
    // Held against a run by another family of methods.
    let exact = printed(folder.path(), &["run", "--accuracy", "1e-9", "--json"]);
    let exact: Value = serde_json::from_str(&exact).expect("a summary");
    let worst =
        ["peak", "arrival"].map(|kind| right["error_estimate"][kind].as_f64().expect("a number"));
    let peak = |summary: &Value, place: usize| {
        summary["sensors"][place]["first_peak"]["dynamic_n"].as_f64().expect("a force")
    };
    for place in 0..exact["sensors"].as_array().expect("a list").len() {
        let off = (peak(&right, place) / peak(&exact, place) - 1.0).abs();
        assert!(off <= worst[0] && off <= 0.01, "{off:e} of {worst:?}");
    }
}

/// A striker's own speed is no error of the method.
#[test]
fn by_hand_no_error_is_told_that_is_none() {
    let folder = temporary();
    let spread = "base = \"magnet-0.61g\"\n[effects.striker_speed_spread]\nrelative = \"5 %\"\n";
    std::fs::write(folder.path().join("spread.toml"), spread).expect("a file");
    for (scene, step) in [("spread.toml", "200ns"), ("linear-300-cells", "1us")] {
        let asked = ["run", scene, "--method", "velocity-verlet", "--step", step, "--json"];
        let text = printed(folder.path(), &asked);
        let summary: Value = serde_json::from_str(&text).expect("a summary");
        let worst = ["peak", "arrival"]
            .map(|kind| summary["error_estimate"][kind].as_f64().expect("a number"));
        // Verlet's own error; the speed that is drawn may be 5 % off.
        assert!(worst.iter().all(|worst| *worst < 3e-3), "{scene}: {worst:?}");
        let notes = summary["notes"].to_string();
        assert!(!notes.contains("too large"), "{scene}: {notes}");
        if scene == "linear-300-cells" {
            // Verlet's phase errors add up in late traces, which the horizon states.
            let trace = summary["error_estimate"]["trace"].as_f64().expect("a number");
            let limit = worst[0].max(worst[1]).sqrt();
            assert_eq!(summary["horizon_s"].is_null(), trace <= limit, "{trace:e}, {limit:e}");
        }
    }
    // To an accuracy it holds for the shot's own speed as well.
    let text = printed(folder.path(), &["run", "spread.toml", "--accuracy", "1e-6", "--json"]);
    let summary: Value = serde_json::from_str(&text).expect("a summary");
    let peak = summary["error_estimate"]["peak"].as_f64().expect("a number");
    assert!(peak <= 1e-6, "{peak:e}");
}

/// A chain pressed flat is no chain any more, and stiff losses are refused by the contact that
/// makes them so.
#[test]
fn what_no_bench_could_be_is_told() {
    let folder = temporary();
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), format!("base = \"magnet-0.61g\"\n{text}"))
            .expect("a file");
    };
    write("flat.toml", "[effects.magnet_preload]\nforce = \"1e5 N\"\nparticle = 1\n");
    let page = printed(folder.path(), &["run", "flat.toml"]);
    says(&page, &["times the length of the smaller one: Hertz's law does not hold there"]);
    assert!(!printed(folder.path(), &["run", "magnet-0.61g"]).contains("smaller one's length"));
    let stiff = "[effects.dashpot]\ngamma = \"1000 N s/m\"\nend_of_contact = \"zero_force\"\n";
    write("stiff.toml", stiff);
    let asked = ["run", "stiff.toml", "--method", "runge-kutta-4", "--step", "1us"];
    says(
        &refused(folder.path(), &asked),
        &["losses, most of all between ferromagnetic_sphere and", "expected at most"],
    );
    write("law.toml", "[effects.magnet_law]\nmodel = \"x\"\n");
    says(&refused(folder.path(), &["run", "law.toml"]), &["effects.magnet_law: found"]);
}

/// A recording carries everything its scene is based on: moved to another machine, it is analysed
/// as beside its files.
#[test]
fn a_recording_is_analysed_without_the_files_of_its_scene() {
    let folder = temporary();
    let (here, there) = (folder.path().join("lab"), folder.path().join("elsewhere"));
    std::fs::create_dir_all(here.join("parts")).expect("a folder");
    std::fs::create_dir(&there).expect("a folder");
    let data = hertzscope::data::instrument;
    for (file, kind, name) in [
        ("basis.toml", "scenes", "magnet-0.61g"),
        ("parts/sensor.toml", "sensors", "pzt-5a-710pf"),
        ("parts/striker.toml", "strikers", "alumina-1.22g"),
    ] {
        std::fs::write(here.join(file), data(kind, name).expect(name)).expect("a file");
    }
    let scene = "base = \"basis.toml\"\ntitle = \"all from files\"\n\
                 [striker]\nmodel = \"parts/striker.toml\"\n\
                 [sensors.p2]\nmodel = \"parts/sensor.toml\"\n";
    std::fs::write(here.join("own.toml"), scene).expect("a file");
    let run = [&["run", "own.toml", "-q", "-o", "own.mcap"][..], &QUICK].concat();
    printed(&here, &run);
    std::fs::copy(here.join("own.mcap"), there.join("own.mcap")).expect("a copy");
    for arguments in [
        "info own.mcap",
        "arrivals own.mcap",
        "force own.mcap",
        "spectrum own.mcap",
        "convert own.mcap folders",
    ] {
        let words: Vec<&str> = arguments.split(' ').collect();
        let (beside, moved) = (hertzscope(&here, &words), hertzscope(&there, &words));
        assert_eq!((beside.code, moved.code), (0, 0), "{arguments}: {}", moved.stderr);
        assert_eq!(moved.stdout, beside.stdout, "{arguments}");
        assert_eq!(moved.stderr, beside.stderr, "{arguments}");
    }
    // The scene as typed is there, too.
    let set = hertzscope::recording::format::open(&there.join("own.mcap")).expect("a recording");
    let typed = set.attachments.iter().find(|attachment| attachment.name == "own.toml");
    assert_eq!(typed.expect("the scene").data, scene.as_bytes());
}
