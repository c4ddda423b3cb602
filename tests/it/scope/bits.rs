//! Converters of more than 8 bits: `bits` of the oscilloscope, and what comes of it everywhere.
//! With `b` bits a division has `25 * 2^(b - 8)` levels, and codes go from `-2^(b - 1)` to
//! `2^(b - 1) - 1`.

use hertzscope::experiment::Outcome;
use hertzscope::measurement::arrivals::survey;
use hertzscope::recording::format::open;
use hertzscope::recording::mcap::write;
use hertzscope::recording::{Capture, TraceSet, isf, tek_csv};
use hertzscope::scene::{Scene, SceneError};
use hertzscope::scope::Model;
use hertzscope::scope::acquire::level;
use hertzscope::scope::waveform::codes;

use super::with;

fn twelve(changes: &str) -> Outcome {
    with(&format!("[scope]\nbits = 12\n{changes}"))
}

/// 1 V/div and 2 div up: 8 bits have 25 levels a division, so 0.123 V is 50 + 3.075; 12 bits have
/// 400, so it is 800 + 49.2; 16 bits have 6400, so it is 12800 + 787.2.
#[test]
fn codes_follow_the_bits() {
    let scene = Scene::load("magnet-0.61g").expect("a scene");
    let mut vertical = scene.scope.channels[0].as_ref().expect("CH1").vertical;
    (vertical.scale, vertical.position) = (1.0, 2.0);
    for (bits, zero, some, ends) in [
        (8, 50, 53, [-128, 127]),
        (9, 100, 106, [-256, 255]),
        (12, 800, 849, [-2048, 2047]),
        (16, 12800, 13587, [-32768, 32767]),
    ] {
        let model = Model { bits, ..scene.scope.model.clone() };
        assert_eq!([0.0, 0.123].map(|volts| level(&model, &vertical, volts)), [zero, some]);
        assert_eq!([-99.0, 99.0].map(|volts| level(&model, &vertical, volts)), ends, "{bits}");
        assert_eq!(codes(bits), ends[0]..=ends[1]);
    }
}

/// The same signal in 8 and in 12 bits: a level of 12 bits is a sixteenth, so that the codes differ
/// by half a coarse level and half a fine one at most; the trigger comes at the same time.
#[test]
fn a_run_of_twelve_bits_is_finer() {
    let (coarse, fine) = (with(""), twelve(""));
    assert_eq!(coarse.summary.trigger.time_s, fine.summary.trigger.time_s);
    let mut beyond = 0;
    for (one, other) in coarse.shot.captures.iter().zip(&fine.shot.captures) {
        let (one, other) = (&one.waveform, &other.waveform);
        assert_eq!((one.bits(), other.bits()), (Some(8), Some(12)));
        assert_eq!(other.preamble.y_mult, other.vertical.scale / 400.0);
        assert_eq!((one.clipped(), other.clipped()), (0, 0));
        for (a, b) in one.codes.iter().zip(&other.codes) {
            let off = f64::from(*b) / 16.0 - f64::from(*a);
            assert!(off.abs() <= 0.5 + 0.5 / 16.0, "{a} {b}");
        }
        beyond += other.codes.iter().filter(|code| !(-128..=127).contains(*code)).count();
        // On the screen both are at the same place, to a dot of which a division has 25.
        let pairs = one.heights().zip(other.heights());
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() <= 0.54));
        assert_eq!(one.ground(), other.ground());
    }
    assert!(beyond > 1000, "{beyond}");
}

#[test]
fn the_ends_of_twelve_bits_are_clipped() {
    let outcome = twelve("[scope.ch2]\nscale = \"50 mV/div\"\n");
    let waveform = &outcome.shot.captures[1].waveform;
    let at = |code: i16| waveform.codes.iter().filter(|c| **c == code).count();
    assert!(at(2047) > 0 && at(-2048) > 0);
    assert_eq!(waveform.clipped(), at(2047) + at(-2048));
    let notes = &outcome.summary.notes;
    assert!(notes.iter().any(|n| n.sentence.starts_with("CH2") && n.sentence.contains("clipped")));
}

fn is_same(one: &Capture, other: &Capture) -> bool {
    let (a, b) = (&one.waveform, &other.waveform);
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
    a.codes == b.codes
        && a.bits() == b.bits()
        && near(a.preamble.y_mult, b.preamble.y_mult)
        && near(a.preamble.y_off, b.preamble.y_off)
        && near(a.vertical.position, b.vertical.position)
        && near(a.preamble.x_zero, b.preamble.x_zero)
}

#[test]
fn formats_keep_twelve_bits_or_refuse_them() {
    let outcome = twelve("");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.mcap");
    let shots = vec![outcome.shot.clone()];
    write(&file, &TraceSet { shots, ..TraceSet::default() }).expect("a recording");
    let set = open(&file).expect("a recording");
    for (capture, read) in outcome.shot.captures.iter().zip(&set.shots[0].captures) {
        assert_eq!(capture.waveform, read.waveform);
        for width in [isf::Width::One, isf::Width::Two] {
            let bytes = isf::write(capture, width).expect("an ISF file");
            let read = isf::read(&bytes, "a.isf").expect("the same");
            assert!(is_same(&read, capture), "{}", read.waveform.preamble.y_mult);
        }
        // The instrument's own files have 25 levels to a division.
        let error = tek_csv::write(capture).expect_err("12 bits").to_string();
        assert!(error.contains("the converter's resolution is 12 bits"), "{error}");
    }
}

/// Values of a table have no scale beside them: they and their distance are kept, the scale is a
/// guess and noted.
#[test]
fn a_table_keeps_the_values_of_twelve_bits() {
    let outcome = twelve("");
    let waveform = &outcome.shot.captures[1].waveform;
    let rows: Vec<String> = (0..waveform.codes.len())
        .map(|n| format!("{},{}", waveform.time(n), waveform.volts(n).expect("a point")))
        .collect();
    let text = format!("time_s,CH2_V\n{}\n", rows.join("\n"));
    let read = tek_csv::read(text.as_bytes(), "t.csv").expect("a table").waveform;
    let mut pairs = waveform.values().zip(read.values());
    assert!(pairs.all(|(a, b)| (a - b).abs() < 1e-12), "values");
    assert!((read.preamble.y_mult / waveform.preamble.y_mult - 1.0).abs() < 1e-9, "{read:?}");
}

/// Without noise all that is left is rounding, even within a level: `q/sqrt(12)`, which is 11.5 mV
/// with 8 bits at 1 V/div and a sixteenth of that with 12.
#[test]
fn the_noise_of_rounding_falls_by_sixteen() {
    let noise = |outcome: &Outcome| {
        let shots = vec![outcome.shot.clone()];
        let set = TraceSet { shots, ..TraceSet::default() };
        survey(&set, &set.shots[0]).channels[1].noise.expect("noise")
    };
    for (outcome, level) in [(with(""), 1.0 / 25.0), (twelve(""), 1.0 / 400.0)] {
        let (noise, expected) = (noise(&outcome), level / 12f64.sqrt());
        assert!((noise / expected - 1.0).abs() < 0.01, "{noise} {expected}");
    }
}

#[test]
fn bits_are_those_of_a_converter() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("scene.toml");
    let problem = |changes: &str| {
        std::fs::write(&file, format!("base = \"magnet-0.61g\"\n{changes}")).expect("a file");
        let error = Scene::load(file.display().to_string()).expect_err("a problem");
        assert!(matches!(error, SceneError::Problems(_)));
        error.to_string()
    };
    for bits in ["7", "17", "12.5"] {
        let said = problem(&format!("[scope]\nbits = {bits}\n"));
        assert!(said.contains("scope.bits") && said.contains("from 8 to 16"), "{said}");
    }
    let said = problem("resolution = 12\n");
    assert!(said.contains("[scope] bits = 12"), "{said}");
}
