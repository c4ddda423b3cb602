//! The scope on the network. Every wait ends with an answer; the limits only end tests that have
//! failed.

mod abuse;
mod bench;
mod connections;
mod faults;
mod hislip;
mod libsigrok;
mod load;
mod process;
mod random_sessions;
mod recording;
mod transcripts;
mod vxi11;

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::process::Command;
use std::thread::JoinHandle;
use std::time::Duration;

use hertzscope::experiment::inputs::{InputWindow, inputs};
use hertzscope::experiment::{Integration, run};
use hertzscope::recording::mcap::{RecordingWriter, read};
use hertzscope::scene::Scene;
use hertzscope::server::{ServeError, ServerOptions, Sockets, serve};
use process::Process;
use tokio::sync::oneshot;

/// What a test waits for at most.
const LIMIT: Duration = Duration::from_secs(120);
/// `*IDN?` of the shipped TDS 2014.
const IDENTITY: &str = "TEKTRONIX,TDS 2014,0,CF:91.1CT FV:v4.12 TDS2CM:CMV:v1.04\n";

pub struct Server {
    pub address: SocketAddr,
    pub hislip: SocketAddr,
    pub vxi11: SocketAddr,
    mapper: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<Result<(), ServeError>>>,
}

impl Server {
    pub fn with(options: ServerOptions) -> Self {
        Self::serving(scene(), options, None)
    }

    fn of(scene: Scene) -> Self {
        Self::serving(scene, ServerOptions::default(), None)
    }

    pub fn serving(
        scene: Scene,
        options: ServerOptions,
        recording: Option<RecordingWriter>,
    ) -> Self {
        let port = || TcpListener::bind("127.0.0.1:0").expect("a port");
        let mapper = port();
        let datagrams = UdpSocket::bind(mapper.local_addr().expect("an address")).expect("a port");
        let port_mapper = Some((mapper, datagrams));
        let sockets =
            Sockets { raw: port(), hislip: Some(port()), vxi11: Some(port()), port_mapper };
        let address = sockets.raw.local_addr().expect("an address");
        let hislip = sockets.hislip.as_ref().expect("a port").local_addr().expect("an address");
        let vxi11 = sockets.vxi11.as_ref().expect("a port").local_addr().expect("an address");
        let mapper = sockets.port_mapper.as_ref().expect("one").0.local_addr().expect("an address");
        let (stop, stopped) = oneshot::channel::<()>();
        let stopped = async {
            let _ = stopped.await;
        };
        let thread =
            std::thread::spawn(move || serve(sockets, &scene, options, recording, stopped));
        Self { address, hislip, vxi11, mapper, stop: Some(stop), thread: Some(thread) }
    }

    pub fn at_rest() -> Self {
        Self::with(ServerOptions::default())
    }

    pub fn connect(&self) -> Client {
        connect(self.address)
    }
}

pub fn connect(address: SocketAddr) -> Client {
    let stream = TcpStream::connect(address).expect("a connection");
    stream.set_read_timeout(Some(LIMIT)).expect("a limit");
    stream.set_write_timeout(Some(LIMIT)).expect("a limit");
    Client { stream: BufReader::new(stream) }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.stop.take());
        let ended = self.thread.take().expect("one end").join();
        if !std::thread::panicking() {
            ended.expect("no panic").expect("a graceful end");
        }
    }
}

pub struct Client {
    stream: BufReader<TcpStream>,
}

impl Client {
    pub fn send(&mut self, bytes: &[u8]) {
        self.stream.get_mut().write_all(bytes).expect("a client that can write");
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        self.stream.read_line(&mut line).expect("a line");
        line
    }

    pub fn ask(&mut self, message: &str) -> String {
        self.send(format!("{message}\n").as_bytes());
        self.line()
    }

    /// Whether the server has closed the connection.
    fn is_closed(&mut self) -> bool {
        !matches!(self.stream.read(&mut [0]), Ok(1))
    }
}

pub fn scene() -> Scene {
    let mut scene = Scene::load("magnet-0.61g").expect("the default scene");
    scene.accuracy = 1e-3;
    scene
}

#[test]
fn the_identity_byte_for_byte() {
    let server = Server::at_rest();
    let mut client = server.connect();
    assert_eq!(client.ask("*IDN?"), IDENTITY);
    client.send(b"*ID");
    client.send(b"N?\r\n");
    assert_eq!(client.line(), IDENTITY);
}

/// Front panel as in the scene; settings are everybody's, headers each one's own.
#[test]
fn two_clients_share_the_instrument() {
    let server = Server::with(ServerOptions { header: true, ..ServerOptions::default() });
    let (mut one, mut two) = (server.connect(), server.connect());
    assert_eq!(one.ask("HEADER OFF;:CH1:SCALE?"), "1.0E0\n");
    let panel = one.ask("HOR:SCA?;:TRIG:MAI:MOD?;:SEL:CH1?;CH2?;CH3?;CH4?");
    let setup = scene().scope;
    let on: Vec<u8> = setup.channels.iter().map(|c| u8::from(c.is_some())).collect();
    let time_base = hertzscope::scope::set_up::nr3(setup.time_base);
    let [a, b, c, d] = on.try_into().expect("four channels");
    assert_eq!(panel, format!("{time_base};NORMAL;{a};{b};{c};{d}\n"));
    assert_eq!(one.ask("CH1:SCALE 2;SCALE?"), "2.0E0\n");
    assert_eq!(two.ask("CH1:SCALE?"), ":CH1:SCALE 2.0E0\n");
}

/// What a client has set of its connection is its own: headers, words, terminator, what it has
/// begun to send.
#[test]
fn a_new_client_starts_with_nothing_of_another() {
    let server = Server::at_rest();
    let mut one = server.connect();
    one.send(b"HEAD ON;VERB OFF;:RS232:TRAN:TERM CRLF;:CH1:SCA?\n");
    assert_eq!(one.line(), ":CH1:SCA 1.0E0\r\n");
    one.send(b":CH1:SCA 2;");
    let mut two = server.connect();
    assert_eq!(two.ask("CH1:SCA?"), "1.0E0\n");
    assert_eq!(two.ask("TRIG:MAI:EDGE:SLO?"), "RISE\n");
    assert_eq!(one.ask(":CH1:SCA?"), ":CH1:SCA 2.0E0\r\n");
}

#[test]
fn an_unknown_query_has_no_reply() {
    let server = Server::at_rest();
    let mut client = server.connect();
    client.send(b"*CLS\n:CH5:POSITION?\n");
    assert_eq!(client.ask("*ESR?"), "32\n");
    assert_eq!(client.ask("EVENT?"), "113\n");
}

/// The records that the scene itself gives for the shot that was caught, whichever that was.
#[test]
fn a_single_sequence_catches_an_impact() {
    let impact_every = Some(Duration::from_millis(20));
    let server = Server::with(ServerOptions { impact_every, ..ServerOptions::default() });
    let mut client = server.connect();
    client.send(b"ACQ:STOPA SEQ\nACQ:STATE ON\n");
    assert_eq!(client.ask("*OPC?"), "1\n");
    assert_eq!(client.ask("ACQ:STATE?;NUMACQ?"), "0;1\n");
    let scene = scene();
    let levels = |line: String| -> Vec<i16> {
        line.trim_end().split(',').map(|level| level.parse().expect("a level")).collect()
    };
    let mut records = Vec::new();
    for (number, channel) in (1_u8..).zip(&scene.scope.channels) {
        if channel.is_some() {
            records.push(levels(client.ask(&format!("DATA:SOU CH{number};ENC ASCI;:CURVE?"))));
        }
    }
    assert!(!records.is_empty());
    // Levels within round-off of a step between two may differ, two a record.
    let is_it = |shot: u32| {
        let outcome = run(&scene, Integration::Accuracy(1e-3), shot, &mut |_| ()).expect("a run");
        let captures = &outcome.shot.captures;
        let differ = |(a, b): (&Vec<i16>, &Vec<i16>)| {
            a.len() != b.len() || a.iter().zip(b).filter(|(a, b)| a != b).count() > 2
        };
        captures.len() == records.len()
            && !records.iter().zip(captures.iter().map(|c| &c.waveform.codes)).any(differ)
    };
    assert!((1..=40).any(is_it), "no shot gives these records");
}

#[test]
fn a_binary_curve_ends_with_one_terminator() {
    let server = Server::at_rest();
    let mut client = server.connect();
    let sequence = "HOR:SCA 1E-4;:TRIG:MAI:MOD AUTO;:ACQ:STOPA SEQ;STATE ON;*OPC?";
    assert_eq!(client.ask(sequence), "1\n");
    client.send(b"DATA:SOU CH1;ENC RPB;WIDTH 1;:CURVE?\n*OPC?\n");
    let mut reply = vec![0; 6 + 2500 + 3];
    client.stream.read_exact(&mut reply).expect("a block");
    assert!(reply.starts_with(b"#42500"));
    assert!(reply.ends_with(b"\n1\n"));
}

/// Gone in the middle of a block, gone before its answer, a megabyte without end, answers that
/// nobody reads.
#[test]
fn bad_clients_harm_nobody() {
    let server = Server::at_rest();
    let mut good = server.connect();
    let mut client = server.connect();
    client.send(b"CURVE #42500abc");
    drop(client);
    let mut client = server.connect();
    client.send(b"ACQ:STOPA SEQ;STATE ON;*OPC?\n");
    drop(client);
    let mut flood = server.connect();
    flood.send(&vec![b'x'; 1 << 20]);
    let mut deaf = server.connect();
    deaf.send("SET?\n".repeat(1000).as_bytes());
    assert_eq!(good.ask("*IDN?"), IDENTITY);
    flood.send(b"\n");
    assert_eq!(flood.ask("*IDN?"), IDENTITY);
    assert_eq!(good.ask("CH1:SCALE?"), "1.0E0\n");
    deaf.stream.get_mut().shutdown(Shutdown::Both).expect("an end");
    assert_eq!(good.ask("*IDN?"), IDENTITY);
}

/// `printf '...' | nc -N`: the client sends no more, and still gets the answer that waits for an
/// impact.
#[test]
fn who_sends_no_more_is_still_answered() {
    let server = Server::at_rest();
    let mut half = server.connect();
    half.send(b"ACQ:STOPA SEQ;STATE ON\n*OPC?\n");
    half.stream.get_mut().shutdown(Shutdown::Write).expect("half a connection");
    let mut other = server.connect();
    assert_eq!(other.ask("BENC:IMP;:ACQ:STOPA?"), "SEQUENCE\n");
    assert_eq!(half.line(), "1\n");
    assert!(half.is_closed());
    // One that waits for nothing is closed at once, with what it asked for.
    let mut done = server.connect();
    done.send(b"*IDN?\n*IDN?\nCH1:SCALE 5");
    done.stream.get_mut().shutdown(Shutdown::Write).expect("half a connection");
    assert_eq!((done.line(), done.line()), (IDENTITY.to_owned(), IDENTITY.to_owned()));
    assert!(done.is_closed());
    // Half a command is none.
    assert_eq!(other.ask("CH1:SCALE?"), "1.0E0\n");
}

#[test]
fn clients_are_closed_at_the_end() {
    let server = Server::at_rest();
    let mut client = server.connect();
    assert_eq!(client.ask("*IDN?"), IDENTITY);
    drop(server);
    assert!(client.is_closed());
}

/// However far a client moves the record away, an impact costs no more than so much.
#[test]
fn what_an_impact_costs_is_limited() {
    let mut scene = scene();
    scene.duration = 2e-4;
    let samples = |interval: f64, before: f64, after: f64| {
        let arrived = inputs(&scene, InputWindow { interval, before, after }, 1).expect("signals");
        assert!(arrived.contact <= arrived.volts[0].len());
        arrived.volts[0].len()
    };
    assert!((1_999_990..=2_000_000).contains(&samples(1e-9, 50.0, 50.0)));
    // Ten durations are 2 ms.
    assert!((1_990..=2_030).contains(&samples(1e-6, 0.0, 50.0)));
    assert!((1_200..=1_230).contains(&samples(1e-6, 1e-3, 0.0)));
}

/// At 50 ms/div with the trigger in the screen's centre, 250 ms pass before the scope is ready
/// after a setting; an impact whose signals arrive meanwhile waits for it.
#[test]
fn an_impact_during_a_change_of_scale_is_recorded() {
    let server = Server::at_rest();
    let mut client = server.connect();
    client.send(b":HOR:SCA 50E-3;POS 0;:TRIG:MAI:MOD NORM;:ACQ:STOPA SEQ;STATE RUN\n");
    while client.ask("TRIG:STATE?") != "READY\n" {
        std::thread::sleep(Duration::from_millis(5));
    }
    client.send(b":BENC:IMP;:CH2:SCA 2\n");
    assert_eq!(client.ask("*OPC?;:ACQ:NUMAC?;:CH2:SCA?"), "1;1;2.0E0\n");
}

/// A bench without a striker is driven: an impact is its signal.
#[test]
fn a_driven_bench_says_that_its_signal_plays() {
    let told = |arguments: &[&str]| {
        let mut server = Process::start(arguments);
        let mut lines = server.told.by_ref().map_while(Result::ok);
        lines.nth(1).expect("a line after the resource string")
    };
    assert_eq!(
        told(&["driven-dimer"]),
        "to drive    send BENCh:IMPact: the drive's signal plays once, from rest"
    );
    assert_eq!(told(&["gravity-0.61g"]), "to strike   send BENCh:IMPact");
}

/// Two lines on standard input are two impacts; its end is not the server's.
#[test]
fn enter_strikes_the_chain() {
    let mut server = Process::start(&["gravity-0.61g", "--impact-on-enter"]);
    let mut client = connect(server.address);
    let line = server.told.next().expect("a line").expect("text");
    assert_eq!(line, "Enter strikes the chain");
    // Answered only when the scope is ready: standard input is another way.
    assert_eq!(client.ask("ACQ:STOPA SEQ;STATE ON;STATE?"), "1\n");
    let mut keys = server.child.stdin.take().expect("a pipe");
    keys.write_all(b"\n").expect("a line");
    assert_eq!(client.ask("*OPC?"), "1\n");
    assert_eq!(client.ask("ACQ:STATE ON;:BENC:IMP?"), "1\n");
    keys.write_all(b"again\n").expect("a line");
    drop(keys);
    assert_eq!(client.ask("*OPC?"), "1\n");
    assert_eq!(client.ask("BENC:IMP?"), "2\n");
}

/// Who has read where it listens may end it at once: its recording is whole.
#[test]
#[cfg(unix)]
fn it_may_be_ended_as_soon_as_it_listens() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("served.mcap");
    for _ in 0..5 {
        let arguments = ["gravity-0.61g".as_ref(), "--record".as_ref(), file.as_os_str()];
        let mut server = Process::start(&arguments);
        let id = server.child.id().to_string();
        let asked = Command::new("kill").arg(id).status().expect("kill");
        assert!(asked.success() && server.child.wait().expect("an end").success());
        read(&file).expect("a recording");
    }
}

#[test]
fn the_command_says_where_it_listens() {
    let server = Process::start(&["gravity-0.61g", "--header", "on"]);
    assert_eq!(connect(server.address).ask("CH1:PROBE?"), ":CH1:PROBE 1\n");
}

/// Where it listens as JSON, and the log: connection, command, reply, error, fault and impact, each
/// with its time.
#[test]
#[cfg(unix)]
fn a_script_reads_where_it_listens_and_a_log_what_happens() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("serve.log");
    let mut child = Command::new(env!("CARGO_BIN_EXE_hertzscope"))
        .args(["serve", "--json", "--listen", "127.0.0.1:0", "--hislip", "0", "--vxi11", "0"])
        .args(["--fault", "cut=3*1", &format!("--log={}", file.display())])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .expect("a server");
    let mut line = String::new();
    let mut told = BufReader::new(child.stdout.take().expect("a pipe"));
    told.read_line(&mut line).expect("a line");
    let told: serde_json::Value = serde_json::from_str(&line).expect("JSON");
    let port = |name: &str| told[name].as_str().expect(name).rsplit_once(':').expect("a port").1;
    let resources = &told["resources"];
    assert_eq!(resources["socket"], format!("TCPIP::127.0.0.1::{}::SOCKET", port("listening")));
    assert_eq!(resources["hislip"], format!("TCPIP::127.0.0.1::hislip0,{}::INSTR", port("hislip")));
    assert_eq!(resources["vxi11"], format!("TCPIP::127.0.0.1,{}::inst0::INSTR", port("vxi11")));
    let mut client = connect(told["listening"].as_str().expect("text").parse().expect("one"));
    assert_eq!(client.ask("*IDN?\n*OPC?"), "TEK1\n");
    client.send(b"NONSENSE\n");
    assert_eq!(told["strike"], "BENCh:IMPact");
    client.send(b"BENCh:IMPact\n");
    while client.ask("BENCh:IMPact?") == "0\n" {}
    drop(client);
    let id = child.id().to_string();
    assert!(Command::new("kill").arg(id).status().expect("kill").success());
    assert!(child.wait().expect("an end").success());
    let log = std::fs::read_to_string(file).expect("a log");
    let found = [
        "opened",
        "> *IDN?",
        "* a fault disturbs TEKTRONIX,TDS 2014",
        "< 1",
        "> NONSENSE",
        "! 113 Undefined header",
        "bench  impact 1",
    ];
    let mut rest = log.as_str();
    for what in found {
        let (_, after) = rest.split_once(what).unwrap_or_else(|| panic!("{what} in {log}"));
        rest = after;
    }
    let is_known =
        |line: &str| [" s  raw 127.0.0.1:", " s  bench  "].iter().any(|who| line.contains(who));
    assert!(log.lines().all(is_known), "{log}");
}
