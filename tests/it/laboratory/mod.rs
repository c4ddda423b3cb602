//! A laboratory that shares no code with the program: chain, impact, sensor, disturbances,
//! digitiser and file writer of its own.
//!
//! It draws true values, makes the files that a TDS 2014 would have saved, and hands them to the
//! program, which does not know the truth. The share of printed 95 % intervals that contain the
//! truth is what the tests of this folder bound. Equations: Hertz contacts (Herbold et al. 2009,
//! Eq. 2), a piezo plate with a resistor in parallel (`V' = S F' - V / tau`), a first-order high
//! pass for AC coupling, a digitiser with 25 levels a division.

mod chain;
mod coverage;
mod disturbance;
mod impact;
mod prediction;
mod random;
mod scope;

use disturbance::Disturbance;
use random::Random;
use scope::{Channel, Timing};
