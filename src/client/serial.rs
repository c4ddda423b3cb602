//! RS-232, as the TDS2CM module has it: 8 data bits, no parity, one stop bit, hard flagging by RTS
//! and CTS.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::OFlags;
use rustix::io::Errno;
use rustix::termios::{
    ControlModes, OptionalActions, QueueSelector, tcflush, tcgetattr, tcsendbreak, tcsetattr,
};

use crate::client::line::{LINE_TIMEOUT, Line, connection_closed, timed_out};

/// An open serial port.
#[derive(Debug)]
pub struct SerialLine(File);

impl SerialLine {
    /// Opens `device` at `baud` bits a second; bytes from before are dropped.
    ///
    /// # Errors
    /// The system's error; also where the port cannot be set up like this.
    pub fn open(device: &Path, baud: u32) -> io::Result<Self> {
        // Without waiting for a carrier, which a three-wire cable never shows.
        let flags = OFlags::NOCTTY | OFlags::NONBLOCK;
        let mut options = OpenOptions::new();
        options.read(true).write(true).custom_flags(flags.bits().cast_signed());
        let file = options.open(device)?;
        let mut settings = tcgetattr(&file)?;
        settings.make_raw();
        settings.control_modes -= ControlModes::CSIZE | ControlModes::PARENB | ControlModes::CSTOPB;
        let modes =
            ControlModes::CS8 | ControlModes::CREAD | ControlModes::CLOCAL | ControlModes::CRTSCTS;
        settings.control_modes |= modes;
        settings.set_speed(baud)?;
        tcsetattr(&file, OptionalActions::Now, &settings)?;
        // It also succeeds where only a part of it could be set.
        let set = tcgetattr(&file)?;
        if !set.control_modes.contains(modes) || set.output_speed() != baud {
            let words = format!("this port cannot do {baud} baud with RTS/CTS");
            return Err(io::Error::new(ErrorKind::Unsupported, words));
        }
        tcflush(&file, QueueSelector::IOFlush)?;
        Ok(Self(file))
    }

    /// Waits until the port can do something of `wanted`.
    fn wait(&self, wanted: PollFlags, limit: Duration) -> io::Result<()> {
        let started = Instant::now();
        loop {
            let left = limit.saturating_sub(started.elapsed());
            let time = Timespec::try_from(left).map_err(io::Error::other)?;
            let mut ports = [PollFd::new(&self.0, wanted)];
            let ready = match poll(&mut ports, Some(&time)) {
                Err(Errno::INTR) => continue,
                ready => ready?,
            };
            let [port] = ports;
            if port.revents().intersects(wanted) {
                return Ok(());
            }
            if ready > 0 {
                return Err(connection_closed());
            }
            return Err(timed_out(limit));
        }
    }
}

impl Line for SerialLine {
    fn send(&mut self, message: &str) -> io::Result<()> {
        let bytes = format!("{message}\n").into_bytes();
        let mut left = bytes.as_slice();
        while !left.is_empty() {
            self.wait(PollFlags::OUT, LINE_TIMEOUT).map_err(|error| match error.kind() {
                ErrorKind::TimedOut => io::Error::new(
                    ErrorKind::TimedOut,
                    "the scope takes no bytes (CTS is off): is it on, with hard flagging, behind a cable with RTS and CTS?",
                ),
                _ => error,
            })?;
            match self.0.write(left) {
                Ok(count) => left = left.get(count..).unwrap_or_default(),
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    fn read(&mut self, buffer: &mut [u8], limit: Duration) -> io::Result<usize> {
        loop {
            self.wait(PollFlags::IN, limit)?;
            return match self.0.read(buffer) {
                Ok(0) => Err(connection_closed()),
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) =>
                {
                    continue;
                }
                read => read,
            };
        }
    }

    /// A break makes the instrument drop what it has to send, and say `DCL`. Source: programmer
    /// manual 071-1075, "RS-232 Break Signal".
    fn clear(&mut self) -> io::Result<()> {
        Ok(tcsendbreak(&self.0)?)
    }
}
