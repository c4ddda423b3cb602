//! Answers questions to recordings, without simulating.
//!
//! Stands between `recording` and the views: what a recording's metadata describe, forces from
//! voltages, arrivals and speeds, and the comparison of two recordings. The formulas are those of
//! `analysis`; here they meet the metadata of sensors, channels and scenes.

pub mod arrivals;
pub mod compare;
pub mod force;
pub mod metadata;
pub mod statistics;
