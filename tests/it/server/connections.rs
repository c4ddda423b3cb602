//! Connections: how many there are, who gives way to whom, and whose turn it is.

use hertzscope::hislip::{MessageType, write};
use hertzscope::server::{MAX_CONNECTIONS, MAX_CONNECTIONS_OF_PEER, Protocol};

use crate::fuzz_corpora::network::Network;
use crate::hislip::partner::Fake;

/// Whether a raw connection is answered.
fn answers(network: &mut Network<Fake>, at: usize) -> bool {
    network.send(at, b"who?\n");
    network.received(at) == b"who\n"
}

fn connect(network: &mut Network<Fake>, protocol: Protocol, count: usize) -> Vec<usize> {
    (0..count).map(|_| network.connect(protocol)).collect()
}

#[test]
fn connections_are_limited() {
    let mut network = Network::<Fake>::new(0);
    let own = connect(&mut network, Protocol::Raw, MAX_CONNECTIONS_OF_PEER);
    let refused = network.connect(Protocol::Raw);
    assert!(network.is_closed(refused), "an address has its share");
    let of_others = (MAX_CONNECTIONS_OF_PEER..MAX_CONNECTIONS)
        .map(|_| network.connect_from([127, 0, 0, 2], Protocol::Raw))
        .collect::<Vec<_>>();
    let refused = network.connect_from([127, 0, 0, 3], Protocol::Raw);
    assert!(network.is_closed(refused), "the server is full");
    assert!(own.iter().chain(&of_others).all(|at| answers(&mut network, *at)));
    network.close(own[5]);
    let next = network.connect_from([127, 0, 0, 3], Protocol::Raw);
    assert!(answers(&mut network, next), "the place is free again");
}

/// Connections that say nothing give way to those that come, the oldest first; whoever talks stays.
#[test]
fn the_oldest_idle_connection_gives_way() {
    let mut network = Network::<Fake>::new(0);
    let at = connect(&mut network, Protocol::Raw, MAX_CONNECTIONS_OF_PEER);
    network.wait_until(2.0);
    assert!(answers(&mut network, at[0]));
    let new = connect(&mut network, Protocol::Raw, 3);
    assert!(new.iter().all(|at| answers(&mut network, *at)));
    let closed: Vec<usize> = at.iter().copied().filter(|at| network.is_closed(*at)).collect();
    assert_eq!(closed, at[1..4], "the oldest three, but for the one that talks");
}

/// Ends of lines alone keep no connection.
#[test]
fn chatty_connections_give_way() {
    let mut network = Network::<Fake>::new(0);
    let chatty = connect(&mut network, Protocol::Raw, MAX_CONNECTIONS_OF_PEER);
    for tenths in 0..20 {
        network.wait_until(1.0 + f64::from(tenths) / 10.0);
        for at in &chatty {
            network.send(*at, b"\n");
        }
    }
    let new = network.connect(Protocol::Raw);
    assert!(answers(&mut network, new));
}

/// A client that waits for a reply is not idle.
#[test]
fn who_waits_for_a_reply_keeps_the_place() {
    let mut network = Network::<Fake>::new(0);
    let waits = network.connect(Protocol::Raw);
    network.send(waits, b"later?\n");
    let silent = connect(&mut network, Protocol::Raw, MAX_CONNECTIONS_OF_PEER - 1);
    network.wait_until(10.0);
    network.connect(Protocol::Raw);
    assert!(!network.is_closed(waits) && network.is_closed(silent[0]));
    network.device().reply(1, b"later\n");
    network.wait_until(12.0);
    assert_eq!(network.received(waits), b"later\n");
    network.connect(Protocol::Raw);
    assert!(network.is_closed(waits), "it has its reply and says nothing");
}

/// Silent connections to the port mapper and to VXI-11 keep nobody out; the port mapper's end after
/// ten seconds.
#[test]
fn silent_connections_of_all_protocols_give_way() {
    for protocol in [Protocol::PortMapper, Protocol::Vxi11, Protocol::Hislip] {
        let mut network = Network::<Fake>::new(0);
        let silent = connect(&mut network, protocol, MAX_CONNECTIONS_OF_PEER);
        let refused = network.connect(Protocol::Raw);
        assert!(network.is_closed(refused), "{protocol:?}");
        network.wait_until(1.5);
        let new = network.connect(Protocol::Raw);
        assert!(answers(&mut network, new), "{protocol:?}");
        network.wait_until(11.5);
        let is_open = silent.iter().any(|at| !network.is_closed(*at));
        assert_eq!(is_open, protocol == Protocol::Vxi11, "{protocol:?}");
    }
}

/// The two connections of a HiSLIP session are idle together, and give way together.
#[test]
fn a_session_gives_way_with_both_connections() {
    let mut network = Network::<Fake>::new(0);
    let message = |kind, parameter| {
        let mut bytes = Vec::new();
        write(kind, 0, parameter, b"", &mut bytes);
        bytes
    };
    let session = [network.connect(Protocol::Hislip), network.connect(Protocol::Hislip)];
    network.send(session[0], &message(MessageType::Initialize, 0x0100_0000));
    network.send(session[1], &message(MessageType::AsyncInitialize, 1));
    let silent = connect(&mut network, Protocol::Raw, MAX_CONNECTIONS_OF_PEER - 2);
    network.wait_until(2.0);
    network.send(session[1], &message(MessageType::AsyncStatusQuery, 0));
    network.connect(Protocol::Raw);
    assert!(network.is_closed(silent[0]) && !network.is_closed(session[0]), "it has spoken");
    network.wait_until(4.0);
    assert!(silent[1..].iter().all(|at| answers(&mut network, *at)));
    network.connect(Protocol::Raw);
    assert!(session.iter().all(|at| network.is_closed(*at)));
}

/// A client that does not read its replies is dropped after ten seconds, and is not read from
/// meanwhile; others are answered.
#[test]
fn who_does_not_read_is_dropped() {
    let mut network = Network::<Fake>::new(0);
    let (deaf, other) = (network.connect(Protocol::Raw), network.connect(Protocol::Raw));
    network.stop_reading(deaf);
    // Four replies fit into the stream's buffer.
    let long = format!("{}?\n", "x".repeat((1 << 18) - 2));
    (0..8).for_each(|_| network.send(deaf, long.as_bytes()));
    network.wait_until(5.0);
    assert!(answers(&mut network, other));
    assert!(!network.device().log.contains(&"close 1".to_owned()));
    network.wait_until(20.0);
    assert!(answers(&mut network, other));
    let log = network.device().log.clone();
    assert!(log.contains(&"close 1".to_owned()));
    assert_eq!(log.iter().filter(|line| line.starts_with("1: ")).count(), 5);
}

/// A client that sends a hundred messages at once waits for the others between them.
#[test]
fn sessions_take_turns() {
    let mut network = Network::<Fake>::new(0);
    let (many, one) = (network.connect(Protocol::Raw), network.connect(Protocol::Raw));
    network.send_all(&[(many, &b"many\n".repeat(100)), (one, b"one\n")]);
    let log = network.device().log.clone();
    assert_eq!(log.len(), 2 + 101);
    let place = log.iter().position(|line| line == "2: one").expect("it is executed");
    assert!(place <= 4, "after two of the others at most, found {place} lines before it");
}

/// A browser's request in two pieces is closed before a command is read.
#[test]
fn an_http_request_in_pieces_is_no_command() {
    let mut network = Network::<Fake>::new(0);
    let page = network.connect(Protocol::Raw);
    network.send(page, b"PO");
    assert!(!network.is_closed(page));
    network.send(page, b"ST /x HTTP/1.1\r\n\r\nCH1:SCALE 5\n");
    assert!(network.is_closed(page));
    assert_eq!(network.device().log, ["open 1", "close 1"]);
}
