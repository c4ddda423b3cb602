//! The messages of the HiSLIP protocol, without I/O: [`message`] takes the bytes of one connection
//! apart. Source: IVI-6.1, High-Speed LAN Instrument Protocol, revision 1.1.

pub mod message;
