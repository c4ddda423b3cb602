//! Many clients, and clients that come and go, at a server of its own process.

use std::io::Read as _;
use std::net::{Shutdown, TcpStream};

use super::process::Process;
use super::{IDENTITY, connect};

const CLIENTS: usize = 50;
const CURVES: usize = 200;
const CYCLES: usize = 1000;

/// 50 clients read 200 curves each, all the same bytes.
#[test]
fn fifty_clients_read_the_right_bytes() {
    let server = Process::start(&["magnet-0.61g"]);
    let mut first = connect(server.address);
    first.send(b"TRIG:MAI:MOD AUTO;:ACQ:STOPA SEQ;STATE ON;*OPC?\n");
    assert_eq!(first.line(), "1\n");
    let curve = |client: &mut super::Client| {
        client.send(b"CURVE?\n");
        let mut bytes = vec![0; 6 + 2500 + 1];
        client.stream.read_exact(&mut bytes).expect("a curve");
        bytes
    };
    let expected = curve(&mut first);
    assert!(expected.starts_with(b"#42500") && expected.ends_with(b"\n"));
    let (address, expected) = (server.address, &expected);
    std::thread::scope(|scope| {
        for _ in 0..CLIENTS {
            scope.spawn(move || {
                let mut client = connect(address);
                (0..CURVES).for_each(|_| assert!(curve(&mut client) == *expected, "a wrong byte"));
            });
        }
    });
}

/// Clients come, ask and are gone, each in another way; sockets, threads and memory are as before.
#[cfg(target_os = "linux")]
#[test]
fn clients_that_come_and_go_leave_nothing() {
    let server = Process::start(&["magnet-0.61g"]);
    let process = format!("/proc/{}", server.child.id());
    let number = |field: &str| -> usize {
        let status = std::fs::read_to_string(format!("{process}/status")).expect("a process");
        let line = status.lines().find(|line| line.starts_with(field)).expect("a field");
        line.split_whitespace().nth(1).expect("a number").parse().expect("a number")
    };
    let sockets = || std::fs::read_dir(format!("{process}/fd")).expect("a process").count();
    let cycles = |count: usize| {
        for cycle in 0..count {
            // None may be refused for want of room: the server sees ends as fast as beginnings.
            let mut client = connect(server.address);
            match cycle % 4 {
                0 => {}
                1 => client.send(b"CURVE #42500abc"),
                2 => client.send(b"*IDN?\nSET?\nCURVE?\n"),
                _ => assert_eq!(client.ask("*IDN?"), IDENTITY),
            }
            if cycle % 2 == 0 {
                let _ = client.stream.get_mut().shutdown(Shutdown::Both);
            }
        }
        // The last ones are gone when the server has no more sockets than it had with nobody but
        // the one who asks.
        let quiet = || -> TcpStream {
            let mut client = connect(server.address);
            assert_eq!(client.ask("*IDN?"), IDENTITY);
            client.stream.into_inner()
        };
        for _ in 0..1000 {
            let client = quiet();
            let now = sockets();
            drop(client);
            if now <= 16 {
                return now;
            }
        }
        sockets()
    };
    let before = (cycles(100), number("Threads:"), number("VmRSS:"));
    let after = (cycles(CYCLES), number("Threads:"), number("VmRSS:"));
    println!("sockets, threads, kB before {before:?}, after {after:?}");
    assert!(after.0 <= 16, "{} open files", after.0);
    assert_eq!(after.1, before.1, "threads");
    // A connection that left its buffers would leave 1000 times some kilobytes.
    assert!(after.2 < before.2 + 1000, "{} kB after {} kB", after.2, before.2);
}
