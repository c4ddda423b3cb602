//! Every command, ended at every one of its writes.

use std::collections::BTreeMap;
use std::path::Path;

use super::{QUICK, command, contents, done};

type Contents = BTreeMap<String, Vec<u8>>;

/// Ends `arguments` at each write in turn, in a folder made anew by `prepare`, until one goes
/// through. What is there then is always what was there before or what is there in the end. Returns
/// how often it was ended.
fn kill_everywhere(prepare: &dyn Fn(&Path), arguments: &[&str]) -> u32 {
    kill_each(prepare, arguments, &|found, old, new| found == old || found == new)
}

/// As [`kill_everywhere`]; `is_right` judges what is there between the contents before and after.
fn kill_each(
    prepare: &dyn Fn(&Path),
    arguments: &[&str],
    is_right: &dyn Fn(&Contents, &Contents, &Contents) -> bool,
) -> u32 {
    let prepared = || {
        let folder = tempfile::tempdir().expect("a folder");
        prepare(folder.path());
        folder
    };
    let folder = prepared();
    let old = contents(folder.path());
    done(folder.path(), arguments);
    let new = contents(folder.path());
    assert_ne!(old, new, "{arguments:?} writes nothing");
    let folder = prepared();
    for at in 1.. {
        // What is there already is what the next one finds, as after a night of power failures.
        let output = command(folder.path(), arguments)
            .env("HERTZSCOPE_TEST_ABORT_AT", at.to_string())
            .output()
            .expect("the program starts");
        let found = contents(folder.path());
        if output.status.code().is_some() {
            assert_eq!(names(&found), names(&new), "{arguments:?}");
            assert!(found == new, "{arguments:?}: other bytes");
            return at - 1;
        }
        assert!(
            is_right(&found, &old, &new),
            "{arguments:?} ended at write {at}: {:?}",
            names(&found)
        );
        if found == new {
            restore(folder.path(), &old);
            prepare(folder.path());
        }
    }
    unreachable!("a command has an end")
}

fn names(found: &BTreeMap<String, Vec<u8>>) -> Vec<&String> {
    found.keys().collect()
}

/// Removes what was not there before.
fn restore(folder: &Path, old: &BTreeMap<String, Vec<u8>>) {
    for name in contents(folder).keys().filter(|name| !old.contains_key(*name)) {
        std::fs::remove_file(folder.join(name)).expect("a file");
        // Folders that are empty now.
        for above in Path::new(name).ancestors().skip(1) {
            let _ = std::fs::remove_dir(folder.join(above));
        }
    }
}

fn recording(folder: &Path, name: &str, seed: &str) {
    done(folder, &[&["run", "-q", "-o", name, "--seed", seed][..], &QUICK].concat());
}

#[test]
fn run_leaves_the_old_recording_or_the_new_one() {
    let again = [&["run", "-q", "-o", "a.mcap", "--seed", "2"][..], &QUICK].concat();
    assert!(kill_everywhere(&|folder| recording(folder, "a.mcap", "1"), &again) > 5);
    // Without a name: the first is never touched, the second is there when it is whole.
    let unnamed = [&["run", "-q"][..], &QUICK].concat();
    let first = |folder: &Path| recording(folder, "magnet-0.61g.mcap", "1");
    assert!(kill_everywhere(&first, &unnamed) > 5);
}

#[test]
fn convert_leaves_the_old_file_or_the_new_one() {
    let two = |output: &'static str| {
        move |folder: &Path| {
            recording(folder, "one.mcap", "1");
            recording(folder, "two.mcap", "2");
            done(folder, &["convert", "one.mcap", output]);
        }
    };
    assert!(kill_everywhere(&two("x.mcap"), &["convert", "two.mcap", "x.mcap", "--force"]) > 5);
    for output in ["x.bmp", "x.svg"] {
        assert!(kill_everywhere(&two(output), &["convert", "two.mcap", output, "--force"]) >= 4);
    }
    // A folder: all channels with set-up and screen, or none.
    assert!(kill_everywhere(&two("lab"), &["convert", "two.mcap", "lab"]) > 20);
}

#[test]
fn calibrate_leaves_the_old_results_or_the_new_ones() {
    let folder = tempfile::tempdir().expect("a folder");
    let test = |seed: &str, name: &str| {
        let asked =
            ["calibrate", "--simulate", "pzt-5a-710pf", "--striker", "ptfe-capped-1.22g", "-q"];
        done(folder.path(), &[&asked[..], &["--seed", seed, "-o", name]].concat());
    };
    test("1", "one");
    test("2", "two");
    let plan = |name: &str| folder.path().join(name).join("plan.toml").display().to_string();
    let (one, two) = (plan("one"), plan("two"));
    // A file of the user's stays, and a folder.
    let prepare = |folder: &Path| {
        done(folder, &["calibrate", &one, "-o", "out"]);
        std::fs::create_dir_all(folder.join("out/mine")).expect("a folder");
        std::fs::write(folder.join("out/mine/notes.txt"), "mine").expect("a file");
        std::fs::write(folder.join("out/notes.txt"), "mine").expect("a file");
    };
    // Files are replaced one after the other: each is the old or the new one, whole.
    let each = |found: &Contents, old: &Contents, new: &Contents| {
        found.iter().all(|(name, bytes)| [old, new].iter().any(|of| of.get(name) == Some(bytes)))
            && old.keys().all(|name| found.contains_key(name))
    };
    assert!(kill_each(&prepare, &["calibrate", &two, "-o", "out"], &each) > 20);
    // A folder that is not there yet appears with all of them.
    assert!(kill_everywhere(&|_| (), &["calibrate", &two, "-o", "out"]) > 20);
}

#[test]
fn compare_leaves_the_old_report_or_the_new_one() {
    let prepare = |output: &'static str| {
        move |folder: &Path| {
            recording(folder, "one.mcap", "1");
            recording(folder, "two.mcap", "2");
            done(folder, &["compare", "one.mcap", "one.mcap", "-q", "-o", output]);
        }
    };
    for output in ["x.html", "x.mcap"] {
        let asked = ["compare", "one.mcap", "two.mcap", "-q", "-o", output];
        assert!(kill_everywhere(&prepare(output), &asked) >= 4);
    }
}

#[test]
fn fit_leaves_the_old_scene_or_the_new_one() {
    let prepare = |folder: &Path| {
        recording(folder, "lab.mcap", "1");
        std::fs::write(folder.join("fitted.toml"), "base = \"magnet-0.61g\"\n").expect("a file");
    };
    let asked = ["fit", "lab.mcap", "magnet-0.61g", "--free", "striker.speed", "-q"];
    let asked =
        [&asked[..], &["--starts", "1", "--accuracy", "1e-3", "-o", "fitted.toml"]].concat();
    assert!(kill_everywhere(&prepare, &asked) >= 4);
}

#[test]
fn gather_leaves_the_old_table_or_the_new_one() {
    let grid = "scene = \"magnet-0.61g\"\nseed = 1\n[grid]\n\"striker.speed\" = [\"0.4 m/s\", \"0.5 m/s\"]\n";
    let prepare = |folder: &Path| {
        std::fs::write(folder.join("grid.toml"), grid).expect("a file");
        done(folder, &["sweep", "grid.toml", "-q", "--accuracy", "1e-3"]);
        std::fs::write(folder.join("grid.csv"), "old\n").expect("a file");
    };
    assert!(kill_everywhere(&prepare, &["gather", "grid.sweep", "-q", "--force"]) >= 4);
}
