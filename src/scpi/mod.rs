//! The remote interface: bytes in, replies out, nothing else.
//!
//! `input` cuts the stream into messages, `message` cuts a message into units, `tree` finds each
//! unit's row in the one table of commands (`command`, of the kinds in `table`), and `reply` writes
//! what the row answers. A [`Session`] is one connection: it knows the path, the headers and the
//! terminator, and keeps what waits for the end of an acquisition. The instrument is passed in with
//! every call, so that several sessions can share one. `list` makes the document of all commands
//! from the same table.
//!
//! Source of the commands: programmer manual 071-1075. Quirks that are imitated: a query that does
//! not exist has no reply at all; numbers are clamped and snapped instead of refused; setting
//! anything is never acknowledged.

pub mod command;
pub mod input;
pub mod list;
pub mod message;
pub mod reply;
pub mod session;
pub mod table;
pub mod tree;
pub mod value;

pub use reply::{Preferences, Terminator};
pub use session::{MAXIMUM_REPLY, Reply, Session, TranscriptLine};
