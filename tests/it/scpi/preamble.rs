//! Preambles of real instruments.

use super::bench::Bench;

/// TDS 2024 (FV:v4.12) on RS-232.
#[test]
fn with_headers_low_byte_first() {
    let mut bench = Bench::with_headers();
    bench.quiet_record("CH1:PROBE 1;SCALE 0.5;POS -6.64;:HOR:SCA 0.05;POS 0.1;:DATA:ENC SRI");
    assert_eq!(
        bench.ask("wfmpre?"),
        ":WFMPRE:BYT_NR 1;BIT_NR 8;ENCDG BIN;BN_FMT RI;BYT_OR LSB;NR_PT 2500;\
         WFID \"Ch1, DC coupling, 5.0E-1 V/div, 5.0E-2 s/div, 2500 points, Sample mode\";PT_FMT Y;\
         XINCR 2.0E-4;PT_OFF 0;XZERO -1.5E-1;XUNIT \"s\";YMULT 2.0E-2;YZERO 0.0E0;YOFF -1.66E2;YUNIT \"Volts\""
    );
}

/// TDS2024C (FV:v24.26), position 2 div.
#[test]
fn signed_one_byte() {
    let mut bench = Bench::new();
    bench.quiet_record("CH1:PROBE 1;SCALE 0.2;POS 2;:HOR:SCA 5E-7;:DATA INIT");
    assert_eq!(
        bench.ask("WFMPRE?"),
        "1;8;BIN;RI;MSB;2500;\"Ch1, DC coupling, 2.0E-1 V/div, 5.0E-7 s/div, 2500 points, Sample mode\";\
         Y;2.0E-9;0;-2.5E-6;\"s\";8.0E-3;0.0E0;5.0E1;\"Volts\""
    );
}

/// TDS2024C (FV:v24.26).
#[test]
fn positive_two_bytes() {
    let mut bench = Bench::new();
    bench.quiet_record("CH1:PROBE 1;SCALE 0.5;:HOR:SCA 5E-5;:DATA:ENC RPB;WID 2");
    assert_eq!(
        bench.ask("WFMP?"),
        "2;16;BIN;RP;MSB;2500;\"Ch1, DC coupling, 5.0E-1 V/div, 5.0E-5 s/div, 2500 points, Sample mode\";\
         Y;2.0E-7;0;-2.5E-4;\"s\";7.8125E-5;0.0E0;3.2768E4;\"Volts\""
    );
}

/// TDS2024C (FV:v24.26): text is signed whatever the binary format is.
#[test]
fn text() {
    let mut bench = Bench::new();
    bench.quiet_record(
        "CH1:PROBE 1;SCALE 0.01;POS 2;:HOR:SCA 1E-6;POS 4.6E-6;:DATA:ENC RPB;ENC ASCI;WID 1",
    );
    assert_eq!(
        bench.ask("WFMP?"),
        "1;8;ASC;RP;MSB;2500;\"Ch1, DC coupling, 1.0E-2 V/div, 1.0E-6 s/div, 2500 points, Sample mode\";\
         Y;4.0E-9;0;-4.0E-7;\"s\";4.0E-4;0.0E0;5.0E1;\"Volts\""
    );
}

/// `YMULT = s/25`, `YOFF = 25 p`; 128 more for positive numbers; both times 256 for two bytes.
#[test]
fn every_encoding_has_its_scale() {
    let mut bench = Bench::new();
    bench.quiet_record("CH1:PROBE 1;SCALE 0.5;POS 1");
    for (encoding, width, y_mult, y_off) in [
        ("ASCII", 1, "2.0E-2", "2.5E1"),
        ("RIBINARY", 1, "2.0E-2", "2.5E1"),
        ("SRIBINARY", 1, "2.0E-2", "2.5E1"),
        ("RPBINARY", 1, "2.0E-2", "1.53E2"),
        ("SRPBINARY", 1, "2.0E-2", "1.53E2"),
        ("ASCII", 2, "7.8125E-5", "6.4E3"),
        ("RIBINARY", 2, "7.8125E-5", "6.4E3"),
        ("SRIBINARY", 2, "7.8125E-5", "6.4E3"),
        ("RPBINARY", 2, "7.8125E-5", "3.9168E4"),
        ("SRPBINARY", 2, "7.8125E-5", "3.9168E4"),
    ] {
        bench.tell(&format!("DATA:ENCDG {encoding};WIDTH {width}"));
        bench.transcript(&[
            ("DATA:ENC?", encoding),
            ("WFMP:YMU?", y_mult),
            (":WFMP:CH1:YOF?", y_off),
            ("WFMPRE:YOF?", y_off),
        ]);
    }
}

/// Fields one after the other as `lantz` asks, and those of a channel as `InstrumentKit` does.
#[test]
fn fields_one_by_one() {
    let mut bench = Bench::new();
    bench.quiet_record("CH1:PROBE 1;SCALE 0.5;:HOR:SCA 0.05");
    bench.transcript(&[
        (":WFMPRE:XZE?;XIN?;YZE?", "-2.5E-1;2.0E-4;0.0E0"),
        ("WFMP:CH1:YOF?", "0.0E0"),
        ("WFMP:CH1:NR_P?;PT_F?;XUN?", "2500;Y;\"s\""),
    ]);
}

/// Two views of one state.
#[test]
fn the_encoding_is_seen_from_both_sides() {
    let mut bench = Bench::new();
    bench.transcript(&[
        ("WFMP:BN_F RP;BYT_O LSB;:DATA:ENC?", "SRPBINARY"),
        ("WFMP:ENC ASC;:DATA:ENC?", "ASCII"),
        ("WFMP:BIT_N 16;:DATA:WID?", "2"),
        ("DATA:ENC RIB;:WFMP:BN_F?;BYT_O?;ENC?;BYT_N?", "RI;MSB;BIN;2"),
    ]);
    bench.tell("HEADER ON");
    assert_eq!(
        bench.ask("DATA INIT;DATA?"),
        ":DATA:ENCDG RIBINARY;DESTINATION REFA;SOURCE CH1;START 1;STOP 2500;WIDTH 1"
    );
}

#[test]
fn points_are_those_to_be_sent() {
    let mut bench = Bench::new();
    bench.quiet_record("CH1:PROBE 1");
    bench.transcript(&[
        ("DATA:START 11;STOP 20;:WFMP:NR_PT?", "10"),
        ("DATA:START 20;STOP 11;:WFMP:NR_PT?", "10"),
        ("DATA:START 1;:data:stop 1000000;:DATA:STOP?;:WFMP:NR_PT?", "2500;2500"),
    ]);
}

#[test]
fn a_waveform_that_is_not_displayed_has_no_preamble() {
    let mut bench = Bench::new();
    bench.quiet_record("CH1:PROBE 1");
    for line in ["DATA:SOU CH2;:WFMP?", "CURVE?", "WAVF?", "WFMP:REFA:YOF?"] {
        bench.tell(line);
        // The manual names both events for `CURVe?`; for `WFMPre?` no instrument was asked
        // (docs/scpi-commands.md).
        bench.transcript(&[("*ESR?", "20"), ("EVENT?", "2244"), ("EVENT?", "420")]);
    }
}
