//! The VXI-11 protocol without I/O: bytes in, bytes out, an instrument behind it.
//!
//! A client opens the core channel, a TCP connection on which it calls procedures of the server
//! (ONC RPC), and creates links to the instrument on it; a link is a session. [`rpc`] takes records
//! and calls apart, [`procedure`] knows their arguments, [`Vxi11Server`] holds channels and links
//! together and tells what is to be sent where, [`port_mapper`] answers clients that ask for the
//! port. The abort channel is a second connection to the same port. Sources: VXI-11, TCP/IP
//! Instrument Protocol Specification, revision 1.0 (1995); RFC 5531 (RPC), RFC 4506 (XDR), RFC 1833
//! (port mapper).
//!
//! Limits: `device_docmd` is not supported, as the instrument has no interface to command; nor are
//! interrupt channels, on which the server would connect to the client: service requests show in
//! `device_readstb`. A link belongs to the connection that created it, and ends with it.

pub mod port_mapper;
pub mod procedure;
pub mod rpc;
mod server;

pub use server::{MAX_LINKS, MAX_LINKS_OF_CONNECTION, Vxi11Server};
