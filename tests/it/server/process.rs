//! A server of its own process.

use std::ffi::OsStr;
use std::io::{BufRead as _, BufReader, Lines};
use std::net::SocketAddr;
use std::process::{Child, ChildStdout, Command, Stdio};

/// `hertzscope serve`; it ends with this.
pub struct Process {
    pub child: Child,
    /// What it says after where it listens.
    pub told: Lines<BufReader<ChildStdout>>,
    pub address: SocketAddr,
}

impl Process {
    /// Starts it with `arguments` besides where it listens.
    pub fn start(arguments: &[impl AsRef<OsStr>]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_hertzscope"))
            .args(["serve", "--listen", "127.0.0.1:0"])
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a server");
        let mut told = BufReader::new(child.stdout.take().expect("a pipe")).lines();
        let line = told.next().expect("a line").expect("text");
        let address = line.strip_prefix("listening on ").map(str::parse).expect("an address");
        Self { child, told, address: address.expect("an address") }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
