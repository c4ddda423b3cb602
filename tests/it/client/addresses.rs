//! Wrong addresses, and what is no scope.

use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::process::Command;
use std::thread;

use crate::vxi11::words;

fn refused(arguments: &[&str]) -> String {
    let mut hertzscope = Command::new(env!("CARGO_BIN_EXE_hertzscope"));
    let output = hertzscope.args(arguments).output().expect("a program");
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    String::from_utf8(output.stderr).expect("text")
}

#[test]
fn wrong_addresses_say_what_to_type() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("day.mcap");
    let file = file.to_str().expect("a path");
    for (address, words) in [
        ("tcp://scope", "names no host with a port: type e.g. tcp://127.0.0.1:5025"),
        ("magnet-0.61g", "names no host with a port"),
        ("serial:/dev/nowhere", "No such file or directory"),
        ("serial:/dev/null", "cannot be opened"),
        ("/dev/usbtmc_nowhere", "no such device file"),
        ("USB0::0xFFFF::0x0001::INSTR", "no such instrument on USB"),
        ("USB0::tek::INSTR", "names no maker and model: type e.g. /dev/usbtmc0"),
    ] {
        let told = refused(&["acquire", address, "-o", file]);
        assert!(told.contains(words), "{told}");
    }
    assert!(refused(&["acquire", "tcp://127.0.0.1:1", "-o", "day.csv"]).contains(".mcap"));
    assert!(refused(&["compare", "tcp://scope", "magnet-0.61g"]).contains("type e.g. tcp://"));
    let told = refused(&["compare", "tcp://127.0.0.1:1", "magnet-0.61g"]);
    assert!(told.contains("cannot be opened: Connection refused"), "{told}");
    assert!(!std::path::Path::new(file).exists());
}

/// A VXI-11 server without the program refuses each call (RFC 5531: accepted, status 1).
#[test]
fn a_refused_procedure_call_is_reported() {
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let number = port.local_addr().expect("an address").port();
    thread::spawn(move || {
        for mut client in port.incoming().map_while(Result::ok) {
            let mut head = [0; 4];
            while client.read_exact(&mut head).is_ok() {
                let length = u32::from_be_bytes(head) & 0x7FFF_FFFF;
                let mut call = vec![0; usize::try_from(length).expect("short")];
                client.read_exact(&mut call).expect("a call");
                let reply = [words(&[0x8000_0018]), call[..4].to_vec(), words(&[1, 0, 0, 0, 1])];
                client.write_all(&reply.concat()).expect("a client");
            }
        }
    });
    let address = format!("TCPIP::127.0.0.1,{number}::inst0::INSTR");
    let said = refused(&["info", &address]);
    assert!(said.contains("a refused procedure call"), "{said}");
}
