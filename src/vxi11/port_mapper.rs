//! The port mapper, which tells clients on port 111 where a program listens: version 2, over TCP
//! and UDP. Source: RFC 1833, section 3.
//!
//! Clients that speak a later version first (rpcbind, 3 and 4) get the reply that
//! version 2 is supported. Programs cannot be registered or removed.

use super::procedure::{ABORT_PROGRAM, CORE_PROGRAM, VERSION};
use super::rpc::{Call, Refusal, XdrReader, words};

/// The port that clients ask at.
pub const PORT: u16 = 111;
/// Number of the program and its version.
const PROGRAM: u32 = 100_000;
const MAPPER_VERSION: u32 = 2;
/// Its procedures.
const NULL: u32 = 0;
const GET_PORT: u32 = 3;
const DUMP: u32 = 4;
/// Number of TCP among the protocols.
const TCP: u32 = 6;

/// The reply to a call in a datagram or record, where the VXI-11 server listens on `port`; none to
/// what is no call.
pub fn answer(message: &[u8], port: u16) -> Option<Vec<u8>> {
    let call = match Call::parse(message) {
        Ok(call) => call,
        Err(reply) => return reply,
    };
    let port = u32::from(port);
    let results = match (call.program, call.version, call.procedure) {
        (PROGRAM, MAPPER_VERSION, NULL) => Ok(Vec::new()),
        (PROGRAM, MAPPER_VERSION, GET_PORT) => {
            registered(call.arguments, port).ok_or(Refusal::Arguments)
        }
        // A list: another entry follows, program, version, protocol, port.
        (PROGRAM, MAPPER_VERSION, DUMP) => {
            let entry = |program| [1, program, VERSION, TCP, port];
            Ok(words(&[&entry(CORE_PROGRAM)[..], &entry(ABORT_PROGRAM), &[0]].concat()))
        }
        (PROGRAM, MAPPER_VERSION, _) => Err(Refusal::Procedure),
        (PROGRAM, ..) => Err(Refusal::Version(MAPPER_VERSION)),
        _ => Err(Refusal::Program),
    };
    Some(call.reply(results))
}

/// The port of the program that is asked for, 0 for one that is not here.
fn registered(mut arguments: XdrReader<'_>, port: u32) -> Option<Vec<u8>> {
    let (program, _version, protocol) = (arguments.word()?, arguments.word()?, arguments.word()?);
    let is_here = matches!(program, CORE_PROGRAM | ABORT_PROGRAM) && protocol == TCP;
    Some(words(&[if is_here { port } else { 0 }]))
}
