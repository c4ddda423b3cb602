//! Whole captures of foreign dialects, where the environment variable `HERTZSCOPE_CAPTURES` names
//! their folder.
//!
//! What is expected was counted in the files themselves, with other tools: rows, first and last
//! values, how many values stand at an end, how far apart neighbouring values lie.

use std::path::Path;

use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::read_all;
use hertzscope::scope::Source;

fn captures(name: &str) -> Option<Vec<Capture>> {
    let folder = std::env::var_os("HERTZSCOPE_CAPTURES")?;
    let path = Path::new(&folder).join(name);
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    Some(read_all(&bytes, name).unwrap_or_else(|error| panic!("{error}")))
}

/// What a capture must say. Volts are compared to a billionth.
struct Wanted {
    source: Source,
    points: usize,
    first: f64,
    last: f64,
    lowest: f64,
    highest: f64,
    scale: f64,
    position: f64,
    time_base: f64,
    interval: f64,
    trigger_point: f64,
    probe: f64,
    clipped: usize,
}

fn check(name: &str, capture: &Capture, wanted: &Wanted) {
    let waveform = &capture.waveform;
    let volts = |index: usize| waveform.volts(index).expect("inside");
    let level = |code: Option<&i16>| waveform.volts_of(*code.expect("points"));
    assert_eq!(waveform.source, wanted.source, "{name}");
    assert_eq!(waveform.codes.len(), wanted.points, "{name}");
    for (what, found, wanted) in [
        ("first", volts(0), wanted.first),
        ("last", volts(wanted.points - 1), wanted.last),
        ("lowest", level(waveform.codes.iter().min()), wanted.lowest),
        ("highest", level(waveform.codes.iter().max()), wanted.highest),
    ] {
        assert!((found - wanted).abs() < 1e-9, "{name}, {what}: {found}, wanted {wanted}");
    }
    assert_eq!(waveform.vertical.scale, wanted.scale, "{name}");
    assert_eq!(waveform.vertical.position, wanted.position, "{name}");
    assert_eq!(waveform.vertical.probe, wanted.probe, "{name}");
    assert_eq!(waveform.horizontal_scale, wanted.time_base, "{name}");
    assert_eq!(waveform.preamble.x_incr, wanted.interval, "{name}");
    assert_eq!(waveform.trigger_point, wanted.trigger_point, "{name}");
    assert_eq!(waveform.clipped(), wanted.clipped, "{name}");
}

fn model(capture: &Capture) -> &str {
    capture.instrument.as_ref().map(|i| i.model.as_str()).unwrap_or_default()
}

const ROD: Wanted = Wanted {
    source: Source::Channel(1),
    points: 2500,
    first: 0.0,
    last: 6.96,
    lowest: -0.04,
    highest: 6.96,
    scale: 1.0,
    position: -1.88,
    time_base: 250e-6,
    interval: 1e-6,
    trigger_point: 1030.0,
    probe: 1.0,
    clipped: 183,
};

/// The header's Yzero of channel 2, -1.4 V at 2 V/div, is -17.5 levels; values are whole multiples
/// of 0.08 V.
const PIEZO: Wanted = Wanted {
    source: Source::Channel(2),
    last: 0.0,
    lowest: -0.08,
    highest: 3.04,
    scale: 2.0,
    position: -0.72,
    clipped: 0,
    ..ROD
};

#[test]
fn openchoice_two_channels_of_a_hammered_rod() {
    for (name, clipped, first_clipped, piezo_first) in [
        ("openchoice-rod-piezo-2.csv", 183, 2316, 0.0),
        ("openchoice-rod-piezo-3.csv", 813, 1687, 0.08),
    ] {
        let Some(found) = captures(name) else { return };
        assert_eq!(found.len(), 2, "{name}");
        check(name, &found[0], &Wanted { clipped, ..ROD });
        check(name, &found[1], &Wanted { first: piezo_first, ..PIEZO });
        let at_the_end = found[0].waveform.codes.iter().position(|code| *code == 127);
        assert_eq!(at_the_end, Some(first_clipped), "{name}");
        assert_eq!((model(&found[0]), model(&found[1])), ("TDS1002B", "TDS1002B"));
        assert_eq!(found[0].notes.len(), 1, "{:?}", found[0].notes);
        assert!(found[0].notes[0].starts_with("OpenChoice says: TDS 1002B - 3:3"));
        assert!(found[1].notes[1].starts_with("zero is -17.5 levels"), "{:?}", found[1].notes);
    }
}

#[test]
fn a_spreadsheet_kept_every_level() {
    let name = "spreadsheet-tds2001c-F0000CH1.CSV";
    let Some(found) = captures(name) else { return };
    assert_eq!(found.len(), 1);
    let wanted = Wanted {
        source: Source::Channel(1),
        points: 2500,
        first: 0.0056,
        last: 0.0064,
        lowest: 0.0032,
        highest: 0.0912,
        scale: 0.02,
        // -43.2 mV at 20 mV/div.
        position: -2.16,
        time_base: 250e-9,
        interval: 1e-9,
        trigger_point: 330.0,
        probe: 10.0,
        clipped: 0,
    };
    check(name, &found[0], &wanted);
    // (0.0032 - 0.0432) / 0.0008 and (0.0912 - 0.0432) / 0.0008.
    let codes = &found[0].waveform.codes;
    assert_eq!((codes.iter().min(), codes.iter().max()), (Some(&-50), Some(&60)));
    assert_eq!((model(&found[0]), found[0].notes.as_slice()), ("TDS2001C", &[][..]));
}

/// 128 different values, all neighbours 0.04 V apart: 1 V/div, if a division has 25 of them.
#[test]
fn a_file_without_header_shows_its_scale() {
    let name = "headless-TEK0001.CSV";
    let Some(found) = captures(name) else { return };
    assert_eq!(found.len(), 1);
    let wanted = Wanted {
        source: Source::Channel(1),
        points: 2500,
        first: -1.2,
        last: -1.52,
        lowest: -2.56,
        highest: 2.52,
        scale: 1.0,
        position: 0.0,
        time_base: 100e-6,
        interval: 4e-7,
        trigger_point: 1243.0,
        probe: 1.0,
        clipped: 0,
    };
    check(name, &found[0], &wanted);
    assert_eq!(found[0].instrument, None);
    for guess in ["vertical scale", "vertical position", "source", "probe", "time base", "unit of"]
    {
        let named = found[0].notes.iter().any(|note| note.starts_with(guess));
        assert!(named, "{guess}: {:?}", found[0].notes);
    }
}

#[test]
fn a_newer_model_with_eight_bits() {
    let name = "tbs1052c-TEK00000.CSV";
    let Some(found) = captures(name) else { return };
    assert_eq!(found.len(), 1);
    let wanted = Wanted {
        source: Source::Channel(1),
        points: 2000,
        first: -1.32,
        last: 0.04,
        lowest: -5.08,
        highest: 1.84,
        scale: 1.0,
        position: 0.0,
        time_base: 0.1,
        interval: 8e-4,
        trigger_point: 1000.0,
        probe: 1.0,
        clipped: 0,
    };
    check(name, &found[0], &wanted);
    assert_eq!(model(&found[0]), "TBS1052C");
    assert_eq!(found[0].notes, ["vertical position taken as 0 div: not given in the file"]);
}
