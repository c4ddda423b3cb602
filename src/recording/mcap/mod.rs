//! The recording format: MCAP with protobuf, which Foxglove, `PlotJuggler`, Rerun and Python read
//! without plug-ins.
//!
//! Topics: `/scope/ch<n>` one [`message::CaptureMessage`] a trigger, `/scope/setup`, `/truth/...`
//! of a simulation, `/energy`, `/log`, `/scpi` one [`message::ScpiLineMessage`] for each command
//! and reply of a served session; metadata `hertzscope:recording`, `hertzscope:scope`,
//! `hertzscope:sensor/<n>`; the scene as an attachment.

mod container;
mod decode;
mod encode;
pub mod message;
mod read;
mod schema;
mod write;

pub use container::MAGIC;
pub use message::ShotNotes;
pub use read::{IndexedRecording, ReadState, Traffic, read, read_bytes};
pub use write::{RecordingWriter, write, write_numbered};
