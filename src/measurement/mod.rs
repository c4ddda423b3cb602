//! Answers questions to recordings, without simulating.
//!
//! Stands between `recording` and the views: what a recording's metadata describe, forces from
//! voltages, arrivals and speeds, the comparison of two recordings, and the calibration of a sensor
//! from a plan and its recordings. The formulas are those of `analysis`; here they meet the
//! metadata of sensors, channels and scenes.

pub mod arrivals;
pub mod calibration;
pub mod compare;
pub mod force;
pub mod metadata;
pub mod statistics;
