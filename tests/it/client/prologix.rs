//! A stand-in for a Prologix GPIB-to-Ethernet adapter with a scope behind it.
//!
//! As its manual (version 1.6.6.0) says: a line that begins with `++` is for the adapter, ESC takes
//! its meaning from the next byte, data end with LF and EOI, and bytes of the instrument come only
//! after `++read eoi`.

use std::io::{BufRead as _, BufReader, Read, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::thread;

pub struct Adapter {
    pub address: SocketAddr,
    commands: Arc<Mutex<Vec<String>>>,
}

impl Adapter {
    /// An adapter before the scope at `server`, for one client after the other.
    pub fn before(server: SocketAddr) -> Self {
        let port = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = port.local_addr().expect("an address");
        let commands = Arc::new(Mutex::new(Vec::new()));
        let told = Arc::clone(&commands);
        thread::spawn(move || {
            while let Ok((client, _)) = port.accept() {
                // The end of a client is no failure.
                let _ = serve(client, server, &told);
            }
        });
        Self { address, commands }
    }

    /// What it was told.
    pub fn commands(&self) -> Vec<String> {
        self.commands.lock().expect("commands").clone()
    }
}

fn serve(
    mut client: TcpStream,
    server: SocketAddr,
    told: &Mutex<Vec<String>>,
) -> std::io::Result<()> {
    let mut bus = BufReader::new(TcpStream::connect(server)?);
    let mut typed = BufReader::new(client.try_clone()?);
    loop {
        let (line, is_command) = line(&mut typed)?;
        if !is_command {
            bus.get_mut().write_all(&line)?;
            bus.get_mut().write_all(b"\n")?;
            continue;
        }
        let command = String::from_utf8(line).expect("text");
        match command.as_str() {
            "++read eoi" => client.write_all(&message(&mut bus)?)?,
            // A device clear: what the instrument had to say is gone.
            "++clr" => bus = BufReader::new(TcpStream::connect(server)?),
            _ => {}
        }
        told.lock().expect("commands").push(command);
    }
}

/// One line without its end, and whether it is for the adapter.
fn line(typed: &mut impl Read) -> std::io::Result<(Vec<u8>, bool)> {
    let (mut line, mut plain, mut byte) = (Vec::new(), Vec::new(), [0]);
    loop {
        typed.read_exact(&mut byte)?;
        match byte[0] {
            0x1b => {
                typed.read_exact(&mut byte)?;
                line.push(byte[0]);
                plain.push(false);
            }
            b'\n' | b'\r' => break,
            other => {
                line.push(other);
                plain.push(true);
            }
        }
    }
    let is_command = line.starts_with(b"++") && plain.starts_with(&[true, true]);
    Ok((line, is_command))
}

/// All bytes up to the end of the instrument's message; a line feed in a block is none.
fn message(bus: &mut impl BufReadBytes) -> std::io::Result<Vec<u8>> {
    let (mut message, mut is_text) = (Vec::new(), false);
    loop {
        let byte = bus.byte()?;
        message.push(byte);
        match byte {
            b'"' => is_text = !is_text,
            b'#' if !is_text => {
                let digits = bus.byte()?;
                message.push(digits);
                let mut length = 0;
                for _ in b'0'..digits {
                    let digit = bus.byte()?;
                    message.push(digit);
                    length = 10 * length + usize::from(digit - b'0');
                }
                for _ in 0..length {
                    message.push(bus.byte()?);
                }
            }
            b'\n' => return Ok(message),
            _ => {}
        }
    }
}

trait BufReadBytes {
    fn byte(&mut self) -> std::io::Result<u8>;
}

impl BufReadBytes for BufReader<TcpStream> {
    fn byte(&mut self) -> std::io::Result<u8> {
        let byte = self.fill_buf()?.first().copied();
        self.consume(1);
        byte.ok_or_else(|| std::io::ErrorKind::UnexpectedEof.into())
    }
}
