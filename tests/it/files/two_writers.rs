//! Two of each command at once on the same name: one of them wins, whole, and the other one says so
//! or comes after it.

use std::path::Path;
use std::process::Child;

use hertzscope::recording::format::open;

use super::{QUICK, command, contents, done};

fn start(folder: &Path, arguments: &[&str]) -> Child {
    command(folder, arguments).spawn().expect("the program starts")
}

/// Runs both at once, often; each is done, or says that another one writes. `check` looks at what
/// is there then.
fn at_once(folder: &Path, both: [&[&str]; 2], check: &dyn Fn()) {
    for _ in 0..10 {
        let children = both.map(|arguments| start(folder, arguments));
        let codes = children.map(|child| {
            let output = child.wait_with_output().expect("it ends");
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            let code = output.status.code().expect("an exit code");
            assert!(code < 2 || said.contains("another process is writing it"), "{said}");
            code
        });
        assert!(codes.iter().any(|code| *code < 2), "neither was done");
        check();
    }
}

#[test]
fn one_recording_has_one_writer() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let run = |seed| [&["run", "-q", "-o", "x.mcap", "--seed", seed][..], &QUICK].concat();
    let whole = ["1", "2"].map(|seed| {
        done(path, &run(seed));
        std::fs::read(path.join("x.mcap")).expect("a recording")
    });
    let is_whole = || {
        assert!(whole.contains(&std::fs::read(path.join("x.mcap")).expect("a recording")));
    };
    at_once(path, [&run("1"), &run("2")], &is_whole);
}

/// Every one gets a folder of its own, with all channels of one recording.
#[test]
fn folders_are_made_by_one_converter_each() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    for (name, seed) in [("one.mcap", "1"), ("two.mcap", "2")] {
        done(path, &[&["run", "-q", "-o", name, "--seed", seed][..], &QUICK].concat());
    }
    let both = [&["convert", "-q", "one.mcap", "lab"][..], &["convert", "-q", "two.mcap", "lab"]];
    at_once(path, both, &|| ());
    let levels = |file: &Path| {
        let set = open(file).expect("captures");
        set.shots[0].captures.iter().map(|c| c.waveform.codes.clone()).collect::<Vec<_>>()
    };
    let known = ["one.mcap", "two.mcap"].map(|name| levels(&path.join(name)));
    let mut found = [0, 0];
    for number in 0..20 {
        let levels = levels(&path.join(format!("lab/ALL{number:04}")));
        found
            [known.iter().position(|known| *known == levels).expect("one recording's channels")] +=
            1;
    }
    assert_eq!(found, [10, 10]);
    assert_eq!(contents(&path.join("lab")).len(), 20 * 6);
}

#[test]
fn results_of_two_calibrations_are_not_mixed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let asked = ["calibrate", "--simulate", "pzt-5a-710pf", "--striker", "ptfe-capped-1.22g", "-q"];
    let calibrate = ["1", "2"].map(|seed| {
        done(path, &[&asked[..], &["--seed", seed, "-o", seed]].concat());
        format!("{seed}/plan.toml")
    });
    let calibrate = calibrate.each_ref().map(|plan| ["calibrate", plan, "-o", "out"]);
    let whole = calibrate.map(|arguments| {
        done(path, &arguments);
        contents(&path.join("out"))
    });
    at_once(path, [&calibrate[0], &calibrate[1]], &|| {
        assert!(whole.contains(&contents(&path.join("out"))));
    });
}

#[test]
fn reports_and_tables_are_not_mixed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    for (name, seed) in [("one.mcap", "1"), ("two.mcap", "2")] {
        done(path, &[&["run", "-q", "-o", name, "--seed", seed][..], &QUICK].concat());
    }
    let compare =
        ["one.mcap", "two.mcap"].map(|with| ["compare", "one.mcap", with, "-q", "-o", "x.html"]);
    let fit = ["one.mcap", "two.mcap"].map(|lab| {
        ["fit", lab, "magnet-0.61g", "--free", "striker.speed", "-q", "--starts", "1", "--accuracy"]
            .into_iter()
            .chain(["1e-3", "-o", "fitted.toml"])
            .collect::<Vec<_>>()
    });
    let grid = "scene = \"magnet-0.61g\"\nseed = 1\n[grid]\n\"striker.speed\" = [\"0.4 m/s\", \"0.5 m/s\"]\n";
    std::fs::write(path.join("grid.toml"), grid).expect("a file");
    done(path, &["sweep", "grid.toml", "-q", "--accuracy", "1e-3"]);
    let gather = ["gather", "grid.sweep", "-q"];
    for (both, file) in [
        ([&compare[0][..], &compare[1]], "x.html"),
        ([&fit[0], &fit[1]], "fitted.toml"),
        ([&gather, &gather], "grid.csv"),
    ] {
        let whole = both.map(|arguments| {
            done(path, arguments);
            std::fs::read(path.join(file)).expect(file)
        });
        at_once(path, both, &|| {
            assert!(whole.contains(&std::fs::read(path.join(file)).expect(file)), "{file}");
        });
    }
}
