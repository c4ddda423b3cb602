//! Two connections to one instrument: bytes of any kind, in pieces of any size, while time passes
//! and impacts come.
//!
//! The first byte of every piece says what happens: to whom the bytes go, whether the link ends the
//! message, a device clear, time, the start of an impact, or its signals at the inputs.

#![cfg_attr(not(test), no_main)]

use std::sync::LazyLock;

use hertzscope::instrument::{Instrument, Signals};
use hertzscope::scene::Scene;
use hertzscope::scpi::{MAXIMUM_REPLY, Preferences, Reply, Session};

static SCENE: LazyLock<Scene> = LazyLock::new(|| Scene::load("magnet-0.61g").expect("it ships"));

fn length(reply: Reply) -> usize {
    match reply {
        Reply::None => 0,
        Reply::Now(bytes) | Reply::WhenIdle(bytes) => bytes.len(),
    }
}

/// One input.
pub fn run(input: &[u8]) {
    let scene = &*SCENE;
    let mut instrument = Instrument::new(scene.scope.model.clone(), 0.02, 1);
    instrument.bench.scene.striker_mass = Some(1e-3);
    instrument.bench.scenes = vec![instrument.bench.scene.clone()];
    let mut sessions = [
        Session::new(Preferences::new(false)),
        Session::new(Preferences::new(true)).with_transcript(),
    ];
    let mut now = 0.0;
    let mut under_way: Option<Signals> = None;
    for piece in input.split(|byte| *byte == 0) {
        let Some((what, bytes)) = piece.split_first() else { continue };
        let session = &mut sessions[usize::from(what & 1)];
        // A piece may hold many messages, each with a whole reply.
        let messages = 1 + bytes.iter().filter(|byte| matches!(byte, b'\n' | b'\r')).count();
        let reply = session.receive(&mut instrument, bytes);
        assert!(length(reply) <= messages * (MAXIMUM_REPLY + 20_000));
        match what >> 1 & 7 {
            0 => {
                length(session.end_of_message(&mut instrument));
            }
            1 => session.clear(),
            2 => {
                now += f64::from(*what) * 1e-3;
                instrument.advance(now);
            }
            3 => {
                let wanted = instrument.sample_window();
                assert!(wanted.interval > 0.0);
                let pulse = vec![(0..200).map(|n| f64::from(n - 100) * 0.05).collect()];
                under_way = Some(Signals {
                    time_base: Some(wanted.time_base),
                    interval: wanted.interval,
                    automatic: 100,
                    volts: pulse,
                    external: Vec::new(),
                    shot: 1,
                });
            }
            4 => session.interrupt(&mut instrument),
            // The impact arrives; settings may have changed since it began.
            5 => {
                if let Some(signals) = under_way.take() {
                    instrument.accept_signals(&signals);
                }
            }
            _ => {}
        }
        instrument.apply_panel();
        let _ = instrument.take_finished();
        for session in &mut sessions {
            length(session.resume(&mut instrument));
            let _ = session.take_transcript();
        }
    }
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
