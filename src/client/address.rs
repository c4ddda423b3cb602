//! Addresses of scopes, as typed.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::hislip_line::PORT as HISLIP_PORT;
use super::usbtmc::UsbIdentity;

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
    /// VXI-11.
    Vxi11 {
        /// The host.
        host: String,
        /// Port of the core channel; looked up where there is none.
        port: Option<u16>,
        /// The instrument's name on the host.
        device: String,
    },
    /// HiSLIP.
    Hislip {
        /// `HOST:PORT`.
        pair: String,
        /// The instrument's name on the host.
        device: String,
    },
    /// An instrument on USB, by the kernel's device file.
    UsbFile(PathBuf),
    /// An instrument on USB, by maker, model and serial number.
    Usb(UsbIdentity),
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
        let is_visa = ["TCPIP", "ASRL", "GPIB", "USB"].iter().any(|kind| upper.starts_with(kind))
            && text.contains("::");
        let schemes = ["serial:", "usbtmc:", USB_FILES];
        let is_named = text.contains("://")
            || schemes.iter().any(|scheme| text.starts_with(scheme))
            || is_visa;
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
        if let Some(device) = bare.strip_prefix("usbtmc:") {
            return Ok(Self::UsbFile(device.into()));
        }
        if bare.starts_with(USB_FILES) {
            return Ok(Self::UsbFile(bare.into()));
        }
        if let Some(rest) = bare.strip_prefix("prologix://") {
            return prologix(rest).map_err(|problem| wrong(problem, PROLOGIX_EXAMPLE));
        }
        if let Some((scheme, _)) = bare.split_once("://") {
            let problem =
                format!("unknown kind of line `{scheme}`: use tcp, serial, usbtmc or prologix");
            return Err(wrong(&problem, SOCKET_EXAMPLE));
        }
        if bare.contains("::") && !bare.starts_with('[') {
            return visa(bare).map_err(|(problem, example)| wrong(problem, example));
        }
        host_and_port(bare, None).map(Self::Socket).ok_or_else(|| wrong(NO_PORT, SOCKET_EXAMPLE))
    }
}

/// How the kernel's device files of instruments on USB begin.
const USB_FILES: &str = "/dev/usbtmc";
const NO_PORT: &str = "names no host with a port";
const SOCKET_EXAMPLE: &str = "e.g. tcp://127.0.0.1:5025";
const SERIAL_EXAMPLE: &str = "e.g. serial:/dev/ttyUSB0?baud=19200 (Windows: serial:COM3)";
const USB_EXAMPLE: &str = "e.g. /dev/usbtmc0 or USB0::0x0699::0x0363::C031611::INSTR";
const VISA_EXAMPLE: &str = "e.g. TCPIP::192.168.1.20::INSTR or TCPIP::192.168.1.20::hislip0::INSTR";
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
        [_, rest @ ..] if upper.starts_with("USB") => {
            usb(rest).ok_or(("names no maker and model", USB_EXAMPLE))
        }
        [_, rest @ ..] => network(rest).ok_or(("names no instrument on a host", VISA_EXAMPLE)),
        [] => Err((NO_PORT, SOCKET_EXAMPLE)),
    }
}

/// `HOST::INSTR`, `HOST[,PORT]::inst0::INSTR` (VXI-11), `HOST::hislip0[,PORT]::INSTR` (HiSLIP).
fn network(parts: &[&str]) -> Option<Address> {
    let parts = match parts {
        [rest @ .., last] if last.eq_ignore_ascii_case("INSTR") => rest,
        all => all,
    };
    let with_port = |text: &str| match text.split_once(',') {
        Some((name, port)) => Some((name.to_owned(), Some(port.parse::<u16>().ok()?))),
        None => Some((text.to_owned(), None)),
    };
    let (host, device) = match parts {
        [host] => (*host, "inst0"),
        [host, device] => (*host, *device),
        _ => return None,
    };
    let (host, host_port) = with_port(host)?;
    let (device, device_port) = with_port(device)?;
    if host.is_empty() || device.is_empty() {
        return None;
    }
    if device.to_ascii_lowercase().starts_with("hislip") {
        let port = device_port.or(host_port).unwrap_or(HISLIP_PORT);
        return Some(Address::Hislip {
            pair: host_and_port(&format!("{host}:{port}"), None)?,
            device,
        });
    }
    Some(Address::Vxi11 { host, port: host_port.or(device_port), device })
}

/// `VENDOR::PRODUCT[::SERIAL][::INTERFACE]::INSTR`, numbers in hexadecimal with `0x`, or decimal.
fn usb(parts: &[&str]) -> Option<Address> {
    let number = |text: &str| match text.to_ascii_lowercase().strip_prefix("0x") {
        Some(digits) => u16::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    };
    let (vendor, product, rest) = match parts {
        [vendor, product, rest @ ..] => (number(vendor)?, number(product)?, rest),
        _ => return None,
    };
    let serial = rest.first().filter(|text| !text.eq_ignore_ascii_case("INSTR"));
    let serial = serial.map(|text| (*text).to_owned()).unwrap_or_default();
    Some(Address::Usb(UsbIdentity { vendor, product, serial }))
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Socket(pair) => write!(f, "tcp://{pair}"),
            Self::Serial { device, baud } => {
                write!(f, "serial:{}?baud={baud}", device.display())
            }
            Self::Vxi11 { host, port, device } => {
                let port = port.map_or(String::new(), |port| format!(",{port}"));
                write!(f, "TCPIP::{host}{port}::{device}::INSTR")
            }
            Self::Hislip { pair, device } => {
                let (host, port) = pair.rsplit_once(':').unwrap_or((pair, ""));
                write!(f, "TCPIP::{host}::{device},{port}::INSTR")
            }
            Self::UsbFile(device) if device.starts_with("/dev") => {
                write!(f, "{}", device.display())
            }
            Self::UsbFile(device) => write!(f, "usbtmc:{}", device.display()),
            Self::Usb(UsbIdentity { vendor, product, serial }) => {
                let serial = if serial.is_empty() { String::new() } else { format!("::{serial}") };
                write!(f, "USB::0x{vendor:04X}::0x{product:04X}{serial}::INSTR")
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
            ("TCPIP::10.0.0.7::INSTR", "TCPIP::10.0.0.7::inst0::INSTR"),
            ("TCPIP0::10.0.0.7,1024::inst0::INSTR", "TCPIP::10.0.0.7,1024::inst0::INSTR"),
            ("tcpip::scope.lab::hislip0::instr", "TCPIP::scope.lab::hislip0,4880::INSTR"),
            ("TCPIP::10.0.0.7::hislip0,4881::INSTR", "TCPIP::10.0.0.7::hislip0,4881::INSTR"),
            ("/dev/usbtmc0", "/dev/usbtmc0"),
            ("usbtmc:lab/usb", "usbtmc:lab/usb"),
            ("USB0::0x0699::0x0363::C031611::INSTR", "USB::0x0699::0x0363::C031611::INSTR"),
            ("USB::1689::867::INSTR", "USB::0x0699::0x0363::INSTR"),
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
            ("TCPIP::10.0.0.7::a::b::INSTR", "names no instrument on a host"),
            ("TCPIP::10.0.0.7::hislip0,x::INSTR", "names no instrument on a host"),
            ("USB0::tek::INSTR", "names no maker and model: type e.g. /dev/usbtmc0"),
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
