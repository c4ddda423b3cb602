//! The lossless chain's own stepper: Runge-Kutta-Nystrom pairs on rows of eight contacts, contacts that open or close put right, and
//! splittings in fixed steps.
//!
//! For chains whose forces depend on positions alone. Everything is allocated before the first step. What the machine can do is
//! asked once, at the start.

mod around;
mod dispatch;
mod evaluate;
mod few;
mod flow;
mod force_septic;
mod force_track;
mod forces;
mod foresight;
mod form;
mod frame;
mod gathered;
mod group;
mod guard;
mod kicks;
mod kinks;
mod known;
mod lanes;
#[cfg(target_arch = "x86_64")]
mod lanes_avx2;
#[cfg(target_arch = "x86_64")]
mod lanes_avx512;
#[cfg(target_arch = "x86_64")]
mod lanes_sse2;
mod layout;
mod lone;
mod look_in;
mod notes;
mod pacer;
mod parts;
mod passes;
mod plan;
mod quintics;
mod rows;
mod samples;
mod seen;
mod single;
mod split_tasks;
mod splits;
mod steps;
mod strip;
mod sweep;
mod tasks;
mod timing;
mod tried;
mod visible;
mod wanted;
mod workspace;

pub use dispatch::InstructionSet;
pub(super) use dispatch::dispatch;
pub use force_track::{LOOKED_AT, Looks, Place, Span};
pub use group::{ChainGroup, GroupTrail, Kind, Look, Member};
pub(super) use lanes::{Lanes, Task};
pub use samples::{Due, ROOM_BEHIND};
pub use seen::{Depth, Seen};
pub use single::{ChainStepper, Refinement, Trail};
