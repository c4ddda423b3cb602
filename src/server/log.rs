//! The log of a server: a line for each connection, command, reply, error and impact, with the time
//! since the start.

use std::io::{self, Write};
use std::time::Duration;

use tokio::time::Instant;

use super::writer::{BackgroundWriter, Sink};

/// Longest piece of a message in a line (bytes).
const MAX_SHOWN: usize = 100;
/// Time that a log which takes nothing has at the end of the server.
const FINISH_TIMEOUT: Duration = Duration::from_secs(1);

/// A log, or none.
pub struct Log {
    started: Instant,
    writer: Option<BackgroundWriter<LogSink>>,
}

impl Log {
    /// Writes to `out`, if there is one, up to `limit` (bytes); `warn` is called if it ends before
    /// the server.
    ///
    /// # Errors
    /// The system's error if the writer's thread cannot be started.
    pub fn start(
        out: Option<Box<dyn Write + Send>>,
        limit: Option<u64>,
        warn: fn(&str),
    ) -> io::Result<Self> {
        let sink = out.map(|out| LogSink { out, written: 0, limit });
        let writer = sink.map(|sink| BackgroundWriter::start("log", sink, warn)).transpose()?;
        Ok(Self { started: Instant::now(), writer })
    }

    /// Whether lines are written.
    pub fn is_on(&self) -> bool {
        self.writer.is_some()
    }

    /// Writes a line.
    pub fn line(&mut self, who: &str, what: &str) {
        if let Some(writer) = &mut self.writer {
            let time = self.started.elapsed().as_secs_f64();
            let line = format!("{time:10.3} s  {who}  {what}\n");
            let bytes = line.len();
            writer.push(line, bytes);
        }
    }

    /// Waits where the log is far behind and still works.
    pub async fn keep_pace(&mut self) {
        if let Some(writer) = &mut self.writer {
            writer.keep_pace().await;
        }
    }

    /// Writes what is queued, unless the output accepts nothing.
    pub async fn finish(self) {
        if let Some(writer) = self.writer {
            // A failure was reported when it happened.
            let _ = writer.finish(FINISH_TIMEOUT).await;
        }
    }
}

/// The output of a log.
struct LogSink {
    out: Box<dyn Write + Send>,
    written: u64,
    limit: Option<u64>,
}

impl LogSink {
    fn put(&mut self, text: &str) -> Result<(), String> {
        self.written += text.len() as u64;
        let written = self.out.write_all(text.as_bytes()).and_then(|()| self.out.flush());
        written.map_err(|reason| format!("the log could not be written: {reason}"))
    }
}

impl Sink for LogSink {
    type Entry = String;
    type Error = String;

    fn write(&mut self, line: String) -> Result<(), String> {
        self.put(&line)
    }

    fn write_loss(&mut self, count: u64) -> Result<(), String> {
        self.put(&format!("... {count} lines lost: the log was not read in time\n"))
    }

    fn flush(&mut self) -> Result<(), String> {
        Ok(())
    }

    fn limit_reached(&self) -> Option<String> {
        let limit = self.limit.filter(|limit| self.written >= *limit)?;
        Some(format!("the log has reached its limit of {limit} bytes"))
    }

    fn finish(self) -> Result<(), String> {
        Ok(())
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
