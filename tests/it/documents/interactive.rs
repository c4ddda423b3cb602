//! Commands that go on until they are told to stop.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use portable_pty::{CommandBuilder, PtySize, native_pty_system};

/// Serves on ports that are free until a client has been answered, and ends as `kill` asks for;
/// what it printed.
pub fn served(folder: &Path, arguments: &[&str]) -> Result<String, String> {
    let is_port = |word: &str| ["4880", "1024", "1111"].contains(&word);
    let free = arguments.iter().map(|word| if is_port(word) { "0" } else { word });
    let mut server = Command::new(env!("CARGO_BIN_EXE_hertzscope"))
        .arg("serve")
        .args(free)
        .args(["--listen", "127.0.0.1:0"])
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program");
    let mut lines = BufReader::new(server.stdout.take().expect("its output")).lines();
    let first = lines.next().and_then(Result::ok).unwrap_or_default();
    let mut printed = vec![first.clone()];
    if let Some(address) = first.strip_prefix("listening on ") {
        let mut client = TcpStream::connect(address).expect("a connection");
        client.set_read_timeout(Some(Duration::from_secs(60))).expect("a limit");
        client.write_all(b"*IDN?\n").expect("a query");
        let reply = BufReader::new(client).lines().next().expect("a reply").expect("a reply");
        assert!(reply.starts_with("TEKTRONIX,TDS 2014"), "{reply}");
    }
    let asked = Command::new("kill").arg(server.id().to_string()).status().expect("kill");
    printed.extend(lines.map_while(Result::ok));
    let status = server.wait().expect("its end");
    let printed = printed.join("\n");
    if asked.success() && status.success() {
        Ok(printed)
    } else {
        Err(format!("{status}: {printed}"))
    }
}

/// Does `act` while a scope is served that is struck again and again; it is told where.
pub fn with_scope<T>(folder: &Path, act: impl FnOnce(&str) -> T) -> T {
    let mut server = Command::new(env!("CARGO_BIN_EXE_hertzscope"))
        .args(["serve", "--listen", "127.0.0.1:0", "--impact-every", "100ms"])
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program");
    let mut lines = BufReader::new(server.stdout.take().expect("its output")).lines();
    let first = lines.next().and_then(Result::ok).unwrap_or_default();
    let done = act(first.strip_prefix("listening on ").expect("an address"));
    // It has done its work.
    let _ = server.kill();
    server.wait().expect("its end");
    done
}

/// Views in a terminal until the screen is there, then presses `q`; nothing, as screens are tested
/// elsewhere.
pub fn viewed(folder: &Path, arguments: &[&str]) -> Result<String, String> {
    let size = PtySize { rows: 24, cols: 80, pixel_width: 0, pixel_height: 0 };
    let pair = native_pty_system().openpty(size).expect("a pseudo-terminal");
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_hertzscope"));
    command.arg("view");
    command.args(arguments);
    command.cwd(folder);
    command.env("TERM", "xterm");
    let mut child = pair.slave.spawn_command(command).expect("the program");
    drop(pair.slave);
    let mut reader = pair.master.try_clone_reader().expect("a reader");
    let mut keyboard = pair.master.take_writer().expect("a writer");
    let mut all = String::new();
    let mut buffer = vec![0; 65536];
    let mut pressed = false;
    // The end of a pseudo-terminal is an error on Linux.
    while let Ok(count @ 1..) = reader.read(&mut buffer) {
        all.push_str(&String::from_utf8_lossy(&buffer[..count]));
        if !pressed && all.contains("\x1b[?1049h") {
            keyboard.write_all(b"q").expect("a key");
            pressed = true;
        }
    }
    let status = child.wait().expect("its end");
    if pressed && status.success() { Ok(String::new()) } else { Err(all) }
}
