//! The HiSLIP protocol without I/O: bytes in, bytes out, an instrument behind it.
//!
//! A session has two connections, a synchronous one for messages and replies and an asynchronous
//! one for status, locks and device clear. [`message`] takes the bytes of one connection apart,
//! [`Server`] holds the sessions together and tells what is to be sent where. Source: IVI-6.1,
//! High-Speed LAN Instrument Protocol, revision 1.1.
//!
//! Limits: synchronised mode alone is offered, as the instrument has one thing to say at a time;
//! protocol 2.0's encryption is not there, and a client that speaks it is told version 1.0. Locks
//! bind HiSLIP sessions and VXI-11 links, not raw sockets.

pub mod message;
mod server;
mod session;

pub use server::{RemoteControl, Server};
