//! The calls of the VXI-11 protocol, without I/O: [`rpc`] takes records and calls apart,
//! [`procedure`] knows their arguments, [`port_mapper`] answers clients that ask for the port.
//! Sources: VXI-11, TCP/IP Instrument Protocol Specification, revision 1.0 (1995); RFC 5531 (RPC),
//! RFC 4506 (XDR), RFC 1833 (port mapper).

pub mod port_mapper;
pub mod procedure;
pub mod rpc;
