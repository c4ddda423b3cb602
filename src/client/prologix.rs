//! GPIB behind a Prologix GPIB-to-Ethernet adapter, or one that understands the same `++` commands
//! (AR488).
//!
//! The adapter is the controller (`++mode 1`), and reads from the instrument only when it is told
//! to (`++auto 0`, `++read eoi`): an instrument that is told to talk without a query would report
//! an error. In data, the bytes that the adapter takes for its own are escaped. Source: Prologix
//! GPIB-ETHERNET Controller User Manual, version 1.6.6.0, sections 8 and 9.

use std::io;
use std::time::Duration;

use super::line::Line;
use super::socket::SocketLine;

/// Byte before each byte of data that the adapter would take for its own.
const ESCAPE: u8 = 0x1b;
/// Bytes to escape.
const SPECIAL: [u8; 4] = [b'\r', b'\n', ESCAPE, b'+'];

/// An instrument on the adapter's bus.
#[derive(Debug)]
pub struct PrologixLine(SocketLine);

impl PrologixLine {
    /// Connects to the adapter at `address`, `HOST:PORT`, and sets it up for the instrument at bus
    /// address `gpib`.
    ///
    /// # Errors
    /// The system's error.
    pub fn connect(address: &str, gpib: u8) -> io::Result<Self> {
        let mut socket = SocketLine::connect(address)?;
        // Settings stay out of the adapter's memory; messages end with LF and EOI; 3 s is its
        // longest time limit.
        let set_up = format!(
            "++savecfg 0\n++mode 1\n++addr {gpib}\n++auto 0\n++eoi 1\n++eos 2\n++eot_enable 0\n++read_tmo_ms 3000\n"
        );
        socket.write(set_up.as_bytes())?;
        Ok(Self(socket))
    }
}

impl Line for PrologixLine {
    fn send(&mut self, message: &str) -> io::Result<()> {
        self.0.write(&escaped(message))
    }

    fn request_reply(&mut self) -> io::Result<()> {
        self.0.write(b"++read eoi\n")
    }

    fn read(&mut self, buffer: &mut [u8], limit: Duration) -> io::Result<usize> {
        self.0.read(buffer, limit)
    }

    fn clear(&mut self) -> io::Result<()> {
        self.0.write(b"++clr\n")
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

#[cfg(test)]
mod tests {
    #[test]
    fn bytes_of_the_adapter_are_escaped() {
        assert_eq!(super::escaped("CH1:SCA 1E+1"), b"CH1:SCA 1E\x1b+1\n");
        assert_eq!(super::escaped("\x1b\r\n"), b"\x1b\x1b\x1b\r\x1b\n\n");
    }
}
