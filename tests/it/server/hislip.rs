//! HiSLIP on the wire: sessions, locks, device clear and service requests against the served scope.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};

use hertzscope::hislip::{DecodedPiece, Decoder, MessageType, write};

use super::{IDENTITY, LIMIT, Server};

/// One connection.
struct Link {
    stream: TcpStream,
    decoder: Decoder,
}

impl Link {
    fn to(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).expect("a connection");
        stream.set_read_timeout(Some(LIMIT)).expect("a limit");
        Self { stream, decoder: Decoder::default() }
    }

    fn send(&mut self, kind: MessageType, control: u8, parameter: u32, payload: &[u8]) {
        let mut bytes = Vec::new();
        write(kind, control, parameter, payload, &mut bytes);
        self.stream.write_all(&bytes).expect("a server that listens");
    }

    /// The next message; none when the server has closed the connection.
    fn next(&mut self) -> Option<(MessageType, u8, u32, Vec<u8>)> {
        loop {
            match self.decoder.next_piece() {
                Some(DecodedPiece::Message(header, payload)) => {
                    let kind = MessageType::from_code(header.code).expect("a known kind");
                    return Some((kind, header.control, header.parameter, payload));
                }
                Some(piece) => panic!("{piece:?}"),
                None => {}
            }
            let mut buffer = [0; 4096];
            match self.stream.read(&mut buffer) {
                Ok(length) if length > 0 => self.decoder.push(&buffer[..length]),
                _ => return None,
            }
        }
    }

    /// A message of this kind.
    #[track_caller]
    fn expect(&mut self, kind: MessageType) -> (u8, u32, Vec<u8>) {
        let (found, control, parameter, payload) = self.next().expect("a message");
        assert_eq!(found, kind);
        (control, parameter, payload)
    }
}

struct Client {
    sync: Link,
    asynchronous: Link,
    identifier: u32,
    delivered: u8,
}

impl Client {
    fn to(address: SocketAddr) -> Self {
        let mut sync = Link::to(address);
        sync.send(MessageType::Initialize, 0, 0x0100_7878, b"hislip0");
        let (_, parameter, _) = sync.expect(MessageType::InitializeResponse);
        let mut asynchronous = Link::to(address);
        asynchronous.send(MessageType::AsyncInitialize, 0, parameter & 0xFFFF, b"");
        asynchronous.expect(MessageType::AsyncInitializeResponse);
        Self { sync, asynchronous, identifier: 0xFFFF_FF00, delivered: 0 }
    }

    fn tell(&mut self, text: &str) -> u32 {
        let identifier = self.identifier;
        self.sync.send(MessageType::DataEnd, self.delivered, identifier, text.as_bytes());
        self.identifier = identifier.wrapping_add(2);
        self.delivered = 0;
        identifier
    }

    /// The reply to a query, which carries the query's identifier.
    fn ask(&mut self, text: &str) -> String {
        let identifier = self.tell(text);
        let (_, parameter, payload) = self.sync.expect(MessageType::DataEnd);
        assert_eq!(parameter, identifier);
        self.delivered = 1;
        String::from_utf8(payload).expect("text")
    }
}

/// The raw socket and HiSLIP share one instrument; a message needs no line end.
#[test]
fn both_protocols_reach_the_same_instrument() {
    let server = Server::at_rest();
    let mut raw = server.connect();
    let mut client = Client::to(server.hislip);
    assert_eq!(client.ask("*IDN?"), IDENTITY);
    assert_eq!(client.ask("*IDN?\r\n"), IDENTITY);
    client.tell("CH1:SCALE 5");
    assert_eq!(client.ask("CH1:SCALE?"), "5.0E0\n");
    assert_eq!(raw.ask("CH1:SCALE?"), "5.0E0\n");
}

/// HiSLIP's trigger executes what `*DDT` holds, and its reply comes.
#[test]
fn a_trigger_executes_what_was_stored() {
    let server = Server::at_rest();
    let mut client = Client::to(server.hislip);
    client.tell("*DDT \"CH1:SCA 2;SCA?\"");
    let identifier = client.identifier;
    client.sync.send(MessageType::Trigger, 0, identifier, b"");
    let (_, parameter, payload) = client.sync.expect(MessageType::DataEnd);
    assert_eq!((parameter, payload), (identifier, b"2.0E0\n".to_vec()));
}

/// A wait that no impact ends is ended by a device clear; the replies after it are the right ones.
#[test]
fn a_device_clear_ends_a_wait() {
    let server = Server::at_rest();
    let mut client = Client::to(server.hislip);
    client.tell("ACQ:STOPA SEQ;STATE ON;*OPC?");
    client.asynchronous.send(MessageType::AsyncDeviceClear, 0, 0, b"");
    client.asynchronous.expect(MessageType::AsyncDeviceClearAcknowledge);
    client.sync.send(MessageType::DeviceClearComplete, 0, 0, b"");
    client.sync.expect(MessageType::DeviceClearAcknowledge);
    client.identifier = 0xFFFF_FF00;
    assert_eq!(client.ask("BUSY?"), "1\n");
}

/// `*OPC` after an impact: the event asks for service, and the record is there.
#[test]
fn an_impact_asks_for_service() {
    let server = Server::at_rest();
    let mut client = Client::to(server.hislip);
    client.tell("*CLS;*ESE 1;*SRE 32;:ACQ:STOPA SEQ;STATE ON;*OPC;:BENC:IMP");
    let (byte, ..) = client.asynchronous.expect(MessageType::AsyncServiceRequest);
    assert_eq!(byte, 32 | 64);
    client.asynchronous.send(MessageType::AsyncStatusQuery, 0, 0, b"");
    let (byte, ..) = client.asynchronous.expect(MessageType::AsyncStatusResponse);
    assert_eq!(byte, 32 | 64);
    assert_eq!(client.ask("*ESR?;:ACQ:STATE?;:BENC:IMP?"), "1;0;1\n");
}

/// A lock holds other sessions back until its holder is gone, however it goes.
#[test]
fn a_lock_ends_with_its_holder() {
    let server = Server::at_rest();
    let mut one = Client::to(server.hislip);
    let mut two = Client::to(server.hislip);
    one.asynchronous.send(MessageType::AsyncLock, 1, 0, b"");
    assert_eq!(one.asynchronous.expect(MessageType::AsyncLockResponse).0, 1);
    two.tell("*IDN?");
    two.asynchronous.send(MessageType::AsyncLock, 1, 60_000, b"");
    assert_eq!(one.ask("CH1:SCALE 2;SCALE?"), "2.0E0\n");
    drop(one);
    assert_eq!(two.asynchronous.expect(MessageType::AsyncLockResponse).0, 1);
    assert_eq!(two.sync.expect(MessageType::DataEnd).2, IDENTITY.as_bytes());
}

/// What is no HiSLIP is told so and closed; a session beside it goes on.
#[test]
fn garbage_ends_its_own_connection() {
    let server = Server::at_rest();
    let mut good = Client::to(server.hislip);
    let mut bad = Link::to(server.hislip);
    bad.stream.write_all(b"GET / HTTP/1.1\r\n\r\n").expect("a server that listens");
    let (code, ..) = bad.expect(MessageType::FatalError);
    assert_eq!(code, 1);
    assert_eq!(bad.next(), None);
    // Half a message, and gone.
    let mut half = Client::to(server.hislip);
    half.sync
        .stream
        .write_all(b"HS\x07\0\xff\xff\xff\0\0\0\0\0\0\0\xff\xffCURVE #4")
        .expect("room");
    drop(half);
    assert_eq!(good.ask("*IDN?"), IDENTITY);
}
