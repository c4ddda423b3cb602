//! The other side of a scope: connects to a real one or to a served one, and takes its traces.
//!
//! An [`Address`] names a line (raw socket, RS-232, GPIB behind a Prologix adapter), a [`Client`]
//! sends messages over it and checks what comes back, and a [`ShotAcquisition`] arms the scope,
//! waits for triggers and reads set-up and records. Everything is synchronous: a thread that waits
//! for a scope has nothing else to do. Commands are those of Tektronix' programmer manual 071-1075,
//! which hold for the TDS200, TDS1000, TDS2000, TPS2000 and TBS1000 families. Limits: single bytes
//! that a noisy line changes are not noticed, since the instruments send no checksums; impacts that
//! come while records are read out are missed.

mod acquisition;
mod address;
mod connection;
mod error;
mod identity;
mod line;
mod prologix;
mod recorder;
#[cfg(unix)]
mod serial;
mod socket;
mod transfer;

pub use acquisition::{
    AcquiredShot, AcquisitionEvent, ClientTiming, ShotAcquisition, wall_clock_time,
};
pub use address::{Address, AddressError};
pub use connection::Client;
pub use error::ClientError;
pub use identity::identity;
pub use recorder::ShotRecorder;
pub use transfer::{PLAIN_REPLIES, ReplyForm, capture, displayed, records};
