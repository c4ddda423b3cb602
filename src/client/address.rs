//! Addresses of scopes, as typed.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Port of a Prologix adapter.
const PROLOGIX_PORT: u16 = 1234;
/// Speeds that the RS-232 of the family has (baud).
const BAUD_RATES: [u32; 7] = [300, 600, 1200, 2400, 4800, 9600, 19200];
/// Its speed when it leaves the factory (baud).
const FACTORY_BAUD_RATE: u32 = 9600;
/// Highest address on a GPIB.
const HIGHEST_GPIB_ADDRESS: u8 = 30;

/// Where a scope is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// A raw socket, `HOST:PORT`.
    Socket(String),
    /// A serial port and its speed (baud).
    Serial {
        /// The port's file.
        device: PathBuf,
        /// The speed (baud).
        baud: u32,
    },
    /// A GPIB behind a Prologix adapter.
    Prologix {
        /// The adapter, `HOST:PORT`.
        adapter: String,
        /// The scope's address on the bus.
        gpib: u8,
    },
}

/// Why a text is no address.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{text}: {problem}: type {example}")]
pub struct AddressError {
    text: String,
    problem: String,
    example: &'static str,
}

impl Address {
    /// The address that `text` is meant as; none where it names a file or a scene.
    ///
    /// # Errors
    /// [`AddressError`] where it is meant as an address and is wrong.
    pub fn recognise(text: &str) -> Result<Option<Self>, AddressError> {
        let upper = text.to_ascii_uppercase();
        let is_visa = ["TCPIP", "ASRL", "GPIB"].iter().any(|kind| upper.starts_with(kind))
            && text.contains("::");
        let is_named = text.contains("://") || text.starts_with("serial:") || is_visa;
        let is_pair = text
            .rsplit_once(':')
            .is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok());
        if is_named || (is_pair && !Path::new(text).exists()) {
            return text.parse().map(Some);
        }
        Ok(None)
    }
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let wrong = |problem: &str, example| AddressError {
            text: text.to_owned(),
            problem: problem.to_owned(),
            example,
        };
        let bare = text.trim_end_matches('/');
        if let Some(rest) = bare.strip_prefix("tcp://") {
            let pair = host_and_port(rest, None);
            return pair.map(Self::Socket).ok_or_else(|| wrong(NO_PORT, SOCKET_EXAMPLE));
        }
        if let Some(rest) = bare.strip_prefix("serial:") {
            let device = rest.strip_prefix("//").unwrap_or(rest);
            return serial(device).map_err(|problem| wrong(problem, SERIAL_EXAMPLE));
        }
        if let Some(rest) = bare.strip_prefix("prologix://") {
            return prologix(rest).map_err(|problem| wrong(problem, PROLOGIX_EXAMPLE));
        }
        if let Some((scheme, _)) = bare.split_once("://") {
            let problem = format!("unknown kind of line `{scheme}`: use tcp, serial or prologix");
            return Err(wrong(&problem, SOCKET_EXAMPLE));
        }
        if bare.contains("::") && !bare.starts_with('[') {
            return visa(bare).map_err(|(problem, example)| wrong(problem, example));
        }
        host_and_port(bare, None).map(Self::Socket).ok_or_else(|| wrong(NO_PORT, SOCKET_EXAMPLE))
    }
}

const NO_PORT: &str = "names no host with a port";
const SOCKET_EXAMPLE: &str = "e.g. tcp://127.0.0.1:5025";
const SERIAL_EXAMPLE: &str = "e.g. serial:/dev/ttyUSB0?baud=19200 (Windows: serial:COM3)";
const PROLOGIX_EXAMPLE: &str = "e.g. prologix://192.168.1.20?gpib=1";

/// `HOST:PORT`, with `usual` where there is no port; none where there is no host, or the port is no
/// number.
fn host_and_port(text: &str, usual: Option<u16>) -> Option<String> {
    let is_open = |host: &str| host.contains(':') && !host.ends_with(']');
    let (host, port) = match text.rsplit_once(':') {
        Some((host, port)) if !text.ends_with(']') => (host, port.parse().ok()?),
        _ => (text, usual?),
    };
    (!host.is_empty() && !is_open(host)).then(|| format!("{host}:{port}"))
}

fn serial(text: &str) -> Result<Address, &'static str> {
    const WRONG_BAUD: &str =
        "needs baud=300, 600, 1200, 2400, 4800, 9600 or 19200 behind the question mark";
    let (device, baud) = match text.split_once('?') {
        None => (text, Some(FACTORY_BAUD_RATE)),
        Some((device, option)) => {
            (device, option.strip_prefix("baud=").and_then(|baud| baud.parse().ok()))
        }
    };
    let baud = baud.ok_or(WRONG_BAUD)?;
    if !BAUD_RATES.contains(&baud) {
        return Err(WRONG_BAUD);
    }
    if device.is_empty() {
        return Err("names no port");
    }
    Ok(Address::Serial { device: device.into(), baud })
}

fn prologix(text: &str) -> Result<Address, &'static str> {
    const WRONG_GPIB: &str =
        "needs the scope's address on the bus, gpib=0 to gpib=30, behind a question mark";
    let (adapter, option) = text.split_once('?').unwrap_or((text, ""));
    let adapter = host_and_port(adapter.trim_end_matches('/'), Some(PROLOGIX_PORT));
    let gpib = option.strip_prefix("gpib=").and_then(|gpib| gpib.parse().ok());
    let gpib = gpib.filter(|gpib| *gpib <= HIGHEST_GPIB_ADDRESS).ok_or(WRONG_GPIB)?;
    Ok(Address::Prologix { adapter: adapter.ok_or("names no host")?, gpib })
}

/// A VISA resource string, where it names a line that is spoken here.
fn visa(text: &str) -> Result<Address, (&'static str, &'static str)> {
    let parts: Vec<&str> = text.split("::").collect();
    let upper = text.to_ascii_uppercase();
    match parts.as_slice() {
        [_, host, port, kind]
            if upper.starts_with("TCPIP") && kind.eq_ignore_ascii_case("SOCKET") =>
        {
            let pair = host_and_port(&format!("{host}:{port}"), None);
            pair.map(Address::Socket).ok_or((NO_PORT, SOCKET_EXAMPLE))
        }
        [port, ..] if upper.starts_with("ASRL") => match port.get(4..) {
            Some(device) if device.starts_with('/') => {
                serial(device).map_err(|problem| (problem, SERIAL_EXAMPLE))
            }
            _ => Err(("a serial port is named by its device, not by a number", SERIAL_EXAMPLE)),
        },
        _ if upper.starts_with("GPIB") => {
            Err(("a GPIB is reached through a Prologix adapter", PROLOGIX_EXAMPLE))
        }
        _ => Err(("neither VXI-11 nor HiSLIP is spoken by this client", SOCKET_EXAMPLE)),
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Socket(pair) => write!(f, "tcp://{pair}"),
            Self::Serial { device, baud } => {
                write!(f, "serial:{}?baud={baud}", device.display())
            }
            Self::Prologix { adapter, gpib } => write!(f, "prologix://{adapter}?gpib={gpib}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_as_people_type_them() {
        for (text, expected) in [
            ("tcp://127.0.0.1:5025", "tcp://127.0.0.1:5025"),
            ("tcp://scope.lab:4000/", "tcp://scope.lab:4000"),
            ("scope:5025", "tcp://scope:5025"),
            ("[::1]:5025", "tcp://[::1]:5025"),
            ("TCPIP0::10.0.0.7::5025::SOCKET", "tcp://10.0.0.7:5025"),
            ("tcpip::10.0.0.7::5025::socket", "tcp://10.0.0.7:5025"),
            ("serial:/dev/ttyUSB0", "serial:/dev/ttyUSB0?baud=9600"),
            ("serial:///dev/ttyUSB0?baud=19200", "serial:/dev/ttyUSB0?baud=19200"),
            ("ASRL/dev/ttyUSB0::INSTR", "serial:/dev/ttyUSB0?baud=9600"),
            ("prologix://10.0.0.8?gpib=1", "prologix://10.0.0.8:1234?gpib=1"),
            ("prologix://adapter:4321/?gpib=30", "prologix://adapter:4321?gpib=30"),
        ] {
            let found = Address::recognise(text).map(|found| found.map(|found| found.to_string()));
            assert_eq!(found, Ok(Some(expected.to_owned())), "{text}");
        }
    }

    #[test]
    fn wrong_ones_say_what_to_type() {
        for (text, words) in [
            ("tcp://scope", "names no host with a port: type e.g. tcp://127.0.0.1:5025"),
            ("tcp://:5025", "names no host"),
            ("tcp://scope:99999", "names no host with a port"),
            ("udp://scope:1", "unknown kind of line `udp`"),
            ("serial:/dev/ttyUSB0?baud=115200", "needs baud=300"),
            ("serial:/dev/ttyUSB0?speed=9600", "needs baud=300"),
            ("serial:", "names no port: type e.g. serial:/dev/ttyUSB0?baud=19200"),
            ("prologix://adapter", "gpib=0 to gpib=30"),
            ("prologix://adapter?gpib=31", "gpib=0 to gpib=30"),
            ("TCPIP::10.0.0.7::INSTR", "neither VXI-11 nor HiSLIP"),
            ("TCPIP::10.0.0.7::hislip0,4880::INSTR", "neither VXI-11 nor HiSLIP"),
            ("ASRL3::INSTR", "named by its device"),
            ("GPIB0::1::INSTR", "through a Prologix adapter"),
        ] {
            let refused = Address::recognise(text).expect_err(text).to_string();
            assert!(refused.starts_with(text) && refused.contains(words), "{refused}");
        }
    }

    #[test]
    fn files_and_scenes_are_no_addresses() {
        for text in ["day.mcap", "magnet-0.61g", "C:\\day.mcap", "a:b", "ALL0000", ":5"] {
            assert_eq!(Address::recognise(text), Ok(None), "{text}");
        }
    }
}
