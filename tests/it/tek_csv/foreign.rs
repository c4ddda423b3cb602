//! The foreign dialects, made up: the levels that come back are those that went in, and every guess
//! is named.

use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::{read, read_all, write};
use hertzscope::scope::Source;

use super::foreign_texts::{
    headerless, newer, openchoice, spreadsheet, with_quotes, with_semicolons,
};
use super::made_up::{Setup, fft, plain_record, ramp_after, record};

fn one(text: &str) -> Capture {
    let mut captures = read_all(text.as_bytes(), "F.CSV").expect("readable");
    assert_eq!(captures.len(), 1, "captures");
    captures.remove(0)
}

fn without_notes(capture: &Capture) -> Capture {
    Capture { notes: Vec::new(), ..capture.clone() }
}

/// 100 mV/div, so that a spreadsheet keeps every digit; zero 3 divisions below the centre.
const COARSE: Setup =
    Setup { scale: 0.1, probe: 10.0, position_levels: -75, interval: 4e-6, trigger_point: 700.0 };

fn coarse() -> Capture {
    record(&COARSE, ramp_after(&[], 2500))
}

#[test]
fn native_files_read_as_ever() {
    let text = write(&plain_record()).expect("writable");
    assert_eq!(one(&text), read(text.as_bytes(), "F.CSV").expect("native"));
    assert_eq!(one(&text.replace('\n', "\r\n")), plain_record());
}

#[test]
fn spreadsheets_lose_digits_but_no_levels() {
    let text = spreadsheet(&coarse());
    for (text, notes) in [
        (text.clone(), &[][..]),
        (text.replace('\n', "\r\n"), &[]),
        (format!("\u{feff}{text}"), &[]),
        (format!(",,,x,y\n{text}"), &["passed over above the header: `,,,x,y`"]),
        (with_semicolons(&text), &["numbers have a decimal comma"]),
        (with_quotes(&text), &["numbers have a decimal comma"]),
        (text.replace(',', "\t"), &[]),
    ] {
        let found = one(&text);
        assert_eq!(found.notes, notes, "{}", &text[..60]);
        assert!(without_notes(&found) == coarse(), "{}", &text[..60]);
    }
}

#[test]
fn hand_made_header_rows_are_passed_over() {
    let native = write(&plain_record()).expect("writable");
    for (names, end) in [(",,,time,volt,", "\n"), ("a,b,c,x,y,d", "\r\n")] {
        let text = format!("{names}\n{native}").replace('\n', end);
        let found = one(&text);
        assert_eq!(found.notes, [format!("passed over above the header: `{names}`")]);
        assert_eq!(without_notes(&found), plain_record());
    }
}

/// Five points of a spreadsheet's FFT: 0.4 dB apart, from a Yzero of which three digits are left.
#[test]
fn a_spreadsheet_keeps_an_fft() {
    let interval = 1e8 / 2048.0;
    let native = fft(interval, 5e6, -20.9691, ramp_after(&[], 1024));
    let found = one(&spreadsheet(&native)).waveform;
    assert_eq!(found.codes, native.waveform.codes);
    assert_eq!((found.preamble.y_off, found.preamble.y_unit.as_str()), (0.0, "dB"));
    assert!((found.preamble.y_zero + 20.9691).abs() < 2e-5, "{}", found.preamble.y_zero);
    assert!((found.preamble.x_incr / interval - 1.0).abs() < 1e-6, "{}", found.preamble.x_incr);
}

/// At 2 mV/div a level is 0.08 mV; four decimals cannot tell it.
#[test]
fn rounded_levels_are_not_forced() {
    let text = spreadsheet(&plain_record());
    let rounded = text.lines().fold(String::new(), |rows, line| {
        let (head, volts) = line.rsplit_once(',').expect("five cells");
        let volts: f64 = volts.parse().expect("a number");
        rows + &format!("{head},{volts:.4}\n")
    });
    let found = one(&rounded);
    assert_eq!(
        found.notes,
        [
            "the values are no multiples of 80.00 µV, the scale's level; no levels of a digitiser show in the \
             values: kept as printed, in steps of 100.0 µV"
        ]
    );
    for (index, line) in rounded.lines().enumerate() {
        let printed: f64 = line.rsplit(',').next().and_then(|v| v.parse().ok()).expect("volts");
        let volts = found.waveform.volts(index).expect("inside");
        assert!((volts - printed).abs() < 1e-12, "row {index}: {volts}, printed {printed}");
    }
    assert_eq!((found.waveform.vertical.scale, found.waveform.clipped()), (2e-3, 0));
}

#[test]
fn openchoice_keeps_two_channels_through_single_precision() {
    let setup = Setup { probe: 10.0, ..COARSE };
    let first = record(&setup, ramp_after(&[-128, 127, 0], 2500));
    let second = Setup { scale: 2.0, position_levels: 35, ..setup };
    let mut second = record(&second, ramp_after(&[5, 4, 3], 2500));
    second.waveform.source = Source::Channel(2);
    let wanted = [first, second];
    let text = openchoice(&wanted);
    for text in [text.clone(), format!("{text}\r\n"), with_semicolons(&text)] {
        let found = read_all(text.as_bytes(), "F.CSV").expect("readable");
        assert_eq!(found.len(), 2);
        for (found, wanted) in found.iter().zip(&wanted) {
            assert_eq!(found.waveform, wanted.waveform);
            let instrument = found.instrument.as_ref().expect("noted");
            assert_eq!((instrument.model.as_str(), instrument.firmware.as_str()), ("TDS1002B", ""));
            let said = "OpenChoice says: TDS 1002B - 3:31:27 PM 3/2/2023";
            assert!(found.notes.iter().any(|note| note == said), "{:?}", found.notes);
            // One with a model writes as a native file.
            assert!(write(found).is_ok());
        }
    }
}

/// Zero levels that are no whole number have been seen in `OpenChoice` files: -1.4 V at 2 V/div.
#[test]
fn a_zero_between_levels_is_noted() {
    let mut capture = record(&Setup { scale: 2.0, ..COARSE }, ramp_after(&[-18, -17], 2500));
    capture.waveform.codes.iter_mut().for_each(|code| *code = (*code).clamp(-50, 50));
    capture.waveform.vertical.position = -0.7;
    capture.waveform.preamble.y_off = -18.0;
    let found = &read_all(openchoice(&[capture]).as_bytes(), "F.CSV").expect("readable")[0];
    assert_eq!(found.waveform.codes[..2], [-18, -17]);
    assert_eq!(found.waveform.volts(1), Some(0.08));
    assert!(found.notes[1].starts_with("zero is -17.5 levels"), "{:?}", found.notes);
}

#[test]
fn newer_models_with_eight_bits_keep_their_levels() {
    let volts = |level: f64| -> Vec<String> {
        (0..2000).map(|i| format!("{}", f64::from(i % 200 - 100) * level)).collect()
    };
    // 1 V/div: 0.04 V a level, 0.5 V/div: 0.02 V; no digits beyond those that tell.
    let short = |cells: Vec<String>| -> Vec<String> {
        cells.iter().map(|cell| format!("{:.2}", cell.parse::<f64>().unwrap())).collect()
    };
    let text = newer(&[1.0, 0.5], &[short(volts(0.04)), short(volts(0.02))]);
    for text in [text.clone(), text.replace('\n', "\r\n"), with_semicolons(&text)] {
        let found = read_all(text.as_bytes(), "TEK00000.CSV").expect("readable");
        assert_eq!(found.len(), 2);
        for (channel, (found, scale)) in (1..).zip(found.iter().zip([1.0, 0.5])) {
            let waveform = &found.waveform;
            assert_eq!(waveform.source, Source::Channel(channel));
            assert_eq!((waveform.codes[0], waveform.codes[199]), (-100, 99));
            assert_eq!((waveform.vertical.scale, waveform.preamble.y_mult), (scale, scale / 25.0));
            assert_eq!((waveform.preamble.x_incr, waveform.trigger_point), (3.2e-8, 90.0));
            assert_eq!(waveform.horizontal_scale, 4e-6);
            assert_eq!(waveform.vertical.probe, 10_f64.powi(i32::from(channel) - 1));
        }
        let moved = "Vertical Offset 1 V moves the screen and is not in the values";
        assert!(found[1].notes.iter().any(|note| note == moved), "{:?}", found[1].notes);
    }
}

/// Six digits of a converter with more bits: no level of 0.199 V/25 fits, and 16 bits do not hold
/// the digits.
#[test]
fn newer_models_with_more_bits_are_not_forced_into_eight() {
    let volts: Vec<f64> = (0..2000).map(|i| 0.7 * (f64::from(i) * 0.0137).sin() + 1e-4).collect();
    let cells = volts.iter().map(|v| six_digits(*v)).collect();
    let found = one(&newer(&[0.199], &[cells]));
    let (step, note) = (found.waveform.preamble.y_mult, &found.notes[0]);
    assert!(
        note.contains("in 16 bits (.isf) they are in steps of 50.00 µV, within 25 µV"),
        "{note}"
    );
    assert_eq!(step, 5e-5);
    for (index, volts) in volts.iter().enumerate() {
        let kept = found.waveform.volts(index).expect("inside");
        assert!((kept - volts).abs() < 0.5 * step + 1e-6, "point {index}: {kept} for {volts}");
    }
    assert_eq!((found.waveform.vertical.scale, found.waveform.clipped()), (0.199, 0));
}

/// As C prints with `%g`.
fn six_digits(value: f64) -> String {
    format!("{value:.5e}").parse::<f64>().expect("a number").to_string()
}

#[test]
fn samples_alone_are_read_with_every_guess_named() {
    let text = headerless(&coarse());
    let wanted = coarse().waveform;
    for text in [text.clone(), text.replace("\r\n", "\n"), text.replace(',', ";")] {
        let found = one(&text);
        let waveform = &found.waveform;
        for index in 0..2500 {
            let (volts, truth) = (waveform.volts(index), wanted.volts(index));
            assert!((volts.unwrap() - truth.unwrap()).abs() < 1e-12, "point {index}");
        }
        assert_eq!(waveform.preamble.y_mult, 0.1 / 25.0);
        assert_eq!((waveform.vertical.scale, waveform.vertical.probe), (0.1, 1.0));
        assert_eq!((waveform.preamble.x_incr, waveform.trigger_point), (4e-6, 700.0));
        assert_eq!(waveform.horizontal_scale, 1e-3);
        for guess in [
            "the file has no header",
            "unit of the values taken as V: not given in the file",
            "vertical scale taken as 100 mV/div, 25 levels a division: not given in the file",
            "source taken as CH1: not given in the file",
            "probe attenuation taken as 1: not given in the file",
        ] {
            assert!(found.notes.iter().any(|note| note == guess), "{guess}: {:?}", found.notes);
        }
    }
}

#[test]
fn the_spacing_of_levels_tells_every_scale_of_the_family() {
    for (scale, probe) in [2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0]
        .into_iter()
        .flat_map(|scale| [(scale, 1.0), (scale * 10.0, 10.0), (scale * 1000.0, 1000.0)])
    {
        let record = record(&Setup { scale, probe, ..COARSE }, ramp_after(&[], 2500));
        let waveform = one(&headerless(&record)).waveform;
        assert_eq!(waveform.vertical.scale, scale);
        let off = |index| waveform.volts(index).unwrap() - record.waveform.volts(index).unwrap();
        assert!((0..2500).all(|index| off(index).abs() < 1e-9 * scale), "{scale} V/div");
    }
}

#[test]
fn names_of_files_tell_the_channel_of_samples_alone() {
    let captures = read_all(headerless(&coarse()).as_bytes(), "ALL0001/F0001CH3.CSV");
    let capture = &captures.expect("readable")[0];
    assert_eq!(capture.waveform.source, Source::Channel(3));
    let named = "source taken as CH3 from the file's name";
    assert!(capture.notes.iter().any(|note| note == named), "{:?}", capture.notes);
}

#[test]
fn names_above_the_samples_tell_unit_and_channel() {
    let rows = "-1,100\n-0.5,140\n0,180\n0.5,100\n1,60\n";
    let found = one(&format!("Time (ms),CH2 (mV)\n{rows}"));
    let waveform = &found.waveform;
    assert_eq!(waveform.source, Source::Channel(2));
    assert_eq!((waveform.preamble.x_incr, waveform.trigger_point), (5e-4, 2.0));
    assert_eq!(waveform.preamble.y_mult, 0.04);
    assert!((waveform.volts(2).unwrap() - 0.18).abs() < 1e-12);
    assert_eq!(found.notes[0], "the file has no header but `Time (ms),CH2 (mV)`");
    let few = "the scale is a weak guess: only 4 levels occur";
    assert!(found.notes.iter().any(|note| note == few), "{:?}", found.notes);
    let plain = one(&format!("x,y\n{rows}"));
    assert_eq!((plain.waveform.source, plain.waveform.preamble.x_incr), (Source::Channel(1), 0.5));
    let two = read_all(b"t;a;b\n0;1,5;2\n1;1;4\n", "two.csv").expect("two channels");
    assert_eq!((two.len(), two[1].waveform.source), (2, Source::Channel(2)));
    assert_eq!(two[0].waveform.volts(0), Some(1.5));
}

#[test]
fn a_constant_record_is_kept_as_printed() {
    let found = one("0,0.5\n1e-6,0.5\n2e-6,0.5\n");
    assert_eq!(found.waveform.volts(1), Some(0.5));
    assert!(found.notes.iter().any(|note| note.contains("kept as printed")), "{:?}", found.notes);
}

#[test]
fn a_header_that_disagrees_with_the_times_is_noted() {
    let text = spreadsheet(&coarse());
    let found = one(&text.replace("Trigger Point,7.00E+02", "Trigger Point,7.10E+02"));
    assert_eq!(found.waveform, coarse().waveform);
    assert_eq!(
        found.notes,
        ["trigger point 700 taken from the column of times; the header says 710"]
    );
    let short: String = text.lines().take(2000).fold(String::new(), |rows, row| rows + row + "\n");
    assert_eq!(one(&short).notes, ["found 2000 points, the header says 2500"]);
}

#[test]
fn refusals_tell_line_and_reason() {
    let sheet = spreadsheet(&coarse());
    let line = |number: usize| sheet.lines().nth(number - 1).expect("2500 rows").to_owned();
    let with = |number: usize, row: &str| sheet.replacen(&line(number), row, 1);
    for (text, wanted) in [
        (with(100, ",,,soon,0.1"), "F.CSV, line 100, column 4: found `soon`, expected a number"),
        (with(100, ",,,-0.0024"), "F.CSV, line 100, column 11: found ``, expected a number"),
        (
            with(100, ",,,-0.0025,0.1"),
            "F.CSV, line 100, column 4: found -0.002500 s, expected -0.002404 s by even spacing",
        ),
        (
            with_semicolons(&with(100, ",,,-0.002404,0.1")).replace("-0,002404", "-0.002404"),
            "F.CSV, line 100, column 4: found `-0.002404`, expected a number with a decimal comma, as elsewhere in the file",
        ),
        (
            sheet.replace("Source,CH1", "Source,CH9"),
            "F.CSV, line 7, column 8: `Source` is `CH9`, expected CH1 to CH8, MATH or REFA to REFD",
        ),
        (
            sheet.replace("Vertical Scale,1.00E-01", "Vertical Scale,much"),
            "F.CSV, line 9, column 16: `Vertical Scale` is `much`, expected a number",
        ),
        (
            "Model,TBS1102C\nRecord Length,2000\n".to_owned(),
            "F.CSV: this is nearest to a Tektronix header beside samples (TDS1000/2000, OpenChoice), but lacks a column of times, \
             and a sample interval; say which column holds them, e.g. --columns time=1:ms,CH1=2:V,p14=4:N, or how far apart the values are, e.g. --interval \"1 us\"",
        ),
        (
            "Model,TBS1102C\nTIME,CH1\n0,1\n1,one\n".to_owned(),
            "F.CSV, line 4, column 3: found `one`, expected a number",
        ),
        (
            "Model,TBS1102C\nTIME,BUS1\n0,1\n1,2\n".to_owned(),
            "F.CSV: this is nearest to a table with a column of times and one for each channel (`Time (s),CH1 (V)`), but lacks \
             1 to 8 channels: column 2 `BUS1` is no channel and is left out; say what its columns are, e.g. --columns time=1:ms,CH1=2:V,p14=4:N",
        ),
        ("0,1\n".to_owned(), "F.CSV: found 1 rows, expected 2 to 2000000 with samples"),
        (
            "1,1\n0,1\n".to_owned(),
            "F.CSV, line 2, column 1: found 0 s, expected more than 1 s by even spacing",
        ),
    ] {
        let error = read_all(text.as_bytes(), "F.CSV").expect_err(wanted);
        assert_eq!(error.to_string(), wanted);
    }
}
