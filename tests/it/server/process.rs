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
        Self::run(Command::new(env!("CARGO_BIN_EXE_hertzscope")), arguments)
    }

    /// The same with an address space of so many kibibytes.
    #[cfg(target_os = "linux")]
    pub fn start_within(limit: u64, arguments: &[impl AsRef<OsStr>]) -> Self {
        let mut shell = Command::new("sh");
        let script = format!("ulimit -v {limit}; exec \"$0\" \"$@\"");
        shell.args(["-c", &script, env!("CARGO_BIN_EXE_hertzscope")]);
        Self::run(shell, arguments)
    }

    fn run(mut program: Command, arguments: &[impl AsRef<OsStr>]) -> Self {
        let mut child = program
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
