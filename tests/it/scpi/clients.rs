//! What unmodified client programs send, and need as replies.

use super::bench::Bench;
use hertzscope::instrument::Signals;
use hertzscope::scpi::Reply;

/// pylablib 1.4.5, `TDS2000` with `nchannels="auto"`: counts channels by silence.
#[test]
fn pylablib_counts_channels() {
    let mut bench = Bench::new();
    for (channel, exists) in [(2, true), (3, true), (4, true), (5, false)] {
        bench.tell("*CLS");
        let reply = bench.bytes(&format!(":CH{channel}:POSITION?\r"));
        assert_eq!(reply, if exists { b"0.0E0\n".to_vec() } else { Vec::new() });
        assert_eq!(bench.ask("*ESR?\r"), if exists { "0" } else { "32" });
    }
}

/// pylablib 1.4.5: settings with their queries.
#[test]
fn pylablib_sets() {
    let mut bench = Bench::new();
    assert!(bench.ask("*IDN?").starts_with("TEKTRONIX,TDS 2014,"));
    bench.tell(":CH1:PROBE 1");
    for (command, query, reply) in [
        (":SELECT:CH1 1", ":SELECT:CH1?", "1"),
        (":CH1:SCALE 5.000000E-01", ":CH1:SCALE?", "5.0E-1"),
        (":CH1:POSITION 1.000000E+00", ":CH1:POSITION?", "1.0E0"),
        (":CH1:COUPL DC", ":CH1:COUPL?", "DC"),
        (":CH1:PROBE 1", ":CH1:PROBE?", "1"),
        (":HORIZONTAL:SCALE 1.000000E-04", ":HORIZONTAL:SCALE?", "1.0E-4"),
        (":HORIZONTAL:POS 0.000000E+00", ":HORIZONTAL:POS?", "0.0E0"),
        ("TRIGGER:MAIN:EDGE:SOURCE CH1", "TRIGGER:MAIN:EDGE:SOURCE?", "CH1"),
        ("TRIGGER:MAIN:EDGE:COUPL DC", "TRIGGER:MAIN:EDGE:COUPL?", "DC"),
        ("TRIGGER:MAIN:EDGE:SLOPE RISE", "TRIGGER:MAIN:EDGE:SLOPE?", "RISE"),
        ("TRIGGER:MAIN:LEVEL 1.000000E-01", "TRIGGER:MAIN:LEVEL?", "1.0E-1"),
        ("TRIGGER:MAIN:TYPE EDGE", "TRIGGER:MAIN:TYPE?", "EDGE"),
        ("TRIGGER:MAIN:MODE NORM", "TRIGGER:MAIN:MODE?", "NORMAL"),
        (":DATA:ENCDG ASCII", ":DATA:ENCDG?", "ASCII"),
        (":DATA:ENCDG RIBINARY", ":DATA:ENCDG?", "RIBINARY"),
        (":DATA:WIDTH 2", ":DATA:WIDTH?", "2"),
        (":DATA:SOURCE CH1", ":DATA:SOURCE?", "CH1"),
    ] {
        bench.tell(command);
        assert_eq!(bench.ask(query), reply, "{query}");
    }
    bench.transcript(&[
        (":DATA:START?", "1"),
        (":DATA:STOP?", "2500"),
        (":HORIZONTAL:RECORDLENGTH?", "2500"),
        ("*ESR?", "0"),
    ]);
}

/// pylablib 1.4.5: single acquisition and reading, replies with CRLF.
#[test]
fn pylablib_acquires_and_reads() {
    let mut bench = Bench::new();
    bench.tell("RS232:TRANSMIT:TERMINATOR CRLF");
    bench.tell(":CH1:PROBE 1\r");
    bench.tell(":CH1:SCALE 5.000000E-01\r");
    bench.tell("TRIGGER:MAIN:LEVEL 1.000000E-01\r");
    bench.tell("TRIGGER:MAIN:MODE NORM\r");
    bench.tell(":ACQ:STOPAFTER SEQ\r");
    bench.tell(":ACQ:STATE ON\r");
    bench.wait(0.3);
    assert_eq!(bench.bytes(":ACQ:STOPAFTER?\r"), b"SEQUENCE\r\n");
    let reply = bench.session.receive(&mut bench.instrument, b"*OPC?\r\n");
    assert_eq!(reply, Reply::WhenIdle(Vec::new()));
    let volts = (0..5000).map(|n| if n < 2000 { 0.0 } else { 0.5 }).collect();
    let interval = bench.instrument.sample_window().interval;
    let signals =
        Signals { interval, automatic: 0, volts: vec![volts], shot: 1, ..Signals::default() };
    bench.instrument.accept_signals(&signals);
    bench.wait(0.1);
    assert_eq!(bench.session.resume(&mut bench.instrument), Reply::Now(b"1\r\n".to_vec()));
    bench.tell(":DATA:SOURCE CH1\r");
    let preamble = String::from_utf8(bench.bytes(":WFMP?\r")).expect("text");
    assert!(preamble.split(';').count() >= 15, "{preamble}");
    let curve = bench.bytes(":CURVE?\r");
    assert_eq!(curve.len(), 6 + 2500 + 2);
    assert_eq!(&curve[6 + 1249..6 + 1251], &[0, 25]);
    assert_eq!(bench.bytes(":WFMP:NR_PT?\r"), b"2500\r\n");
    assert_eq!(bench.bytes(":ACQ:STATE?\r"), b"0\r\n");
    assert_eq!(bench.bytes("TRIGGER:STATE?\r"), b"SAVE\r\n");
}

/// pymeasure 0.16: the immediate measurement, every type that the original has.
#[test]
fn pymeasure_measures() {
    let mut bench = Bench::new();
    bench.record("CH1:PROBE 1;SCALE 0.5;:HOR:SCA 1E-3;:TRIG:MAI:LEV 3", |time| {
        (std::f64::consts::TAU * 1000.0 * time).sin()
    });
    bench.tell("MEASU:IMM:SOU CH1");
    assert_eq!(bench.ask("MEASU:IMM:SOU?"), "CH1");
    for (sent, told, unit) in [
        ("FREQ", "FREQUENCY", "Hz"),
        ("MEAN", "MEAN", "V"),
        ("PERI", "PERIOD", "s"),
        ("PK2", "PK2PK", "V"),
        ("CRM", "CRMS", "V"),
        ("MINI", "MINIMUM", "V"),
        ("MAXI", "MAXIMUM", "V"),
        ("RIS", "RISE", "s"),
        ("FALL", "FALL", "s"),
        ("PWI", "PWIDTH", "s"),
        ("NWI", "NWIDTH", "s"),
    ] {
        bench.tell(&format!("MEASU:IMM:TYP {sent}"));
        assert_eq!(bench.ask("MEASU:IMM:TYP?"), told);
        assert_eq!(bench.ask("MEASU:IMM:UNI?"), format!("\"{unit}\""));
        let value: f64 = bench.ask("MEASU:IMM:VAL?").parse().expect("a number");
        assert!(value.abs() < 1e6, "{sent}: {value}");
    }
    assert_eq!(bench.ask("*ESR?"), "0");
}

/// Lab scripts with pyvisa.
#[test]
fn lab_scripts_read_curves() {
    let mut bench = Bench::new();
    bench.quiet_record("CH1:PROBE 1;SCALE 0.5");
    bench.tell("DATA:SOU CH1; WIDTH 1; ENC RPB");
    bench.transcript(&[("WFMPRE:YMULT?", "2.0E-2"), ("WFMPRE:YOFF?", "1.28E2")]);
    let curve = bench.bytes("CURVE?");
    assert_eq!(&curve[..7], b"#42500\x80");
    assert_eq!(&curve[2505..], b"\x80\n");
}
