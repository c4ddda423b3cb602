//! The log of a server: a line for each connection, command, reply, error and impact, with the time
//! since the start.

use std::io::Write;
use std::time::Instant;

/// Longest piece of a message in a line (bytes).
const MAX_SHOWN: usize = 100;

/// A log, or none.
pub struct Log {
    started: Instant,
    out: Option<Box<dyn Write + Send>>,
    warn: fn(&str),
}

impl Log {
    /// Writes to `out`, if there is one; `warn` is told if that fails.
    pub fn new(out: Option<Box<dyn Write + Send>>, warn: fn(&str)) -> Self {
        Self { started: Instant::now(), out, warn }
    }

    /// Whether lines are written.
    pub fn is_on(&self) -> bool {
        self.out.is_some()
    }

    /// Writes a line. Where that fails, the log ends and the server goes on.
    pub fn line(&mut self, who: &str, what: &str) {
        let Some(out) = &mut self.out else { return };
        let time = self.started.elapsed().as_secs_f64();
        let written = writeln!(out, "{time:10.3} s  {who}  {what}").and_then(|()| out.flush());
        if let Err(reason) = written {
            self.out = None;
            (self.warn)(&format!(
                "the log could not be written: {reason}; the server goes on without it"
            ));
        }
    }
}

/// A message for a line: without its end, what is not printable escaped, long ones cut.
pub fn shown(bytes: &[u8]) -> String {
    let bytes = bytes.trim_ascii_end();
    let cut = bytes.get(..MAX_SHOWN).unwrap_or(bytes);
    let more = if cut.len() < bytes.len() {
        format!(" ... ({} bytes)", bytes.len())
    } else {
        String::new()
    };
    format!("{}{more}", cut.escape_ascii())
}
