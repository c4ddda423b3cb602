//! A client of an oscilloscope, real or served: connects to it, and takes its traces.
//!
//! An [`Address`] names a line (raw socket, VXI-11, HiSLIP, USB, RS-232, GPIB behind a Prologix
//! adapter), a [`Client`] sends messages over it and checks the replies, a [`Scope`] knows what to
//! send and reconnects, and a [`ShotAcquisition`] arms the scope, waits for triggers and reads
//! set-up and records.
//! Everything is synchronous: a thread that waits for a scope has nothing else to do. Every wait
//! has a limit and ends when the user asks to stop. Commands are those of Tektronix' programmer
//! manual 071-1075, which hold for the TDS200, TDS1000, TDS2000, TPS2000 and TBS1000 families.
//! Limits: a point that a noisy line changes is not noticed, since the instruments send no
//! checksums; impacts that come while records are read out are missed.

mod acquisition;
mod address;
mod connection;
mod hislip_line;
mod lines;
mod record;
mod scope;
mod transport;
mod usbtmc;
mod vxi11_line;

pub use acquisition::{
    AcquiredShot, AcquisitionEvent, ShotAcquisition, create_recording, wall_clock_time,
};
pub use address::{Address, AddressError};
pub use connection::Client;
pub use record::{Record, displayed};
pub use scope::{ClientError, ClientTiming, LineEvent, Scope, ScopeState};
pub use usbtmc::{UsbIdentity, UsbInstrument, instruments};
