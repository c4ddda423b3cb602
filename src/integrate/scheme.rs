//! A method as the chain's vector path takes it.

use super::splitting::Splitting;

/// A method for forces that depend on positions alone, and its setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scheme {
    /// The Runge-Kutta-Nystrom pair of Dormand, El-Mikkawy and Prince, and the tolerated error of a
    /// step relative to the system's scales (1).
    Nystrom(f64),
    /// A splitting, and its step (s).
    Splitting(&'static Splitting, f64),
    /// A splitting in steps of two lengths, and the error that they are made for (1).
    TwoStep(&'static Splitting, f64),
}
