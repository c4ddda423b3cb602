//! Registers and events.

use super::bench::Bench;

/// What a real instrument answers after power on.
#[test]
fn after_power_on() {
    let mut bench = Bench::switched_on();
    bench.tell("HEADER ON");
    bench.transcript(&[
        ("allev?", ":ALLEV 1,\"No events to report - new events pending *ESR?\""),
        ("*esr?", "128"),
        ("allev?", ":ALLEV 401,\"Power on; \""),
        ("allev?", ":ALLEV 0,\"No events to report - queue empty\""),
        ("*esr?", "0"),
    ]);
}

#[test]
fn events_wait_for_the_register_to_be_read() {
    let mut bench = Bench::new();
    bench.tell("FOO?");
    bench.transcript(&[
        ("EVENT?", "1"),
        ("EVM?", "1,\"No events to report - new events pending *ESR?\""),
        ("*ESR?", "32"),
        ("EVQ?", "1"),
        ("EVM?", "113,\"Undefined header; \""),
        ("EVENT?", "0"),
    ]);
    bench.tell("FOO?;CH1:COUP XY");
    bench.transcript(&[
        ("*ESR?", "48"),
        ("ALLE?", "113,\"Undefined header; \",224,\"Illegal parameter value; \""),
    ]);
    // Reading the register again drops what was released and not read.
    bench.tell("FOO?");
    bench.transcript(&[("*ESR?", "32"), ("*ESR?", "0"), ("EVENT?", "0")]);
}

#[test]
fn enabled_events_show_in_the_status_byte() {
    let mut bench = Bench::new();
    bench.tell("*ESE 32;*SRE 32");
    bench.transcript(&[("*ESE?;*SRE?;DESE?;*PSC?", "32;32;255;1"), ("*STB?", "0")]);
    bench.tell("FOO?");
    bench.transcript(&[
        ("*STB?", "96"),
        ("CH1:COUP?;*STB?", "DC;112"),
        ("*ESR?", "32"),
        ("*STB?", "0"),
    ]);
}

#[test]
fn events_that_are_not_enabled_do_not_happen() {
    let mut bench = Bench::new();
    bench.tell("DESE 16;FOO?");
    bench.transcript(&[("*ESR?", "0"), ("EVENT?", "0")]);
    bench.tell("CH1:COUP XY");
    bench.transcript(&[("*ESR?", "16"), ("EVENT?", "224"), ("DESE?", "16")]);
}

#[test]
fn the_queue_ends_in_an_overflow() {
    let mut bench = Bench::new();
    let capacity = bench.instrument.model.event_queue;
    for _ in 0..3 * capacity {
        bench.tell("FOO?");
    }
    assert_eq!(bench.ask("*ESR?"), "32");
    let events = bench.ask("ALLEV?");
    assert_eq!(events.matches("113,").count(), capacity - 1);
    assert!(events.ends_with(",350,\"Queue overflow; \""), "{events}");
}

#[test]
fn clearing_forgets_events() {
    let mut bench = Bench::new();
    bench.tell("FOO?;*CLS");
    bench.transcript(&[("*ESR?", "0"), ("EVENT?", "0")]);
}

#[test]
fn self_tests_pass() {
    let mut bench = Bench::new();
    bench.transcript(&[("*TST?", "0"), ("*CAL?", "0"), ("DIA:RESU:FLA?", "PASS")]);
}

/// `*CLS` forgets events that were released as well (programmer manual, `*CLS`: the event queue).
#[test]
fn clear_forgets_released_events() {
    let mut bench = Bench::new();
    bench.tell("FOO");
    assert_eq!(bench.ask("*ESR?"), "32");
    bench.tell("*CLS");
    bench.transcript(&[("EVENT?", "0"), ("EVQ?", "0"), ("*ESR?", "0")]);
}

/// A device trigger runs what `*DDT` says, replies included, and leaves a message alone that has
/// begun (IEEE 488.2, group execute trigger).
#[test]
fn a_device_trigger_answers_beside_a_message() {
    use hertzscope::scpi::Reply;
    let mut bench = Bench::new();
    bench.tell("*DDT \"*STB?;:TRIG:MAI:MOD?\"");
    let begun = bench.session.receive(&mut bench.instrument, b"CH1:SCA 2");
    assert_eq!(begun, Reply::None);
    let triggered = bench.session.trigger(&mut bench.instrument);
    assert_eq!(triggered, Reply::Now(b"0;AUTO\n".to_vec()));
    bench.transcript(&[(";SCALE?", "2.0E0"), ("*ESR?", "0")]);
}
