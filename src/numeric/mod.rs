//! Methods for numbers alone: roots and minima, moments and straight lines, distributions and
//! intervals, small linear systems.

pub mod intervals;
pub mod linear;
pub mod roots;
pub mod statistics;
