//! Connections of all kinds to one VXI-11 server, whose instrument is the virtual oscilloscope, and
//! to its port mapper.
//!
//! Each step begins with two bytes: which of five connections it is about and what happens there
//! (bytes come, or a call with a sound record and header around them, or it is closed), and how
//! many bytes belong to it. Time passes between steps.

#![cfg_attr(not(test), no_main)]

use hertzscope::server::{MAX_LINKS, Protocol};
use hertzscope::vxi11::port_mapper;
use hertzscope::vxi11::procedure::{ABORT_PROGRAM, CORE_PROGRAM};
use hertzscope::vxi11::rpc::{MAX_RECORD, record, words};

#[cfg(not(test))]
#[path = "../desk.rs"]
mod desk;
#[cfg(not(test))]
#[allow(dead_code, reason = "the tests use more of it")]
#[path = "../network.rs"]
mod network;
#[cfg(test)]
use super::{desk, network};
use desk::Desk;
use network::Network;

/// One input.
pub fn run(input: &[u8]) {
    let mut network = Network::<Desk>::new(1024);
    let mut now = 0.0;
    let mut slots = [None; 5];
    let mut rest = input;
    while let [what, length, tail @ ..] = rest {
        let (bytes, tail) = tail.split_at(usize::from(*length).min(tail.len()));
        rest = tail;
        let slot = usize::from(what % 5);
        let at = *slots[slot].get_or_insert_with(|| network.connect(Protocol::Vxi11));
        match what / 5 % 4 {
            0 => network.send(at, bytes),
            1 => {
                network.close(at);
                slots[slot] = None;
            }
            // A sound call: its procedure from the first byte, the others are the arguments; link
            // numbers begin at 0x8000.
            _ => {
                let [procedure, arguments @ ..] = bytes else { continue };
                let program = if *procedure == 1 { ABORT_PROGRAM } else { CORE_PROGRAM };
                let head = words(&[7, 0, 2, program, 1, u32::from(*procedure), 0, 0, 0, 0]);
                let message = [&head, arguments].concat();
                network.send(at, &record(&message));
            }
        }
        if let Some(reply) = port_mapper::answer(bytes, 1024) {
            assert!(reply.len() >= 20, "a reply has a header");
        }
        now += 0.01;
        network.wait_until(now);
        network.device().resume(now);
        network.settle();
        for slot in &mut slots {
            let Some(at) = *slot else { continue };
            let received = network.received(at);
            assert!(received.len() <= 2 * MAX_RECORD + (1 << 20), "a reply has an end");
            if network.is_closed(at) {
                *slot = None;
            }
        }
        assert!(network.device().sessions() <= MAX_LINKS);
    }
    slots.into_iter().flatten().for_each(|at| network.close(at));
    assert!(network.device().sessions() == 0, "every link ends with its connection");
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
