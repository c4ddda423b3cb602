//! Runs a scene from the striker's first contact to the scope's records.
//!
//! The chain moves under an integrator; at every probe the force is read from the interpolant, at
//! the scope's own sample times; sensors turn it into volts; the scope conditions, triggers and
//! digitises. Where the scope's record ends after the scene's duration, the chain simply moves on
//! until the record is full.

pub mod accuracy;
pub(crate) mod acquisition;
#[doc(hidden)]
pub mod auto_effects;
#[doc(hidden)]
pub mod bench;
pub mod ensemble;
mod error;
#[doc(hidden)]
pub mod estimate;
mod extremes;
pub mod facts;
mod frames;
mod grid;
#[doc(hidden)]
pub mod horizon;
#[doc(hidden)]
pub mod inputs;
pub(crate) mod method_choice;
mod motion_record;
mod notes;
pub mod outcome;
pub mod paper_speeds;
#[doc(hidden)]
pub mod parallel;
#[doc(hidden)]
pub mod prediction;
mod probe_record;
pub mod pulse;
pub mod run;

pub use accuracy::reference_tolerance;
pub use error::RunError;
pub use method_choice::{Integration, for_accuracy, method};
pub use outcome::Outcome;
pub use run::run;
pub(crate) use run::{film_grid, free_grid, read_bench, sample_grid, scene_bench};
