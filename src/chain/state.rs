//! Positions and velocities of a chain.

/// Positions and velocities at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Time since the striker's first contact (s).
    pub time: f64,
    /// Displacements from static equilibrium, downward positive (m).
    pub position: Vec<f64>,
    /// Velocities, downward positive (m/s).
    pub velocity: Vec<f64>,
}
