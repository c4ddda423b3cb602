//! Connections of all kinds to one HiSLIP server, whose instrument is the virtual oscilloscope.
//!
//! Each step begins with two bytes: which of five connections it is about and what happens there
//! (bytes come, or a message with a sound header around them, or it is closed), and how many bytes
//! belong to it. Time passes between steps.

#![cfg_attr(not(test), no_main)]

use hertzscope::hislip::Server;
use hertzscope::hislip::message::MessageHeader;

#[cfg(not(test))]
#[path = "../desk.rs"]
mod desk;
#[cfg(test)]
use super::desk;
use desk::Desk;

/// One input.
pub fn run(input: &[u8]) {
    let mut desk = Desk::default();
    let mut server = Server::default();
    let mut now = 0.0;
    let mut open = [false; 5];
    let mut rest = input;
    while let [what, length, tail @ ..] = rest {
        let (bytes, tail) = tail.split_at(usize::from(*length).min(tail.len()));
        rest = tail;
        let slot = usize::from(what % 5);
        let number = slot as u64;
        if !open[slot] {
            server.opened(number);
            open[slot] = true;
        }
        match what / 5 % 4 {
            0 => server.received(number, bytes, &mut desk),
            1 => {
                server.closed(number, &mut desk);
                open[slot] = false;
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
                server.received(number, &message, &mut desk);
            }
        }
        now += 0.01;
        for (session, reply) in desk.resume(now) {
            server.reply(session, &reply);
        }
        server.advance(now, &mut desk);
        for output in server.take_output() {
            assert!(output.bytes.is_empty() || output.bytes.starts_with(b"HS"));
            let slot = usize::try_from(output.connection).expect("a slot");
            if output.close {
                open[slot] = false;
            }
        }
    }
    for slot in 0..5 {
        server.closed(slot, &mut desk);
    }
    assert!(desk.sessions() == 0, "every session ends with its connections");
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
