//! Momentum tests on the simulated bench: their design, the coverage of the uncertainties that they
//! state, and their files.

pub mod coverage;
pub mod design;
pub mod files;
pub mod simulation;

pub use simulation::BlindCalibration;
