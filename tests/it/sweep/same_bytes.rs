//! One table, whoever makes it.

use super::{QUICK, done, folder, program, read, told};

#[test]
fn threads_and_shards_change_nothing() {
    let one = folder(QUICK);
    done(one.path(), &["sweep", "grid.toml", "--threads", "1"]);
    let expected = read(one.path(), "grid.csv");
    assert_eq!(expected.lines().count(), 41);

    let two = folder(QUICK);
    done(two.path(), &["sweep", "grid.toml", "--threads", "2"]);
    assert_eq!(read(two.path(), "grid.csv"), expected);

    let seven = folder(QUICK);
    for shard in [4, 1, 7, 2, 3, 6, 5] {
        done(seven.path(), &["sweep", "grid.toml", "--shard", &format!("{shard}/7")]);
    }
    done(seven.path(), &["gather", "grid.sweep"]);
    assert_eq!(read(seven.path(), "grid.csv"), expected);
}

/// A finished sweep is not run again, and shards of any number leave what others have done.
#[test]
fn nothing_is_done_twice() {
    let folder = folder(QUICK);
    done(folder.path(), &["sweep", "grid.toml", "--shard", "2/3"]);
    let (code, report, notes) = told(folder.path(), &["gather", "grid.sweep"]);
    assert_eq!((code, notes.as_str()), (1, ""), "{report}");
    assert!(report.contains("13 of 40 runs"), "{report}");
    assert!(report.contains("27 runs: 0, 2-3, 5-6"), "{report}");
    let report = done(folder.path(), &["sweep", "grid.toml", "--json"]);
    let summary: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!((&summary["finished_before"], &summary["done"]), (&13.into(), &27.into()));
    let table = read(folder.path(), "grid.csv");
    let report = done(folder.path(), &["sweep", "grid.toml", "--json"]);
    let summary: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!((&summary["finished_before"], &summary["done"]), (&40.into(), &0.into()));
    assert_eq!(read(folder.path(), "grid.csv"), table);
}

/// The variables of an array's task are a shard.
#[test]
fn slurm_s_variables_are_read() {
    let whole = folder(QUICK);
    done(whole.path(), &["sweep", "grid.toml"]);
    let array = folder(QUICK);
    for task in 5..=7 {
        let mut program = program(array.path());
        program.args(["sweep", "grid.toml", "--quiet"]);
        program.env("SLURM_ARRAY_TASK_ID", task.to_string());
        program.env("SLURM_ARRAY_TASK_MIN", "5").env("SLURM_ARRAY_TASK_MAX", "7");
        program.env("SLURM_ARRAY_TASK_COUNT", "3");
        assert!(program.status().expect("the program starts").success());
    }
    assert!(array.path().join("grid.sweep/shard-3-of-3.log").exists());
    done(array.path(), &["gather", "grid.sweep"]);
    assert_eq!(read(array.path(), "grid.csv"), read(whole.path(), "grid.csv"));
}

/// A table that is there is replaced only by a whole one, and nothing else is left lying about.
#[test]
fn only_whole_tables_are_left() {
    let folder = folder(QUICK);
    std::fs::write(folder.path().join("grid.csv"), "old").expect("a file");
    let (code, _, stderr) = told(folder.path(), &["sweep", "grid.toml"]);
    assert!(code == 2 && stderr.contains("no table of this sweep"), "{stderr}");
    assert_eq!(read(folder.path(), "grid.csv"), "old");
    done(folder.path(), &["sweep", "grid.toml", "--force"]);
    // Its own table is brought up to date without.
    done(folder.path(), &["sweep", "grid.toml"]);
    let mut names: Vec<String> = std::fs::read_dir(folder.path())
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(names, ["grid.csv", "grid.sweep", "grid.toml"]);
    assert_eq!(read(folder.path(), "grid.csv").lines().count(), 41);
}
