//! Clients and systems that mean no good: silent connections, web pages, full disks, signals.

use std::io::{BufRead as _, BufReader, Read as _};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use hertzscope::recording::mcap::read;

use super::process::Process;
use super::{IDENTITY, Server, connect};

/// A web page can have a browser send a POST request whose body holds commands: the connection is
/// closed at its first line.
#[test]
fn an_http_request_is_no_command() {
    let server = Server::at_rest();
    let mut witness = server.connect();
    let scale = witness.ask("CH1:SCALE?");
    for method in ["GET", "POST", "PUT", "HEAD", "OPTIONS", "DELETE"] {
        let mut client = server.connect();
        let request = format!(
            "{method} / HTTP/1.1\r\nHost: 127.0.0.1\r\nOrigin: http://evil.example\r\n\r\nCH1:SCALE 5\n*IDN?\n"
        );
        client.send(request.as_bytes());
        assert!(client.is_closed(), "{method}");
    }
    assert_eq!(witness.ask("CH1:SCALE?"), scale);
    // A command that begins alike is one.
    let mut client = server.connect();
    assert_eq!(client.ask("HEAD ON;:CH1:SCALE?"), format!(":CH1:SCALE {scale}"));
}

/// A server of its own process with what it says on standard error.
fn started(script: &str, arguments: &[&str]) -> (Child, std::net::SocketAddr) {
    let mut child = Command::new("sh")
        .args(["-c", &format!("{script} exec \"$0\" serve --listen 127.0.0.1:0 \"$@\"")])
        .arg(env!("CARGO_BIN_EXE_hertzscope"))
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a server");
    let mut line = String::new();
    let mut out = BufReader::new(child.stdout.as_mut().expect("a pipe"));
    out.read_line(&mut line).expect("a line");
    let address = line.trim_end().strip_prefix("listening on ").expect("an address");
    let address = address.parse().expect("an address");
    // The rest goes nowhere, and is short.
    (child, address)
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(sent.expect("kill").success());
}

fn end(mut child: Child) -> (Option<i32>, String) {
    let status = child.wait().expect("an end");
    let mut said = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut said).expect("text");
    (status.code(), said)
}

/// Where the recording cannot grow (a full disk, `ulimit -f`) the server says so and goes on; what
/// was recorded is not called whole.
#[cfg(unix)]
#[test]
fn a_full_disk_ends_the_recording_and_not_the_server() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.mcap");
    let name = file.display().to_string();
    let (child, address) = started("ulimit -f 64;", &["--record", &name]);
    let mut client = connect(address);
    // Curves fill 64 blocks of at most a kilobyte.
    for _ in 0..400 {
        client.send(b"DATA:ENC ASC;:TRIG:MAI:LEV 0.123;:SET?\n");
        assert!(client.line().contains("TRIGGER"));
        client.send(b"BENC:IMP\n");
        std::thread::sleep(Duration::from_millis(5));
        if std::fs::metadata(&file).expect("a recording").len() >= 32 * 1024 {
            break;
        }
    }
    std::thread::sleep(Duration::from_millis(1500));
    assert_eq!(client.ask("*IDN?"), IDENTITY, "it goes on");
    signal(&child, "-TERM");
    let (code, said) = end(child);
    assert!(said.contains("could not be written") && said.contains("goes on without it"), "{said}");
    assert_eq!(code, Some(2), "{said}");
    let set = read(&file).expect("what was recorded");
    assert!(set.problems.iter().any(|problem| !problem.is_empty()), "it does not look whole");
}

/// A log has a size limit: the server says so and goes on.
#[cfg(unix)]
#[test]
fn a_log_ends_at_its_size_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("serve.log");
    let arguments = [format!("--log={}", log.display()), "--size-limit=1".to_owned()];
    let arguments = arguments.each_ref().map(String::as_str);
    let (child, address) = started("", &arguments);
    let mut client = connect(address);
    let length = || std::fs::metadata(&log).expect("a log").len();
    // 150 bytes of log each; the limit is looked at once a second.
    while length() < 1_000_000 {
        assert_eq!(client.ask("*IDN?"), IDENTITY);
    }
    let mut before = 0;
    while length() > before {
        before = length();
        std::thread::sleep(Duration::from_millis(1100));
        assert_eq!(client.ask("*IDN?"), IDENTITY);
    }
    signal(&child, "-TERM");
    let (code, said) = end(child);
    assert!(said.contains("limit of 1000000 bytes") && said.contains("goes on"), "{said}");
    assert_eq!(code, Some(0));
}

/// A log whose reader has stopped (a script that never reads the pipe, a pager) holds up no client,
/// and signals end the server.
#[cfg(unix)]
#[test]
fn a_log_that_is_not_read_stops_nobody() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.mcap");
    let (mut child, address) = started("", &["--log", "--record", &file.display().to_string()]);
    let mut client = connect(address);
    // 200 bytes of log for each: many times what a pipe holds.
    for _ in 0..5000 {
        assert_eq!(client.ask("*IDN?"), IDENTITY);
    }
    assert_eq!(connect(address).ask("*IDN?"), IDENTITY);
    signal(&child, "-TERM");
    assert_eq!(child.wait().expect("an end").code(), Some(0));
    assert_eq!(read(&file).expect("a recording").problems, [""; 0]);
}

/// A terminal that is closed ends the recording as Ctrl-C does.
#[cfg(unix)]
#[test]
fn a_hang_up_finishes_the_recording() {
    for name in ["-HUP", "-TERM", "-INT"] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("lab.mcap");
        let (child, address) = started("", &["--record", &file.display().to_string()]);
        assert_eq!(connect(address).ask("*IDN?"), IDENTITY);
        signal(&child, name);
        let (code, said) = end(child);
        assert_eq!((code, said.as_str()), (Some(0), ""), "{name}");
        assert_eq!(read(&file).expect("a recording").problems, [""; 0], "{name}");
    }
}

/// One recording has one writer: the second session gets a file of its own, and `run` refuses the
/// name while the session goes on.
#[cfg(unix)]
#[test]
fn two_sessions_do_not_share_a_recording() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.mcap");
    let name = file.display().to_string();
    let (one, first) = started("", &["--record", &name]);
    let (two, second) = started("", &["--record", &name]);
    assert_eq!(connect(first).ask("*IDN?"), IDENTITY);
    assert_eq!(connect(second).ask("ID?;"), "TEK/TDS 2014,CF:91.1CT,FV:v4.12 TDS2CM:CMV:v1.04\n");
    let refused = Command::new(env!("CARGO_BIN_EXE_hertzscope"))
        .args(["run", "-q", "--accuracy", "1e-3", "-o", &name])
        .output()
        .expect("a run");
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("another process"), "{said}");
    for child in [one, two] {
        signal(&child, "-TERM");
        assert_eq!(end(child).0, Some(0));
    }
    let commands = |file: &std::path::Path| {
        let set = read(file).expect("a recording");
        assert_eq!(set.problems, [""; 0]);
        String::from_utf8_lossy(&set.lines[0].bytes).into_owned()
    };
    assert_eq!(commands(&file), "*IDN?");
    assert_eq!(commands(&folder.path().join("lab-2.mcap")), "ID?;");
}

/// No reply waits for a simulation or for what becomes of its signals, on the fastest time bases
/// either: while an impact is under way, replies say that it is not there yet.
#[test]
fn no_reply_waits_for_an_impact() {
    let server = Process::start(&["magnet-0.61g"]);
    let mut client = connect(server.address);
    client.send(b"HOR:SCA 5E-8;:ACQ:STATE RUN\n");
    let mut replies = 0;
    for impact in 0..20 {
        client.send(b"BENC:IMP\n");
        let before = format!("{impact}\n");
        while client.ask("BENC:IMP?") == before {
            replies += 1;
        }
    }
    println!("{replies} replies during 20 impacts");
    assert!(replies >= 20, "{replies} replies during 20 impacts");
}

/// Time of `SET?`, which writes a hundred settings, over that of `*IDN?`: 9 to 12 were measured.
const LARGEST_RATIO: u32 = 40;

/// A kilobyte of `SET?` takes little longer than `*IDN?` does: no set-up is built again and again
/// for it.
#[test]
fn a_set_up_is_told_quickly() {
    let server = Process::start(&["magnet-0.61g"]);
    let mut client = connect(server.address);
    // The best of many: other tests run beside it.
    let mut best = |query: &str| {
        let told = client.ask(query);
        let mut round = || {
            let began = Instant::now();
            client.send(format!("{query}\n").repeat(200).as_bytes());
            (0..200).for_each(|_| assert_eq!(client.line(), told));
            began.elapsed() / 200
        };
        (0..30).map(|_| round()).min().expect("rounds")
    };
    let (identity, set_up) = (best("*IDN?"), best("SET?"));
    println!("*IDN?: {identity:?}, SET?: {set_up:?}");
    assert!(set_up < LARGEST_RATIO * identity, "{set_up:?}, {identity:?}");
}
