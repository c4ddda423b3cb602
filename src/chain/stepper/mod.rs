//! The lossless chain's own stepper: Runge-Kutta-Nystrom pairs on rows of eight contacts, contacts that open or close put right.
//!
//! For chains whose forces depend on positions alone. Everything is allocated before the first step. What the machine can do is
//! asked once, at the start.

mod dispatch;
mod force_track;
mod forces;
mod frame;
mod group;
mod kinks;
mod lanes;
#[cfg(target_arch = "x86_64")]
mod lanes_x86;
mod passes;
mod plan;
mod quadrature;
mod quintic;
mod quintics;
mod single;
mod steps;
mod tasks;
mod visible;
mod workspace;

pub use dispatch::InstructionSet;
pub use force_track::{ForceTrack, LOOKS, Looks, View};
pub use group::{ChainGroup, Member};
pub use single::{ChainStepper, Refinement};
