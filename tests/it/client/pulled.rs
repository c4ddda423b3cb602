//! Lines that are pulled out in mid-curve: nothing that is recorded is false.

use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::thread;
use std::time::Duration;

use hertzscope::client::{AcquisitionEvent, Address, ClientTiming, LineEvent};

use super::lines::{ByteTime, Failure, Pull, serial_port, socket, usb_device};
use super::{TIMING, assert_recorded, shots, struck};

/// From the first byte of the first curve to the last of the fourth; behind 2500 bytes only the end
/// of the line is missing.
const PULLS: [Pull; 10] = [
    (1, 0),
    (1, 1),
    (1, 2499),
    (2, 700),
    (2, 2500),
    (3, 1249),
    (3, 10),
    (4, 2000),
    (4, 2499),
    (4, 2500),
];

fn failures(events: &[AcquisitionEvent]) -> usize {
    events.iter().filter(|event| matches!(event, AcquisitionEvent::Line(LineEvent::Back))).count()
}

#[test]
fn a_socket_that_closes_ten_times_in_mid_curve() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.mcap");
    let server = struck(&own);
    let address = socket(server.address, PULLS.to_vec(), Failure::Closed, || ());
    let (taken, events) = shots(&Address::Socket(address.to_string()), TIMING, 3);
    drop(server);
    assert_recorded(&taken, &own);
    assert_eq!(failures(&events), 10, "{events:?}");
}

#[test]
fn a_socket_that_falls_silent() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.mcap");
    let server = struck(&own);
    let address = socket(server.address, PULLS[3..5].to_vec(), Failure::Silent, || ());
    let timing = ClientTiming { reply_timeout: Duration::from_millis(300), ..TIMING };
    let (taken, events) = shots(&Address::Socket(address.to_string()), timing, 2);
    drop(server);
    assert_recorded(&taken, &own);
    assert!(failures(&events) >= 2, "{events:?}");
    let is_silent = |event: &AcquisitionEvent| matches!(event, AcquisitionEvent::Line(LineEvent::Failed(why)) if why.contains("no reply within 0.3 s"));
    assert!(events.iter().any(is_silent), "{events:?}");
}

/// The rest of a curve comes when the line is back, and is not taken for the next reply.
#[test]
fn a_serial_line_that_is_pulled_out_ten_times_in_mid_curve() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.mcap");
    let server = struck(&own);
    let device = serial_port(server.address, folder.path(), ByteTime::at(19200), PULLS.to_vec());
    let (taken, events) = shots(&Address::Serial { device, baud: 19200 }, TIMING, 3);
    drop(server);
    assert_recorded(&taken, &own);
    assert!(failures(&events) >= 10, "{events:?}");
}

/// Nothing half-read is kept.
#[test]
fn a_usb_cable_that_is_pulled_out_ten_times_in_mid_curve() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.mcap");
    let server = struck(&own);
    let device = usb_device(server.address, folder.path(), PULLS.to_vec());
    let (taken, events) = shots(&Address::UsbFile(device), TIMING, 3);
    drop(server);
    assert_recorded(&taken, &own);
    assert!(failures(&events) >= 10, "{events:?}");
}

/// While the line is down somebody starts the scope: the channels that were read before are not
/// those that are there now.
#[test]
fn a_record_that_was_replaced_while_the_line_was_down_is_dropped() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.mcap");
    let server = struck(&own);
    let scope = server.address;
    let start_again = move || {
        let mut lab = crate::server::connect(scope);
        lab.send(b"ACQ:STATE RUN\n");
        assert_eq!(lab.ask("*OPC?"), "1\n");
    };
    let address = socket(scope, vec![(2, 1000)], Failure::Closed, start_again);
    let (taken, events) = shots(&Address::Socket(address.to_string()), TIMING, 2);
    drop(server);
    assert_recorded(&taken, &own);
    let dropped =
        AcquisitionEvent::Dropped("the scope took another record while its line was down");
    assert!(events.contains(&dropped), "{events:?}");
}

/// The command that arms the scope for the second shot is lost: the record of the first one, which
/// it still holds, is not recorded again.
#[test]
fn a_scope_that_was_not_armed_brings_no_second_record() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.mcap");
    let server = struck(&own);
    let scope = server.address;
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = port.local_addr().expect("an address");
    thread::spawn(move || {
        let mut armed = 0;
        for client in port.incoming().map_while(Result::ok) {
            let mut scope = TcpStream::connect(scope).expect("a scope");
            let (mut from, mut to) =
                (scope.try_clone().expect("one"), client.try_clone().expect("one"));
            thread::spawn(move || {
                let _ = std::io::copy(&mut from, &mut to);
                let _ = to.shutdown(Shutdown::Both);
            });
            for line in BufReader::new(client).lines().map_while(Result::ok) {
                armed += usize::from(line.contains("STATE RUN"));
                if armed == 2 {
                    armed += 1;
                    break;
                }
                scope.write_all(format!("{line}\n").as_bytes()).expect("a scope");
            }
            let _ = scope.shutdown(Shutdown::Both);
        }
    });
    let (taken, events) = shots(&Address::Socket(address.to_string()), TIMING, 3);
    drop(server);
    assert_recorded(&taken, &own);
    assert_eq!(failures(&events), 1, "{events:?}");
}
