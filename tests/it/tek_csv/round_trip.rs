//! Made-up captures through writer and reader: scales, positions, trigger points, the old header.

use hertzscope::recording::tek_csv::{read, write};

use super::made_up::{PLAIN, Setup, instrument, plain_record, ramp_after, record, round_trip};

#[test]
fn every_level_comes_back_at_every_scale() {
    let codes = ramp_after(&[], 2500);
    let steps = [2e-3, 5e-3, 10e-3, 20e-3, 50e-3, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0];
    let fine = [0.059, 0.06, 0.08, 0.09, 0.288];
    for at_bnc in steps.into_iter().chain(fine) {
        for probe in [1.0, 10.0, 100.0, 1000.0] {
            for position_levels in [0, 50, -140, 25_000, -24_999] {
                let setup = Setup { scale: at_bnc * probe, probe, position_levels, ..PLAIN };
                let capture = record(&setup, codes.clone());
                let text = write(&capture).expect("writable");
                let back = read(text.as_bytes(), "scale.csv").expect("readable");
                assert_eq!(
                    back.waveform.codes, codes,
                    "{at_bnc} V/div x {probe} at {position_levels}"
                );
                assert_eq!(
                    back.waveform.preamble.y_off.to_bits(),
                    f64::from(position_levels).to_bits()
                );
            }
        }
    }
}

#[test]
fn smallest_scale_prints_whole_steps_of_five_decimals() {
    let setup = Setup { position_levels: 0, ..PLAIN };
    let text = write(&record(&setup, ramp_after(&[-128, -1, 0, 1, 127], 2500))).expect("writable");
    for (line, volts) in
        text.lines().zip(["  -0.01024", "  -0.00008", "   0.00000", "   0.00008", "   0.01016"])
    {
        assert_eq!(line.split(',').nth(4), Some(volts), "{line}");
    }
}

/// Times by hand: (row - 1 - trigger point) * 0.1 ms.
#[test]
fn trigger_points_inside_and_outside_the_record() {
    for (trigger_point, first, nineteenth, last) in [
        (17.0, "  -0.001700000000", "0.000100000000", "0.248200000000"),
        (18.0, "  -0.001800000000", "-00.000000000000", "00.248100000000"),
        (1250.0, "  -0.125000000000", "-00.123200000000", "00.124900000000"),
        (0.0, "   0.000000000000", "0.001800000000", "0.249900000000"),
        (2500.0, "  -0.250000000000", "-00.248200000000", "-00.000100000000"),
        (3000.0, "  -0.300000000000", "-00.298200000000", "-00.050100000000"),
        (-4.57e4, "   4.570000000000", "4.571800000000", "4.819900000000"),
        (612.5, "  -0.061250000000", "-00.059450000000", "00.188650000000"),
    ] {
        let setup = Setup { trigger_point, ..PLAIN };
        let capture = record(&setup, ramp_after(&[], 2500));
        let text = round_trip(&capture);
        let time = |row: usize| text.lines().nth(row - 1).and_then(|line| line.split(',').nth(3));
        assert_eq!(time(1), Some(first), "trigger point {trigger_point}");
        assert_eq!(time(19), Some(nineteenth), "trigger point {trigger_point}");
        assert_eq!(time(2500), Some(last), "trigger point {trigger_point}");
    }
}

#[test]
fn round_off_in_a_preamble_does_not_reach_the_file() {
    let setup = Setup { scale: 5.0, probe: 10.0, position_levels: -87, ..PLAIN };
    let clean = record(&setup, ramp_after(&[], 2500));
    let mut noisy = clean.clone();
    noisy.waveform.preamble.y_off = -17.4 / 0.2;
    noisy.waveform.trigger_point = 800.000_000_000_000_1;
    assert_ne!(noisy.waveform.preamble.y_off.to_bits(), (-87.0_f64).to_bits());
    assert_eq!(write(&noisy).expect("writable"), write(&clean).expect("writable"));
}

#[test]
fn old_header_has_neither_model_nor_serial() {
    let mut capture = plain_record();
    capture.instrument = Some(instrument("", "", "FV:v6.08"));
    let text = round_trip(&capture);
    assert!(!text.contains("Model Number") && !text.contains("Serial Number"));
    let row = |number: usize| text.lines().nth(number - 1).expect("2500 rows");
    assert!(row(16).starts_with("Firmware Version,FV:v6.08,,  -0.078500000000,"), "{}", row(16));
    assert!(row(17).starts_with(",,,-00.078400000000,"), "{}", row(17));
}

#[test]
fn files_do_not_tell_coupling_bandwidth_and_inversion() {
    let text = write(&plain_record()).expect("writable");
    let vertical = read(text.as_bytes(), "plain.csv").expect("readable").waveform.vertical;
    assert_eq!(vertical.coupling, None);
    assert_eq!(vertical.bandwidth_limited, None);
    assert_eq!(vertical.inverted, None);
}

#[test]
fn crlf_reads_as_lf() {
    let text = write(&plain_record()).expect("writable");
    let converted = text.replace('\n', "\r\n");
    let converted = read(converted.as_bytes(), "a.csv").expect("converted");
    let original = read(text.as_bytes(), "a.csv").expect("as written");
    assert_eq!(converted, original);
    assert_eq!(original, plain_record());
}
