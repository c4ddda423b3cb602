//! Killed anywhere, a sweep goes on where it was: no finished run is lost, none counted twice.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Stdio;

use rand_distr::{Distribution as _, Uniform};
use rand_pcg::Pcg64;

use super::{QUICK, done, folder, program, read, told};

/// How often the sweep is killed.
const KILLS: usize = 10;
/// Runs of [`LONG`].
const RUNS: usize = 3000;
/// Enough runs to be killed in many places.
const LONG: &str = r#"
scene = "magnet-0.61g"
accuracy = 1e-2
watch = ["p2"]

[grid]
duration = "0.1 ms"

[latin_hypercube]
count = 3000

[latin_hypercube.over]
striker.speed = { from = "0.2 m/s", to = "0.6 m/s" }
"#;
const LOG: &str = "grid.sweep/shard-1-of-1.log";

fn size(folder: &Path) -> u64 {
    std::fs::metadata(folder.join(LOG)).map_or(0, |log| log.len())
}

/// Whole lines of the log behind its first.
fn lines(folder: &Path) -> Vec<String> {
    let text = std::fs::read(folder.join(LOG)).expect("a log");
    let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let text = String::from_utf8(text[..whole].to_vec()).expect("text");
    text.lines().skip(1).map(str::to_owned).collect()
}

/// The process is killed as soon as its log has grown by a random number of bytes, ten times; where
/// it is then does not depend on a clock of the test, and one that is finished sooner begins again.
/// What the log held is still there after each resumption, and the table is that of a sweep left in
/// peace.
#[test]
fn a_killed_sweep_goes_on() {
    let peace = folder(LONG);
    done(peace.path(), &["sweep", "grid.toml"]);
    let killed = folder(LONG);
    let whole = size(peace.path());
    let mut stream = Pcg64::new(2009, 1);
    let growth = Uniform::new(0, whole / 10).expect("a range");
    let mut kills = 0;
    for attempt in 0.. {
        assert!(attempt < 100, "killed {kills} times only: it is always finished first");
        let held = if size(killed.path()) > 0 { lines(killed.path()) } else { Vec::new() };
        let target = size(killed.path()) + growth.sample(&mut stream);
        let mut sweep = program(killed.path());
        sweep.args(["sweep", "grid.toml", "--quiet"]).stderr(Stdio::null());
        let mut sweep = sweep.spawn().expect("the program starts");
        while size(killed.path()) <= target && sweep.try_wait().expect("a process").is_none() {
            std::thread::yield_now();
        }
        // SIGKILL.
        let _ = sweep.kill();
        let finished = sweep.wait().expect("a process").success();
        let now = lines(killed.path());
        assert_eq!(now[..held.len()], held, "lines that stood there have changed");
        kills += usize::from(!finished);
        if kills == KILLS {
            break;
        }
        if finished {
            std::fs::remove_dir_all(killed.path().join("grid.sweep")).expect("a folder");
        }
    }
    let report = done(killed.path(), &["sweep", "grid.toml", "--json"]);
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    println!("killed {KILLS} times; at the end {} runs were left", report["done"]);
    let runs: BTreeSet<String> = lines(killed.path())
        .iter()
        .map(|line| line[9..].split(',').next().expect("a number").to_owned())
        .collect();
    assert_eq!((lines(killed.path()).len(), runs.len()), (RUNS, RUNS), "a run was counted twice");
    assert_eq!(read(killed.path(), "grid.csv"), read(peace.path(), "grid.csv"));
}

/// A log cut off at any byte is a log of fewer runs: what is torn is told, cut off and done again.
#[test]
fn a_torn_log_is_mended() {
    let folder = folder(QUICK);
    done(folder.path(), &["sweep", "grid.toml"]);
    let (table, log) = (read(folder.path(), "grid.csv"), read(folder.path(), LOG));
    let mut stream = Pcg64::new(2009, 2);
    let places = Uniform::new(0, log.len()).expect("a range");
    for place in (0..8).map(|_| places.sample(&mut stream)).chain([0, 1, log.len() - 1]) {
        std::fs::write(folder.path().join(LOG), &log[..place]).expect("a log");
        let whole = log[..place].matches('\n').count();
        let (code, report, notes) = told(folder.path(), &["sweep", "grid.toml", "--json"]);
        assert_eq!(code, 0, "{notes}");
        let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
        assert_eq!(report["finished_before"], whole.saturating_sub(1), "cut at {place}");
        let torn = place > 0 && !log[..place].ends_with('\n') && whole > 0;
        assert_eq!(notes.contains("torn line"), torn, "cut at {place}: {notes}");
        assert_eq!(read(folder.path(), "grid.csv"), table);
    }
}

/// A flipped bit in the middle is told, costs one run, and no other.
#[test]
fn a_damaged_line_counts_for_nothing() {
    let folder = folder(QUICK);
    done(folder.path(), &["sweep", "grid.toml"]);
    let (table, mut log) = (read(folder.path(), "grid.csv"), read(folder.path(), LOG).into_bytes());
    let end = log.iter().skip(log.len() / 2).position(|&byte| byte == b'\n').expect("a whole line");
    let middle = log.len() / 2 + end - 1;
    assert_ne!(log[middle], b'\n', "an empty line");
    log[middle] ^= 1;
    std::fs::write(folder.path().join(LOG), &log).expect("a log");
    let (code, report, notes) = told(folder.path(), &["sweep", "grid.toml", "--json"]);
    assert_eq!(code, 0, "{notes}");
    assert!(notes.contains("found 1 line that does not agree with the checksum"), "{notes}");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!((&report["finished_before"], &report["done"]), (&39.into(), &1.into()));
    assert_eq!(read(folder.path(), "grid.csv"), table);
}
