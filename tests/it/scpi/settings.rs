//! What settings become, group by group.

use super::bench::Bench;

#[test]
fn volts_snap_and_positions_come_in_levels() {
    let mut bench = Bench::new();
    bench.tell("CH1:PROBE 1");
    for (typed, told) in [
        ("0.5", "5.0E-1"),
        ("5.000000E-01", "5.0E-1"),
        ("0.48", "5.0E-1"),
        ("1E-9", "2.0E-3"),
        ("1000", "5.0E0"),
        ("-1", "2.0E-3"),
        ("0", "2.0E-3"),
    ] {
        assert_eq!(bench.ask(&format!("CH1:SCALE {typed};SCALE?")), told, "{typed}");
        assert_eq!(bench.ask("CH1:VOLTS?"), told);
    }
    bench.tell("CH1:SCALE 0.2");
    for (typed, told) in [
        ("1.000000E+00", "1.0E0"),
        ("0.28", "2.8E-1"),
        ("0.27", "2.8E-1"),
        ("99", "1.0E1"),
        ("-99", "-1.0E1"),
    ] {
        assert_eq!(bench.ask(&format!("CH1:POSITION {typed};POSITION?")), told, "{typed}");
    }
    // 2 V at the input up to 200 mV/div, 50 V above.
    bench.tell("CH1:SCALE 0.002;POSITION 1E6");
    assert_eq!(bench.ask("CH1:POSITION?"), "1.0E3");
    bench.tell("CH1:SCALE 5;POSITION 1E6");
    assert_eq!(bench.ask("CH1:POSITION?"), "1.0E1");
}

#[test]
fn a_probe_keeps_the_input_and_multiplies() {
    let mut bench = Bench::new();
    bench.transcript(&[
        ("CH2:PROBE 1;SCALE 0.5;PROBE?;SCALE?", "1;5.0E-1"),
        ("CH2:PROBE 10;PROBE?;SCALE?", "10;5.0E0"),
        ("CH2:PROBE 20;PROBE?", "10"),
        ("CH2:SCALE 1000;SCALE?", "5.0E1"),
    ]);
}

#[test]
fn a_channel_tells_everything() {
    let mut bench = Bench::with_headers();
    assert_eq!(
        bench.ask("CH3?"),
        ":CH3:PROBE 10;SCALE 1.0E0;POSITION 0.0E0;COUPLING DC;BANDWIDTH OFF;INVERT OFF"
    );
}

/// Each setting of a channel is one of its own: none changes another.
#[test]
fn settings_of_a_channel_do_not_change_each_other() {
    let mut bench = Bench::with_headers();
    for (command, reply) in [
        // Any number but zero is on.
        ("INV -1", "PROBE 10;SCALE 1.0E0;POSITION 0.0E0;COUPLING DC;BANDWIDTH OFF;INVERT ON"),
        (
            "INV OFF;BAN ON",
            "PROBE 10;SCALE 1.0E0;POSITION 0.0E0;COUPLING DC;BANDWIDTH ON;INVERT OFF",
        ),
        ("COUP GND", "PROBE 10;SCALE 1.0E0;POSITION 0.0E0;COUPLING GND;BANDWIDTH ON;INVERT OFF"),
        ("POS 1", "PROBE 10;SCALE 1.0E0;POSITION 1.0E0;COUPLING GND;BANDWIDTH ON;INVERT OFF"),
        ("SCA 2", "PROBE 10;SCALE 2.0E0;POSITION 1.0E0;COUPLING GND;BANDWIDTH ON;INVERT OFF"),
    ] {
        bench.tell(&format!("CH3:{command}"));
        assert_eq!(bench.ask("CH3?"), format!(":CH3:{reply}"), "{command}");
    }
    assert!(bench.ask("CH2?").ends_with("COUPLING DC;BANDWIDTH OFF;INVERT OFF"));
}

/// Without headers as the fact sheet gives it.
#[test]
fn the_displayed_waveforms() {
    let mut bench = Bench::new();
    // An empty memory is not displayed.
    bench.quiet_record("HOR:SCA 1E-3");
    bench.tell("SAV:WAVE CH1,REFD");
    bench.transcript(&[
        ("SELect?", "1;0;0;0;0;0;0;0;0"),
        ("SEL:CH2 ON;MATH 1;REFD ON;:SEL?", "1;1;0;0;1;0;0;0;1"),
        ("SEL:CH1 OFF;CH2 0;:SEL:CH1?;CH2?;MATH?;REFD?", "0;0;1;1"),
        ("HEAD ON;:SEL:REFD?", ":SELECT:REFD 1"),
    ]);
}

#[test]
fn time_bases_snap_and_positions_come_in_points() {
    let mut bench = Bench::new();
    for (typed, told) in [
        ("1.000000E-04", "1.0E-4"),
        ("2E-4", "2.5E-4"),
        ("1E-12", "5.0E-9"),
        ("1E12", "5.0E1"),
        ("5E-2", "5.0E-2"),
    ] {
        assert_eq!(bench.ask(&format!("HOR:SCA {typed};SCA?")), told, "{typed}");
        assert_eq!(bench.ask("HOR:MAI:SECD?;:HOR:SECDIV?"), format!("{told};{told}"));
    }
    bench.transcript(&[
        ("HOR:SCALE 1E-3;POS 0.0123456;POS?", "1.236E-2"),
        ("HOR:POS -1;POS?", "-4.0E-3"),
        ("HOR:MAIN:POS 1000;:HOR:POS?", "5.0E1"),
        ("HOR:SCALE 1E-4;POS 1000;POS?", "5.0E-2"),
        ("HOR:RECORDLENGTH?", "2500"),
    ]);
}

/// From the log of the TDS 2024, where the time base and the trigger were set by hand.
#[test]
fn replies_of_a_tds_2024() {
    let mut bench = Bench::with_headers();
    bench.quiet_record("CH1:PROBE 1;SCALE 0.5;:HOR:MAI:SCA 0.05;:TRIG:MAI:LEV 4.56E0");
    bench.tell("CH1:POS -6.64;:TRIG:MAI:LEV 4.56");
    bench.transcript(&[
        ("TRIG:STATE?", ":TRIGGER:STATE SAVE"),
        ("TRIGGER:MAIN:HOLDO?", ":TRIGGER:MAIN:HOLDOFF:VALUE 5.0E-7"),
        ("TRIGGER:MAIN:LEVEL?", ":TRIGGER:MAIN:LEVEL 4.56E0"),
        ("hor:mai:sca?", ":HORIZONTAL:MAIN:SCALE 5.0E-2"),
        ("CH1:scale?", ":CH1:SCALE 5.0E-1"),
    ]);
}

#[test]
fn the_acquisition_tells_everything() {
    let mut bench = Bench::with_headers();
    assert_eq!(bench.ask("ACQuire?"), ":ACQUIRE:STOPAFTER RUNSTOP;STATE 1;MODE SAMPLE;NUMAVG 16");
    bench.tell("ACQ:STATE STOP;MODE PEAK;NUMAV 100;STOPA SEQ");
    assert_eq!(bench.ask("ACQ?"), ":ACQUIRE:STOPAFTER SEQUENCE;STATE 0;MODE PEAKDETECT;NUMAVG 128");
    bench.tell("ACQ:STATE 1");
    assert_eq!(bench.ask("ACQ:STATE?;NUMACQ?"), ":ACQUIRE:STATE 1;:ACQUIRE:NUMACQ 0");
}

#[test]
fn the_trigger_is_clamped_to_its_source() {
    let mut bench = Bench::new();
    bench.tell("CH1:PROBE 1;SCALE 0.1;POSITION 2");
    bench.transcript(&[
        ("TRIG:MAI:LEV 10;LEV?", "6.0E-1"),
        ("TRIG:MAI:LEV -10;LEV?", "-1.0E0"),
        ("TRIG:MAI:EDGE:SOU EXT;:TRIG:MAI:LEV 10;LEV?", "1.6E0"),
        ("TRIG:MAI:EDGE:SOU EXT5;:TRIG:MAI:LEV 10;LEV?", "8.0E0"),
        ("TRIG:MAI:HOLDO:VAL 100;VAL?", "1.0E1"),
        ("TRIG:MAI:HOLDO:VAL 0;VAL?", "5.0E-7"),
        ("TRIG:MAI:PUL:WID:WID 0;WID?", "3.3E-8"),
        ("TRIG:MAI:PUL:WID:WHEN NOTEQ;WHEN?", "NOTEQUAL"),
        ("TRIG:MAI:VID:SYNC LINEN;SYNC?;STAN PAL;STAN?;LINE 700;LINE?", "LINENUM;PAL;625"),
        ("TRIG:MAI:TYP PUL;TYP?;MOD NORM;MOD?", "PULSE;NORMAL"),
    ]);
    bench.tell("HEADER ON");
    assert_eq!(
        bench.ask("TRIGGER:MAIN:EDGE?"),
        ":TRIGGER:MAIN:EDGE:SOURCE EXT5;COUPLING DC;SLOPE RISE"
    );
}

#[test]
fn cursors_math_display_and_printer() {
    let mut bench = Bench::new();
    bench.transcript(&[
        ("CURS:FUNC VBA;FUNC?", "VBARS"),
        ("CURS:VBA:POSITION1 -1E-3;POSITION2 1E-3;DELT?;UNI HER;DELT?", "2.0E-3;5.0E2"),
        ("CURS:HBA:POSITION1 1;POSITION2 -1.5;DELT?;UNI?", "2.5E0;VOLTS"),
        ("CURS:SEL:SOU REFA;SOU?", "REFA"),
        ("MATH:DEFINE \"ch1+ch2\";DEFINE?", "\"CH1 + CH2\""),
        ("MATH:DEFINE \"CH4-CH3\";DEFINE?", "\"CH4 - CH3\""),
        ("MATH:DEFINE \"FFT (CH2, FLAT)\";DEFINE?", "\"FFT(CH2,FLATTOP)\""),
        ("MATH:FFT:HOR:SCA 3;SCA?", "2.0E0"),
        ("DIS:PERS INF;PERS?;PERS 4;PERS?;PERS OFF;PERS?", "INFINITE;5;0"),
        ("DIS:STY DOT;STY?;FORM XY;FORM?;CONTR 200;CONTR?", "DOTS;XY;100"),
        (
            "HARDC:FORM TIF;FORM?;PORT RS232;PORT?;LAY LAN;LAY?;INKS OFF;INKS?",
            "TIFF;RS232;LANDSCAPE;OFF",
        ),
        ("LOCK ALL;LOCK?;UNLOCK ALL;LOCK?", "ALL;NONE"),
    ]);
}

#[test]
fn set_ups_are_kept_and_recalled() {
    let mut bench = Bench::new();
    bench.tell("CH1:COUP AC;*SAV 3;COUP GND");
    bench.transcript(&[
        ("CH1:COUP?", "GND"),
        ("*RCL 3;:CH1:COUP?", "AC"),
        ("RECALL:SETUP FACTORY;:CH1:COUP?", "DC"),
        ("RECA:SETU 3;:CH1:COUP?", "AC"),
        ("*RST;:CH1:COUP?", "DC"),
        // Headers are on after `FACtory`.
        ("*RCL 3;:CH1:COUP?;:FACTORY;:CH1:COUP?", "AC;:CH1:COUPLING DC"),
    ]);
}

/// The trigger level stays within 8 divisions of the screen's centre, whatever is turned (user
/// manual, trigger level range): scale, position, probe, source.
#[test]
fn the_trigger_level_stays_within_reach_whatever_is_turned() {
    let mut bench = Bench::new();
    bench.tell("CH1:SCA 50;:TRIG:MAI:LEV 300");
    for (turned, level) in [
        ("CH1:POS 0", "3.0E2"),
        ("CH1:SCA 0.2", "1.6E0"),
        ("CH1:POS 2", "1.2E0"),
        ("CH1:POS 0", "1.2E0"),
        ("CH1:PRO 1", "1.6E-1"),
        ("TRIG:MAI:EDGE:SOU CH2", "1.6E-1"),
        ("TRIG:MAI:LEV 7.5;:TRIG:MAI:EDGE:SOU EXT", "1.6E0"),
        ("TRIG:MAI:LEV -9;:TRIG:MAI:EDGE:SOU EXT5", "-1.6E0"),
        ("TRIG:MAI:LEV -9;:TRIG:MAI:EDGE:SOU CH2", "-8.0E0"),
        ("TRIG:MAI:EDGE:SOU LINE", "-8.0E0"),
        ("TRIG:MAI:EDGE:SOU CH1", "-1.6E-1"),
    ] {
        bench.tell(turned);
        assert_eq!(bench.ask("TRIG:MAI:LEV?"), level, "after {turned}");
    }
    // A set-up that is recalled, too.
    bench.tell("CH1:SCA 5;:TRIG:MAI:LEV 40;*SAV 3;:CH1:SCA 0.02;*RCL 3");
    assert_eq!(bench.ask("TRIG:MAI:LEV?;:CH1:SCA?"), "4.0E1;5.0E0");
}

/// A model with two channels has no CH3, as a value no more than in a header; it has two reference
/// memories (a real two-channel set-up names REFA and REFB).
#[test]
fn values_name_what_the_model_has() {
    for (channels, events) in [(2, "224"), (4, "0")] {
        for command in [
            "TRIG:MAI:EDGE:SOU CH4",
            "TRIG:MAI:PUL:SOU CH3",
            "DATA:SOU CH4",
            "DATA:SOU REFC",
            "DATA:DEST REFD",
            "MEASU:IMM:SOU CH3",
            "MEASU:MEAS2:SOU CH3",
            "CURS:SEL:SOU CH4",
        ] {
            let mut bench = Bench::with_channels(channels);
            bench.tell(command);
            let set = bench.ask("*ESR?;:EVENT?");
            assert_eq!(set.split_once(';').map(|(_, event)| event), Some(events), "{command}");
        }
    }
    let mut bench = Bench::with_channels(2);
    bench.tell("SAV:WAVE CH1,REFC");
    assert_eq!(bench.ask("*ESR?"), "16");
    assert_eq!(bench.ask("EVENT?"), "224");
    bench.tell("SEL:REFC ON");
    assert_eq!(bench.ask("*ESR?"), "32");
    assert_eq!(bench.ask("EVENT?"), "113");
    assert_eq!(bench.ask("SELECT?"), "1;0;0;0;0");
}
