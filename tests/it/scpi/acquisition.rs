//! States, single sequences, and what waits for them.

use super::bench::Bench;
use hertzscope::instrument::{Accepted, Instrument, Signals};
use hertzscope::scpi::{Preferences, Reply, Session};

/// A step of 2 V at sample 1500 on the grid that the instrument wants.
/// Samples of the signal in one point of the record at 1 ms/div, 4 us.
const PER_POINT: usize = 4;

fn step(instrument: &Instrument) -> Signals {
    let interval = instrument.sample_window().interval;
    let start = 1500 * PER_POINT;
    let volts = (0..4000 * PER_POINT).map(|n| if n < start { 0.0 } else { 2.0 }).collect();
    Signals { interval, automatic: start, volts: vec![volts], shot: 1, ..Signals::default() }
}

fn armed() -> Bench {
    let mut bench = Bench::new();
    bench.tell(
        "CH1:PROBE 1;SCALE 0.5;:HOR:SCA 1E-3;:TRIG:MAI:MOD NORM;LEV 1;:ACQ:STOPA SEQ;STATE ON",
    );
    bench
}

fn send(bench: &mut Bench, line: &str) -> Reply {
    bench.session.receive(&mut bench.instrument, format!("{line}\n").as_bytes())
}

#[test]
fn a_single_sequence_from_armed_to_saved() {
    let mut bench = armed();
    bench.transcript(&[("TRIG:STATE?", "ARMED"), ("BUSY?", "1"), ("ACQ:STATE?", "1")]);
    let signals = step(&bench.instrument);
    assert_eq!(bench.instrument.accept_signals(&signals), Accepted::NotReady);
    // Half a record of 10 ms comes before the trigger.
    bench.wait(0.006);
    assert_eq!(bench.ask("TRIG:STATE?"), "READY");
    let accepted = bench.instrument.accept_signals(&signals);
    let Accepted::Triggered { complete_at } = accepted else { panic!("{accepted:?}") };
    assert!((complete_at - 0.011).abs() < 1e-5, "{complete_at}");
    bench.transcript(&[("TRIG:STATE?", "TRIGGER"), ("ACQ:NUMACQ?", "0")]);
    bench.wait(0.006);
    bench.transcript(&[
        ("TRIG:STATE?", "SAVE"),
        ("ACQ:NUMACQ?", "1"),
        ("BUSY?", "0"),
        ("ACQ:STATE?", "0"),
        // The trigger is point 1251.
        ("DATA:ENC ASCI;START 1250;STOP 1251;:CURVE?", "0,100"),
    ]);
}

#[test]
fn opc_answers_when_the_sequence_is_done() {
    let mut bench = armed();
    bench.wait(0.006);
    assert_eq!(send(&mut bench, "CH1:COUP?;*OPC?;:CH1:COUP?"), Reply::WhenIdle(Vec::new()));
    assert_eq!(bench.session.resume(&mut bench.instrument), Reply::WhenIdle(Vec::new()));
    let signals = step(&bench.instrument);
    bench.instrument.accept_signals(&signals);
    bench.wait(0.006);
    assert_eq!(bench.session.resume(&mut bench.instrument), Reply::Now(b"DC;1;DC\n".to_vec()));
    assert_eq!(bench.session.resume(&mut bench.instrument), Reply::None);
    assert_eq!(bench.ask("*OPC?"), "1");
}

#[test]
fn opc_sets_its_bit_when_the_sequence_is_done() {
    let mut bench = armed();
    bench.tell("*OPC");
    assert_eq!(bench.ask("*ESR?"), "0");
    bench.tell("ACQ:STATE OFF");
    bench.transcript(&[("*ESR?", "1"), ("EVM?", "402,\"Operation complete; \"")]);
    bench.tell("*OPC");
    assert_eq!(bench.ask("*ESR?"), "1");
}

#[test]
fn messages_after_wai_wait_in_their_order() {
    let mut bench = armed();
    assert_eq!(send(&mut bench, "*WAI;:CH1:COUP?"), Reply::WhenIdle(Vec::new()));
    assert_eq!(send(&mut bench, "ACQ:STATE?"), Reply::WhenIdle(Vec::new()));
    bench.instrument.stop();
    assert_eq!(bench.session.resume(&mut bench.instrument), Reply::Now(b"DC\n0\n".to_vec()));
}

/// A query while the reply to `*OPC?` waits throws that reply away.
#[test]
fn a_query_interrupts_a_waiting_reply() {
    let mut bench = armed();
    assert_eq!(send(&mut bench, "*OPC?"), Reply::WhenIdle(Vec::new()));
    // A command does not.
    assert_eq!(send(&mut bench, "CH1:COUP AC"), Reply::WhenIdle(Vec::new()));
    assert_eq!(send(&mut bench, "CH1:COUP?"), Reply::Now(b"AC\n".to_vec()));
    bench.transcript(&[("*ESR?", "4"), ("EVENT?", "410")]);
    bench.instrument.stop();
    assert_eq!(bench.session.resume(&mut bench.instrument), Reply::None);
}

#[test]
fn what_waits_is_limited() {
    let mut bench = armed();
    send(&mut bench, "*WAI");
    let message = format!("REM \"{}\"", "x".repeat(70));
    for _ in 0..1000 {
        send(&mut bench, &message);
    }
    bench.instrument.stop();
    bench.session.resume(&mut bench.instrument);
    bench.transcript(&[("*ESR?", "8"), ("EVENT?", "363")]);
}

#[test]
fn a_signal_below_the_level_does_not_trigger() {
    let mut bench = armed();
    bench.tell("TRIG:MAI:LEV 3");
    bench.wait(0.006);
    let signals = step(&bench.instrument);
    assert_eq!(bench.instrument.accept_signals(&signals), Accepted::NoTrigger);
    assert_eq!(bench.ask("TRIG:STATE?;:ACQ:NUMACQ?"), "READY;0");
}

#[test]
fn force_acts_when_ready_only() {
    let mut bench = armed();
    bench.tell("TRIGGER FORCE");
    assert_eq!(bench.ask("TRIG:STATE?"), "ARMED");
    bench.wait(0.006);
    bench.tell("TRIGGER FORCE");
    assert_eq!(bench.ask("TRIG:STATE?"), "TRIGGER");
    bench.wait(0.006);
    assert_eq!(bench.ask("TRIG:STATE?;:ACQ:STATE?;*OPC?"), "SAVE;0;1");
    // Nothing is at the inputs: 2500 times zero volts.
    assert_eq!(bench.ask("DATA:ENC ASC;:CURVE?"), vec!["0"; 2500].join(","));
}

#[test]
fn automatic_mode_loses_its_patience() {
    let mut bench = Bench::new();
    bench.tell("HOR:SCA 1E-3");
    assert_eq!(bench.ask("TRIG:STATE?"), "ARMED");
    bench.wait(1.0);
    assert_eq!(bench.ask("TRIG:STATE?;:ACQ:NUMACQ?"), "AUTO;1");
    bench.tell("HOR:SCA 0.1");
    assert_eq!(bench.ask("TRIG:STATE?"), "SCAN");
    bench.tell("ACQ:STATE STOP");
    assert_eq!(bench.ask("TRIG:STATE?"), "SAVE");
}

/// Four records of alternating steps make an average half way; the sequence ends with the fourth.
#[test]
fn an_average_takes_its_number_of_records() {
    let mut bench = armed();
    bench.tell("ACQ:MODE AVE;NUMAV 4");
    for shot in 0_u32..4 {
        assert_eq!(bench.ask("BUSY?"), "1", "{shot}");
        bench.wait(0.006);
        let mut signals = step(&bench.instrument);
        if shot % 2 == 0 {
            signals.volts[0].iter_mut().for_each(|volts| *volts *= 0.75);
        }
        bench.instrument.accept_signals(&signals);
        bench.wait(0.006);
    }
    bench.transcript(&[
        ("BUSY?;:ACQ:NUMACQ?", "0;4"),
        // 75 and 100 levels.
        ("DATA:ENC ASCI;START 1251;STOP 1251;:CURVE?", "88"),
    ]);
    assert!(bench.ask("WFMP:WFI?").ends_with("Average mode\""));
}

/// 2 ms wide pulses trigger where that is asked for, at their end.
#[test]
fn pulses_of_the_right_width_trigger() {
    for (settings, triggers) in [
        ("WHEN EQ;WID 2E-3", true),
        ("WHEN EQ;WID 1E-3", false),
        ("WHEN NOTEQ;WID 1E-3", true),
        ("WHEN IN;WID 3E-3", true),
        ("WHEN OUT;WID 3E-3", false),
        ("POL NEGA;WHEN EQ;WID 2E-3", false),
    ] {
        let mut bench = armed();
        bench.tell(&format!("TRIG:MAI:TYP PUL;PUL:WID:{settings}"));
        bench.wait(0.006);
        let mut signals = step(&bench.instrument);
        signals.volts[0].iter_mut().skip(2000 * PER_POINT).for_each(|volts| *volts = 0.0);
        let found = bench.instrument.accept_signals(&signals);
        assert_eq!(matches!(found, Accepted::Triggered { .. }), triggers, "{settings}");
    }
}

/// A step of 2 V that rises within 1 us, and a peak that stays up 3 us: what each coupling lets
/// through to a level.
#[test]
fn the_trigger_is_deaf_as_its_coupling_says() {
    for (settings, step_triggers, peak_triggers) in [
        ("COUP DC;:TRIG:MAI:LEV 1.5", true, true),
        // Corner 10 Hz: a step passes.
        ("COUP AC;:TRIG:MAI:LEV 1.5", true, true),
        // Corner 300 kHz: `(1 - exp(-x))/x` of a step that rises in 1 us, x = 1.885, is 0.90 V.
        ("COUP LFR;:TRIG:MAI:LEV 1", false, false),
        ("COUP LFR;:TRIG:MAI:LEV 0.8", true, true),
        // Corner 80 kHz: a step passes in the end, of the peak `1 - exp(-4 x) (exp(x) - 1)/x`, x =
        // 0.503, 1.65 V.
        ("COUP HFR;:TRIG:MAI:LEV 1.8", true, false),
        ("COUP HFR;:TRIG:MAI:LEV 1.5", true, true),
        // Hysteresis of 0.4 div is 0.2 V: below a level of 0.15 V the signal has not been.
        ("COUP NOISE;:TRIG:MAI:LEV 0.15", false, false),
        ("COUP NOISE;:TRIG:MAI:LEV 0.25", true, true),
        ("COUP DC;:TRIG:MAI:LEV 0.15", true, true),
    ] {
        for (peak, triggers) in [(false, step_triggers), (true, peak_triggers)] {
            let mut bench = armed();
            bench.tell(&format!("TRIG:MAI:EDGE:{settings}"));
            bench.wait(0.006);
            let mut signals = step(&bench.instrument);
            if peak {
                signals.volts[0].iter_mut().skip(1501 * PER_POINT).for_each(|volts| *volts = 0.0);
            }
            let found = bench.instrument.accept_signals(&signals);
            let found = matches!(found, Accepted::Triggered { .. });
            assert_eq!(found, triggers, "{settings}, peak: {peak}");
        }
    }
}

/// Captures of a finished run are shown as if just taken.
#[test]
fn captures_can_be_stored() {
    use hertzscope::experiment::{Integration, run};
    use hertzscope::scene::Scene;
    let scene = Scene::load("magnet-0.61g").expect("the default scene");
    let outcome = run(&scene, Integration::Accuracy(1e-3), 1, &mut |_| ()).expect("a run");
    let mut bench = Bench::new();
    bench.instrument.store(&outcome.shot.captures);
    let waveform = &outcome.shot.captures[0].waveform;
    let codes: Vec<String> = waveform.codes.iter().map(ToString::to_string).collect();
    bench.tell(&format!("DATA:SOU {};ENC ASCI", waveform.source));
    assert_eq!(bench.ask("CURVE?"), codes.join(","));
    assert_eq!(bench.ask("TRIG:STATE?"), "SAVE");
}

/// Two connections share the instrument; headers and terminators are each one's own.
#[test]
fn connections_share_the_instrument() {
    let mut bench = Bench::new();
    let mut other = Session::new(Preferences::new(true));
    bench.tell("CH1:COUP AC;:HEADER OFF");
    let reply = other.receive(&mut bench.instrument, b"CH1:COUP?\n");
    assert_eq!(reply, Reply::Now(b":CH1:COUPLING AC\n".to_vec()));
}
