//! Lines between a client and a served scope: a pseudo-terminal as a serial port, and a socket;
//! both can be pulled out.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::os::fd::OwnedFd;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, poll};
use rustix::fs::{Mode, OFlags, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

/// So many times as fast as a real line.
const HASTE: u32 = 100;
/// Bits of a byte on a line: start, eight, stop.
const BITS: u32 = 10;

/// Time of one byte on a line (ns).
#[derive(Clone, Copy)]
pub struct ByteTime(u32);

impl ByteTime {
    /// At `baud`, hastened so that tests do not wait.
    pub fn at(baud: u32) -> Self {
        Self(1_000_000_000 / HASTE * BITS / baud)
    }
}

/// In which curve since it was plugged in a line is pulled out, and behind how many of its bytes.
pub type Pull = (usize, usize);

/// Counts curves, and says when to pull the line.
pub struct Curves {
    pull: Option<Pull>,
    tail: Vec<u8>,
}

impl Curves {
    pub fn new(pull: Option<Pull>) -> Self {
        Self { pull, tail: Vec::new() }
    }

    /// Whether the line is pulled out behind this byte.
    pub fn is_pulled_behind(&mut self, byte: u8) -> bool {
        const START: &[u8] = b"#42500";
        let Some((curve, bytes)) = &mut self.pull else { return false };
        if *curve == 0 {
            *bytes = bytes.saturating_sub(1);
            return *bytes == 0;
        }
        self.tail.push(byte);
        if self.tail.ends_with(START) {
            self.tail.clear();
            *curve -= 1;
            return *curve == 0 && *bytes == 0;
        }
        false
    }
}

/// A pseudo-terminal: master and slave, which is kept open as a port's electronics are.
struct Terminal {
    master: File,
    _slave: OwnedFd,
}

impl Terminal {
    /// Opens one that is called `name`.
    fn at(name: &Path) -> Self {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a pseudo-terminal");
        grantpt(&master).expect("rights");
        unlockpt(&master).expect("unlocked");
        let path = ptsname(&master, Vec::new()).expect("a name");
        let slave = open(&path, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).expect("a slave");
        // A port does not send back what it receives.
        let mut settings = tcgetattr(&slave).expect("settings");
        settings.make_raw();
        tcsetattr(&slave, OptionalActions::Now, &settings).expect("settings");
        let link = name.with_extension("new");
        symlink(path.to_str().expect("a path"), &link).expect("a link");
        std::fs::rename(&link, name).expect("a link");
        Self { master: File::from(master), _slave: slave }
    }
}

/// A serial port in `folder` that leads to the scope at `server`; it is pulled out at each of
/// `pulls`, and put back. What the scope sends meanwhile comes when the line is back, as with hard
/// flagging.
pub fn serial_port(server: SocketAddr, folder: &Path, time: ByteTime, pulls: Vec<Pull>) -> PathBuf {
    terminal(server, folder, time, pulls, false)
}

/// The same as the kernel's device file of an instrument on USB: what the scope had to send is gone
/// when it is plugged in again.
pub fn usb_device(server: SocketAddr, folder: &Path, pulls: Vec<Pull>) -> PathBuf {
    terminal(server, folder, ByteTime(0), pulls, true)
}

fn terminal(
    server: SocketAddr,
    folder: &Path,
    time: ByteTime,
    pulls: Vec<Pull>,
    forgets: bool,
) -> PathBuf {
    let port = folder.join("ttyLAB");
    let mut scope = TcpStream::connect(server).expect("a scope");
    let mut pulls = pulls.into_iter();
    let mut terminal = Terminal::at(&port);
    let name = port.clone();
    thread::spawn(move || {
        let mut curves = Curves::new(pulls.next());
        let mut bytes = [0; 64];
        loop {
            let mut ends =
                [PollFd::new(&terminal.master, PollFlags::IN), PollFd::new(&scope, PollFlags::IN)];
            poll(&mut ends, None).expect("two ends");
            let [from_client, from_scope] = ends.map(|end| !end.revents().is_empty());
            if from_client {
                let Ok(count @ 1..) = terminal.master.read(&mut bytes) else { return };
                if scope.write_all(&bytes[..count]).is_err() {
                    return;
                }
            }
            if from_scope {
                let Ok(count @ 1..) = scope.read(&mut bytes) else { return };
                for byte in &bytes[..count] {
                    if terminal.master.write_all(&[*byte]).is_err() {
                        return;
                    }
                    if curves.is_pulled_behind(*byte) {
                        curves = Curves::new(pulls.next());
                        // The old one is gone before the new one is there.
                        let _ = std::fs::remove_file(&name);
                        terminal = Terminal::at(&name);
                        if forgets {
                            let Ok(again) = TcpStream::connect(server) else { return };
                            scope = again;
                            break;
                        }
                    }
                }
                thread::sleep(Duration::from_nanos(u64::from(time.0)) * count as u32);
            }
        }
    });
    port
}

/// How a socket fails.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// The connection is closed.
    Closed,
    /// Nothing comes any more.
    Silent,
}

/// A socket that leads to the scope at `server`; its connections fail at `pulls`, one after the
/// other, and `meanwhile` is done before the next one is accepted.
pub fn socket(
    server: SocketAddr,
    pulls: Vec<Pull>,
    failure: Failure,
    meanwhile: impl Fn() + Send + 'static,
) -> SocketAddr {
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = port.local_addr().expect("an address");
    let mut pulls = pulls.into_iter();
    thread::spawn(move || {
        // Those that are silent stay open.
        let mut silent = Vec::new();
        while let Ok((mut client, _)) = port.accept() {
            let mut scope = TcpStream::connect(server).expect("a scope");
            let to_scope = (client.try_clone().expect("a socket"), scope.try_clone().expect("one"));
            thread::spawn(move || {
                let (mut client, mut scope) = to_scope;
                // The end of either is the end of both.
                let _ = std::io::copy(&mut client, &mut scope);
                let _ = scope.shutdown(Shutdown::Both);
            });
            let mut curves = Curves::new(pulls.next());
            let mut bytes = [0; 4096];
            'connection: while let Ok(count @ 1..) = scope.read(&mut bytes) {
                for (place, byte) in bytes[..count].iter().enumerate() {
                    if curves.is_pulled_behind(*byte) {
                        let _ = client.write_all(&bytes[..=place]);
                        meanwhile();
                        break 'connection;
                    }
                }
                if client.write_all(&bytes[..count]).is_err() {
                    break;
                }
            }
            if failure == Failure::Closed {
                let _ = client.shutdown(Shutdown::Both);
            }
            silent.push(client);
        }
    });
    address
}
