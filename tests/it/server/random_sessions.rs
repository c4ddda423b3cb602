//! Sessions of random messages over both protocols, and twenty clients that mean no good beside one
//! that only asks who is there.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use hertzscope::hislip::MessageHeader;
use hertzscope::scpi::tree;

use super::process::Process;
use super::{IDENTITY, LIMIT, connect};
use crate::vxi11::{call, opaque, words};

/// A small generator: the same messages each time (xorshift64*, Vigna 2016).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    fn pick<'a>(&mut self, choices: &[&'a str]) -> &'a str {
        choices[self.below(choices.len())]
    }
}

const ARGUMENTS: [&str; 28] = [
    "0",
    "1",
    "-1",
    "2.5",
    "1E-9",
    "5E-9",
    "1E-3",
    "50",
    "1E30",
    "-1E30",
    "2500",
    "ON",
    "OFF",
    "CH1",
    "CH2",
    "REFA",
    "MATH",
    "EXT5",
    "LINE",
    "CH1,REFB",
    "\"FFT(CH1)\"",
    "\"CH1 - CH2\"",
    "#15hello",
    "#42500",
    "1,2,3",
    "FACTORY",
    "AVE",
    "PEAK",
];

/// What turns the bench and the time base while the chain moves.
const LIVELY: [&str; 16] = [
    "BENC:IMP",
    "HOR:SCA 5E-9",
    "HOR:SCA 5E-8",
    "HOR:SCA 1",
    "HOR:SCA 50",
    "HOR:SCA 2.5E-4",
    "*RST",
    "RECA:SETU FACTORY",
    "TRIG:MAI:MOD AUTO",
    "ACQ:MOD PEAK",
    "ACQ:STATE RUN",
    "ACQ:STOPA SEQ",
    "BENC:STRI:SPE 1",
    "BENC:SCEN \"magnet-0.61g\"",
    "AUTOS EXEC",
    "HOR:POS 1E-2",
];

/// A message of up to four units from all subsystems.
fn message(random: &mut Random, headers: &[String]) -> String {
    let mut units = Vec::new();
    for _ in 0..=random.below(4) {
        let header = &headers[random.below(headers.len())];
        units.push(match random.below(4) {
            0 => random.pick(&LIVELY).to_owned(),
            1 => format!("{header} {}", random.pick(&ARGUMENTS)),
            _ => format!("{header}?"),
        });
    }
    units.join(";:").replace(":*", "*")
}

fn headers() -> Vec<String> {
    let filled =
        |header: &str| header.replace("<wfm>", "CH2").replace("REF<x>", "REFB").replace("<x>", "2");
    tree::rows().map(|row| filled(row.header)).collect()
}

fn dial(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).expect("a connection");
    stream.set_read_timeout(Some(Duration::from_millis(2))).expect("a limit");
    stream.set_write_timeout(Some(Duration::from_secs(1))).expect("a limit");
    stream
}

/// Sends and takes what there is; whether the server is still there.
fn exchange(stream: &mut TcpStream, bytes: &[u8]) -> bool {
    if stream.write_all(bytes).is_err() {
        return false;
    }
    let mut buffer = [0; 16384];
    !matches!(stream.read(&mut buffer), Ok(0))
}

/// Ends what a client sends, and waits until the server has executed it all and closes the
/// connection. A session that waits for an acquisition is left after a second.
fn leave(mut stream: TcpStream) {
    let left = Instant::now();
    let mut buffer = [0; 16384];
    if stream.shutdown(Shutdown::Write).is_err() {
        return;
    }
    while left.elapsed() < Duration::from_secs(1) {
        match stream.read(&mut buffer) {
            Err(reason) if matches!(reason.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
            }
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
    }
}

fn hislip_message(code: u8, control: u8, parameter: u32, payload: &[u8]) -> Vec<u8> {
    let length = payload.len() as u64;
    let mut bytes = MessageHeader { code, control, parameter, length }.bytes().to_vec();
    bytes.extend_from_slice(payload);
    bytes
}

/// Both connections of a session.
fn hislip_session(address: SocketAddr) -> Option<[TcpStream; 2]> {
    let mut synchronous = dial(address);
    synchronous.set_read_timeout(Some(Duration::from_secs(5))).ok()?;
    synchronous.write_all(&hislip_message(0, 0, 0x0100_0000, b"hislip0")).ok()?;
    let mut answer = [0; 16];
    synchronous.read_exact(&mut answer).ok()?;
    let session = u32::from(u16::from_be_bytes([answer[6], answer[7]]));
    synchronous.set_read_timeout(Some(Duration::from_millis(2))).ok()?;
    let mut asynchronous = dial(address);
    asynchronous.write_all(&hislip_message(17, 0, session, b"")).ok()?;
    Some([synchronous, asynchronous])
}

/// Random messages on a session: data, data ends, triggers, clears, locks, status queries.
fn random_hislip(
    random: &mut Random,
    address: SocketAddr,
    headers: &[String],
    goes_on: &dyn Fn() -> bool,
) {
    while goes_on() {
        let Some([mut synchronous, mut asynchronous]) = hislip_session(address) else { continue };
        for number in 0..40 {
            let text = message(random, headers);
            let (code, on) = match random.below(10) {
                0 => (12, 0),
                1 => (8, 0),
                2 => (random.below(256) as u8, 0),
                3 => (19, 1),
                4 => (4, 1),
                5 => (21, 1),
                _ => (7, 0),
            };
            let control = (random.below(2)) as u8;
            let bytes = hislip_message(code, control, 0xffff_ff00 + 2 * number, text.as_bytes());
            let stream = if on == 1 { &mut asynchronous } else { &mut synchronous };
            if !exchange(stream, &bytes) {
                break;
            }
        }
        leave(synchronous);
        leave(asynchronous);
    }
}

/// Where a server listens.
#[derive(Clone, Copy)]
struct Ports {
    raw: SocketAddr,
    hislip: SocketAddr,
    vxi11: SocketAddr,
    mapper: SocketAddr,
}

/// A server of all protocols.
fn started() -> (Process, Ports) {
    let arguments = ["magnet-0.61g", "--hislip", "0", "--vxi11", "0", "--port-mapper", "0"];
    let mut server = Process::start(&arguments);
    let mut port = |name: &str| -> SocketAddr {
        let line = server.told.next().expect("a line").expect("text");
        line.strip_prefix(name).map(str::parse).expect("a port").expect("an address")
    };
    let (hislip, vxi11) = (port("HiSLIP on "), port("VXI-11 on "));
    let mapper = port("port mapper on ");
    let ports = Ports { raw: server.address, hislip, vxi11, mapper };
    (server, ports)
}

/// An RPC call; whether its reply begins as one that was accepted, with the word `result`.
fn is_answered(stream: &mut TcpStream, message: &[u8], result: u32) -> bool {
    let length = u32::try_from(message.len()).expect("short");
    let mut reply = [0; 32];
    let sent = stream.write_all(&[&words(&[0x8000_0000 | length]), message].concat());
    sent.is_ok() && stream.read_exact(&mut reply).is_ok() && reply[28..] == words(&[result])
}

/// A new link.
fn is_linked(stream: &mut TcpStream) -> bool {
    let link = [words(&[1, 0, 0]), opaque(b"inst0")].concat();
    is_answered(stream, &call(CORE, 1, CREATE_LINK, &link), 0)
}

const CORE: u32 = 0x0006_07AF;
const CREATE_LINK: u32 = 10;

/// One client that means no good, of one of twelve kinds.
#[allow(clippy::too_many_lines, reason = "a few lines for each kind")]
fn abuse(kind: usize, seed: u64, ports: Ports, goes_on: &dyn Fn() -> bool) {
    let Ports { raw, hislip, vxi11, mapper } = ports;
    let headers = headers();
    let mut random = Random(0x9E37_79B9_7F4A_7C15 ^ seed);
    match kind {
        // Set-ups without end.
        0 => {
            while goes_on() {
                let mut stream = dial(raw);
                while goes_on() && exchange(&mut stream, "SET?\n".repeat(50).as_bytes()) {}
            }
        }
        // Curves that are never read.
        1 => {
            while goes_on() {
                let mut stream = dial(raw);
                while goes_on() && stream.write_all(&b"CURVE?\n".repeat(20)).is_ok() {}
            }
        }
        // A line without end.
        2 => {
            while goes_on() {
                let mut stream = dial(raw);
                while goes_on() && exchange(&mut stream, &[b'x'; 4096]) {}
            }
        }
        // Every command.
        3 => {
            while goes_on() {
                let mut stream = dial(raw);
                for _ in 0..100 {
                    let text = message(&mut random, &headers);
                    if !goes_on() || !exchange(&mut stream, format!("{text}\n").as_bytes()) {
                        break;
                    }
                }
                leave(stream);
            }
        }
        // Coming and going.
        4 => {
            while goes_on() {
                let mut stream = dial(raw);
                let _ = stream.write_all(b"*IDN?\nCURVE #42500abc");
            }
        }
        // A web page.
        5 => {
            while goes_on() {
                let mut stream = dial(raw);
                exchange(&mut stream, b"POST / HTTP/1.1\r\n\r\n*RST\n");
            }
        }
        // Silence.
        6 => {
            let _stream = dial(raw);
            while goes_on() {
                std::thread::sleep(Duration::from_millis(20));
            }
        }
        // Time bases that turn while the chain moves.
        7 => {
            while goes_on() {
                let mut stream = dial(raw);
                for _ in 0..200 {
                    let text = random.pick(&LIVELY);
                    std::thread::sleep(Duration::from_millis(2));
                    if !goes_on() || !exchange(&mut stream, format!("{text}\n").as_bytes()) {
                        break;
                    }
                }
                leave(stream);
            }
        }
        // Bytes that are no HiSLIP.
        8 => {
            while goes_on() {
                let mut stream = dial(hislip);
                let bytes: Vec<u8> = (0..200).map(|_| random.below(256) as u8).collect();
                exchange(&mut stream, &bytes);
            }
        }
        // As many links as one connection may have, and silence; anew when it had to give way.
        9 => {
            while goes_on() {
                let mut stream = dial(vxi11);
                while goes_on() && is_linked(&mut stream) {}
                while goes_on() && !matches!(stream.read(&mut [0]), Ok(0)) {
                    std::thread::sleep(Duration::from_millis(20));
                }
            }
        }
        // Silence at the port mapper.
        10 => {
            let _streams: Vec<_> = (0..10).map(|_| dial(mapper)).collect();
            while goes_on() {
                std::thread::sleep(Duration::from_millis(20));
            }
        }
        _ => random_hislip(&mut random, hislip, &headers, goes_on),
    }
}

/// A newcomer that tries until it is served.
fn is_served(address: SocketAddr, asks: impl Fn(&mut TcpStream) -> bool) -> bool {
    (0..1000).any(|_| {
        let mut stream = dial(address);
        stream.set_read_timeout(Some(LIMIT)).expect("a limit");
        let is_served = asks(&mut stream);
        if !is_served {
            std::thread::sleep(Duration::from_millis(20));
        }
        is_served
    })
}

/// Ends the abusers, also where their test fails: it would wait for them.
struct EndOnDrop<'a>(&'a AtomicBool);

impl Drop for EndOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Relaxed);
    }
}

/// Twelve kinds, for seconds; beside them one client asks who is there, and is answered as if it
/// were alone, and newcomers over all protocols are served.
#[test]
fn twenty_abusers_keep_nobody_waiting() {
    let (mut server, ports) = started();
    let raw = ports.raw;
    let goes_on = AtomicBool::new(true);
    let mut times = Vec::new();
    // Where all places are taken by live connections, a newcomer is closed at once: this client is
    // there before.
    let mut client = connect(raw);
    assert_eq!(client.ask("*IDN?"), IDENTITY);
    std::thread::scope(|scope| {
        let _end = EndOnDrop(&goes_on);
        for number in 0..20 {
            let goes_on = &goes_on;
            scope.spawn(move || {
                abuse(number % 12, number as u64, ports, &|| goes_on.load(Ordering::Relaxed));
            });
        }
        let began = Instant::now();
        while began.elapsed() < Duration::from_secs(8) {
            let asked = Instant::now();
            assert_eq!(client.ask("*IDN?"), IDENTITY);
            times.push(asked.elapsed());
            std::thread::sleep(Duration::from_millis(2));
        }
        assert!(is_served(raw, |stream| {
            let mut reply = [0; IDENTITY.len()];
            let asked = stream.write_all(b"*IDN?\n").and_then(|()| stream.read_exact(&mut reply));
            asked.is_ok() && reply == IDENTITY.as_bytes()
        }));
        assert!(is_served(ports.hislip, |_| hislip_session(ports.hislip).is_some()));
        assert!(is_served(ports.vxi11, is_linked));
        let asks = call(100_000, 2, 3, &words(&[CORE, 1, 6, 0]));
        let port = u32::from(ports.vxi11.port());
        assert!(is_served(ports.mapper, |stream| is_answered(stream, &asks, port)));
    });
    times.sort();
    let p99 = times[times.len() * 99 / 100];
    println!("{} replies, p99 {p99:?}, longest {:?}", times.len(), times[times.len() - 1]);
    assert!(server.child.try_wait().expect("a child").is_none(), "the server lives");
    // A time, which other tests change: `tests/run --full` runs this test alone.
    if std::env::var_os("HERTZSCOPE_LATENCY").is_some() {
        assert!(p99 < Duration::from_millis(50), "{p99:?}");
    }
}

/// Random messages from all subsystems over both protocols, the same each time: the server lives,
/// and measures afterwards.
#[test]
fn random_sessions_leave_a_scope_that_works() {
    let (mut server, ports) = started();
    let raw = ports.raw;
    let began = Instant::now();
    let goes_on = || began.elapsed() < Duration::from_secs(5);
    std::thread::scope(|scope| {
        for (number, kind) in [3, 3, 3, 7, 11, 11].into_iter().enumerate() {
            let goes_on = &goes_on;
            scope.spawn(move || abuse(kind, 1000 + number as u64, ports, goes_on));
        }
    });
    // Sessions that still wait for an acquisition have sent more, which may come between: the set-up
    // is made again where it was changed.
    let mut client = connect(raw);
    client.send(b"HEAD OFF\n");
    let measures = (0..100).any(|_| {
        client.send(
            b"*RST;*CLS;:HOR:SCA 2.5E-4;:CH1:SCA 1;:SEL:CH1 ON;:BENC:SCEN \"magnet-0.61g\"\n",
        );
        client.send(b"DATA INIT;:DATA:ENC ASC;:TRIG:MAI:MOD NORM;LEV 0.5\n");
        client.send(b"ACQ:MOD SAM;STOPA SEQ;STATE RUN;:BENC:IMP\n");
        let is_done = (0..200).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            client.ask("BUSY?") == "0\n"
        });
        let reply = client.ask("ACQ:STOPA?;NUMAC?;:CURVE?");
        let curve = reply.strip_prefix("SEQUENCE;1;");
        is_done && curve.is_some_and(|curve| curve.split(',').count() == 2500)
    });
    assert!(measures);
    assert!(server.child.try_wait().expect("a child").is_none(), "the server lives");
}
