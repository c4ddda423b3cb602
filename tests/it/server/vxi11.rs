//! VXI-11 on the wire: links, waiting reads, service requests and the port mapper of the served
//! scope.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream, UdpSocket};

use super::{IDENTITY, LIMIT, Server};
use crate::vxi11::{call, opaque, words};

const CORE: u32 = 0x0006_07AF;

/// One record, sent.
fn send(stream: &mut TcpStream, message: &[u8]) {
    let length = u32::try_from(message.len()).expect("short");
    let record = [&words(&[0x8000_0000 | length]), message].concat();
    stream.write_all(&record).expect("a server that listens");
}

/// One record, received.
fn receive(stream: &mut TcpStream) -> Vec<u8> {
    let mut head = [0; 4];
    stream.read_exact(&mut head).expect("a record");
    let length = usize::try_from(u32::from_be_bytes(head) & 0x7FFF_FFFF).expect("short");
    let mut record = vec![0; length];
    stream.read_exact(&mut record).expect("a record");
    record
}

struct Client {
    stream: TcpStream,
    link: u32,
}

impl Client {
    fn to(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).expect("a connection");
        stream.set_read_timeout(Some(LIMIT)).expect("a limit");
        let mut client = Self { stream, link: 0 };
        let made = client.call(10, &[words(&[1, 0, 0]), opaque(b"inst0")].concat());
        client.link = u32::from_be_bytes(made[4..8].try_into().expect("a word"));
        client
    }

    /// The results of a call.
    fn call(&mut self, procedure: u32, arguments: &[u8]) -> Vec<u8> {
        send(&mut self.stream, &call(CORE, 1, procedure, arguments));
        let reply = receive(&mut self.stream);
        assert_eq!(reply[..24], words(&[7, 1, 0, 0, 0, 0]));
        reply[24..].to_vec()
    }

    fn write(&mut self, text: &str) {
        let length = u32::try_from(text.len()).expect("short");
        let head = words(&[self.link, 10_000, 0, 8]);
        let written = self.call(11, &[head, opaque(text.as_bytes())].concat());
        assert_eq!(written, words(&[0, length]));
    }

    /// The reply to a query, read in parts until the end.
    fn ask(&mut self, text: &str) -> Vec<u8> {
        self.write(text);
        let mut reply = Vec::new();
        loop {
            let results = self.call(12, &words(&[self.link, 1000, 60_000, 0, 0, 0]));
            let word =
                |n: usize| u32::from_be_bytes(results[4 * n..][..4].try_into().expect("one"));
            assert_eq!(word(0), 0, "no error");
            reply.extend_from_slice(&results[12..][..usize::try_from(word(2)).expect("short")]);
            if word(1) & 4 != 0 {
                return reply;
            }
        }
    }
}

/// `device_remote` (16) locks the keys of the front panel, `device_local` (17) unlocks them.
#[test]
fn remote_and_local_lock_the_keys() {
    let server = Server::at_rest();
    let mut client = Client::to(server.vxi11);
    for (procedure, keys) in [(16, "ALL\n"), (17, "NONE\n")] {
        let arguments = words(&[client.link, 0, 0, 0]);
        assert_eq!(client.call(procedure, &arguments), words(&[0]));
        assert_eq!(String::from_utf8_lossy(&client.ask("LOCK?")), keys);
    }
}

/// A wait that an impact ends, and the curve as over the raw socket.
#[test]
fn a_single_shot_over_vxi11() {
    let server = Server::at_rest();
    let mut client = Client::to(server.vxi11);
    assert_eq!(client.ask("*IDN?"), IDENTITY.as_bytes());
    client.write("ACQ:STOPA SEQ;STATE ON;:BENC:IMP");
    assert_eq!(client.ask("*OPC?"), b"1\n");
    let curve = client.ask("DATA INIT;:CURVE?");
    assert!(curve.starts_with(b"#42500") && curve.len() == 2507);
    let mut raw = server.connect();
    raw.send(b"CURVE?\n");
    let mut same = vec![0; 2507];
    raw.stream.read_exact(&mut same).expect("a curve");
    assert_eq!(curve, same);
    let mut bad = TcpStream::connect(server.vxi11).expect("a connection");
    bad.write_all(b"GET / HTTP/1.1\r\n\r\n").expect("a server that listens");
    assert_eq!(bad.read(&mut [0]).unwrap_or(0), 0, "closed");
    assert_eq!(client.ask("*IDN?"), IDENTITY.as_bytes());
}

/// `*OPC` after an impact: the status byte says so, once.
#[test]
fn an_impact_asks_for_service() {
    let server = Server::at_rest();
    let mut client = Client::to(server.vxi11);
    client.write("*CLS;*ESE 1;*SRE 32;:ACQ:STOPA SEQ;STATE ON;*OPC;:BENC:IMP");
    let poll = |client: &mut Client| client.call(13, &words(&[client.link, 0, 0, 0]));
    while poll(&mut client) == words(&[0, 0]) {}
    assert_eq!(client.ask("*STB?"), b"96\n");
    assert_eq!(poll(&mut client), words(&[0, 32]), "polled before");
}

/// A device clear drops a reply that a fault delays.
#[test]
fn a_device_clear_drops_a_late_reply() {
    let faults = vec!["late=100ms*1".parse().expect("a fault")];
    let options = hertzscope::server::ServerOptions { faults, ..Default::default() };
    let server = Server::with(options);
    let mut client = Client::to(server.vxi11);
    client.write("*IDN?");
    assert_eq!(client.call(15, &words(&[client.link, 0, 0, 0])), words(&[0]));
    // Nothing to read within 300 ms: error 15.
    let read = client.call(12, &words(&[client.link, 1000, 300, 0, 0, 0]));
    assert_eq!(read[..4], words(&[15]));
    assert_eq!(client.ask("*OPC?"), b"1\n");
}

/// Over TCP and UDP, and after a call that is none.
#[test]
fn the_port_mapper_answers() {
    let server = Server::at_rest();
    let asked = call(100_000, 2, 3, &words(&[CORE, 1, 6, 0]));
    let expected = words(&[7, 1, 0, 0, 0, 0, u32::from(server.vxi11.port())]);
    let mut stream = TcpStream::connect(server.mapper).expect("a connection");
    for _ in 0..2 {
        send(&mut stream, &asked);
        assert_eq!(receive(&mut stream), expected);
    }
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    socket.set_read_timeout(Some(LIMIT)).expect("a limit");
    socket.send_to(b"no call", server.mapper).expect("sent");
    socket.send_to(&asked, server.mapper).expect("sent");
    let mut buffer = [0; 100];
    let length = socket.recv(&mut buffer).expect("a reply");
    assert_eq!(buffer[..length], expected);
}
