//! The HiSLIP protocol without a network: messages, sessions, locks. Numbers of types and codes are
//! those of IVI-6.1.

mod locks;
mod messages;
pub mod partner;
mod sessions;
