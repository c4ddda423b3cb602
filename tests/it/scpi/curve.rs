//! Points on their way out and in.

use hertzscope::instrument::Instrument;
use hertzscope::scope::Model;
use hertzscope::scpi::Reply;

use super::bench::{Bench, model};

/// Two divisions up from the trigger on, at half a volt a division and one division above the
/// centre: level 25 and, after the trigger at point 1250, level 75.
fn step() -> Bench {
    let mut bench = Bench::new();
    bench.record("CH1:PROBE 1;SCALE 0.5;POS 1;:HOR:SCA 1E-3;:TRIG:MAI:LEV 0.5", |time| {
        if time >= 0.0 { 1.0 } else { 0.0 }
    });
    bench
}

#[test]
fn a_block_has_its_length_and_one_line_feed() {
    let mut bench = step();
    let reply = bench.bytes("CURVE?");
    assert_eq!(&reply[..6], b"#42500");
    assert_eq!(reply.len(), 6 + 2500 + 1);
    assert_eq!(reply.last(), Some(&b'\n'));
    bench.tell("HEADER ON");
    assert_eq!(&bench.bytes("curv?")[..14], b":CURVE #42500\x19");
    bench.tell("DATA:WIDTH 2");
    assert_eq!(&bench.bytes("curv?")[..13], b":CURVE #45000");
}

/// The two points on either side of the trigger. Levels 25 and 75, the definition of each encoding
/// by hand.
#[test]
fn every_encoding() {
    let mut bench = step();
    bench.tell("DATA:START 1250;STOP 1251");
    for (encoding, width, expected) in [
        ("RIB", 1, &b"#12\x19\x4b\n"[..]),
        ("SRI", 1, b"#12\x19\x4b\n"),
        ("RPB", 1, b"#12\x99\xcb\n"),
        ("SRP", 1, b"#12\x99\xcb\n"),
        ("RIB", 2, b"#14\x19\x00\x4b\x00\n"),
        ("SRI", 2, b"#14\x00\x19\x00\x4b\n"),
        ("RPB", 2, b"#14\x99\x00\xcb\x00\n"),
        ("SRP", 2, b"#14\x00\x99\x00\xcb\n"),
        ("ASCI", 1, b"25,75\n"),
        ("ASCI", 2, b"6400,19200\n"),
    ] {
        bench.tell(&format!("DATA:ENC {encoding};WID {width}"));
        assert_eq!(bench.bytes("CURVE?"), expected, "{encoding} {width}");
    }
}

/// The same step in 12 bits, at 0.6 V: 400 levels a division and one division up, so level 400
/// before the trigger and 400 + 480 = 880 after it. One byte is the upper 8 of the 12 bits: 25 and
/// 55. In two bytes the levels are shifted by four bits to the left: 6400 and 14080.
#[test]
fn twelve_bits_fill_two_bytes_from_the_left() {
    let mut bench = Bench::new();
    let model = Model { bits: 12, ..model() };
    bench.instrument = Instrument::new(model, 0.0, 1);
    bench.instrument.status.clear();
    bench.record("CH1:PROBE 1;SCALE 0.5;POS 1;:HOR:SCA 1E-3;:TRIG:MAI:LEV 0.5", |time| {
        if time >= 0.0 { 0.6 } else { 0.0 }
    });
    bench.tell("DATA:START 1250;STOP 1251");
    for (encoding, width, expected, preamble) in [
        ("RIB", 1, &b"#12\x19\x37\n"[..], "8;2.0E-2;2.5E1"),
        ("RPB", 1, b"#12\x99\xb7\n", "8;2.0E-2;1.53E2"),
        ("RIB", 2, b"#14\x19\x00\x37\x00\n", "16;7.8125E-5;6.4E3"),
        ("SRP", 2, b"#14\x00\x99\x00\xb7\n", "16;7.8125E-5;3.9168E4"),
        ("ASCI", 2, b"6400,14080\n", "16;7.8125E-5;6.4E3"),
    ] {
        bench.tell(&format!("DATA:ENC {encoding};WID {width}"));
        assert_eq!(bench.bytes("CURVE?"), expected, "{encoding} {width}");
        assert_eq!(bench.ask("WFMP:BIT_N?;YMU?;YOF?"), preamble, "{encoding} {width}");
    }
    // 0.6013 V are 481.04 levels; the four lowest bits are 881 = 0x371: one byte leaves them out.
    bench.record("", |time| if time >= 0.0 { 0.6013 } else { 0.0 });
    bench.tell("DATA:ENC RIB;WID 2");
    assert_eq!(bench.bytes("CURVE?"), b"#14\x19\x00\x37\x10\n");
    bench.tell("DATA:WID 1");
    assert_eq!(bench.bytes("CURVE?"), b"#12\x19\x37\n");
    // What comes in in two bytes goes out as it came.
    bench.tell("DATA INIT;:DATA:WID 2;DEST REFB;:WFMP:NR_P 2;:WFMP:YMU 7.8125E-5;YOF 6400");
    let sent = b":CURVE #14\x12\x30\xff\xf0\n";
    assert_eq!(bench.session.receive(&mut bench.instrument, sent), Reply::None);
    bench.tell("SEL:REFB ON;:DATA:SOU REFB");
    assert_eq!(bench.bytes("CURVE?"), b"#14\x12\x30\xff\xf0\n");
    assert_eq!(bench.ask("WFMP:YMU?;YOF?"), "7.8125E-5;6.4E3");
}

#[test]
fn signals_beyond_the_converter_are_cut_off() {
    let mut bench = Bench::new();
    bench
        .record("CH1:PROBE 1;SCALE 0.5;:HOR:SCA 1E-3", |time| if time >= 0.0 { 9.0 } else { -9.0 });
    assert_eq!(bench.ask("DATA:ENC ASCI;START 1250;STOP 1251;:CURVE?"), "-128,127");
}

#[test]
fn preamble_and_points_in_one_reply() {
    let mut bench = step();
    bench.tell("DATA:ENC ASCI;START 1250;STOP 1251");
    assert_eq!(
        bench.ask("WAVFrm?"),
        "1;8;ASC;RI;MSB;2;\"Ch1, DC coupling, 5.0E-1 V/div, 1.0E-3 s/div, 2500 points, Sample mode\";\
         Y;4.0E-6;0;-5.0E-3;\"s\";2.0E-2;0.0E0;2.5E1;\"Volts\";25,75"
    );
    bench.tell("HEADER ON;:DATA:ENC RIB");
    assert!(bench.bytes("WAVF?").ends_with(b";YUNIT \"Volts\";:CURVE #12\x19\x4b\n"));
}

/// Peak detection: lowest and highest of each two intervals, told as an envelope.
#[test]
fn peak_detection_keeps_both_ends() {
    let mut bench = Bench::new();
    bench.record("ACQ:MODE PEAK;:CH1:PROBE 1;SCALE 0.5;:HOR:SCA 1E-3", |time| {
        if time < 0.0 {
            -0.5
        } else if (time / 4e-6).round() % 2.0 == 0.0 {
            1.0
        } else {
            0.2
        }
    });
    bench.transcript(&[
        ("WFMP:PT_F?", "ENV"),
        ("DATA:ENC ASCI;START 1249;STOP 1254;:CURVE?", "-25,-25,10,50,10,50"),
    ]);
    assert!(bench.ask("WFMP:WFI?").ends_with("Peak Detect mode\""));
}

#[test]
fn a_curve_sent_in_comes_back() {
    let mut bench = Bench::new();
    bench.tell("DATA INIT;DATA:DEST REFB;:WFMP:XIN 1E-6;XZE -5E-6;YMU 1E-2;YOF 5;NR_P 4");
    let mut message = b"CURVE #14".to_vec();
    message.extend([0xff, b'\n', b'\r', 0x80]);
    message.push(b'\n');
    bench.session.receive(&mut bench.instrument, &message);
    bench.tell("SEL:REFB ON;:DATA:SOU REFB;ENC ASCI");
    bench.transcript(&[
        ("*ESR?", "0"),
        ("CURVE?", "-1,10,13,-128"),
        ("WFMP:NR_P?;XIN?;XZE?;YMU?;YOF?", "4;1.0E-6;-5.0E-6;1.0E-2;5.0E0"),
    ]);
    // As text, and as positive pairs, low byte first.
    bench.tell("CURVE -7,8,127,-200");
    assert_eq!(bench.ask("CURVE?"), "-7,8,127,-128");
    bench.tell("DATA:ENC SRP;WID 2");
    bench.session.receive(&mut bench.instrument, b"CURVE #18\x00\x99\x00\xcb\x00\x00\x00\xff\n");
    assert_eq!(bench.ask("DATA:ENC ASCI;WID 1;:CURVE?"), "25,75,-128,127");
}

#[test]
fn a_waveform_is_kept_in_a_reference() {
    let mut bench = step();
    bench.tell(
        "SAVE:WAVEFORM CH1,REFC;:RECALL:WAVEFORM REFC;:DATA:SOU REFC;ENC ASCI;START 1250;STOP 1251",
    );
    bench.transcript(&[("SEL:REFC?", "1"), ("CURVE?", "25,75")]);
    bench.tell("SAVE:WAVEFORM CH2,REFC");
    bench.transcript(&[("*ESR?", "16"), ("EVENT?", "2244")]);
}

/// `CH1 - CH2` where channel 2 shows nothing.
#[test]
fn the_difference_of_two_channels() {
    let mut bench = Bench::new();
    bench.record(
        "SEL:CH2 ON;MATH ON;:MATH:DEFINE \"CH2 - CH1\";:CH2:PROBE 1;SCALE 1;:CH1:PROBE 1;SCALE 0.5;:HOR:SCA 1E-3",
        |time| if time >= 0.0 { 1.0 } else { -1.0 },
    );
    bench.tell("DATA:SOU MATH;ENC ASCI;START 1250;STOP 1251");
    bench.transcript(&[("CURVE?", "25,-25"), ("WFMP:YMU?", "4.0E-2")]);
}

/// A sine of 1 V peak is -3.01 dB of a volt. 2.5 kHz at 5 ms/div is bin 101.376 of 24.66 Hz.
#[test]
fn the_spectrum_of_a_sine() {
    let mut bench = Bench::new();
    bench.record(
        "SEL:MATH ON;:MATH:DEFINE \"FFT(CH1,FLATTOP)\";:CH1:PROBE 1;SCALE 0.5;:HOR:SCA 5E-3;:TRIG:MAI:LEV 1.9",
        |time| (std::f64::consts::TAU * 2500.0 * time).sin(),
    );
    bench.tell("DATA:SOU MATH;ENC ASCI");
    // 100/99 of 50 kHz over 2048, `20 log10(0.5) - 20.9691`.
    bench.transcript(&[
        ("WFMP:NR_P?;XUN?;YUN?", "1024;\"Hz\";\"dB\""),
        ("WFMP:XIN?", "2.46606692E1"),
        ("WFMP:YMU?;YZE?", "4.0E-1;-2.69896999E1"),
    ]);
    let levels: Vec<f64> =
        bench.ask("CURVE?").split(',').map(|level| level.parse().expect("a level")).collect();
    let decibels: Vec<f64> = levels.iter().map(|level| -26.9897 + 0.4 * level).collect();
    let highest = decibels.iter().copied().fold(f64::MIN, f64::max);
    // Half a level, and what a flat top loses between bins.
    assert!((highest + 3.01).abs() < 0.21, "{highest} dB");
    let bin = decibels.iter().position(|d| *d == highest).expect("a bin");
    assert!((99..=104).contains(&bin), "bin {bin}");
    assert!(levels.iter().all(|level| *level >= -100.0));
}

/// A block is positive where `BN_Fmt` is `RP`, also while `ENCdg` is text: 128 is level 0.
#[test]
fn a_block_is_read_as_its_numbers_are() {
    for (encoding, block) in [("RPB", [0x80, 0x94, 0x6C]), ("RIB", [0, 0x14, 0xEC])] {
        let mut bench = Bench::new();
        bench.tell(&format!("DATA:DEST REFA;ENC {encoding};:DATA:ENC ASC"));
        let yoff = if encoding == "RPB" { "128" } else { "0" };
        bench.tell(&format!("WFMP:YOF {yoff};NR_P 3"));
        let message = [b"CURVE #13".as_slice(), &block, b"\n"].concat();
        bench.session.receive(&mut bench.instrument, &message);
        bench.tell("SEL:REFA ON;:DATA:SOU REFA;STAR 1;STOP 3");
        bench.transcript(&[("CURVE?", "0,20,-20"), ("WFMP:YOF?", "0.0E0"), ("*ESR?", "0")]);
    }
}
