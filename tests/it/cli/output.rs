//! Standard output and standard error that are closed or full, and numbers that are not finite.

use std::path::Path;
use std::process::Command;

use super::{QUICK, hertzscope, printed, refused, says, temporary};

/// Exit code of the program in a shell that redirects its output.
fn code(folder: &Path, arguments: &str, redirection: &str) -> Option<i32> {
    let program = env!("CARGO_BIN_EXE_hertzscope");
    let mut shell = Command::new("bash");
    shell.current_dir(folder).args(["-c", &format!("'{program}' {arguments} {redirection}")]);
    shell.output().expect("bash").status.code()
}

/// Finding 8: `run` panicked (exit code 101) although the recording was complete.
#[test]
fn a_closed_or_full_standard_error_changes_no_exit_code() {
    let folder = temporary();
    let path = folder.path();
    std::fs::write(
        path.join("late.toml"),
        "base = \"magnet-0.61g\"\nscope.trigger.level = \"90 V\"\n",
    )
    .expect("a scene");
    printed(path, &[&["run", "-q", "-o", "m.mcap"][..], &QUICK].concat());
    for redirection in ["2>&-", "2>/dev/full", "2> >(exec true)"] {
        let run = "run magnet-0.61g -q --accuracy 1e-3 -o x.mcap";
        assert_eq!(code(path, run, redirection), Some(0), "{redirection}");
        // Refusals, and an answer of no.
        assert_eq!(code(path, "run nothing-of-this-name", redirection), Some(2), "{redirection}");
        assert_eq!(code(path, "fly", redirection), Some(2), "{redirection}");
    }
}

/// What was asked for could not be printed: an error, but for a reader that has enough.
#[test]
fn a_full_standard_output_is_an_error_of_every_command() {
    let folder = temporary();
    let path = folder.path();
    for arguments in
        ["--help", "--version", "run --help", "scenes", "list materials", "man", "help"]
    {
        assert_eq!(code(path, arguments, ">/dev/full"), Some(2), "{arguments}");
        assert_eq!(code(path, arguments, "| true; exit ${PIPESTATUS[0]}"), Some(0), "{arguments}");
    }
}

/// Finding 10: infinite results were printed, in text as "inf" and in JSON as null.
#[test]
fn a_result_that_is_not_finite_is_refused_with_its_quantity() {
    let folder = temporary();
    let path = folder.path();
    let shipped = hertzscope::data::instrument("magnets", "ring-15-6-6").expect("it ships");
    let line = shipped.lines().find(|line| line.starts_with("sphere_diameter")).expect("a sphere");
    let huge = shipped.replace(line, "sphere_diameter = \"1e308 mm\"");
    std::fs::write(path.join("huge.toml"), huge).expect("a magnet");
    printed(path, &[&["run", "-q", "-o", "run.mcap"][..], &QUICK].concat());
    printed(path, &["convert", "-q", "run.mcap", "one.isf", "--channel", "CH2"]);
    // Ten samples, so close that the spectrum's bins are further apart than any number.
    let bytes = std::fs::read(path.join("one.isf")).expect("a curve");
    let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
    let (head, curve) = text.split_once(":CURVE #42500").expect("a curve");
    let (before, after) = head.split_once("XINCR ").expect("an interval");
    let (_, after) = after.split_once(';').expect("further keys");
    let head = format!("{before}XINCR 1.0E-310;{after}");
    let head = head.replace("NR_PT 2500", "NR_PT 10").replace("2500 points", "10 points");
    let samples: String = curve.chars().skip(1000).take(10).collect();
    let changed = format!("{head}:CURVE #210{samples}");
    let bytes: Vec<u8> = changed.chars().map(|c| u8::try_from(c).expect("a byte")).collect();
    std::fs::write(path.join("huge.isf"), bytes).expect("a curve");
    for arguments in [
        &["magnet", "huge.toml", "--distance", "1mm"][..],
        &["magnet", "huge.toml", "--distance", "1mm", "--json"],
        &["magnet", "huge.toml", "--distance", "1mm", "--plot", "huge.svg"],
        &["spectrum", "huge.isf"],
        &["spectrum", "huge.isf", "--json"],
    ] {
        let words = refused(path, arguments);
        says(&words, &["expected a finite number", "`"]);
    }
    assert!(!path.join("huge.svg").exists());
}

/// Finding 10: limits beyond any measurement were accepted.
#[test]
fn limits_and_faults_beyond_any_measurement_are_refused() {
    let folder = temporary();
    for limit in ["correlation=2", "peak=1e300%", "arrival=1e300s", "rms=1e300V", "gain=1e9%"] {
        let arguments = ["compare", "a.mcap", "magnet-0.61g", "--tolerance", limit];
        let done = hertzscope(folder.path(), &arguments);
        assert_eq!(done.code, 2, "{limit}");
        says(&done.stderr, &["--tolerance", limit]);
    }
    #[cfg(feature = "server")]
    for fault in ["garbled=1e300%", "garbled=101%", "second=1e300s", "noisy=1e300V", "late=1e300s"]
    {
        let done = hertzscope(folder.path(), &["serve", "--fault", fault, "--listen", "nowhere"]);
        assert_eq!(done.code, 2, "{fault}");
        says(&done.stderr, &["--fault", "up to"]);
    }
}
