//! What the benches share.
#![allow(dead_code, reason = "each bench uses its part")]

pub mod clock;
pub mod ours;
pub mod scenes;
