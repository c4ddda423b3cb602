//! Interpolation of a step from what is known at its two ends: any method's dense output.
//!
//! With position, velocity and acceleration at both ends a quintic, with their rates in addition a septic. Errors go as the
//! step to the power 6 and 8, with the small constants `1/(6! 2^6)` and `1/(8! 2^8)` at mid-step.
//! Source: C. Hermite, J. reine angew. Math. 84, 70 (1878).

use super::interpolant::{COEFFICIENTS, Interpolant};

/// What is known of one body at one end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// Displacement (m).
    pub position: f64,
    /// Velocity (m/s).
    pub velocity: f64,
    /// Acceleration (m/s²).
    pub acceleration: f64,
}

/// The quintic through both ends of a step of `length` (s).
#[must_use]
pub fn quintic(from: End, to: End, length: f64) -> Interpolant {
    let h = length;
    let (v0, a0) = (h * from.velocity, h * h * from.acceleration);
    let (p, q, r) = rises(from, to, h);
    let position = [
        from.position,
        v0,
        0.5 * a0,
        10.0 * p - 4.0 * q + 0.5 * r,
        -15.0 * p + 7.0 * q - r,
        6.0 * p - 3.0 * q + 0.5 * r,
        0.0,
        0.0,
    ];
    Interpolant { position, velocity: derivative(&position, h) }
}

/// The septic through both ends, `jerks` being the rates of the accelerations there (m/s³).
#[must_use]
pub fn septic(from: End, to: End, jerks: (f64, f64), length: f64) -> Interpolant {
    let h = length;
    let (v0, a0) = (h * from.velocity, h * h * from.acceleration);
    let (j0, j1) = (h * h * h * jerks.0, h * h * h * jerks.1);
    let (p, q, r) = rises(from, to, h);
    // What the cubic Taylor polynomial of the start leaves over at the end, derivative by derivative.
    let (p, q, r, s) = (p - j0 / 6.0, q - j0 / 2.0, r - j0, j1 - j0);
    let position = [
        from.position,
        v0,
        0.5 * a0,
        j0 / 6.0,
        35.0 * p - 15.0 * q + 2.5 * r - s / 6.0,
        -84.0 * p + 39.0 * q - 7.0 * r + 0.5 * s,
        70.0 * p - 34.0 * q + 6.5 * r - 0.5 * s,
        -20.0 * p + 10.0 * q - 2.0 * r + s / 6.0,
    ];
    Interpolant { position, velocity: derivative(&position, h) }
}

/// What the quadratic Taylor polynomial of the start leaves over at the end: position, velocity, acceleration, each times
/// its power of the step (m).
fn rises(from: End, to: End, h: f64) -> (f64, f64, f64) {
    let (v0, a0) = (h * from.velocity, h * h * from.acceleration);
    let p = to.position - from.position - v0 - 0.5 * a0;
    let q = h * to.velocity - v0 - a0;
    let r = h * h * to.acceleration - a0;
    (p, q, r)
}

fn derivative(position: &[f64; COEFFICIENTS], h: f64) -> [f64; COEFFICIENTS] {
    let mut velocity = [0.0; COEFFICIENTS];
    if h > 0.0 {
        for (power, (v, x)) in (1_u8..).zip(velocity.iter_mut().zip(&position[1..])) {
            *v = f64::from(power) * x / h;
        }
    }
    velocity
}

#[cfg(test)]
mod tests {
    use super::*;

    fn end(polynomial: &[f64], t: f64) -> (End, f64) {
        let derivative = |order: usize| -> f64 {
            let falling = |k: usize| (0..order).map(|i| k as f64 - i as f64).product::<f64>();
            let term = |(k, c): (usize, &f64)| c * falling(k) * t.powi(k as i32 - order as i32);
            polynomial.iter().enumerate().skip(order).map(term).sum()
        };
        let end =
            End { position: derivative(0), velocity: derivative(1), acceleration: derivative(2) };
        (end, derivative(3))
    }

    /// Polynomials of degree 5 and 7 come back exactly, velocities too.
    #[test]
    fn polynomials_are_reproduced() {
        let polynomial = [0.3, -1.0, 2.0, 0.7, -3.0, 1.1, 0.4, -0.9];
        for (degree, use_jerks) in [(5, false), (7, true)] {
            let polynomial = &polynomial[..=degree];
            let (start, length) = (0.2, 0.5);
            let ((from, j0), (to, j1)) = (end(polynomial, start), end(polynomial, start + length));
            let found = if use_jerks {
                septic(from, to, (j0, j1), length)
            } else {
                quintic(from, to, length)
            };
            for theta in [0.0, 0.25, 0.6, 1.0] {
                let (exact, _) = end(polynomial, start + theta * length);
                assert!((found.position(theta) - exact.position).abs() < 1e-14);
                assert!((found.velocity(theta) - exact.velocity).abs() < 1e-13);
            }
        }
    }
}
