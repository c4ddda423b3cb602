//! The VXI-11 protocol without a network. Numbers are those of VXI-11 (1995), appendix C, and of
//! RFC 5531 and 1833.

use std::sync::MutexGuard;

use hertzscope::hislip::MessageType;
use hertzscope::server::{MAX_LINKS_OF_CONNECTION, Protocol};
use hertzscope::vxi11::port_mapper;

use crate::hislip::partner::{self, Fake};

const CORE: u32 = 0x0006_07AF;
const ABORT: u32 = 0x0006_07B0;
/// Procedures.
const CREATE_LINK: u32 = 10;
const WRITE: u32 = 11;
const READ: u32 = 12;
const READ_STB: u32 = 13;
const TRIGGER: u32 = 14;
const CLEAR: u32 = 15;
const LOCK: u32 = 18;
const UNLOCK: u32 = 19;
const ENABLE_SRQ: u32 = 20;
const DO_COMMAND: u32 = 22;
const DESTROY_LINK: u32 = 23;
const CREATE_INTERRUPT: u32 = 25;
const DESTROY_INTERRUPT: u32 = 26;
/// Flags.
const WAIT: u32 = 1;
const END: u32 = 8;
const TERMINATOR: u32 = 128;

pub fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_be_bytes()).collect()
}

/// Bytes with their length before them, filled up to a word.
pub fn opaque(bytes: &[u8]) -> Vec<u8> {
    let length = u32::try_from(bytes.len()).expect("short");
    let mut out = [&words(&[length]), bytes].concat();
    out.resize(out.len().next_multiple_of(4), 0);
    out
}

pub fn call(program: u32, version: u32, procedure: u32, arguments: &[u8]) -> Vec<u8> {
    [words(&[7, 0, 2, program, version, procedure, 0, 0, 0, 0]), arguments.to_vec()].concat()
}

fn record(message: &[u8]) -> Vec<u8> {
    let length = u32::try_from(message.len()).expect("short");
    [&words(&[0x8000_0000 | length]), message].concat()
}

/// Clients of an instrument that writes everything down.
struct Lab {
    hislip: partner::Lab,
}

impl Lab {
    fn new() -> Self {
        Self { hislip: partner::Lab::new(4711) }
    }

    fn fake(&self) -> MutexGuard<'_, Fake> {
        self.hislip.network.device()
    }

    fn connect(&mut self) -> usize {
        self.hislip.network.connect(Protocol::Vxi11)
    }

    fn bytes(&mut self, at: usize, bytes: &[u8]) {
        self.hislip.network.send(at, bytes);
    }

    /// Time passes until `now` (s).
    fn wait_until(&mut self, now: f64) {
        self.hislip.network.wait_until(now);
    }

    /// All that a connection was sent since the last look.
    fn sent(&mut self, at: usize) -> Vec<u8> {
        self.hislip.network.settle();
        self.hislip.network.received(at)
    }

    fn is_closed(&self, at: usize) -> bool {
        self.hislip.network.is_closed(at)
    }

    fn send(&mut self, at: usize, procedure: u32, arguments: &[u8]) {
        self.bytes(at, &record(&call(CORE, 1, procedure, arguments)));
    }

    /// The results of one call: what stands behind record, number, reply, accepted, empty verifier,
    /// success.
    #[track_caller]
    fn results(&mut self, at: usize) -> Vec<u8> {
        let sent = self.sent(at);
        let length = u32::try_from(sent.len() - 4).expect("short");
        let head = words(&[0x8000_0000 | length, 7, 1, 0, 0, 0, 0]);
        assert_eq!(sent[..28.min(sent.len())], head, "{sent:?}");
        sent[28..].to_vec()
    }

    #[track_caller]
    fn ask(&mut self, at: usize, procedure: u32, arguments: &[u8]) -> Vec<u8> {
        self.send(at, procedure, arguments);
        self.results(at)
    }

    /// A connection with a link, and the link's number.
    fn link(&mut self) -> (usize, u32) {
        let at = self.connect();
        (at, self.link_on(at))
    }

    fn link_on(&mut self, at: usize) -> u32 {
        let made = self.ask(at, CREATE_LINK, &[words(&[1, 0, 0]), opaque(b"inst0")].concat());
        assert_eq!(made[..4], words(&[0]), "no error");
        u32::from_be_bytes(made[4..8].try_into().expect("a word"))
    }

    #[track_caller]
    fn write(&mut self, (at, link): (usize, u32), flags: u32, text: &[u8]) {
        let written = self.ask(at, WRITE, &[words(&[link, 0, 0, flags]), opaque(text)].concat());
        assert_eq!(written, words(&[0, u32::try_from(text.len()).expect("short")]));
    }

    /// Error, reason and data of a read of at most `count` bytes that waits for `milliseconds`.
    fn read(
        &mut self,
        (at, link): (usize, u32),
        count: u32,
        milliseconds: u32,
    ) -> (u32, u32, Vec<u8>) {
        self.send(at, READ, &words(&[link, count, milliseconds, 0, 0, 0]));
        self.read_results(at)
    }

    #[track_caller]
    fn read_results(&mut self, at: usize) -> (u32, u32, Vec<u8>) {
        let results = self.results(at);
        let word = |n: usize| u32::from_be_bytes(results[4 * n..][..4].try_into().expect("a word"));
        let length = usize::try_from(word(2)).expect("short");
        assert_eq!(results.len(), 12 + length.next_multiple_of(4));
        (word(0), word(1), results[12..12 + length].to_vec())
    }
}

/// Byte for byte: link 0x8000, the abort channel's port 4711 = 0x1267, at most 65536 bytes a write.
#[test]
fn create_link_on_the_wire() {
    let mut lab = Lab::new();
    let at = lab.connect();
    let asked = b"\x80\0\0\x40\xca\xfe\0\x01\0\0\0\0\0\0\0\x02\0\x06\x07\xaf\0\0\0\x01\0\0\0\x0a\
        \0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x12\x34\x56\x78\0\0\0\0\0\0\x27\x10\0\0\0\x05inst0\0\0\0";
    // As a network may cut it.
    for byte in asked {
        lab.bytes(at, &[*byte]);
    }
    let answer = b"\x80\0\0\x28\xca\xfe\0\x01\0\0\0\x01\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\
        \0\0\0\0\0\0\x80\0\0\0\x12\x67\0\x01\0\0";
    assert_eq!(lab.sent(at), answer);
    assert_eq!(lab.fake().log, ["open 1"]);
    // The same in three fragments, one of them empty.
    let (one, two) = asked[4..].split_at(9);
    let length = u32::try_from(two.len()).expect("short");
    let parts = [&words(&[9]), one, &words(&[0]), &words(&[0x8000_0000 | length]), two].concat();
    lab.bytes(at, &parts);
    assert_eq!(lab.sent(at)[28..36], words(&[0, 0x8001]));
}

#[test]
fn a_query_is_read_in_parts() {
    let mut lab = Lab::new();
    let link = lab.link();
    lab.write(link, 0, b"one;tw");
    lab.write(link, END, b"o;three?");
    assert_eq!(lab.fake().log.last().map(String::as_str), Some("1: one;two;three?"));
    assert_eq!(lab.read(link, 4, 0), (0, 1, b"one;".to_vec()), "as many as asked for");
    lab.send(link.0, READ, &words(&[link.1, 100, 0, 0, TERMINATOR, u32::from(b';')]));
    assert_eq!(lab.read_results(link.0), (0, 2, b"two;".to_vec()), "up to the character");
    assert_eq!(lab.read(link, 6, 0), (0, 1 | 4, b"three\n".to_vec()), "the count, and the end");
    assert_eq!(lab.read(link, 6, 0), (15, 0, Vec::new()), "nothing in time");
}

/// A read waits for its time, or until the reply is there; calls behind it wait with it.
#[test]
fn a_read_waits_for_a_reply() {
    let mut lab = Lab::new();
    let link = lab.link();
    lab.wait_until(10.0);
    lab.write(link, END, b"later?");
    lab.send(link.0, READ, &words(&[link.1, 100, 500, 0, 0, 0]));
    lab.send(link.0, READ_STB, &words(&[link.1, 0, 0, 0]));
    lab.wait_until(10.4);
    assert_eq!(lab.sent(link.0), Vec::<u8>::new());
    lab.fake().reply(1, b"later\n");
    lab.wait_until(10.45);
    let sent = lab.sent(link.0);
    assert_eq!(sent[28..40], words(&[0, 4, 6]));
    assert_eq!(sent[52 + 24..], words(&[0, 0]), "the status byte behind it");
    lab.send(link.0, READ, &words(&[link.1, 100, 500, 0, 0, 0]));
    lab.wait_until(10.96);
    assert_eq!(lab.read_results(link.0), (15, 0, Vec::new()));
}

#[test]
fn another_message_interrupts_a_reply() {
    let mut lab = Lab::new();
    let link = lab.link();
    lab.write(link, END, b"one?");
    lab.write(link, END, b"two?");
    assert_eq!(lab.fake().log[2], "1 interrupted");
    assert_eq!(lab.read(link, 100, 0).2, b"two\n");
    lab.write(link, END, b"three?");
    assert_eq!(lab.ask(link.0, CLEAR, &words(&[link.1, 0, 0, 0])), words(&[0]));
    assert_eq!(lab.ask(link.0, TRIGGER, &words(&[link.1, 0, 0, 0])), words(&[0]));
    assert_eq!(lab.read(link, 100, 0).0, 15, "cleared");
    assert_eq!(lab.fake().log[5..], ["1 cleared", "1 triggers"]);
}

#[test]
fn the_abort_channel_ends_a_read() {
    let mut lab = Lab::new();
    let (link, other) = (lab.link(), lab.connect());
    lab.send(link.0, READ, &words(&[link.1, 100, 60_000, 0, 0, 0]));
    lab.bytes(other, &record(&call(ABORT, 1, 1, &words(&[link.1]))));
    assert_eq!(lab.results(other), words(&[0]));
    assert_eq!(lab.read_results(link.0), (23, 0, Vec::new()));
    lab.bytes(other, &record(&call(ABORT, 1, 1, &words(&[77]))));
    assert_eq!(lab.results(other), words(&[4]), "no such link");
}

/// A lock keeps other links and HiSLIP's sessions out, for as long as they wait for it.
#[test]
fn locks_bind_both_protocols() {
    let mut lab = Lab::new();
    let (one, two) = (lab.link(), lab.link());
    assert_eq!(lab.ask(one.0, LOCK, &words(&[one.1, 0, 0])), words(&[0]));
    assert_eq!(lab.ask(one.0, LOCK, &words(&[one.1, 0, 0])), words(&[11]), "held already");
    assert_eq!(lab.ask(two.0, UNLOCK, &words(&[two.1])), words(&[12]), "not held");
    let session = lab.hislip.client().asynchronous;
    let ask_lock = |lab: &mut Lab, request: bool| {
        let codes = (u8::from(request), 0);
        lab.hislip.send(session, MessageType::AsyncLock, codes, b"");
        lab.hislip.next(session).1
    };
    assert_eq!(ask_lock(&mut lab, true), 0, "a HiSLIP session");
    let write = |flags, timeout| [words(&[two.1, 0, timeout, flags]), opaque(b"two?")].concat();
    assert_eq!(lab.ask(two.0, WRITE, &write(END, 1000)), words(&[11, 0]), "does not wait");
    lab.send(two.0, WRITE, &write(END | WAIT, 1000));
    lab.wait_until(0.9);
    assert_eq!(lab.sent(two.0), Vec::<u8>::new());
    assert_eq!(lab.ask(one.0, UNLOCK, &words(&[one.1])), words(&[0]));
    assert_eq!(lab.results(two.0), words(&[0, 4]));
    // A HiSLIP session's lock.
    assert_eq!(ask_lock(&mut lab, true), 1);
    lab.send(two.0, LOCK, &words(&[two.1, WAIT, 1000]));
    lab.wait_until(1.95);
    assert_eq!(lab.results(two.0), words(&[11]), "the time is over");
    // A link that takes the lock as it is created, and gives it back with its connection.
    let late = lab.connect();
    lab.send(late, CREATE_LINK, &[words(&[1, 1, 1000]), opaque(b"inst0")].concat());
    assert_eq!(ask_lock(&mut lab, false), 1);
    lab.wait_until(2.0);
    assert_eq!(lab.results(late)[..4], words(&[0]));
    assert_eq!(lab.ask(two.0, LOCK, &words(&[two.1, 0, 0])), words(&[11]));
    lab.hislip.network.close(late);
    assert_eq!(lab.ask(two.0, LOCK, &words(&[two.1, 0, 0])), words(&[0]));
}

/// Interrupt channels are not offered; a new reason for service shows in the status byte until it
/// is polled.
#[test]
fn service_requests_show_in_the_status_byte() {
    let mut lab = Lab::new();
    let link = lab.link();
    let channel = words(&[0x0A00_0009, 999, 0x0006_07B1, 1, 0]);
    assert_eq!(lab.ask(link.0, CREATE_INTERRUPT, &channel), words(&[8]));
    assert_eq!(lab.ask(link.0, DESTROY_INTERRUPT, &[]), words(&[8]));
    let enable = [words(&[link.1, 1]), opaque(b"mine")].concat();
    assert_eq!(lab.ask(link.0, ENABLE_SRQ, &enable), words(&[8]));
    lab.hislip.network.set_status(true, 32);
    lab.wait_until(0.1);
    lab.wait_until(0.2);
    for byte in [32 | 64, 32] {
        let polled = lab.ask(link.0, READ_STB, &words(&[link.1, 0, 0, 0]));
        assert_eq!(polled, words(&[0, byte]), "bit 6 until it is polled");
    }
}

/// A device trigger may have a reply, which the next read brings.
#[test]
fn a_device_trigger_has_a_reply() {
    let mut lab = Lab::new();
    let link = lab.link();
    lab.fake().triggered = b"0;READY\n".to_vec();
    assert_eq!(lab.ask(link.0, TRIGGER, &words(&[link.1, 0, 0, 0])), words(&[0]));
    assert_eq!(lab.read(link, 100, 0), (0, 4, b"0;READY\n".to_vec()));
}

/// Data above the `maxRecvSize` that the link was told (64 KiB) are error 5, parameter error; the
/// link goes on.
#[test]
fn too_long_a_write_is_a_parameter_error() {
    let mut lab = Lab::new();
    let link = lab.link();
    for length in [64 * 1024 + 4, 70_000, 3_000_000] {
        let arguments = [words(&[link.1, 0, 0, END]), opaque(&vec![b'x'; length])].concat();
        assert_eq!(lab.ask(link.0, WRITE, &arguments), words(&[5, 0]), "{length}");
    }
    lab.write(link, END, b"alive?");
    assert_eq!(lab.read(link, 100, 0).2, b"alive\n");
}

/// Idle connections give way to new links, the one that has been idle for longest first; one that
/// calls or waits stays.
#[test]
fn idle_links_give_way() {
    let mut lab = Lab::new();
    let waits = lab.link();
    let idle: Vec<usize> = (0..4).map(|_| lab.connect()).collect();
    let create = [words(&[1, 0, 0]), opaque(b"inst0")].concat();
    for at in &idle {
        let links =
            if *at == idle[0] { MAX_LINKS_OF_CONNECTION - 1 } else { MAX_LINKS_OF_CONNECTION };
        (0..links).for_each(|_| _ = lab.link_on(*at));
    }
    assert_eq!(lab.ask(idle[3], CREATE_LINK, &create), words(&[9, 0, 0, 0]), "one has its share");
    lab.send(waits.0, READ, &words(&[waits.1, 1, 60_000, 0, 0, 0]));
    let new = lab.connect();
    assert_eq!(lab.ask(new, CREATE_LINK, &create), words(&[9, 0, 0, 0]), "none is idle yet");
    lab.wait_until(0.6);
    lab.ask(idle[0], 0, &[]);
    lab.wait_until(1.1);
    lab.link_on(new);
    assert!(lab.is_closed(idle[1]), "the oldest");
    assert!([waits.0, idle[0], idle[2], idle[3]].iter().all(|at| !lab.is_closed(*at)));
}

#[test]
fn links_have_names_owners_and_an_end() {
    let mut lab = Lab::new();
    let (at, other) = (lab.connect(), lab.link());
    let create = |name: &[u8]| [words(&[1, 0, 0]), opaque(name)].concat();
    assert_eq!(lab.ask(at, CREATE_LINK, &create(b"gpib0,7")), words(&[3, 0, 0, 0]));
    let links: Vec<u32> = (0..MAX_LINKS_OF_CONNECTION).map(|_| lab.link_on(at)).collect();
    assert_eq!(lab.ask(at, CREATE_LINK, &create(b"INST0")), words(&[9, 0, 0, 0]));
    assert_eq!(lab.ask(at, DESTROY_LINK, &words(&[other.1])), words(&[4]), "another client's");
    assert_eq!(lab.ask(at, READ_STB, &words(&[other.1, 0, 0, 0])), words(&[4, 0]));
    assert_eq!(lab.ask(at, DO_COMMAND, &words(&[links[0], 0])), words(&[8, 0]));
    assert_eq!(lab.ask(at, DESTROY_LINK, &words(&[links[0]])), words(&[0]));
    assert_eq!(lab.read((at, links[0]), 1, 0), (4, 0, Vec::new()));
    assert_eq!(lab.link_on(at), links[0]);
    lab.hislip.network.close(at);
    let closed = lab.fake().log.iter().filter(|line| line.starts_with("close ")).count();
    assert_eq!(closed, MAX_LINKS_OF_CONNECTION + 1, "all of its own, one of them twice");
}

/// Refusals of RFC 5531, section 9; the connection goes on.
#[test]
fn what_does_not_exist_is_refused() {
    let mut lab = Lab::new();
    let at = lab.connect();
    let mut refused = |message: &[u8]| {
        lab.bytes(at, &record(message));
        lab.sent(at)[4..].to_vec()
    };
    assert_eq!(refused(&call(CORE, 1, 0, &[])), words(&[7, 1, 0, 0, 0, 0]), "null");
    assert_eq!(refused(&call(100_003, 3, 1, &[])), words(&[7, 1, 0, 0, 0, 1]), "program");
    assert_eq!(refused(&call(CORE, 2, 10, &[])), words(&[7, 1, 0, 0, 0, 2, 1, 1]), "version");
    assert_eq!(refused(&call(CORE, 1, 21, &[])), words(&[7, 1, 0, 0, 0, 3]), "procedure");
    assert_eq!(refused(&call(CORE, 1, 12, &[0; 20])), words(&[7, 1, 0, 0, 0, 4]), "arguments");
    let short = [words(&[1, 0, 0, 0]), words(&[100])].concat();
    assert_eq!(refused(&call(CORE, 1, WRITE, &short)), words(&[7, 1, 0, 0, 0, 4]), "a length");
    assert_eq!(refused(&words(&[7, 0, 3, CORE, 1, 0, 0, 0, 0, 0])), words(&[7, 1, 1, 0, 2, 2]));
    assert!(!lab.is_closed(at));
}

/// What is no call, or too long to be passed over, ends its connection and no other.
#[test]
fn garbage_ends_its_own_connection() {
    let mut lab = Lab::new();
    let link = lab.link();
    let reply = words(&[7, 1, 0, 0, 0, 0]);
    let endless = [0x7F_u8, 0xFF, 0xFF, 0xFF];
    for bytes in [&b"GET / HTTP/1.1\r\n\r\n"[..], &record(&reply), &record(b""), &endless] {
        let at = lab.connect();
        lab.bytes(at, bytes);
        assert!(lab.is_closed(at) && lab.sent(at).is_empty(), "{bytes:?}");
    }
    // Many fragments, of which the last one comes late: a call that is none.
    let at = lab.connect();
    let fragment = [words(&[1024]), vec![0xFF; 1024]].concat();
    (0..70).for_each(|_| lab.bytes(at, &fragment));
    assert!(!lab.is_closed(at));
    lab.bytes(at, &record(b""));
    assert!(lab.is_closed(at));
    // A client that goes on sending while its call waits.
    let (at, number) = lab.link();
    lab.send(at, READ, &words(&[number, 1, 60_000, 0, 0, 0]));
    (0..70).for_each(|_| lab.bytes(at, &[0; 1024]));
    assert!(lab.is_closed(at));
    lab.write(link, END, b"alive?");
    assert_eq!(lab.read(link, 100, 0).2, b"alive\n");
}

#[test]
fn the_port_mapper_knows_the_port() {
    let ask = |version, procedure, arguments: &[u32]| {
        let asked = call(100_000, version, procedure, &words(arguments));
        port_mapper::answer(&asked, 4711).expect("a reply")
    };
    let port = |port| words(&[7, 1, 0, 0, 0, 0, port]);
    assert_eq!(ask(2, 3, &[CORE, 1, 6, 0]), port(4711));
    assert_eq!(ask(2, 3, &[CORE, 1, 17, 0]), port(0), "not over UDP");
    assert_eq!(ask(2, 3, &[100_003, 3, 6, 0]), port(0), "no such program");
    assert_eq!(ask(2, 0, &[]), words(&[7, 1, 0, 0, 0, 0]));
    let list = words(&[7, 1, 0, 0, 0, 0, 1, CORE, 1, 6, 4711, 1, ABORT, 1, 6, 4711, 0]);
    assert_eq!(ask(2, 4, &[]), list);
    // Later versions are told which one is spoken; nobody registers anything.
    assert_eq!(ask(4, 3, &[]), words(&[7, 1, 0, 0, 0, 2, 2, 2]));
    assert_eq!(ask(2, 1, &[CORE, 1, 6, 1]), words(&[7, 1, 0, 0, 0, 3]));
    assert_eq!(ask(2, 3, &[CORE]), words(&[7, 1, 0, 0, 0, 4]));
    assert_eq!(port_mapper::answer(b"no call", 4711), None);
}
