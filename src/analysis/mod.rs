//! Analyses of signals and chains.

pub mod arrival;
pub mod baseline;
pub mod comparison;
pub mod correlation;
pub mod dispersion;
pub mod disturbance;
pub mod droop;
mod fourier;
pub mod gate;
pub mod innovations;
pub mod least_squares;
mod local_fit;
pub mod pulse;
mod pulse_conditions;
pub mod quiet_scope;
pub mod rounding;
pub mod spectrum;
pub mod speed;
pub mod time_frequency;
pub mod transfer;
pub mod wavenumber;
