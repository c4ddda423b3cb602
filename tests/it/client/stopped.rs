//! Ctrl-C on a scope that does not finish its replies: the program ends within 0.3 s, and the scope
//! has its settings back.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::struck;
use crate::server::Server;

/// Time from Ctrl-C to the end of the program.
const STOP_LIMIT: Duration = Duration::from_millis(300);

/// An adapter before the scope at `server` that loses the last byte of each block of 2500.
fn lossy(server: SocketAddr) -> String {
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = port.local_addr().expect("an address").to_string();
    thread::spawn(move || {
        for client in port.incoming().map_while(Result::ok) {
            let mut scope = TcpStream::connect(server).expect("a scope");
            let (mut from, mut to) =
                (scope.try_clone().expect("one"), client.try_clone().expect("one"));
            thread::spawn(move || {
                let (mut tail, mut byte) = (Vec::new(), [0]);
                while from.read_exact(&mut byte).is_ok() {
                    tail.push(byte[0]);
                    if to.write_all(&byte).is_err() {
                        return;
                    }
                    if tail.ends_with(b"#42500") {
                        let mut block = vec![0; 2501];
                        let _ = from.read_exact(&mut block);
                        let _ = to.write_all(&block[..2499]);
                    }
                }
            });
            let mut client = client;
            let _ = std::io::copy(&mut client, &mut scope);
        }
    });
    address
}

/// Sends one byte of a reply every 0.2 s, without an end.
fn dripping() -> String {
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = port.local_addr().expect("an address").to_string();
    thread::spawn(move || {
        for mut client in port.incoming().map_while(Result::ok) {
            while client.write_all(b"T").is_ok() {
                thread::sleep(Duration::from_millis(200));
            }
        }
    });
    address
}

/// Starts the program, sends it Ctrl-C `after` its error output contains `words`, and returns the
/// time that it took to end.
fn interrupted(arguments: &[&str], words: Option<&str>) -> Duration {
    let folder = tempfile::tempdir().expect("a folder");
    let mut child = Command::new(env!("CARGO_BIN_EXE_hertzscope"))
        .args(arguments)
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a program");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    if let Some(words) = words {
        let found = lines.by_ref().map_while(Result::ok).any(|line| line.contains(words));
        assert!(found, "{arguments:?} never printed {words}");
    }
    // It waits for the reply now.
    thread::sleep(Duration::from_millis(500));
    assert!(child.try_wait().expect("a state").is_none(), "{arguments:?} has ended by itself");
    let started = Instant::now();
    let asked = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(asked.expect("kill").success());
    child.wait().expect("its end");
    started.elapsed()
}

/// The shortest of several times: other processes of the machine only make them longer.
fn fastest(mut take: impl FnMut() -> Duration) -> Duration {
    let mut shortest = take();
    for _ in 0..4 {
        if shortest >= STOP_LIMIT {
            shortest = shortest.min(take());
        }
    }
    shortest
}

/// What a client may find changed.
const SETTINGS: &str = ":ACQ:STOPA?;STATE?;:TRIG:MAI:MOD?";

#[test]
fn ctrl_c_in_the_middle_of_a_reply_restores_the_scope_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = struck(&folder.path().join("own.mcap"));
    let mut lab = server.connect();
    lab.send(b":TRIG:MAI:MOD AUTO\n");
    let before = lab.ask(SETTINGS);
    let took = interrupted(&["acquire", &lossy(server.address), "-o", "day.mcap"], Some("reading"));
    assert_eq!(lab.ask(SETTINGS), before);
    assert!(took < STOP_LIMIT, "{took:?}");
}

#[test]
fn ctrl_c_while_a_trigger_is_awaited_ends_at_once() {
    let server = Server::at_rest();
    let mut lab = server.connect();
    let before = lab.ask(SETTINGS);
    let address = server.address.to_string();
    let took = fastest(|| {
        let arguments = ["acquire", &address, "-o", "day.mcap"];
        let took = interrupted(&arguments, Some("waiting for a trigger"));
        assert_eq!(lab.ask(SETTINGS), before);
        took
    });
    assert!(took < STOP_LIMIT, "{took:?}");
}

/// One byte now and then is no reply: Ctrl-C ends each command that talks to a scope, and without
/// it the limit of a reply does.
#[test]
fn bytes_that_drip_do_not_hold_a_command() {
    let address = dripping();
    let prologix = format!("prologix://{address}?gpib=1");
    for arguments in [
        &["acquire", &address, "-o", "day.mcap"][..],
        &["info", &address],
        &["compare", &address, "magnet-0.61g"],
        &["info", &prologix],
    ] {
        let took = fastest(|| interrupted(arguments, None));
        assert!(took < STOP_LIMIT, "{arguments:?}: {took:?}");
    }
    let started = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_hertzscope")).args(["info", &address]).output();
    let output = output.expect("a program");
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("bytes came in"), "{said}");
    // 5 s, and the time of these bytes at 300 baud.
    assert!(started.elapsed() < Duration::from_secs(10), "{:?}", started.elapsed());
}

/// A program that starts a server and holds a pipe to it leaves none behind, however it ends.
#[test]
fn a_server_ends_with_the_program_that_holds_its_input() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_hertzscope"))
        .args(["serve", "--listen", "127.0.0.1:0", "--json", "--until-eof"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("a program");
    let mut line = String::new();
    BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut line).expect("a line");
    assert!(line.contains("listening"), "{line}");
    thread::sleep(Duration::from_millis(50));
    assert!(child.try_wait().expect("a state").is_none());
    drop(child.stdin.take());
    assert!(child.wait().expect("its end").success());
}
