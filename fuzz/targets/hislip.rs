//! Connections of all kinds to one HiSLIP server, whose instrument is the virtual oscilloscope.
//!
//! Each step begins with two bytes: which of five connections it is about and what happens there
//! (bytes come, or a message with a sound header around them, or it is closed), and how many bytes
//! belong to it. Time passes between steps.

#![cfg_attr(not(test), no_main)]

use hertzscope::hislip::MessageHeader;
use hertzscope::server::Protocol;

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
    let mut network = Network::<Desk>::new(0);
    let mut now = 0.0;
    let mut slots = [None; 5];
    let mut rest = input;
    while let [what, length, tail @ ..] = rest {
        let (bytes, tail) = tail.split_at(usize::from(*length).min(tail.len()));
        rest = tail;
        let slot = usize::from(what % 5);
        let at = *slots[slot].get_or_insert_with(|| network.connect(Protocol::Hislip));
        match what / 5 % 4 {
            0 => network.send(at, bytes),
            1 => {
                network.close(at);
                slots[slot] = None;
            }
            // A sound header: kind, control code and parameter from the bytes, the others are the
            // payload.
            _ => {
                let [code, control, parameter, payload @ ..] = bytes else { continue };
                let parameter = u32::from(*parameter);
                let length = payload.len() as u64;
                let header = MessageHeader { code: *code, control: *control, parameter, length };
                let mut message = header.bytes().to_vec();
                message.extend_from_slice(payload);
                network.send(at, &message);
            }
        }
        now += 0.01;
        network.wait_until(now);
        network.device().resume(now);
        network.settle();
        for slot in &mut slots {
            let Some(at) = *slot else { continue };
            let received = network.received(at);
            assert!(received.is_empty() || received.starts_with(b"HS"));
            if network.is_closed(at) {
                *slot = None;
            }
        }
    }
    slots.into_iter().flatten().for_each(|at| network.close(at));
    assert!(network.device().sessions() == 0, "every session ends with its connections");
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
