//! Bytes that nobody meant.

use super::bench::model;
use hertzscope::instrument::{Accepted, Instrument, SampleWindow, Signals};
use hertzscope::scpi::{Preferences, Session, tree};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

fn runner(cases: u32) -> TestRunner {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}

/// A short pulse on the grid that the instrument wants now.
fn pulse(instrument: &Instrument) -> Signals {
    let SampleWindow { time_base, interval, .. } = instrument.sample_window();
    let (time_base, volts) = (Some(time_base), vec![vec![1.0; 10]]);
    Signals { time_base, interval, automatic: 3, volts, shot: 1, ..Signals::default() }
}

/// Sends the bytes as one piece, lets time pass, resumes.
fn survive(instrument: &Instrument, bytes: &[u8]) {
    let mut instrument = instrument.clone();
    let mut session = Session::new(Preferences::new(true));
    session.receive(&mut instrument, bytes);
    session.end_of_message(&mut instrument);
    let signals = pulse(&instrument);
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

/// Signals arrive that were made before the time base was turned, a set-up recalled or the
/// instrument reset. Once it took 40 GB to put the signals of 1 s/div on the grid of 5 ns/div. Now
/// they are dropped, and every record keeps the model's length.
#[test]
fn time_bases_turn_during_impacts() {
    let scale =
        (-90_i32..18).prop_map(|tenths| format!("{:e}", 10_f64.powf(f64::from(tenths) / 10.0)));
    let message = prop_oneof![
        (proptest::sample::select(vec!["MAI:SCA", "DEL:SCA", "MAI:POS", "DEL:POS"]), scale)
            .prop_map(|(header, value)| format!("HOR:{header} {value}")),
        proptest::sample::select(vec![
            "HOR:VIE WINDOW",
            "HOR:VIE MAIN",
            "RECA:SETU FACTORY",
            "SAV:SETU 1",
            "RECA:SETU 1",
            "*RST",
            "AUTOS EXEC",
            "ACQ:MOD PEAK",
            "ACQ:MOD SAM",
            "ACQ:MOD AVE",
            "ACQ:STATE RUN",
            "TRIG:MAI:MOD AUTO",
            "TRIG:MAI:MOD NORM",
            "BENC:IMP",
            "BENC:STRI:SPE 1",
        ])
        .prop_map(str::to_owned),
    ];
    let step = (proptest::collection::vec(message, 0..4), 0_i32..6);
    let model = model();
    let points = model.record_length;
    let fresh = Instrument::new(model, 0.0, 1);
    runner(300)
        .run(&proptest::collection::vec(step, 1..20), |steps| {
            let mut instrument = fresh.clone();
            let mut session = Session::new(Preferences::new(true));
            let mut now = 0.0;
            for (messages, wait) in steps {
                let signals = pulse(&instrument);
                let old = instrument.sample_window().time_base;
                session.receive(&mut instrument, format!("{}\n", messages.join("\n")).as_bytes());
                now += 10_f64.powi(wait - 3);
                instrument.advance(now);
                let accepted = instrument.accept_signals(&signals);
                let is_triggered = matches!(accepted, Accepted::Triggered { .. });
                prop_assert!(
                    !is_triggered || old == instrument.sample_window().time_base,
                    "{accepted:?}"
                );
                for record in instrument.take_finished().into_iter().flat_map(|done| done.records) {
                    prop_assert_eq!(record.codes.len(), points);
                }
            }
            Ok(())
        })
        .expect("no panic, and records of the model's length");
}
