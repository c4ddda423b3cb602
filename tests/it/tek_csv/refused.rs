//! What reader and writer refuse, with the words in which they say so.

use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::{MAXIMUM_BYTES, read, write};

use super::made_up::{instrument, plain_record};

/// The text of a plain record with one piece of one line exchanged.
fn edited(line: usize, from: &str, to: &str) -> String {
    let text = write(&plain_record()).expect("writable");
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    assert!(lines[line - 1].contains(from), "{from} is not in {}", lines[line - 1]);
    lines[line - 1] = lines[line - 1].replace(from, to);
    lines.concat_lines()
}

trait ConcatLines {
    fn concat_lines(&self) -> String;
}

impl ConcatLines for Vec<String> {
    fn concat_lines(&self) -> String {
        self.iter().fold(String::new(), |text, line| text + line + "\n")
    }
}

fn message(bytes: &[u8]) -> String {
    read(bytes, "F.CSV").expect_err("the file is wrong").to_string()
}

/// Line, a piece of it, what it becomes, and the message that must follow.
const WRONG_FIELDS: [(usize, &str, &str, &str); 7] = [
    (
        3,
        "8.000000000000e+02",
        "inf",
        "F.CSV, line 3, column 15: `Trigger Point` is `inf`, expected a number",
    ),
    (
        7,
        "CH1",
        "CH9",
        "F.CSV, line 7, column 8: `Source` is `CH9`, expected CH1 to CH8, MATH or REFA to REFD",
    ),
    (
        19,
        "-00.078200000000",
        "-00.078100000000",
        "F.CSV, line 19, column 4: found -0.078100000000 s, expected -0.078200000000 s by even spacing",
    ),
    (11, ",s,", ",m,", "F.CSV, line 11, column 18: `Horizontal Units` is `m`, expected s or Hz"),
    (13, "Y", "Z", "F.CSV, line 13, column 8: `Pt Fmt` is `Z`, expected Y or ENV"),
    (1000, "00.019900000000", "nan", "F.CSV, line 1000, column 4: found `nan`, expected a number"),
    (1000, ",,,", ",,", "F.CSV, line 1000, column 30: found ``, expected a number"),
];

#[test]
fn errors_tell_line_column_found_and_expected() {
    for (line, from, to, expected) in WRONG_FIELDS {
        assert_eq!(message(edited(line, from, to).as_bytes()), expected);
    }
}

/// Line, a piece of it, what it becomes, and a piece of the note that must follow: the file is
/// read, and the levels are those of the plain record.
const ODD_FIELDS: [(usize, &str, &str, &str); 6] = [
    (2, "Sample Interval", "Sample interval", "not given in a header"),
    (1, "2.500000e+03", "2.000000e+03", "found 2500 points, the header says 2000"),
    (2, "1.000000e-04", "-1.000000e-04", "the header says -1e-4 s"),
    (1, "   0.00096", "   0.00099", "1 values are not levels of the digitiser"),
    (2500, ",,,", ",,0,", "1 rows have something beside time and value"),
    (15, "1.000000e+00", "", "probe attenuation taken as 1"),
];

#[test]
fn what_is_odd_in_a_native_file_is_noted() {
    for (line, from, to, note) in ODD_FIELDS {
        let found = read(edited(line, from, to).as_bytes(), "F.CSV").expect(note);
        assert_eq!(found.waveform.codes, plain_record().waveform.codes, "{note}");
        let notes = found.notes.join("\n");
        assert!(notes.contains(note), "expected `{note}` in {notes}");
    }
}

/// Row 1 is level -128: (-128 + 140) * 0.08 mV = 0.96 mV. A level on is 1.04 mV.
#[test]
fn another_level_is_another_level() {
    let on =
        read(edited(1, "   0.00096", "   0.00104").as_bytes(), "F.CSV").expect("the next level");
    assert_eq!(on.waveform.codes[0], -127);
    assert_eq!(on.notes, [""; 0]);
}

#[test]
fn other_row_counts_are_noted() {
    let text = write(&plain_record()).expect("writable");
    let cut = |lines: usize| -> String {
        text.lines().take(lines).map(str::to_owned).collect::<Vec<String>>().concat_lines()
    };
    for (text, points, note) in [
        (cut(2499), 2499, Some("found 2499 points, the header says 2500")),
        (format!("{text}\n"), 2500, None),
        (text.trim_end().to_owned(), 2500, Some("the last line has no end")),
        (cut(10), 10, Some("found 10 points, the header says 2500")),
    ] {
        let found = read(text.as_bytes(), "F.CSV").expect("readable");
        assert_eq!(found.waveform.codes.len(), points);
        let notes = found.notes.join("\n");
        assert!(note.is_none_or(|note| notes.contains(note)), "{note:?}: {notes}");
        assert_eq!(note.is_none(), found.notes.is_empty(), "{notes}");
    }
}

#[test]
fn what_is_no_text_is_refused() {
    assert_eq!(message(b""), "F.CSV: found no bytes, expected a Tektronix CSV file");
    let huge = vec![b'\n'; MAXIMUM_BYTES + 1];
    assert_eq!(
        message(&huge),
        "F.CSV: 67108865 bytes are more than the 67108864 that are read: cut the record, or save fewer points"
    );
    let widest = vec![b','; MAXIMUM_BYTES];
    assert!(message(&widest).contains("lacks rows of numbers"), "{}", message(&widest));
}

#[test]
fn captures_that_the_format_cannot_hold_are_refused() {
    type Change = fn(&mut Capture);
    let changes: [(Change, &str); 12] = [
        (
            |c| c.instrument = None,
            "the capture names no instrument, expected at least its firmware; `--instrument MODEL` gives it one",
        ),
        (
            |c| c.instrument = Some(instrument("A,B", "", "")),
            "cannot write: Model Number is `A,B`, expected text without commas and control characters",
        ),
        (
            |c| c.instrument = Some(instrument("", "C1", "")),
            "cannot write: Serial Number is `C1`, expected none, for an instrument without a model",
        ),
        (
            |c| c.waveform.codes.truncate(100),
            "cannot write: the number of points is 100, expected 2500",
        ),
        (
            |c| c.waveform.codes[7] = 128,
            "cannot write: the level of point 7, counted from 0, is 128, expected -128 to 127",
        ),
        (|c| c.waveform.preamble.y_mult = 1e-4, "cannot write: y_mult is 0.0001, expected 0.00008"),
        (|c| c.waveform.preamble.y_off = 0.0, "cannot write: y_off is 0, expected -140"),
        (|c| c.waveform.preamble.x_zero = 0.0, "cannot write: x_zero is 0, expected -0.08"),
        (|c| c.waveform.preamble.pt_off = 1, "cannot write: pt_off is 1, expected 0"),
        (
            |c| c.waveform.preamble.y_unit = "A".to_owned(),
            "cannot write: the waveform is `A` over `s`, expected `V` over `s` or `dB` over `Hz`",
        ),
        (
            |c| c.waveform.trigger_point = f64::NAN,
            "cannot write: Trigger Point is NaN, expected a finite number",
        ),
        (
            |c| c.waveform.vertical.probe = 1.000_000_1,
            "cannot write: Probe Atten is 1.0000001, expected 1, all that the header's digits hold",
        ),
    ];
    for (change, expected) in changes {
        let mut capture = plain_record();
        change(&mut capture);
        assert_eq!(write(&capture).expect_err(expected).to_string(), expected);
    }
}
