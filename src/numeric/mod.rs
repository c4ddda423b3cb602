//! Methods for numbers alone: roots and minima, straight lines and statistics, small linear
//! systems.

pub mod linear;
pub mod roots;
pub mod statistics;
