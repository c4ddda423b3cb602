//! What is wrong is told: in a sweep's file before anything runs, in single runs in their lines.

use super::{QUICK, column, done, folder, read, told};

/// Runs a sweep that cannot be run: exit code 2, and nothing on standard output.
fn refused(text: &str) -> String {
    let folder = folder(text);
    let (code, stdout, stderr) = told(folder.path(), &["sweep", "grid.toml"]);
    assert_eq!((code, stdout.as_str()), (2, ""), "{stderr}");
    assert!(!folder.path().join("grid.csv").exists());
    stderr
}

#[test]
fn mistakes_are_named_with_their_places() {
    let head = "scene = \"magnet-0.61g\"\n[grid]\n";
    let cases = [
        (format!("{head}striker.sped = [\"1 m/s\"]"), "grid.toml:3:", "unknown key `sped`"),
        (format!("{head}striker.speed = [\"1 kg\"]"), "grid.toml:3:", "a speed (m/s) above zero"),
        (format!("{head}striker.speed = []"), "grid.toml:3:17", "an empty list"),
        (
            format!("{head}striker.speed = {{ from = \"1 m/s\", to = \"2 kg\", count = 3 }}"),
            "grid.toml:3:",
            "expected a speed (m/s), as `from`",
        ),
        (
            format!("{head}striker.speed = {{ from = \"1 m/s\", to = \"2 m/s\" }}"),
            "grid.toml:3:17",
            "missing `striker.speed.count`: give ",
        ),
        (
            format!("{head}chain.segments.7.repeat = [1]"),
            "chain.segments.7.repeat",
            "found nothing there in the scene, expected one of 1, 2",
        ),
        (format!("{head}striker.model = [\"oak\"]"), "grid.toml:3:", "expected one of alumina-0.61g"),
        ("scene = \"magnet-0.61g\"".to_owned(), "grid.toml:1:1", "nothing that is varied"),
        (format!("seeds = 1\n{head}striker.speed = \"1 m/s\""), "grid.toml:1:1", "`seeds`"),
        (
            "scene = \"magnet-0.61g\"\n[latin_hypercube]\ncount = 5\n[latin_hypercube.over]\nstriker.speed = { mean = \"1 m/s\", deviation = \"1 %\" }".to_owned(),
            "grid.toml:5:",
            "expected from and to",
        ),
        (
            format!("repeat = 100_000_000\n{head}striker.speed = [\"1 m/s\", \"2 m/s\"]"),
            "grid.toml",
            "at most 100000000 runs",
        ),
        (
            format!("{head}frames = {{ from = 100, to = 300, count = 4 }}"),
            "grid.toml:3:",
            "found a range with 166.666666667, expected whole numbers",
        ),
        (
            format!("{head}chain.segments.2.repeat = {{ from = 1, to = 8, count = 3, spacing = \"logarithmic\" }}"),
            "grid.toml:3:",
            "found a range with 2.82842712475, expected whole numbers",
        ),
        (
            "scene = \"magnet-0.61g\"\n[random]\ncount = 5\n[random.over]\nframes = { mean = 100, deviation = 2 }".to_owned(),
            "grid.toml:5:",
            "expected from and to as whole numbers",
        ),
        (
            "scene = \"magnet-0.61g\"\n[random]\ncount = 5\n[random.over]\nstriker.speed = { mean = \"1 m/s\", deviation = \"1 K\" }".to_owned(),
            "grid.toml:5:",
            "expected a speed (m/s) of zero or more",
        ),
        (
            "scene = \"magnet-0.61g\"\n[latin_hypercube]\ncount = 100_000_000\n[latin_hypercube.over]\nstriker.speed = { from = \"1 m/s\", to = \"2 m/s\" }".to_owned(),
            "grid.toml:3:9",
            "found 100000000 points of 1 values, expected at most 50000000",
        ),
        (format!("watch = [\"p3\"]\n{head}striker.speed = [\"1 m/s\"]"), "`p3`", "p2, p14, p27, wall"),
    ];
    for (text, place, words) in cases {
        let said = refused(&text);
        assert!(said.contains(place) && said.contains(words), "{text}\n{said}");
    }
}

/// A run whose values make no scene has a line that says why, and the others have their results.
#[test]
fn a_refused_run_has_its_reason() {
    let folder = folder(
        r#"
        scene = "magnet-0.61g"
        accuracy = 1e-2
        watch = ["p2"]
        [grid]
        duration = "0.1 ms"
        striker.speed = ["0.4 m/s", "0 m/s", "0.5 m/s"]
        "#,
    );
    let report = done(folder.path(), &["sweep", "grid.toml"]);
    assert!(report.contains("no results  1 run; the first, run 1: grid.toml:7:37"), "{report}");
    let csv = read(folder.path(), "grid.csv");
    let lines: Vec<&str> = csv.lines().collect();
    let reason =
        "\"grid.toml:7:37: striker.speed: found \"\"0 m/s\"\", expected a speed (m/s) above zero\"";
    assert!(lines[2].contains(reason), "{}", lines[2]);
    assert!(lines[2].ends_with(",,,,,,"), "{}", lines[2]);
    assert!(column(&csv, "p2.peak (N)")[0].parse::<f64>().expect("a force") > 1.0);
}

/// Two sweeps never share a folder, and two processes never a log.
#[test]
fn logs_are_not_mixed() {
    let folder = folder(QUICK);
    done(folder.path(), &["sweep", "grid.toml"]);
    let other = QUICK.replace("0.13 g", "0.14 g");
    std::fs::write(folder.path().join("grid.toml"), other).expect("a file");
    for shard in ["1/1", "1/2"] {
        let arguments = ["sweep", "grid.toml", "--shard", shard];
        let (code, _, stderr) = told(folder.path(), &arguments);
        assert!(code == 2 && stderr.contains("the log of another sweep"), "{stderr}");
    }
    let log = std::fs::File::open(folder.path().join("grid.sweep/shard-1-of-1.log"));
    let log = log.expect("a log");
    log.lock().expect("a lock");
    let (code, _, stderr) = told(folder.path(), &["sweep", "grid.toml"]);
    assert!(code == 2 && stderr.contains("another process at work"), "{stderr}");
}

#[test]
fn there_is_nothing_to_gather() {
    let folder = folder(QUICK);
    std::fs::write(folder.path().join("no.log"), "something else\n").expect("a file");
    for (place, words) in [(".", "no.log: found no log of a sweep"), ("grid.sweep", "found no log")]
    {
        let (code, _, stderr) = told(folder.path(), &["gather", place]);
        assert!(code == 2 && stderr.contains(words), "{stderr}");
    }
    let (code, _, stderr) = told(folder.path(), &["sweep", "grid.toml", "-o", "a.xlsx"]);
    assert!(code == 2 && stderr.contains("a.xlsx: found no .csv, .jsonl or .parquet"), "{stderr}");
}
