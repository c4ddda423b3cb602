//! What reader and writer refuse, with the words in which they say so.

use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::{Dialect, MAXIMUM_BYTES, read, write};

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
const WRONG_FIELDS: [(usize, &str, &str, &str); 19] = [
    (
        2,
        "Sample Interval",
        "Sample interval",
        "F.CSV, line 2, column 1: found `Sample interval`, expected `Sample Interval`",
    ),
    (4, ",,,", "Note,,,", "F.CSV, line 4, column 1: found `Note`, expected an empty field"),
    (5, ",,,", ",x,,", "F.CSV, line 5, column 2: found `x`, expected an empty field"),
    (
        1,
        "2.500000e+03",
        "2.000000e+03",
        "F.CSV, line 1, column 15: `Record Length` is `2.000000e+03`, expected `2.500000e+03` for a record in V",
    ),
    (
        2,
        "1.000000e-04",
        "1.0e-4",
        "F.CSV, line 2, column 17: `Sample Interval` is `1.0e-4`, expected a number with 6 decimals and exponent",
    ),
    (
        2,
        "1.000000e-04",
        "-1.000000e-04",
        "F.CSV, line 2, column 17: `Sample Interval` is `-1.000000e-04`, expected above 0",
    ),
    (
        3,
        "8.000000000000e+02",
        "inf",
        "F.CSV, line 3, column 15: `Trigger Point` is `inf`, expected a number with 12 decimals and exponent",
    ),
    (
        7,
        "CH1",
        "CH9",
        "F.CSV, line 7, column 8: `Source` is `CH9`, expected CH1 to CH4, MATH or REFA to REFD",
    ),
    (
        8,
        "V,",
        "Volts,",
        "F.CSV, line 8, column 16: `Vertical Units` is `Volts`, expected `V` over `s` or `dB` over `Hz`, not over `s`",
    ),
    (
        9,
        "2.000000e-03",
        "2.000000e-04",
        "F.CSV, line 9, column 16: `Vertical Scale` is `2.000000e-04`, expected above 0.00025 V/div, or five decimals do not resolve levels",
    ),
    (
        12,
        "2.500000e-02",
        "5.000000e-02",
        "F.CSV, line 12, column 18: `Horizontal Scale` is `5.000000e-02`, expected 2.500000e-02, 250 sample intervals",
    ),
    (13, "Y", "Z", "F.CSV, line 13, column 8: `Pt Fmt` is `Z`, expected Y or ENV"),
    (
        14,
        "0.000000e+00",
        "1.000000e+00",
        "F.CSV, line 14, column 7: `Yzero` is `1.000000e+00`, expected 0 in the time domain",
    ),
    (16, "TDS2014C", "", "F.CSV, line 16, column 14: `Model Number` is ``, expected a name"),
    (
        18,
        "Firmware Version",
        "Firmware",
        "F.CSV, line 18, column 1: found `Firmware`, expected `Firmware Version`",
    ),
    (
        19,
        "-00.078200000000",
        "-00.078100000000",
        "F.CSV, line 19, column 4: found `-00.078100000000`, expected -00.078200000000 s by sample interval and trigger point",
    ),
    (1000, "00.019900000000", "nan", "F.CSV, line 1000, column 4: found `nan`, expected a number"),
    (2500, ",,,", ",,0,", "F.CSV, line 2500, column 3: found `0`, expected an empty field"),
    (3, ",,", ",", "F.CSV, line 3, column 63: found 5 fields, expected 6, the last one empty"),
];

#[test]
fn errors_tell_line_column_found_and_expected() {
    for (line, from, to, expected) in WRONG_FIELDS {
        assert_eq!(message(edited(line, from, to).as_bytes()), expected);
    }
}

#[test]
fn a_value_between_two_levels_is_refused() {
    // Row 1 is level -128: (-128 + 140) * 0.08 mV = 0.96 mV. A level on is 1.04 mV.
    let file = edited(1, "   0.00096", "   0.00099");
    assert_eq!(
        message(file.as_bytes()),
        "F.CSV, line 1, column 47: found `   0.00099`, expected a digitiser level, the nearest is 0.00096 V"
    );
    let on =
        read(edited(1, "   0.00096", "   0.00104").as_bytes(), "F.CSV").expect("the next level");
    assert_eq!(on.waveform.codes[0], -127);
    let below = edited(1, "   0.00096", "   0.00088");
    assert_eq!(
        message(below.as_bytes()),
        "F.CSV, line 1, column 47: found `   0.00088`, expected a digitiser level, the nearest is 0.00096 V"
    );
}

#[test]
fn wrong_row_counts_are_refused() {
    let text = write(&plain_record()).expect("writable");
    let short: Vec<String> = text.lines().take(2499).map(str::to_owned).collect();
    assert_eq!(
        message(short.concat_lines().as_bytes()),
        "F.CSV: found 2499 rows, expected 2500 by its Record Length"
    );
    let long = format!("{text}\n");
    assert_eq!(
        message(long.as_bytes()),
        "F.CSV: found 2501 rows, expected 2500 by its Record Length"
    );
    let header: Vec<String> = text.lines().take(10).map(str::to_owned).collect();
    assert_eq!(
        message(header.concat_lines().as_bytes()),
        "F.CSV, line 11, column 1: found the end of the file, expected `Horizontal Units`"
    );
    let cut = message(text.trim_end().as_bytes());
    assert!(cut.starts_with("F.CSV, line 2500, ") && cut.contains("expected a line end"), "{cut}");
    let missing: Vec<String> = text
        .lines()
        .enumerate()
        .filter(|(index, _)| *index != 8)
        .map(|(_, line)| line.to_owned())
        .collect();
    assert_eq!(
        message(missing.concat_lines().as_bytes()),
        "F.CSV, line 9, column 1: found `Vertical Offset`, expected `Vertical Scale`"
    );
}

#[test]
fn what_is_no_text_is_refused() {
    assert_eq!(message(b""), "F.CSV: found no bytes, expected a Tektronix CSV file");
    assert_eq!(
        message(b"Record\nLe\xffngth"),
        "F.CSV, line 2, column 3: found byte 0xFF, expected UTF-8 text"
    );
    let huge = vec![b'\n'; MAXIMUM_BYTES + 1];
    assert_eq!(
        message(&huge),
        "F.CSV: 67108865 bytes are more than the 67108864 that are read: cut the record, or save fewer points"
    );
    let widest = vec![b','; MAXIMUM_BYTES];
    assert_eq!(message(&widest), "F.CSV, line 1, column 1: found ``, expected `Record Length`");
}

#[test]
fn other_dialects_are_refused_by_name() {
    for (text, wanted) in [
        (
            "Record Length,2500,Points,-1.0300000E-3,0.0,,Record Length,2500,Points,-1.0300000E-3,0.0,\r\n",
            Dialect::OpenChoice,
        ),
        ("Model,TBS1102C\nFirmware Version,v1.29.38\n", Dialect::NewerModel),
        (
            "Record Length,2.50E+03,,-0.0304,0\nSample Interval,4.00E-05,,-0.03036,0.004\n",
            Dialect::Spreadsheet,
        ),
        (",,,x,y\nRecord Length,2.50E+03,,-0.0021,-0.0092\n", Dialect::Spreadsheet),
        (
            ",,,time,volt,\nRecord Length,2.500000e+03,,  -0.019300000000,   0.72800,\n",
            Dialect::HandHeader,
        ),
        ("-0.0004972,-1.2\r\n-0.0004968,-0.76\r\n", Dialect::Headerless),
    ] {
        let error = message(text.as_bytes());
        let looks = format!("looks like {wanted}; expected the native CSV");
        assert!(error.starts_with("F.CSV, line 1: ") && error.contains(&looks), "{error}");
    }
    assert_eq!(
        message(b"Model,TBS1102C\n"),
        "F.CSV, line 1: found `Model,TBS1102C`, which looks like a file of a newer model (TBS1000C); \
         expected the native CSV of a TDS1000/2000"
    );
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
