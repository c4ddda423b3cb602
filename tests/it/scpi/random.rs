//! Bytes that nobody meant.

use super::bench::model;
use hertzscope::instrument::{Instrument, Signals};
use hertzscope::scpi::{Preferences, Session, tree};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

fn runner(cases: u32) -> TestRunner {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}

/// Sends the bytes as one piece, lets time pass, resumes.
fn survive(instrument: &Instrument, bytes: &[u8]) {
    let mut instrument = instrument.clone();
    let mut session = Session::new(Preferences::new(true));
    session.receive(&mut instrument, bytes);
    session.end_of_message(&mut instrument);
    let signals = Signals {
        interval: 1e-6,
        automatic: 3,
        volts: vec![vec![1.0; 10]],
        shot: 1,
        ..Signals::default()
    };
    instrument.accept_signals(&signals);
    instrument.advance(1e3);
    session.resume(&mut instrument);
    session.receive(&mut instrument, b"\n*CLS;:SET?;*IDN?\n");
}

#[test]
fn random_bytes_never_panic() {
    let instrument = Instrument::new(model(), 0.0, 1);
    runner(300)
        .run(&proptest::collection::vec(any::<u8>(), 0..200), |bytes| {
            survive(&instrument, &bytes);
            Ok(())
        })
        .expect("no panic");
}

/// Real headers with arguments that may be anything.
#[test]
fn random_arguments_never_panic() {
    let instrument = Instrument::new(model(), 0.0, 1);
    let headers: Vec<String> = tree::rows()
        .map(|row| {
            row.header.replace("<wfm>", "MATH").replace("REF<x>", "REFB").replace("<x>", "2")
        })
        .collect();
    let argument = prop_oneof![
        any::<f64>().prop_map(|value| format!("{value:e}")),
        (-10_i32..3000).prop_map(|value| value.to_string()),
        Just("ON".to_owned()),
        Just("CH1,REFA".to_owned()),
        Just("\"FFT(CH1)\"".to_owned()),
        Just("#15hello".to_owned()),
        "[ -~]{0,12}",
    ];
    let unit = (proptest::sample::select(headers), any::<bool>(), argument);
    runner(300)
        .run(&proptest::collection::vec(unit, 1..12), |units| {
            let text: Vec<String> = units
                .iter()
                .map(|(header, asks, argument)| match asks {
                    true => format!(":{header}?").replace(":*", "*"),
                    false => format!(":{header} {argument}").replace(":*", "*"),
                })
                .collect();
            survive(&instrument, text.join(";").as_bytes());
            Ok(())
        })
        .expect("no panic");
}
