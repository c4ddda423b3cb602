//! One body's motion over one step as polynomials, whatever method made them.

/// Highest degree of an interpolating polynomial, plus one.
pub const COEFFICIENTS: usize = 8;

/// Position and velocity over a step as polynomials in the fraction `theta` of the step, 0 to 1:
/// `x = sum_k position[k] theta^k`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interpolant {
    /// Coefficients of the displacement (m).
    pub position: [f64; COEFFICIENTS],
    /// Coefficients of the velocity (m/s).
    pub velocity: [f64; COEFFICIENTS],
}

impl Interpolant {
    /// A body that does not move: walls.
    pub const REST: Self = Self { position: [0.0; COEFFICIENTS], velocity: [0.0; COEFFICIENTS] };

    /// Displacement at the fraction `theta` of the step (m).
    pub fn position(&self, theta: f64) -> f64 {
        horner(&self.position, theta)
    }

    /// Velocity at the fraction `theta` of the step (m/s).
    pub fn velocity(&self, theta: f64) -> f64 {
        horner(&self.velocity, theta)
    }
}

fn horner(coefficients: &[f64; COEFFICIENTS], theta: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * theta + c)
}
