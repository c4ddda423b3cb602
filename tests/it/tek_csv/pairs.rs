//! R&S RTO, RTE and RTP: settings and values in two files; and files whose names tell nothing.

use std::path::Path;

use hertzscope::recording::{Capture, open};
use hertzscope::scope::Source;

const VALUES: [f64; 5] = [0.1, 0.2, 0.3, 0.25, -0.05];

fn settings(extra: &str) -> String {
    format!(
        "Resolution:2e-09:\nRecordLength:4:\nXStart:-2e-09:\nSignalRecordLength:4:\nHardwareXStart:-6e-09:\nSignalHardwareRecordLength:5:\nSignalResolution:2e-09:\nSource:CH3:\n{extra}FirmwareVersion:4.20:\n"
    )
}

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).expect("a file");
}

fn rows(count: usize) -> String {
    VALUES[..count].iter().map(f64::to_string).collect::<Vec<_>>().join("\n") + "\n"
}

fn is(capture: &Capture, start: f64, count: usize) {
    let waveform = &capture.waveform;
    assert_eq!(waveform.source, Source::Channel(3), "{:?}", capture.notes);
    assert!((waveform.preamble.x_incr / 2e-9 - 1.0).abs() < 1e-12);
    assert!((waveform.time(0) - start).abs() < 1e-18, "{}", waveform.time(0));
    let found: Vec<f64> = waveform.values().collect();
    for (found, expected) in found.iter().zip(&VALUES[..count]) {
        assert!((found - expected).abs() < 1e-15, "{found} for {expected}");
    }
    assert_eq!(found.len(), count);
}

/// Whichever file is named, and for their folder, both are read together: all samples of the
/// hardware from `HardwareXStart`, those on the screen from `XStart`.
#[test]
fn pairs_of_settings_and_values_are_read_as_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    write(path, "shot.csv", &settings(""));
    for (count, start) in [(5, -6e-9), (4, -2e-9)] {
        write(path, "shot.Wfm.csv", &rows(count));
        for name in ["shot.csv", "shot.Wfm.csv", ""] {
            let set = open(&path.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(set.shots.len(), 1);
            assert!(set.problems.is_empty(), "{:?}", set.problems);
            is(&set.shots[0].captures[0], start, count);
            let mut names: Vec<&str> = set.attachments.iter().map(|a| a.name.as_str()).collect();
            names.sort_unstable();
            assert_eq!(names, ["shot.Wfm.csv", "shot.csv"]);
        }
    }
    let refused = |extra: &str, count: usize| {
        write(path, "shot.csv", &settings(extra));
        write(path, "shot.Wfm.csv", &rows(count));
        open(&path.join("shot.csv")).expect_err("not readable").to_string()
    };
    assert!(refused("InterleavedTraceCount:2:\n", 4).contains("an envelope"));
    let short = refused("", 3);
    assert!(short.contains("3 rows") && short.contains('5'), "{short}");
    write(path, "shot.csv", "FirmwareVersion:4.20:\n");
    let error = open(&path.join("shot.Wfm.csv")).expect_err("no interval").to_string();
    assert!(error.contains("SignalResolution"), "{error}");
}

/// Tables, binary files, ISF and recordings under other names are what they contain; texts and
/// other bytes are refused.
#[test]
fn files_of_unknown_endings_are_known_by_their_content() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let table = "Time (s),U (V)\n0,0.5\n1e-6,1.5\n2e-6,0.25\n3e-6,0.5\n";
    for name in ["shot.log", "shot", "shot.csv.bak", "F1.001"] {
        write(path, name, table);
        let set = open(&path.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let values: Vec<f64> = set.shots[0].captures[0].waveform.values().collect();
        assert_eq!(values, [0.5, 1.5, 0.25, 0.5]);
    }
    let set = open(&path.join("shot.log")).expect("a table");
    hertzscope::recording::write(&path.join("shot.mcap"), &set).expect("a recording");
    std::fs::rename(path.join("shot.mcap"), path.join("shot.old")).expect("another name");
    assert_eq!(open(&path.join("shot.old")).expect("a recording").shots, set.shots);
    for (name, text) in [
        ("notes.md", "# Shots\n\nThe striker hit at 0.44 m/s.\n\n- 12 shots\n- 3 of them bad\n"),
        ("scene.xyz", "base = \"magnet-0.61g\"\nstriker.speed = \"0.5 m/s\"\n"),
        ("picture.raw", "\u{0}\u{1}\u{2}1,2\n3,4\n"),
    ] {
        write(path, name, text);
        let error = open(&path.join(name)).expect_err(name).to_string();
        assert!(error.contains("no known format"), "{name}: {error}");
    }
}
