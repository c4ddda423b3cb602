//! Coefficients of losses from a coefficient of restitution at a stated speed.
//!
//! Two bodies of reduced mass `mu` that meet at `v` on a contact of stiffness `A` come apart at
//! `e v`. In the length `L = (mu v^2/A)^(2/5)`, the time `L/v` and the force `A L^1.5` their
//! overlap follows `s'' = -s^1.5 - f(s, s')`, `s = 0` and `s' = 1` at first, `f` the loss's law
//! with the stiffness 1. `e` falls with the coefficient, which is found by halving an interval.
//! Walls are immovable, and the collision is that of two free bodies: in a chain, which holds them,
//! each contact loses less or more.

use super::loss::{ContactLoss, EndOfContact, Touch};

/// A coefficient of restitution, and the speed at which it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Restitution {
    /// Speed of parting over that of meeting (1).
    pub value: f64,
    /// Speed of meeting (m/s).
    pub speed: f64,
}

/// Logarithms of the dimensionless coefficients between which the right one is looked for.
const RANGE: (f64, f64) = (-30.0, 6.0);
/// Halvings of that interval: to the last digits that a collision's steps leave.
const HALVINGS: usize = 45;
/// Step of a collision, which lasts 3.2 without losses (1).
const STEP: f64 = 2e-3;
/// Steps of a collision at most: with strong losses it takes long.
const MAX_STEPS: usize = 100_000;

/// The coefficient of the loss at a place among [`super::LOSS_MODELS`], with this end of contact
/// and `exponent` (1), that makes two bodies of reduced `mass` (kg) on a contact of `stiffness` `A`
/// (N/m^1.5) come apart so (unit).
pub fn coefficient(
    (kind, end, exponent): (usize, EndOfContact, f64),
    Restitution { value, speed }: Restitution,
    stiffness: f64,
    mass: f64,
) -> f64 {
    let loss = |coefficient: f64| {
        let mut coefficients = [0.0; 3];
        coefficients[kind] = coefficient;
        let [dashpot, relaxation, power_force] = coefficients;
        ContactLoss { dashpot, relaxation, power_force, power_exponent: exponent, end }
    };
    let (mut low, mut high) = RANGE;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if rebound(loss(middle.exp()), middle.exp()) > value {
            low = middle;
        } else {
            high = middle;
        }
    }
    let length = (mass * speed * speed / stiffness).powf(0.4);
    let force = stiffness * length.powf(1.5);
    let units = [force / speed, length / speed, force / speed.powf(exponent)];
    (0.5 * (low + high)).exp() * units[kind]
}

/// Speed at which a contact with this `loss` ends, whose largest coefficient is `size` (1).
fn rebound(loss: ContactLoss, size: f64) -> f64 {
    let force = |[s, v]: [f64; 2]| {
        let closed = s.max(0.0);
        let elastic = closed * closed.sqrt();
        let touch = Touch { overlap: closed, closing: v, elastic, closed: true };
        elastic + loss.terms(1.0, touch).iter().sum::<f64>()
    };
    let ended = |state: [f64; 2]| {
        state[1] < 0.0
            && match loss.end {
                EndOfContact::ZeroOverlap => state[0] <= 0.0,
                EndOfContact::ZeroForce => force(state) <= 0.0,
            }
    };
    let step = |[s, v]: [f64; 2], h: f64| {
        let rate = |state: [f64; 2]| [state[1], -force(state)];
        let add = |k: [f64; 2], by: f64| [s + by * k[0], v + by * k[1]];
        let a = rate([s, v]);
        let b = rate(add(a, 0.5 * h));
        let c = rate(add(b, 0.5 * h));
        let d = rate(add(c, h));
        [0, 1].map(|i| [s, v][i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
    };
    let mut state = [0.0, 1.0];
    for _ in 0..MAX_STEPS {
        // Strong losses are stiff.
        let h = STEP / (1.0 + size);
        let next = step(state, h);
        if ended(next) {
            let (mut low, mut high) = (0.0, h);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if ended(step(state, middle)) { high = middle } else { low = middle }
            }
            return -step(state, high)[1];
        }
        state = next;
    }
    0.0
}

#[cfg(test)]
#[allow(clippy::unreadable_literal, reason = "digits as published")]
mod tests {
    use super::*;

    /// The table of viscoelastic collisions, `e` for `x = 3/2 eta (A/mu)^(2/5) v^(1/5)`, backward.
    #[test]
    fn viscoelastic_collisions_are_those_of_the_table() {
        for (x, at_zero_overlap, at_zero_force) in [
            (0.01, 0.988545, 0.988547),
            (0.05, 0.944260, 0.944397),
            (0.1, 0.892148, 0.892859),
            (0.2, 0.797550, 0.800965),
        ] {
            for (end, value) in [
                (EndOfContact::ZeroOverlap, at_zero_overlap),
                (EndOfContact::ZeroForce, at_zero_force),
            ] {
                let (stiffness, mass, speed) = (3e9_f64, 2e-3_f64, 0.7_f64);
                let law = (1, end, 1.0);
                let eta = coefficient(law, Restitution { value, speed }, stiffness, mass);
                let found = 1.5 * eta * (stiffness / mass).powf(0.4) * speed.powf(0.2);
                // The table's last digit is 5e-7 of e, which falls by about x.
                assert!((found / x - 1.0).abs() < 1e-4, "{x}: {found}");
            }
        }
    }
}
