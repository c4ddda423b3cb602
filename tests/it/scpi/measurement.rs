//! Measurements of signals whose values are known.

use super::bench::Bench;

/// One level of the digitiser at half a volt a division (V).
const LEVEL: f64 = 0.02;

fn value(bench: &mut Bench, kind: &str) -> f64 {
    bench.tell(&format!("MEASU:IMM:SOU CH1;TYP {kind}"));
    bench.ask("MEASU:IMM:VAL?").parse().expect("a number")
}

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "found {found}, expected {expected} within {tolerance}"
    );
}

/// A sine of 1.5 V about 0.25 V with 1 kHz, ten cycles on the screen; points come every 4 us.
#[test]
fn a_sine() {
    let mut bench = Bench::new();
    bench.record("CH1:PROBE 1;SCALE 0.5;:HOR:SCA 1E-3;:TRIG:MAI:LEV 3", |time| {
        0.25 + 1.5 * (std::f64::consts::TAU * 1000.0 * time).sin()
    });
    close(value(&mut bench, "MAXI"), 1.75, LEVEL);
    close(value(&mut bench, "MINI"), -1.25, LEVEL);
    close(value(&mut bench, "PK2"), 3.0, 2.0 * LEVEL);
    close(value(&mut bench, "MEAN"), 0.25, 0.5 * LEVEL);
    // Root of offset squared and half the amplitude squared.
    close(value(&mut bench, "CRM"), (0.25_f64.powi(2) + 1.5_f64.powi(2) / 2.0).sqrt(), LEVEL);
    // Crossings: half a level on a slope of 9425 V/s, on either end.
    let time = 2.0 * LEVEL / 9425.0;
    close(value(&mut bench, "PERI"), 1e-3, time);
    close(value(&mut bench, "FREQ"), 1000.0, time * 1e6);
    close(value(&mut bench, "PWI"), 0.5e-3, 2.0 * time);
    close(value(&mut bench, "NWI"), 0.5e-3, 2.0 * time);
    // From -0.8 to 0.8 of the amplitude; the slope there is 0.6 of the steepest.
    let edge = 2.0 * 0.8_f64.asin() / (std::f64::consts::TAU * 1000.0);
    close(value(&mut bench, "RIS"), edge, 2.0 * time / 0.6);
    close(value(&mut bench, "FALL"), edge, 2.0 * time / 0.6);
    assert_eq!(bench.ask("*ESR?"), "0");
    // The frequency counter: the same to six digits, which is what the manual gives it.
    let measured = value(&mut bench, "FREQ");
    let counted: f64 = bench.ask("TRIG:MAI:FREQ?").parse().expect("a number");
    close(counted, measured, 0.5e-5 * measured);
    let digits = counted / 10f64.powf(counted.log10().floor() - 5.0);
    close(digits, digits.round(), 1e-6);
}

/// The event texts are those of real replies.
#[test]
fn without_result() {
    let mut bench = Bench::new();
    bench.quiet_record("CH1:PROBE 1");
    bench.tell("MEASU:IMM:TYP FREQ;:MEASU:MEAS2:TYP PK2;SOU CH3");
    bench.transcript(&[
        ("MEASU:IMM:VAL?", "9.9E37"),
        ("*ESR?", "16"),
        ("EVM?", "2202,\"Measurement error, No period found; \""),
        ("MEASU:MEAS2:VAL?", "9.9E37"),
        ("*ESR?", "16"),
        ("EVM?", "2225,\"Measurement error, No waveform to measure; \""),
        ("MEASU:MEAS1:VAL?", "9.9E37"),
        ("*ESR?", "16"),
        ("EVENT?", "2231"),
    ]);
}

#[test]
fn types_units_and_sources() {
    let mut bench = Bench::with_headers();
    bench.tell("MEASU:IMM:TYP PERI;SOU CH2");
    bench.transcript(&[
        ("MEASU:IMM?", ":MEASUREMENT:IMMED:TYPE PERIOD;UNITS \"s\";SOURCE1 CH2"),
        (
            "MEASU:MEAS4:TYP NWI;SOU MATH;:MEASU:MEAS4?",
            ":MEASUREMENT:MEAS4:TYPE NWIDTH;SOURCE MATH",
        ),
        ("MEASU:MEAS4:UNI?", ":MEASUREMENT:MEAS4:UNITS \"s\""),
    ]);
    // Neither on the original: phase, and no type for the immediate measurement.
    for line in ["MEASU:IMM:TYP PHA", "MEASU:IMM:TYP NONE", "MEASU:MEAS6:TYP MEAN"] {
        bench.tell(line);
        assert_ne!(bench.ask("*ESR?"), "0", "{line}");
    }
}
