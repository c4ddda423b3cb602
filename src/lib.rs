//! Digital twin of a physics lab bench: a chain of beads with Hertz contacts is hit by a striker,
//! piezo sensors embedded in beads feel the force, a virtual Tektronix TDS 2014 records it.
//!
//! Who builds on this library should have it optimised in development builds as well, by
//! `[profile.dev.package.hertzscope] opt-level = 2`: without, an [`Ensemble`] under error control
//! needs more than 8 MiB of stack.

#![cfg_attr(test, allow(clippy::disallowed_macros, reason = "tests print what they measure"))]

pub mod analysis;
pub mod calibrate;
pub mod chain;
pub mod cli;
pub mod client;
pub mod data;
pub mod experiment;
pub mod files;
pub mod fit;
pub mod hislip;
pub mod instrument;
pub mod magnet;
pub mod measurement;
pub mod motion;
pub mod note;
pub mod numeric;
pub mod predict;
pub mod quantity;
pub mod recording;
pub mod report;
pub mod scene;
pub mod scope;
pub mod scpi;
pub mod screen;
pub mod sensor;
#[cfg(feature = "server")]
pub mod server;
pub mod studies;
pub mod sweep;
pub mod table;
pub mod trace;
#[cfg(feature = "tui")]
pub mod tui;
pub mod vxi11;

pub use experiment::ensemble::Ensemble;
