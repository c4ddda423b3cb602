//! What programmer manual 071-1075 says and this instrument did otherwise, found with other
//! programs' drivers.

use hertzscope::instrument::Signals;

use super::bench::Bench;

/// Codes of the events since the last look, in order.
fn events(bench: &mut Bench) -> Vec<u16> {
    bench.ask("*ESR?");
    let all = bench.ask("ALLEV?");
    let codes = all.split("; \"").filter_map(|event| {
        event.trim_start_matches(',').split(',').next().and_then(|code| code.parse().ok())
    });
    codes.filter(|code| *code > 1).collect()
}

/// `FACtory` turns headers on, however the server began; printer, words, lock, language and line
/// stay.
#[test]
fn factory_turns_headers_on_and_leaves_what_the_manual_excepts() {
    let mut bench = Bench::new();
    bench.tell("HEADER ON;VERBOSE OFF;:LOCK ALL;:LANG GERM;:RS232:BAUD 300;:DIS:CONTR 70");
    bench.tell("HARDC:FORM TIF;:*DDT \"TRIG FORC\";:CH1:SCA 5");
    bench.tell("*DDT \"TRIG FORC\";FACTORY");
    assert_eq!(bench.ask("CH1:SCALE?"), ":CH1:SCA 1.0E0");
    assert_eq!(bench.ask("VERBOSE?;:HARDC:FORM?;:LOCK?"), ":VERB 0;:HARDC:FORM TIF;:LOC ALL");
    assert_eq!(bench.ask("LANG?;:RS232:BAUD?"), ":LANG GERM;:RS232:BAU 300");
    bench.tell("HEADER OFF");
    assert_eq!(bench.ask("DIS:CONTR?"), "70");
    assert_eq!(bench.ask("*DDT?"), "\"\"");
}

/// In scan mode points that are not there yet are no volts: nothing is measured while it scans, and
/// what is stopped is measured without them.
#[test]
fn blank_points_are_no_samples() {
    let mut bench = Bench::new();
    bench.tell("HOR:SCA 0.1;:MEASU:IMM:TYP MINI");
    bench.wait(1e-3);
    bench.wait(1.3);
    assert_eq!(bench.ask("TRIG:STATE?"), "SCAN");
    assert_eq!(bench.ask("MEASU:IMM:VAL?"), "9.9E37");
    assert_eq!(events(&mut bench), [221]);
    // The level is put at the middle of what has been sampled, zero volts, not towards the blank.
    bench.tell("TRIG:MAI SETL");
    assert_eq!(bench.ask("TRIG:MAI:LEV?"), "0.0E0");
    bench.tell("HOR:SCA 0.1;:TRIG:MAI:LEV 0.5");
    bench.wait(1.3);
    bench.tell("ACQ:STATE OFF");
    for (kind, expected) in [("MINI", 0.0), ("MAXI", 0.0), ("MEAN", 0.0), ("PK2", 0.0)] {
        let value: f64 =
            bench.ask(&format!("MEASU:IMM:TYP {kind};VAL?")).parse().expect("a number");
        assert_eq!(value, expected, "{kind}");
    }
    assert_eq!(events(&mut bench), [0_u16; 0]);
    bench.tell("AUTOS EXEC");
    assert_eq!(bench.ask("TRIG:MAI:LEV?"), "0.0E0");
}

/// A sine of 4 Hz that is scanned has its frequency, its extremes and its mean, blank or not.
#[test]
fn a_stopped_scan_is_measured_without_its_blank() {
    let mut bench = Bench::new();
    bench.tell("HOR:SCA 0.1;:CH1:PROBE 1;SCA 1");
    bench.wait(1e-3);
    bench.wait(1.2);
    let interval = 4e-4;
    let sine = |n: i32| 2.0 * (std::f64::consts::TAU * 4.0 * f64::from(n) * interval).sin();
    let volts = vec![(0..2500).map(sine).collect()];
    bench.instrument.accept_signals(&Signals { interval, volts, ..Signals::default() });
    bench.wait(0.95);
    bench.tell("ACQ:STATE OFF;:MEASU:IMM:TYP FREQ");
    let value = |bench: &mut Bench, kind: &str| -> f64 {
        bench.ask(&format!("MEASU:IMM:TYP {kind};VAL?")).parse().expect("a number")
    };
    // A level is 40 mV; a crossing is off by half a point of 0.4 ms and half a level on 50 V/s.
    assert!((value(&mut bench, "FREQ") - 4.0).abs() < 0.05);
    assert!((value(&mut bench, "MINI") + 2.0).abs() < 0.04);
    assert!((value(&mut bench, "MAXI") - 2.0).abs() < 0.04);
}

#[test]
fn nothing_is_measured_in_xy() {
    let mut bench = Bench::new();
    bench.quiet_record("HOR:SCA 1E-3;:MEASU:IMM:TYP MINI");
    assert_eq!(bench.ask("MEASU:IMM:VAL?"), "0.0E0");
    bench.tell("DIS:FORM XY;:MEASU:MEAS1:TYP MINI");
    assert_eq!(bench.ask("MEASU:IMM:VAL?;:MEASU:MEAS1:VAL?"), "9.9E37;9.9E37");
    assert_eq!(events(&mut bench), [221, 221]);
}

/// The manual's page on `ACQuire:NUMACq?`: always zero in scan mode.
#[test]
fn records_are_not_counted_in_scan_mode() {
    let mut bench = Bench::new();
    bench.tell("HOR:SCA 0.1;:ACQ:STATE RUN");
    for _ in 0..5 {
        bench.wait(1.0);
        assert_eq!(bench.ask("ACQ:NUMACQ?"), "0");
    }
    bench.tell("HOR:SCA 1E-3");
    bench.wait(0.2);
    assert_eq!(bench.ask("ACQ:NUMACQ?"), "1");
    // Another setting of what is taken begins anew, also where nothing runs.
    bench.tell("ACQ:STATE STOP;:HOR:SCA 2.5E-3");
    assert_eq!(bench.ask("ACQ:NUMACQ?"), "0");
}

#[test]
fn a_curve_that_is_not_displayed_ends_the_query() {
    for query in ["CURVE?", "WAVF?", "WFMP?", "WFMP:YMU?", "WFMP:CH2:YMU?"] {
        let mut bench = Bench::new();
        bench.tell("DATA:SOU CH2");
        bench.tell(query);
        assert_eq!(bench.ask("*ESR?"), "20", "{query}");
        assert_eq!(
            bench.ask("ALLEV?"),
            "2244,\"Waveform is not active; \",420,\"Query UNTERMINATED; \"",
            "{query}"
        );
    }
}

#[test]
fn settings_that_cannot_be_are_conflicts() {
    let mut bench = Bench::new();
    bench.tell("TRIG:MAI:EDGE:SOU LINE;:TRIG:MAI:LEV 1");
    assert_eq!(events(&mut bench), [221], "the mains have no level");
    bench.tell("TRIG:MAI SETL");
    assert_eq!(events(&mut bench), [221]);
    bench.tell("TRIG:MAI:EDGE:SOU CH1;:ACQ:STATE STOP;:TRIG:MAI SETL");
    assert_eq!(events(&mut bench), [221], "stopped");
    bench.tell("CURS:FUNC HBA;:DIS:FORM XY");
    assert_eq!(bench.ask("CURS:FUNC?"), "OFF");
    bench.tell("CURS:FUNC VBA");
    assert_eq!(events(&mut bench), [221], "no cursors in XY");
    assert_eq!(bench.ask("CURS:FUNC?"), "OFF");
    // What a set-up tells can be sent back in all of these states.
    for settings in ["DIS:FORM XY", "DIS:FORM YT;:TRIG:MAI:EDGE:SOU LINE", "ACQ:STATE STOP"] {
        bench.tell(settings);
        let set_up = bench.ask("SET?");
        bench.tell(&set_up);
        assert_eq!(events(&mut bench), [0_u16; 0], "{settings}");
        assert_eq!(bench.ask("SET?"), set_up, "{settings}");
    }
}

/// `CURVe <block>` begins at `DATa:STARt`; what stands elsewhere stays.
#[test]
fn a_curve_goes_to_its_start() {
    let mut bench = Bench::new();
    bench.tell("DATA:DEST REFB;SOU REFB;STAR 1;STOP 10;ENC ASC;:WFMP:NR_PT 2500");
    bench.tell("CURVE 1,2,3,4,5,6,7,8,9,10;:SEL:REFB ON");
    assert_eq!(bench.ask("CURVE?"), "1,2,3,4,5,6,7,8,9,10");
    bench.tell("DATA:STAR 4;:CURVE 40,50,60");
    bench.tell("DATA:STAR 1");
    assert_eq!(bench.ask("CURVE?"), "1,2,3,40,50,60,7,8,9,10");
    bench.tell("DATA:STAR 2499;STOP 2500;:CURVE 1,2,3,4");
    assert_eq!(bench.ask("CURVE?"), "1,2");
    // Nothing stood in front of it: zero volts.
    bench.tell("DATA:DEST REFC;SOU REFC;STAR 3;STOP 4;:WFMP:YOF 7;:CURVE 1,2;:SEL:REFC ON");
    bench.tell("DATA:STAR 1");
    assert_eq!(bench.ask("CURVE?"), "7,7,1,2");
    assert_eq!(events(&mut bench), [0_u16; 0]);
}

#[test]
fn preambles_of_references_can_be_set() {
    let mut bench = Bench::new();
    bench.quiet_record("HOR:SCA 1E-3");
    bench.tell("WFMP:REFA:YMU 0.5");
    assert_eq!(events(&mut bench), [2244], "empty");
    bench.tell("WFMP:CH1:YMU 0.5");
    assert_eq!(events(&mut bench), [2241], "no reference");
    bench.tell("SAV:WAVE CH1,REFA;:SEL:REFA ON");
    bench.tell("WFMP:REFA:YMU 0.5;YOF 25;YZE 1;XIN 1E-3;XZE -1;PT_F ENV;YUN \"N\";XUN \"Hz\"");
    bench.transcript(&[
        ("WFMP:REFA:YMU?;YOF?;YZE?;XIN?;XZE?", "5.0E-1;2.5E1;1.0E0;1.0E-3;-1.0E0"),
        ("WFMP:REFA:PT_F?;YUN?;XUN?", "ENV;\"N\";\"Hz\""),
        ("WFMP:XMU?", "4.0E-2"),
    ]);
    bench.tell("WFMP:XMU 0.25");
    assert_eq!(bench.ask("WFMP:XMU?"), "2.5E-1");
    assert_eq!(events(&mut bench), [0_u16; 0]);
}

/// What is accepted is kept, checked, and told.
#[test]
fn accepted_settings_are_kept_and_checked() {
    let mut bench = Bench::new();
    bench.tell("RS232:BAUD 19200;PAR EVEN;SOFTF ON;:LANG FREN;:DIS:INV ON;:AUTOS:VIEW FFT");
    bench.transcript(&[
        ("RS232?", "19200;OFF;ON;EVEN;LF"),
        ("LANG?;:DIS:INV?;:AUTOS:VIEW?", "FRENCH;ON;FFT"),
    ]);
    bench.tell("RS232:HARDF ON;BAUD 1000");
    assert_eq!(bench.ask("RS232?"), "1200;ON;OFF;EVEN;LF");
    for (wrong, code) in [
        ("RS232:PAR XY", 224),
        ("RS232:PAR", 109),
        ("LANG KLINGON", 224),
        ("LANG", 109),
        ("AUTOS:VIEW XY", 224),
        ("RS232:HARDF \"x\"", 104),
    ] {
        bench.tell(wrong);
        assert_eq!(events(&mut bench), [code], "{wrong}");
    }
    bench.tell("CAL:FAC");
    assert_eq!(events(&mut bench), [0_u16; 0]);
}

#[test]
fn there_is_no_memory_card() {
    let mut bench = Bench::new();
    for command in [
        "FILES:DIR?",
        "FILES?",
        "FILES:FREES?",
        "FILES:CWD?",
        "FILES:CWD \"A:\"",
        "FILES:DELE \"X\"",
        "SAV:IMA \"X\"",
        "SAV:IMA:FILEF BMP",
        "SAV:SETU \"X.SET\"",
        "RECA:SETU \"X.SET\"",
    ] {
        bench.tell(command);
        assert_eq!(events(&mut bench), [241], "{command}");
    }
}

/// `*TRG` executes `*DDT`, wherever it stands in a message, and does not change the path.
#[test]
fn the_device_trigger_is_executed() {
    let mut bench = Bench::new();
    bench.tell("*DDT #226CH1:SCA 2;:CH2:POS 1;POS?;");
    assert_eq!(bench.ask("*DDT?"), "\"CH1:SCA 2;:CH2:POS 1;POS?;\"");
    assert_eq!(bench.ask("CH3:POS 3;*TRG;POS?;:CH1:SCA?"), "1.0E0;3.0E0;2.0E0");
    bench.tell("*DDT #15hello");
    assert_eq!(bench.ask("*DDT?"), "\"hello\"");
    bench.tell("*TRG");
    assert_eq!(events(&mut bench), [113]);
    // It does not execute itself without an end.
    bench.tell("*DDT \"*TRG;*TRG\";*TRG");
    assert_eq!(events(&mut bench), [221, 221]);
    bench.tell(&format!("*DDT \"{}\"", "x".repeat(81)));
    assert_eq!(events(&mut bench), [151]);
}

#[test]
fn registers_refuse_what_does_not_fit() {
    let mut bench = Bench::new();
    bench.tell("*ESE 48;*SRE 32;DESE 254");
    for wrong in ["*ESE 300", "*SRE -1", "DESE 256", "*ESE 1E30"] {
        bench.tell(wrong);
        bench.ask("*ESR?");
        assert_eq!(bench.ask("EVENT?"), "222", "{wrong}");
    }
    assert_eq!(bench.ask("*ESE?;*SRE?;DESE?"), "48;32;254");
}

/// Events that are released and not read do not swallow the next ones.
#[test]
fn a_released_queue_leaves_room() {
    let mut bench = Bench::new();
    for _ in 0..100 {
        bench.tell("FOO?");
    }
    bench.ask("*ESR?");
    bench.tell("CH1:COUP XY");
    bench.ask("*ESR?");
    assert_eq!(bench.ask("ALLEV?"), "224,\"Illegal parameter value; \"");
}

#[test]
fn an_empty_reference_cannot_be_displayed() {
    let mut bench = Bench::new();
    for command in ["SEL:REFA ON", "RECA:WAVE REFA"] {
        bench.tell(command);
        assert_eq!(events(&mut bench), [2244], "{command}");
        assert_eq!(bench.ask("SEL:REFA?"), "0");
    }
    bench.tell("SEL:REFA OFF");
    assert_eq!(events(&mut bench), [0_u16; 0]);
}

/// Sine, square wave and level, by their shapes.
#[test]
fn autoset_tells_its_signal() {
    let tau = std::f64::consts::TAU;
    for (name, volts) in [
        ("SINE", &(|t: f64| (tau * 1e3 * t).sin()) as &dyn Fn(f64) -> f64),
        ("SQUARE", &|t: f64| if (1e3 * t).fract().abs() < 0.5 { 1.0 } else { -1.0 }),
        ("OTHER", &|t: f64| (1e3 * t).rem_euclid(1.0)),
        ("LEVEL", &|_| 0.0),
    ] {
        let mut bench = Bench::new();
        assert_eq!(bench.ask("AUTOS:SIGNAL?;VIEW?"), "NONE;NONE");
        bench.record("CH1:PROBE 1;SCA 0.5;:HOR:SCA 1E-3;:TRIG:MAI:LEV 0.1", volts);
        bench.tell("AUTOS EXEC");
        assert_eq!(bench.ask("AUTOS:SIGNAL?;VIEW?"), format!("{name};DEFAULT"));
    }
}
