//! Connections of all kinds to one VXI-11 server, whose instrument is the virtual oscilloscope, and
//! to its port mapper.
//!
//! Each step begins with two bytes: which of five connections it is about and what happens there
//! (bytes come, or a call with a sound record and header around them, or it is closed), and how
//! many bytes belong to it. Time passes between steps.

#![cfg_attr(not(test), no_main)]

use hertzscope::vxi11::procedure::{ABORT_PROGRAM, CORE_PROGRAM};
use hertzscope::vxi11::rpc::{MAX_RECORD, record, words};
use hertzscope::vxi11::{MAX_LINKS, Vxi11Server, port_mapper};

#[cfg(not(test))]
#[path = "../desk.rs"]
mod desk;
#[cfg(test)]
use super::desk;
use desk::Desk;

/// One input.
pub fn run(input: &[u8]) {
    let mut desk = Desk::default();
    let mut server = Vxi11Server::new(1024);
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
            // A sound call: its procedure from the first byte, the others are the arguments; link
            // numbers begin at 0x8000.
            _ => {
                let [procedure, arguments @ ..] = bytes else { continue };
                let program = if *procedure == 1 { ABORT_PROGRAM } else { CORE_PROGRAM };
                let head = words(&[7, 0, 2, program, 1, u32::from(*procedure), 0, 0, 0, 0]);
                let message = [&head, arguments].concat();
                server.received(number, &record(&message), &mut desk);
            }
        }
        if let Some(reply) = port_mapper::answer(bytes, 1024) {
            assert!(reply.len() >= 20, "a reply has a header");
        }
        now += 0.01;
        for (session, reply) in desk.resume(now) {
            server.reply(session, &reply);
        }
        server.advance(now, &mut desk);
        for output in server.take_output() {
            assert!(output.bytes.len() <= 2 * MAX_RECORD + (1 << 20), "a reply has an end");
            if output.close {
                open[usize::try_from(output.connection).expect("a slot")] = false;
            }
        }
        assert!(desk.sessions() <= MAX_LINKS);
    }
    for slot in 0..5 {
        server.closed(slot, &mut desk);
    }
    assert!(desk.sessions() == 0, "every link ends with its connection");
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
