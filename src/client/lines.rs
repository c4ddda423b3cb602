//! Opens the line that an address names.

use std::io;
use std::time::Duration;

use super::address::Address;
use super::hislip_line::HislipLine;
use super::transport::{PrologixLine, SerialLine, SocketLine, Transport, connect};
use super::usbtmc::{self, UsbLine};
use super::vxi11_line::Vxi11Line;

/// Opens the line to `address`. `is_stopped` is asked until it is open.
///
/// # Errors
/// The system's error.
pub fn open(
    address: &Address,
    timeout: Duration,
    is_stopped: &dyn Fn() -> bool,
) -> io::Result<Box<dyn Transport>> {
    Ok(match address {
        Address::Socket(pair) => Box::new(SocketLine(connect(pair, timeout, is_stopped)?)),
        Address::Vxi11 { host, port, device } => {
            Box::new(Vxi11Line::open((host, *port), device, timeout, is_stopped)?)
        }
        Address::Hislip { pair, device } => {
            Box::new(HislipLine::open(pair, device, timeout, is_stopped)?)
        }
        Address::UsbFile(device) => Box::new(UsbLine::open(device)?),
        Address::Usb(identity) => Box::new(UsbLine::open(&usbtmc::device_of(identity)?)?),
        Address::Serial { device, baud } => Box::new(SerialLine::open(device, *baud)?),
        Address::Prologix { adapter, gpib } => {
            let socket = SocketLine(connect(adapter, timeout, is_stopped)?);
            Box::new(PrologixLine::set_up(socket, *gpib)?)
        }
    })
}
