//! Interpolation of a step from what is known at its two ends: any method's dense output.
//!
//! With position, velocity and acceleration at both ends a quintic, with their rates in addition a
//! septic. Errors go as the step to the power 6 and 8, with the small constants `1/(6! 2^6)` and
//! `1/(8! 2^8)` at mid-step. Source: C. Hermite, J. reine angew. Math. 84, 70 (1878).

use crate::chain::State;

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

/// Fractions of a step at which a motion is interpolated that is known by its values: Chebyshev's
/// nodes (1).
pub fn nodes() -> [f64; COEFFICIENTS] {
    std::array::from_fn(|i| {
        let angle = std::f64::consts::PI * (i as f64 + 0.5) / COEFFICIENTS as f64;
        0.5 * (1.0 - angle.cos())
    })
}

/// Coefficients of the polynomial with these values at [`nodes`], by divided differences (unit).
pub fn through_nodes(values: [f64; COEFFICIENTS]) -> [f64; COEFFICIENTS] {
    let (nodes, mut differences) = (nodes(), values);
    for order in 1..COEFFICIENTS {
        for i in (order..COEFFICIENTS).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (nodes[i] - nodes[i - order]);
        }
    }
    let mut powers = [0.0; COEFFICIENTS];
    for (node, difference) in nodes.iter().zip(differences).rev() {
        for power in (1..COEFFICIENTS).rev() {
            powers[power] = powers[power - 1] - node * powers[power];
        }
        powers[0] = difference - node * powers[0];
    }
    powers
}

/// Value of a polynomial with these coefficients (unit).
pub fn horner(coefficients: &[f64; COEFFICIENTS], theta: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * theta + c)
}

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

/// The motion of `body` between two states with their accelerations (m/s²): a quintic.
pub fn between(from: (&State, &[f64]), to: (&State, &[f64]), body: usize) -> Interpolant {
    let at = |values: &[f64]| values.get(body).copied().unwrap_or(0.0);
    let end = |(state, acceleration): (&State, &[f64])| End {
        position: at(&state.position),
        velocity: at(&state.velocity),
        acceleration: at(acceleration),
    };
    quintic(end(from), end(to), to.0.time - from.0.time)
}

/// The quintic through both ends of a step of `length` (s).
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
pub fn septic(from: End, to: End, jerks: (f64, f64), length: f64) -> Interpolant {
    let position = septic_coefficients(from, to, jerks, length);
    Interpolant { position, velocity: derivative(&position, length) }
}

/// The coefficients of its powers alone (m).
pub fn septic_coefficients(
    from: End,
    to: End,
    jerks: (f64, f64),
    length: f64,
) -> [f64; COEFFICIENTS] {
    let h = length;
    let jerk = h * h * h * jerks.0;
    let (p, q, r) = rises(from, to, h);
    // What the cubic Taylor polynomial of the start leaves over at the end, derivative by
    // derivative.
    let (p, q, r) = (p - jerk / 6.0, q - jerk / 2.0, r - jerk);
    let rest = h * h * h * jerks.1 - jerk;
    [
        from.position,
        h * from.velocity,
        0.5 * h * h * from.acceleration,
        jerk / 6.0,
        35.0 * p - 15.0 * q + 2.5 * r - rest / 6.0,
        -84.0 * p + 39.0 * q - 7.0 * r + 0.5 * rest,
        70.0 * p - 34.0 * q + 6.5 * r - 0.5 * rest,
        -20.0 * p + 10.0 * q - 2.0 * r + rest / 6.0,
    ]
}

/// Weights of position, velocity, acceleration and jerk at the start and at the end in the septic
/// of a step of `length` (s), at the fraction `theta` of the step (1, s, s², s³).
pub fn septic_weights(theta: f64, length: f64) -> [[f64; 4]; 2] {
    let (t, h) = (theta, length);
    let fourth = t * t * t * t;
    // What the end's values are weighed by, less what the Taylor polynomial of the start makes of
    // them.
    let p = fourth * (35.0 + t * (-84.0 + t * (70.0 - 20.0 * t)));
    let q = fourth * (-15.0 + t * (39.0 + t * (-34.0 + 10.0 * t)));
    let r = fourth * (2.5 + t * (-7.0 + t * (6.5 - 2.0 * t)));
    let s = fourth * (-1.0 / 6.0 + t * (0.5 + t * (-0.5 + t / 6.0)));
    let from = [
        1.0 - p,
        h * (t - p - q),
        h * h * (0.5 * t * t - 0.5 * p - q - r),
        h * h * h * (t * t * t / 6.0 - p / 6.0 - 0.5 * q - r - s),
    ];
    [from, [p, h * q, h * h * r, h * h * h * s]]
}

/// What the quadratic Taylor polynomial of the start leaves over at the end: position, velocity,
/// acceleration, each times its power of the step (m).
fn rises(from: End, to: End, h: f64) -> (f64, f64, f64) {
    let (v0, a0) = (h * from.velocity, h * h * from.acceleration);
    let p = to.position - from.position - v0 - 0.5 * a0;
    let q = h * to.velocity - v0 - a0;
    let r = h * h * to.acceleration - a0;
    (p, q, r)
}

/// Rate of a polynomial over a step of length `h` (s), whose coefficients are these (unit).
pub fn derivative(position: &[f64; COEFFICIENTS], h: f64) -> [f64; COEFFICIENTS] {
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

    /// Values of a polynomial, and its third derivative, by differentiating its coefficients.
    fn end(polynomial: &[f64], t: f64) -> (End, f64) {
        let value = |c: &[f64]| c.iter().rev().fold(0.0, |sum, c| sum * t + c);
        let rate = |c: &[f64]| -> Vec<f64> {
            (1_u8..).zip(&c[1..]).map(|(power, c)| f64::from(power) * c).collect()
        };
        let velocity = rate(polynomial);
        let acceleration = rate(&velocity);
        let end = End {
            position: value(polynomial),
            velocity: value(&velocity),
            acceleration: value(&acceleration),
        };
        (end, value(&rate(&acceleration)))
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
                if use_jerks {
                    let [early, late] = septic_weights(theta, length);
                    let values =
                        |end: End, jerk| [end.position, end.velocity, end.acceleration, jerk];
                    let terms = early.into_iter().zip(values(from, j0));
                    let terms = terms.chain(late.into_iter().zip(values(to, j1)));
                    let sum: f64 = terms.map(|(weight, value)| weight * value).sum();
                    assert!((sum - exact.position).abs() < 1e-14);
                }
            }
        }
    }
}
