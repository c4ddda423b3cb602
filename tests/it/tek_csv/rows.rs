//! Rows that real instruments wrote, from the fact sheet, as the writer must write them.

use hertzscope::recording::tek_csv::read;

use super::made_up::{PLAIN, Setup, fft, instrument, ramp_after, record, round_trip};

/// A TDS2014C: the first 20 rows, fact sheet section 4.3.
const DOPPLER: &str = "Record Length,2.500000e+03,,  -0.080000000000,   0.00664,
Sample Interval,1.000000e-04,,  -0.079900000000,   0.00720,
Trigger Point,8.000000000000e+02,,  -0.079800000000,   0.00664,
,,,  -0.079700000000,   0.00784,
,,,  -0.079600000000,   0.00720,
,,,  -0.079500000000,   0.00768,
Source,CH1,,  -0.079400000000,   0.00704,
Vertical Units,V,,  -0.079300000000,   0.00776,
Vertical Scale,2.000000e-03,,  -0.079200000000,   0.00768,
Vertical Offset,-1.120000e-02,,  -0.079100000000,   0.00792,
Horizontal Units,s,,  -0.079000000000,   0.00720,
Horizontal Scale,2.500000e-02,,  -0.078900000000,   0.00704,
Pt Fmt,Y,,  -0.078800000000,   0.00736,
Yzero,0.000000e+00,,  -0.078700000000,   0.00752,
Probe Atten,1.000000e+00,,  -0.078600000000,   0.00704,
Model Number,TDS2014C,,  -0.078500000000,   0.00728,
Serial Number,C031611,,  -0.078400000000,   0.00752,
Firmware Version,FV:v24.26,,  -0.078300000000,   0.00792,
,,,-00.078200000000,   0.00712,
,,,-00.078100000000,   0.00784,
";

/// A TBS1072B in scan mode: the first 20 rows, fact sheet section 4.3.
const SCAN: &str = "Record Length,2.500000e+03,,   0.000000000000,   1.84000,
Sample Interval,4.000000e-03,,   0.004000000000,   1.52000,
Trigger Point,-0.000000000000e+00,,   0.008000000000,   1.32000,
,,,   0.012000000000,   1.20000,
,,,   0.016000000000,   1.08000,
,,,   0.020000000000,   1.00000,
Source,CH1,,   0.024000000000,   0.92000,
Vertical Units,V,,   0.028000000000,   0.92000,
Vertical Scale,1.000000e+00,,   0.032000000000,   0.88000,
Vertical Offset,-4.200000e+00,,   0.036000000000,   0.88000,
Horizontal Units,s,,   0.040000000000,   0.88000,
Horizontal Scale,1.000000e+00,,   0.044000000000,   0.84000,
Pt Fmt,Y,,   0.048000000000,   0.84000,
Yzero,0.000000e+00,,   0.052000000000,   0.84000,
Probe Atten,1.000000e+01,,   0.056000000000,   0.84000,
Model Number,TBS1072B,,   0.060000000000,   0.84000,
Serial Number,C035559,,   0.064000000000,   0.84000,
Firmware Version,FV:v4.06,,   0.068000000000,   0.84000,
,,,0.072000000000,   0.84000,
,,,0.076000000000,   0.84000,
";

/// An FFT of firmware v6.08, two header rows short: the first 20 rows, fact sheet section 4.3.
const OLD_FFT: &str = "Record Length,1.024000e+03,,          0.00000, -42.58970,
Sample Interval,1.233033e+01,,         12.33033, -46.18970,
Trigger Point,0.000000000000e+00,,         24.66067, -63.38970,
,,,         36.99100, -66.98970,
,,,         49.32134, -66.98970,
,,,         61.65167, -66.98970,
Source,MATH,,         73.98201, -60.58970,
Vertical Units,dB,,         86.31234, -66.98970,
Vertical Scale,1.000000e+01,,         98.64268, -66.98970,
Vertical Offset,0.000000e+00,,        110.97301, -66.98970,
Horizontal Units,Hz,,        123.30335, -66.98970,
Horizontal Scale,1.262626e+03,,        135.63368, -66.98970,
Pt Fmt,Y,,        147.96402, -66.98970,
Yzero,-2.698970e+01,,        160.29435, -66.98970,
Probe Atten,1.000000e+01,,        172.62468, -66.98970,
Firmware Version,FV:v6.08,,        184.95502, -66.98970,
,,,197.28535, -66.98970,
,,,209.61568, -65.78970,
,,,221.94601, -66.98970,
,,,234.27634, -66.98970,
";

/// An FFT of a TDS1012C-EDU: the first 20 rows, fact sheet section 4.3.
const FFT: &str = "Record Length,1.024000e+03,,          0.00000, -15.36910,
Sample Interval,1.220703e+04,,      12207.03125,   2.63090,
Trigger Point,0.000000000000e+00,,      24414.06250,  -5.36910,
,,,      36621.09375, -27.76910,
,,,      48828.12500, -37.76910,
,,,      61035.15625, -46.96910,
Source,MATH,,      73242.18750, -56.96910,
Vertical Units,dB,,      85449.21875, -59.76910,
Vertical Scale,1.000000e+01,,      97656.25000, -49.76910,
Vertical Offset,0.000000e+00,,     109863.28125, -60.96910,
Horizontal Units,Hz,,     122070.31250, -59.76910,
Horizontal Scale,1.250000e+06,,     134277.34375, -56.96910,
Pt Fmt,Y,,     146484.37500, -60.96910,
Yzero,-2.096910e+01,,     158691.40625, -60.96910,
Probe Atten,1.000000e+00,,     170898.43750, -60.96910,
Model Number,TDS1012C-EDU,,     183105.46875, -60.96910,
Serial Number,C013699,,     195312.50000, -60.96910,
Firmware Version,FV:v25.07,,     207519.53125, -52.96910,
,,,219726.56250, -55.76910,
,,,231933.59375, -60.96910,
";

fn assert_begins(text: &str, rows: &str) {
    for (number, (found, expected)) in text.lines().zip(rows.lines()).enumerate() {
        assert_eq!(found, expected, "row {}", number + 1);
    }
}

#[test]
fn rows_of_a_tds2014c() {
    // (0.00664 V - 0.0112 V) / 0.08 mV = -57, and so on down the quoted rows.
    let codes = [
        -57, -50, -57, -42, -50, -44, -52, -43, -44, -41, -50, -52, -48, -46, -52, -49, -46, -41,
        -51, -42,
    ];
    let text = round_trip(&record(&PLAIN, ramp_after(&codes, 2500)));
    assert_begins(&text, DOPPLER);
    // Rows about the trigger, times quoted, levels of the ramp left aside.
    for (row, time) in [
        (800, ",,,-00.000100000000,"),
        (801, ",,,-00.000000000000,"),
        (802, ",,,00.000100000000,"),
        (803, ",,,00.000200000000,"),
    ] {
        let line = text.lines().nth(row - 1).expect("2500 rows");
        assert!(line.starts_with(time), "row {row}: {line}");
    }
    assert!(text.ends_with(",\n"));
    assert_eq!(text.lines().count(), 2500);
}

#[test]
fn rows_of_a_scan() {
    // (1.84 V - 4.2 V) / 40 mV = -59, and so on.
    let codes = [
        -59, -67, -72, -75, -78, -80, -82, -82, -83, -83, -83, -84, -84, -84, -84, -84, -84, -84,
        -84, -84,
    ];
    let setup = Setup {
        scale: 1.0,
        probe: 10.0,
        position_levels: -105,
        interval: 4e-3,
        trigger_point: -0.0,
    };
    let mut capture = record(&setup, ramp_after(&codes, 2500));
    capture.instrument = Some(instrument("TBS1072B", "C035559", "FV:v4.06"));
    let text = round_trip(&capture);
    assert_begins(&text, SCAN);
    let back = read(text.as_bytes(), "scan.csv").expect("a scan-mode file");
    assert!(back.waveform.trigger_point.is_sign_negative(), "the sign of zero is kept");
}

#[test]
fn rows_of_an_old_fft() {
    // (-42.5897 dB + 26.9897 dB) / 0.4 dB = -39, and so on.
    let codes = [
        -39, -48, -91, -100, -100, -100, -84, -100, -100, -100, -100, -100, -100, -100, -100, -100,
        -100, -97, -100, -100,
    ];
    let interval = 25e3 * 100.0 / 99.0 / 2048.0;
    let mut capture = fft(interval, 1262.626, -26.9897, ramp_after(&codes, 1024));
    capture.waveform.vertical.probe = 10.0;
    capture.instrument = Some(instrument("", "", "FV:v6.08"));
    assert_begins(&round_trip(&capture), OLD_FFT);
}

#[test]
fn rows_of_an_fft() {
    let codes = [
        14, 59, 39, -17, -42, -65, -90, -97, -72, -100, -97, -90, -100, -100, -100, -100, -100,
        -80, -87, -100,
    ];
    let mut capture = fft(25e6 / 2048.0, 1.25e6, -20.9691, ramp_after(&codes, 1024));
    capture.instrument = Some(instrument("TDS1012C-EDU", "C013699", "FV:v25.07"));
    assert_begins(&round_trip(&capture), FFT);
}
