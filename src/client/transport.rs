//! The lines on which bytes go to an instrument and come back: a raw TCP socket, RS-232, and GPIB
//! behind a Prologix GPIB-to-Ethernet adapter; those with messages of their own are in
//! `hislip_line`, `vxi11_line` and `usbtmc`.
//!
//! A transport moves bytes and knows nothing of messages but their frame. No call waits longer than
//! [`POLL_INTERVAL`], so that whoever waits can also look at the clock and at a request to stop.
//! RS-232 is set as the TDS2CM module has it: 8 data bits, no parity, one stop bit, hard flagging
//! by RTS and CTS. The adapter is the controller (`++mode 1`) and reads from the instrument only on
//! request (`++auto 0`, `++read eoi`): an instrument that is addressed to talk without a query
//! reports an error. In data, the bytes that the adapter interprets itself are escaped. Sources:
//! Prologix GPIB-ETHERNET Controller User Manual, version 1.6.6.0, sections 8 and 9; programmer
//! manual 071-1075, "RS-232 Break Signal".

use std::fmt::Debug;
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use serial2::{CharSize, FlowControl, Parity, SerialPort, Settings, StopBits};

/// Longest wait of one call.
pub const POLL_INTERVAL: Duration = Duration::from_millis(25);
/// Time limit for connecting, and for sending a message.
pub const LINE_TIMEOUT: Duration = Duration::from_secs(5);
/// Length of a break on RS-232; an instrument needs that of one byte, 33 ms at 300 baud.
const BREAK_TIME: Duration = Duration::from_millis(100);
/// Byte before each byte of data that a Prologix adapter would interpret itself.
const ESCAPE: u8 = 0x1b;
/// Bytes to escape.
const SPECIAL: [u8; 4] = [b'\r', b'\n', ESCAPE, b'+'];

/// A line to one instrument.
pub trait Transport: Debug + Send {
    /// Reads at least one byte into `buffer`; returns how many.
    ///
    /// # Errors
    /// [`ErrorKind::TimedOut`] if none comes within [`POLL_INTERVAL`], [`ErrorKind::UnexpectedEof`]
    /// if the other side has closed the line.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Writes at least one byte; returns how many.
    ///
    /// # Errors
    /// [`ErrorKind::TimedOut`] if none is taken within [`POLL_INTERVAL`].
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize>;

    /// The bytes of a message, with its end.
    fn message(&self, text: &str) -> Vec<u8> {
        format!("{text}\n").into_bytes()
    }

    /// The bytes that ask for the reply to a message; most lines need none.
    fn reply_request(&self) -> &'static [u8] {
        b""
    }

    /// Makes the instrument drop what it still has to send, if the line can.
    ///
    /// # Errors
    /// The system's error.
    fn clear(&mut self) -> io::Result<()> {
        Ok(())
    }

    /// Speed of the line, if it is known (baud).
    fn baud(&self) -> Option<u32> {
        None
    }

    /// What to check if the instrument takes no bytes.
    fn hint(&self) -> &'static str {
        "the other side takes no bytes"
    }
}

/// A TCP connection on which messages are lines: a served scope, or a real one behind a
/// serial-to-LAN adapter.
#[derive(Debug)]
pub(super) struct SocketLine(pub(super) TcpStream);

/// Connects to `pair`, `HOST:PORT`. Looking a name up and connecting cannot be interrupted: a
/// thread does both, and is left behind.
pub(super) fn connect(
    pair: &str,
    timeout: Duration,
    is_stopped: &dyn Fn() -> bool,
) -> io::Result<TcpStream> {
    let (sender, found) = mpsc::channel();
    let address = pair.to_owned();
    thread::spawn(move || {
        // Nobody takes it after a stop.
        let _ = sender.send(first_connection(&address, timeout));
    });
    loop {
        match found.recv_timeout(POLL_INTERVAL) {
            Ok(connected) => return connected,
            Err(_) if is_stopped() => return Err(stopped()),
            Err(mpsc::RecvTimeoutError::Timeout) => {}
            Err(mpsc::RecvTimeoutError::Disconnected) => return Err(connection_closed()),
        }
    }
}

fn first_connection(pair: &str, timeout: Duration) -> io::Result<TcpStream> {
    let mut last = io::Error::new(ErrorKind::NotFound, "found no such host");
    for address in pair.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, timeout) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(POLL_INTERVAL))?;
                stream.set_write_timeout(Some(POLL_INTERVAL))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

impl Transport for SocketLine {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        moved(self.0.read(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        moved(self.0.write(bytes))
    }
}

/// An instrument on the GPIB of a Prologix adapter, or of one that understands the same `++`
/// commands (AR488).
#[derive(Debug)]
pub(super) struct PrologixLine(SocketLine);

impl PrologixLine {
    /// Sets the adapter behind `socket` up for the instrument at bus address `gpib`.
    pub(super) fn set_up(mut socket: SocketLine, gpib: u8) -> io::Result<Self> {
        // Settings stay out of the adapter's memory; messages end with LF and EOI; 3 s is its
        // longest time limit.
        let set_up = format!(
            "++savecfg 0\n++mode 1\n++addr {gpib}\n++auto 0\n++eoi 1\n++eos 2\n++eot_enable 0\n++read_tmo_ms 3000\n"
        );
        socket.0.write_all(set_up.as_bytes())?;
        Ok(Self(socket))
    }
}

impl Transport for PrologixLine {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn message(&self, text: &str) -> Vec<u8> {
        escaped(text)
    }

    fn reply_request(&self) -> &'static [u8] {
        b"++read eoi\n"
    }

    fn clear(&mut self) -> io::Result<()> {
        self.0.0.write_all(b"++clr\n")
    }
}

/// `message` as the adapter passes it on, with the end of its line.
fn escaped(message: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(message.len() + 1);
    for byte in message.bytes() {
        if SPECIAL.contains(&byte) {
            bytes.push(ESCAPE);
        }
        bytes.push(byte);
    }
    bytes.push(b'\n');
    bytes
}

/// An open serial port.
#[derive(Debug)]
pub(super) struct SerialLine {
    port: SerialPort,
    baud: u32,
}

impl SerialLine {
    /// Opens `device` at `baud` (baud); bytes from before are dropped.
    pub(super) fn open(device: &Path, baud: u32) -> io::Result<Self> {
        let settings = |mut settings: Settings| {
            settings.set_raw();
            settings.set_baud_rate(baud)?;
            settings.set_char_size(CharSize::Bits8);
            settings.set_parity(Parity::None);
            settings.set_stop_bits(StopBits::One);
            settings.set_flow_control(FlowControl::RtsCts);
            Ok(settings)
        };
        let mut port = SerialPort::open(device, settings)?;
        port.set_read_timeout(POLL_INTERVAL)?;
        port.set_write_timeout(POLL_INTERVAL)?;
        port.discard_buffers()?;
        Ok(Self { port, baud })
    }
}

impl Transport for SerialLine {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        moved(self.port.read(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        moved(self.port.write(bytes))
    }

    /// A break makes the instrument drop what it has to send, and reply `DCL`.
    fn clear(&mut self) -> io::Result<()> {
        self.port.set_break(true)?;
        thread::sleep(BREAK_TIME);
        self.port.set_break(false)
    }

    fn baud(&self) -> Option<u32> {
        Some(self.baud)
    }

    fn hint(&self) -> &'static str {
        "the scope takes no bytes (CTS is off): is it on, with hard flagging, behind a cable with RTS and CTS?"
    }
}

/// The count of a read or write as [`Transport`] promises it.
pub(super) fn moved(done: io::Result<usize>) -> io::Result<usize> {
    match done {
        Ok(0) => Err(connection_closed()),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {
            Err(ErrorKind::TimedOut.into())
        }
        done => done,
    }
}

/// The other side has closed the line.
pub fn connection_closed() -> io::Error {
    io::Error::new(ErrorKind::UnexpectedEof, "it has closed the connection")
}

/// The error for a reply that no oscilloscope sends.
pub fn invalid_reply(found: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, format!("found {found}"))
}

/// The user has asked to stop.
pub fn stopped() -> io::Error {
    io::Error::new(ErrorKind::Interrupted, "stopped")
}

#[cfg(test)]
mod tests {
    #[test]
    fn bytes_of_the_adapter_are_escaped() {
        assert_eq!(super::escaped("CH1:SCA 1E+1"), b"CH1:SCA 1E\x1b+1\n");
        assert_eq!(super::escaped("\x1b\r\n"), b"\x1b\x1b\x1b\r\x1b\n\n");
    }
}
