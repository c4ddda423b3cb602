//! ISF files: heads as instruments of other families wrote them, a whole capture from disk, round
//! trips, refusals, random bytes.

use std::path::Path;

use hertzscope::recording::isf::{MAXIMUM_BYTES, Width, read, write};
use hertzscope::recording::{Capture, InstrumentIdentity};
use hertzscope::scope::{Coupling, PointFormat, Preamble, Source, VerticalSetup, Waveform};
use proptest::prelude::*;

use crate::seeded;

/// `head`, and a block of `bytes` after it.
fn file(head: &str, bytes: &[u8]) -> Vec<u8> {
    let length = bytes.len().to_string();
    let mut file = format!("{head}#{}{length}", length.len()).into_bytes();
    file.extend_from_slice(bytes);
    file
}

/// The project's fact sheet on the TDS2000 family, section 4.4: a TBS1052C, short keys, one byte.
const SHORT_ONE_BYTE: &str = ":WFMP:NR_P 2000;:WFMP:BYT_N 1;BIT_N 8;ENC BIN;BN_F RI;BYT_O MSB;\
    WFI \"Ch1, DC coupling, 1.000V/div, 100.0ms/div, 2000 points, Sample mode\";NR_P 2000;PT_F Y;XUN \"s\";\
    XIN 800.0000E-6;XZE -800.0000E-3;PT_O 0;YUN \"V\";YMU 40.0000E-3;YOF 0.0E+0;YZE 0.0E+0;VSCALE 1.0000;\
    HSCALE 100.0000E-3;VPOS 0.0E+0;VOFFSET 0.0E+0;HDELAY 0.0E+0;HPOS 50.0000;FILTERF 200000000;:CURV ";

/// The same, envelope of a million points of two bytes.
const SHORT_ENVELOPE: &str = ":WFMP:NR_P 1000000;:WFMP:BYT_N 2;BIT_N 16;ENC BIN;BN_F RI;BYT_O MSB;\
    WFI \"Ch4, DC coupling, 10.00V/div, 1.000s/div, 1000000 points, Pk Detect mode\";NR_P 1000000;PT_F ENV;\
    XUN \"s\";XIN 10.0000E-6;XZE -5.0000;PT_O 0;YUN \"V\";YMU 1.5625E-3;YOF -19.0720E+3;YZE 0.0E+0;\
    VSCALE 10.0000;HSCALE 1.0000;VPOS -2.9800;VOFFSET 0.0E+0;HDELAY 0.0E+0;:CURV ";

#[test]
fn short_keys_and_one_byte() {
    let bytes: Vec<u8> = (0..2000_u32).map(|i| (i % 256) as u8).collect();
    let capture = read(&file(SHORT_ONE_BYTE, &bytes), "a.isf").expect("readable");
    let waveform = &capture.waveform;
    assert_eq!(waveform.source, Source::Channel(1));
    assert_eq!(waveform.codes[..3], [0, 1, 2]);
    assert_eq!(waveform.codes[255], -1);
    // 127 levels of 40 mV.
    assert!((waveform.volts(127).unwrap() - 5.08).abs() < 1e-12);
    assert_eq!((waveform.vertical.scale, waveform.vertical.position), (1.0, 0.0));
    assert_eq!(waveform.vertical.coupling, Some(Coupling::Dc));
    assert_eq!((waveform.horizontal_scale, waveform.preamble.x_incr), (0.1, 8e-4));
    assert_eq!((waveform.trigger_point, waveform.time(0)), (1000.0, -0.8));
    assert_eq!(capture.notes, ["probe attenuation taken as 1: not given in the file"]);
}

#[test]
fn envelopes_of_two_bytes_are_eight_bits_where_they_can_be() {
    // Upper bytes -75 and -74, lower bytes 0: levels of an 8-bit converter.
    let coarse = file(SHORT_ENVELOPE, &[0xB5, 0, 0xB6, 0]);
    let waveform = read(&coarse, "a.isf").expect("readable").waveform;
    assert_eq!(waveform.preamble.pt_fmt, PointFormat::Envelope);
    assert_eq!((waveform.codes.as_slice(), waveform.preamble.y_mult), (&[-75, -74][..], 0.4));
    // (-75 * 256 + 19072) * 1.5625 mV and (-74 * 256 + 19072) * 1.5625 mV.
    assert!((waveform.volts(0).unwrap() + 0.2).abs() < 1e-12);
    assert!((waveform.volts(1).unwrap() - 0.2).abs() < 1e-12);
    assert_eq!((waveform.trigger_point, waveform.horizontal_scale), (500_000.0, 1.0));
    assert_eq!(waveform.vertical.position, -2.98);
    // A lower byte that is not 0: 16 bits stay.
    let fine = file(SHORT_ENVELOPE, &[0xB5, 0x01, 0xB6, 0]);
    let capture = read(&fine, "a.isf").expect("readable");
    assert_eq!(capture.waveform.codes, [-19199, -18944]);
    assert!((capture.waveform.volts(0).unwrap() + 0.1984375).abs() < 1e-12);
    assert_eq!(capture.waveform.vertical.position, -2.98);
    assert!(capture.notes.contains(&"found 2 points, the preamble says 1000000".to_owned()));
}

/// Counted in the file with other tools: 10000 points, 0.1 V first, -0.1 V last, -7.3 V to 17.1 V.
#[test]
fn a_capture_of_16_bits() {
    let Some(folder) = std::env::var_os("HERTZSCOPE_CAPTURES") else { return };
    let path = Path::new(&folder).join("example-16bit.isf");
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let capture = read(&bytes, "example-16bit.isf").expect("readable");
    let waveform = &capture.waveform;
    assert_eq!((waveform.source, waveform.codes.len()), (Source::Channel(2), 10_000));
    let volts = |index| waveform.volts(index).unwrap();
    assert!((volts(0) - 0.1).abs() < 1e-9 && (volts(9999) + 0.1).abs() < 1e-9);
    let (low, high) = (waveform.codes.iter().min(), waveform.codes.iter().max());
    assert!((waveform.volts_of(*low.unwrap()) + 7.3).abs() < 1e-9);
    assert!((waveform.volts_of(*high.unwrap()) - 17.1).abs() < 1e-9);
    assert_eq!((waveform.vertical.scale, waveform.vertical.position), (5.0, -1.98));
    assert_eq!((waveform.horizontal_scale, waveform.preamble.x_incr), (400e-9, 400e-12));
    assert_eq!((waveform.trigger_point, waveform.clipped()), (4003.0, 0));
    assert_eq!(waveform.vertical.coupling, Some(Coupling::Dc));
}

/// Level 100, byte by byte, in every encoding; the value is `(100 - 50) * 8 mV = 0.4 V`. Preambles
/// with YOFF as a TDS2024C gave them: 50, 178 with RP, 12800 and 45568 for two bytes.
#[test]
fn encodings_agree() {
    let head = |bytes: u8, numbers: &str, order: &str, y_mult: &str, y_off: &str| {
        format!(
            ":WFMPRE:BYT_NR {bytes};BIT_NR {};ENCDG BIN;BN_FMT {numbers};BYT_OR {order};NR_PT 2;\
             WFID \"Ch1, AC coupling, 2.0E-1 V/div, 5.0E-7 s/div, 2 points, Sample mode\";PT_FMT Y;XINCR 2.0E-9;\
             PT_OFF 0;XZERO -2.5E-6;XUNIT \"s\";YMULT {y_mult};YZERO 0.0E0;YOFF {y_off};YUNIT \"Volts\";:CURVE ",
            8 * bytes
        )
    };
    let wide = "3.125E-5";
    for file in [
        file(&head(1, "RI", "MSB", "8.0E-3", "5.0E1"), &[100, 0x9C]),
        file(&head(1, "RP", "MSB", "8.0E-3", "1.78E2"), &[228, 28]),
        file(&head(2, "RI", "MSB", wide, "1.28E4"), &[100, 0, 0x9C, 0]),
        file(&head(2, "RI", "LSB", wide, "1.28E4"), &[0, 100, 0, 0x9C]),
        file(&head(2, "RP", "MSB", wide, "4.5568E4"), &[228, 0, 28, 0]),
        [head(1, "RP", "MSB", "8.0E-3", "5.0E1").replace("BIN", "ASC"), "100, -100\n".to_owned()]
            .concat()
            .into_bytes(),
        [head(1, "RI", "MSB", "8.0E-3", "5.0E1"), "#0d\u{1c}\n".to_owned()]
            .concat()
            .into_bytes()
            .iter()
            .map(|b| if *b == 0x1c { 0x9C } else { *b })
            .collect(),
    ] {
        let shown = String::from_utf8_lossy(&file).into_owned();
        let waveform = read(&file, "a.isf").unwrap_or_else(|e| panic!("{e}: {shown}")).waveform;
        assert_eq!(
            (waveform.codes.as_slice(), waveform.preamble.y_off),
            (&[100, -100][..], 50.0),
            "{shown}"
        );
        assert_eq!(waveform.volts(0), Some(0.4), "{shown}");
        assert_eq!((waveform.preamble.y_unit.as_str(), waveform.vertical.position), ("V", 2.0));
        assert_eq!(waveform.vertical.coupling, Some(Coupling::Ac));
    }
}

#[test]
fn later_values_win_and_quotes_hold_semicolons() {
    let head = "YMULT 1;:WFMPRE:BYT_NR 1;XINCR 1;WFID \"Ch3; DC\";YMU 2.0E0;XIN 3;:CURVE ";
    let capture = read(&file(head, &[1, 255]), "a.isf").expect("readable");
    assert_eq!((capture.waveform.preamble.y_mult, capture.waveform.preamble.x_incr), (2.0, 3.0));
    assert_eq!(capture.waveform.volts(1), Some(-2.0));
    for guess in [
        "ENCDG taken as BIN",
        "BN_FMT taken as RI",
        "YOFF taken as 0",
        "XZERO taken as 0",
        "source taken as CH1",
        "vertical scale taken as 50.0 V/div",
        "time base taken as 750 s/div",
    ] {
        let named = capture.notes.iter().any(|note| note.starts_with(guess));
        assert!(named, "{guess}: {:?}", capture.notes);
    }
}

fn made_up(codes: Vec<i16>) -> Capture {
    Capture {
        waveform: Waveform {
            source: Source::Channel(2),
            codes,
            as_read: Vec::new(),
            preamble: Preamble {
                x_zero: -0.15,
                x_incr: 2e-4,
                pt_off: 0,
                x_unit: "s".to_owned(),
                y_mult: 0.02,
                y_zero: 0.0,
                y_off: -166.0,
                y_unit: "V".to_owned(),
                pt_fmt: PointFormat::Sample,
            },
            vertical: VerticalSetup {
                scale: 0.5,
                position: -6.64,
                coupling: Some(Coupling::Dc),
                bandwidth_limited: None,
                inverted: None,
                probe: 1.0,
            },
            horizontal_scale: 0.05,
            trigger_point: 750.0,
        },
        instrument: None,
        notes: Vec::new(),
    }
}

/// The preamble is what a TDS 2024 answered for these settings, fact sheet section 2.3, but for the
/// channel and the byte order, which is that of `RIBinary`.
#[test]
fn the_preamble_is_the_instruments_own() {
    let capture = made_up((0..2500).map(|i| i16::try_from(i % 256 - 128).unwrap()).collect());
    let file = write(&capture, Width::One).expect("writable");
    let wanted = ":WFMPRE:BYT_NR 1;BIT_NR 8;ENCDG BIN;BN_FMT RI;BYT_OR MSB;NR_PT 2500;WFID \"Ch2, DC coupling, \
        5.0E-1 V/div, 5.0E-2 s/div, 2500 points, Sample mode\";PT_FMT Y;XINCR 2.0E-4;PT_OFF 0;XZERO -1.5E-1;\
        XUNIT \"s\";YMULT 2.0E-2;YZERO 0.0E0;YOFF -1.66E2;YUNIT \"Volts\";:CURVE #42500";
    let (head, block) = file.split_at(wanted.len());
    assert_eq!(String::from_utf8_lossy(head), wanted);
    assert_eq!((block.len(), block[0], block[128]), (2500, 0x80, 0));
    let wide = write(&capture, Width::Two).expect("writable");
    let text = String::from_utf8_lossy(&wide);
    assert!(text.contains("YMULT 7.8125E-5;YZERO 0.0E0;YOFF -4.2496E4"), "{}", &text[..400]);
    assert!(text.contains(":CURVE #45000"));
}

/// Only the probe is lost: the format has no place for it.
fn comes_back(capture: &Capture, width: Width) {
    let file = write(capture, width).expect("writable");
    let back = read(&file, "a.isf").expect("readable");
    assert_eq!(back.waveform, capture.waveform);
    assert_eq!(back.notes, ["probe attenuation taken as 1: not given in the file"]);
}

#[test]
fn records_come_back_at_both_widths() {
    let ramp: Vec<i16> = (-128..=127).cycle().take(2500).collect();
    for width in [Width::One, Width::Two] {
        comes_back(&made_up(ramp.clone()), width);
        let mut other = made_up(ramp.clone());
        other.instrument = None;
        other.waveform.source = Source::Reference('B');
        other.waveform.vertical.coupling = None;
        other.waveform.preamble.pt_fmt = PointFormat::Envelope;
        comes_back(&other, width);
    }
    // Levels beyond one byte take two whatever was asked for.
    let mut wide = made_up(vec![300, -301, 32_767, -32_768]);
    wide.waveform.preamble.y_mult = 7.8125e-5;
    wide.waveform.preamble.y_off = 0.0;
    wide.waveform.vertical.position = 0.0;
    comes_back(&wide, Width::One);
}

#[test]
fn refusals_tell_byte_and_reason() {
    let head = "BYT_NR 2;XINCR 1;YMULT 1;:CURVE ";
    let at = head.len();
    let message = |bytes: &[u8]| read(bytes, "a.isf").expect_err("wrong").to_string();
    let with = |tail: &str| format!("{head}{tail}").into_bytes();
    for (bytes, wanted) in [
        (
            b"".to_vec(),
            "a.isf: found no CURVE in the first 0 bytes, expected an ISF file".to_owned(),
        ),
        (
            b"BYT_NR 1;".to_vec(),
            "a.isf: found no CURVE in the first 9 bytes, expected an ISF file".to_owned(),
        ),
        (
            file("BYT_NR 1;YMULT 1;CURVE ", b"a"),
            "a.isf: found no XINCR, expected it before CURVE".to_owned(),
        ),
        (
            file("XINCR 1;YMULT 1;CURVE ", b"a"),
            "a.isf: found no BYT_NR, expected it before CURVE".to_owned(),
        ),
        (
            file("BYT_NR 1;XINCR 0;YMULT 1;CURVE ", b"a"),
            "a.isf, byte 15: `XINCR` is `0`, expected a number above 0".to_owned(),
        ),
        (
            file("BYT_NR 3;XINCR 1;YMULT 1;CURVE ", b"a"),
            "a.isf, byte 7: `BYT_NR` is `3`, expected 1 or 2".to_owned(),
        ),
        (
            with("12"),
            format!(
                "a.isf, byte {at}: found `12`, expected `#`, the number of digits, the length, and the block"
            ),
        ),
        (with("#x"), format!("a.isf, byte {}: found `x`, expected a digit", at + 1)),
        (
            with("#3a12"),
            format!("a.isf, byte {}: found `a12`, expected a length of 3 digits", at + 2),
        ),
        (
            with("#14ab"),
            format!("a.isf, byte {}: the file ends after 2 bytes of the block, expected 4", at + 5),
        ),
        (
            with("#9999999999ab"),
            format!(
                "a.isf, byte {}: the file ends after 2 bytes of the block, expected 999999999",
                at + 13
            ),
        ),
        (
            with("#13abc"),
            format!(
                "a.isf, byte {}: found a block of 3 bytes, expected an even number, two bytes a point",
                at + 3
            ),
        ),
        (with("#10"), format!("a.isf, byte {at}: found no points, expected at least one")),
        (
            b"ENCDG ASC;XINCR 1;YMULT 1;CURVE 1,x,3".to_vec(),
            "a.isf, byte 34: found `x`, expected a whole number from -32768 to 32767".to_owned(),
        ),
    ] {
        assert_eq!(message(&bytes), wanted);
    }
}

#[test]
fn what_cannot_be_held_is_refused() {
    let huge = vec![0; MAXIMUM_BYTES + 1];
    let error = read(&huge, "a.isf").expect_err("too large").to_string();
    assert_eq!(
        error,
        format!("a.isf: found {} bytes, expected at most {MAXIMUM_BYTES}", MAXIMUM_BYTES + 1)
    );
    let mut capture = made_up(Vec::new());
    assert_eq!(
        write(&capture, Width::One).expect_err("empty").to_string(),
        "cannot write: the number of points is 0, expected 1 to 499999999"
    );
    capture.waveform.codes.push(0);
    capture.waveform.preamble.y_unit = "\"".to_owned();
    capture.instrument = Some(InstrumentIdentity {
        model: "TDS2014".to_owned(),
        serial: "0".to_owned(),
        firmware: String::new(),
    });
    assert!(write(&capture, Width::One).is_err());
}

proptest! {
    #![proptest_config(seeded(512))]

    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = read(&bytes, "a.isf");
        let _ = read(&file(SHORT_ONE_BYTE, &bytes), "a.isf");
        let _ = read(&[b"BYT_NR 2;XINCR 1;YMULT 1;CURVE #".as_slice(), &bytes].concat(), "a.isf");
    }

    #[test]
    fn mutations_never_panic(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut bytes = write(&made_up((0..40).collect()), Width::Two).expect("writable");
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        let _ = read(&bytes, "a.isf");
        let _ = read(&bytes[..cut.index(bytes.len())], "a.isf");
    }

    #[test]
    fn any_levels_come_back(codes in proptest::collection::vec(any::<i16>(), 1..50), two in any::<bool>()) {
        let mut capture = made_up(codes);
        let narrow = capture.waveform.codes.iter().all(|code| i8::try_from(*code).is_ok());
        let width = if two { Width::Two } else { Width::One };
        let file = write(&capture, width).expect("writable");
        let back = read(&file, "a.isf").expect("readable").waveform;
        // Multiples of 256 beyond one byte come back as the levels of 8 bits that they stand for.
        if narrow || capture.waveform.codes.iter().any(|code| code % 256 != 0) {
            capture.waveform.vertical.position = back.vertical.position;
            prop_assert_eq!(back, capture.waveform);
        }
    }
}

/// Found by fuzzing: of a level of 4E-322 V, a 256th is 0.
#[test]
fn levels_too_small_to_be_scaled_are_not_written() {
    let mut capture = made_up(vec![1, 2, 3]);
    capture.waveform.preamble.y_mult = 4e-322;
    for width in [Width::One, Width::Two] {
        let error = write(&capture, width).expect_err("unwritable").to_string();
        assert!(error.contains("y_mult") && error.contains("at least 1e-300"), "{error}");
    }
}

/// Numbers that are finite but whose products are not: refused, not read as infinity.
#[test]
fn numbers_beyond_single_precision_are_refused() {
    let head = |x_zero: &str, x_incr: &str, pt_off: &str, y_mult: &str| {
        format!(
            ":WFMP:BYT_N 1;BIT_N 8;ENC BIN;BN_F RI;BYT_O MSB;NR_P 4;PT_F Y;XUN \"s\";XIN {x_incr};XZE {x_zero};PT_O {pt_off};YUN \"V\";YMU {y_mult};YOF 0;YZE 0;:CURV #14abcd\n"
        )
    };
    let read = |text: &str| hertzscope::recording::isf::read(text.as_bytes(), "x.isf");
    assert!(read(&head("0", "1E-6", "0", "0.04")).is_ok());
    for text in [
        head("1E308", "1E304", "-100000", "0.04"),
        head("0", "1E-6", "0", "1E308"),
        head("1E39", "1E-6", "0", "0.04"),
        head("1E30", "1E-300", "0", "0.04"),
        // 1/XINCR is not finite: a spectrum would have bins inf Hz apart.
        head("0", "1E-310", "0", "0.04"),
        // All points would have the same time.
        head("0", "1E-6", "9E18", "0.04"),
        head("0", "1E-6", "0", "4E-322"),
    ] {
        let error = read(&text).expect_err("too large").to_string();
        assert!(error.starts_with("x.isf"), "{error}");
    }
}
