//! How a run is integrated.

use crate::integrate::Method;

/// How a run is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integration {
    /// To the accuracy that is asked for: relative error of first-peak forces and times (1).
    Accuracy(f64),
    /// By this method with this setting.
    Method(Method),
    /// By a method that is tried, and held to an accuracy afterwards.
    Attempt {
        /// The method.
        method: Method,
        /// Relative error of first-peak forces and times (1).
        accuracy: f64,
    },
}
