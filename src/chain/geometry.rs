//! Contacts of faces with two curvatures: cylinders that lie across the chain, crossed at an angle,
//! or under spheres.
//!
//! Near the contact two faces are `A x^2 + B y^2` apart, `A <= B`. With the curvature `k_i` of each
//! face at right angles to its axis and the angle `phi_i` of that,
//! `A, B = (sum k_i/2 -+ |sum k_i/2 exp(2 i phi_i)|)/2`; a sphere has `k_i` in both directions.
//! Hertz's contact is an ellipse of semi-axes `b = kappa a`, `e^2 = 1 - kappa^2`, with
//! `B/A = (E/kappa^2 - K)/(K - E)` for the complete elliptic integrals `K(e)` and `E(e)`, and
//! `F = 2/3 pi Estar sqrt((K - E)/(A e^2)) K^(-3/2) overlap^(3/2)`. Source: K. L. Johnson, Contact
//! Mechanics (1985), Eqs. (4.25) to (4.28). Valid as Hertz's law is, and for cylinders much longer
//! than the contact. Parallel cylinders touch along a line, for which there is no such law.

use std::f64::consts::{FRAC_PI_2, PI};

use super::Body;
use super::hertz::{self, Elasticity};

/// Halvings in the search for the ellipse: to the last bit.
const HALVINGS: usize = 200;
/// Ellipses of curvatures closer than this share are circles to rounding, whose error goes as its
/// square (1).
const CIRCLE_SHARE: f64 = 1e-7;
/// Curvatures along a line of contact are smaller than this share of those across it (1).
const LINE_SHARE: f64 = 1e-12;

/// A face of a contact.
#[derive(Debug, Clone, Copy)]
pub struct Face {
    elasticity: Elasticity,
    curvature: f64,
    axis: Option<f64>,
}

impl Face {
    /// A flat wall.
    pub fn flat(elasticity: Elasticity) -> Self {
        Self { elasticity, curvature: 0.0, axis: None }
    }

    /// The faces of a body.
    pub fn of(body: &Body) -> Self {
        Self { elasticity: body.elasticity, curvature: body.curvature, axis: body.axis }
    }
}

/// Stiffness `A` of the contact of two faces in `F = A overlap^1.5` (N/m^1.5), and the radius of
/// the sphere that would be as stiff on a flat (m); both infinite where no curved face is.
pub fn stiffness(upper: Face, lower: Face) -> (f64, f64) {
    if upper.axis.is_none() && lower.axis.is_none() {
        let sides = [upper, lower].map(|face| (face.elasticity, face.curvature));
        return (hertz::stiffness(sides[0], sides[1]), 1.0 / (upper.curvature + lower.curvature));
    }
    let reduced_modulus = reduced_modulus(upper, lower);
    let (mut mean, mut cosine, mut sine) = (0.0, 0.0, 0.0);
    for Face { curvature, axis, .. } in [upper, lower] {
        match axis {
            None => mean += curvature,
            Some(axis) => {
                mean += 0.5 * curvature;
                cosine += 0.5 * curvature * (2.0 * axis).cos();
                sine += 0.5 * curvature * (2.0 * axis).sin();
            }
        }
    }
    let stiffness = reduced_modulus * shape(mean, cosine.hypot(sine));
    (stiffness, (0.75 * stiffness / reduced_modulus).powi(2))
}

/// `E*`, `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2` (Pa).
pub fn reduced_modulus(upper: Face, lower: Face) -> f64 {
    1.0 / (upper.elasticity.compliance() + lower.elasticity.compliance())
}

/// Whether two faces would touch along a line.
pub fn is_line(upper: Face, lower: Face) -> bool {
    let has_axis = upper.axis.is_some() || lower.axis.is_some();
    has_axis && !stiffness(upper, lower).0.is_finite()
}

/// `F/(Estar overlap^1.5)` for the `mean` curvature and the `deviation` from it in both directions
/// (1/m); infinite for a line (m^0.5).
fn shape(mean: f64, deviation: f64) -> f64 {
    let (low, high) = (0.5 * (mean - deviation), 0.5 * (mean + deviation));
    if low <= LINE_SHARE * high {
        return f64::INFINITY;
    }
    if deviation <= CIRCLE_SHARE * mean {
        return 4.0 / 3.0 / mean.sqrt();
    }
    // `B/A` falls from infinity to 1 as the ellipse gets round.
    let ratio = |kappa: f64| {
        let [first, second] = elliptic(kappa);
        (second / (kappa * kappa) - first) / (first - second)
    };
    let (mut narrow, mut round) = (f64::MIN_POSITIVE.ln(), 0.0_f64);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (narrow + round);
        if ratio(middle.exp()) > high / low {
            narrow = middle;
        } else {
            round = middle;
        }
    }
    let kappa = (0.5 * (narrow + round)).exp();
    let [first, second] = elliptic(kappa);
    let eccentricity = (1.0 - kappa) * (1.0 + kappa);
    2.0 / 3.0 * PI * ((first - second) / (low * eccentricity)).sqrt() / first.powf(1.5)
}

/// The complete elliptic integrals `K` and `E` for an axis ratio `kappa`, `e^2 = 1 - kappa^2`, by
/// the arithmetic-geometric mean. Source: M. Abramowitz, I. A. Stegun, Handbook of Mathematical
/// Functions (1964), 17.6.
fn elliptic(kappa: f64) -> [f64; 2] {
    let (mut a, mut b, mut weight) = (1.0_f64, kappa, 0.5);
    let mut sum = weight * (1.0 - kappa) * (1.0 + kappa);
    while (a - b).abs() > f64::EPSILON * a {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        weight *= 2.0;
        sum += weight * c * c;
    }
    let first = FRAC_PI_2 / a;
    [first, first * (1.0 - sum)]
}

#[cfg(test)]
#[allow(clippy::unreadable_literal, reason = "digits as published")]
mod tests {
    use super::*;

    const STEEL: Elasticity = Elasticity { youngs_modulus: 200e9, poissons_ratio: 0.3 };

    fn cylinder(radius: f64, degrees: f64) -> Face {
        Face { elasticity: STEEL, curvature: 1.0 / radius, axis: Some(degrees.to_radians()) }
    }

    /// `K/(E* sqrt R)` of equal cylinders by angle: elliptic integrals and a quadrature of Hertz's
    /// potential integrals by two other codes.
    #[test]
    fn crossed_cylinders_are_those_of_the_table() {
        let reduced = 0.5 * 200e9 / (1.0 - 0.09);
        for (degrees, expected) in [
            (90.0, 1.3333333),
            (75.0, 1.3645692),
            (60.0, 1.4686476),
            (45.0, 1.6873602),
            (30.0, 2.1540517),
            (20.0, 2.8415431),
            (15.0, 3.5024871),
            (10.0, 4.7616067),
            (5.0, 8.2420593),
        ] {
            for turned in [0.0, 17.0, -120.0] {
                let radius = 3e-3;
                let (upper, lower) = (cylinder(radius, turned), cylinder(radius, turned + degrees));
                let (found, _) = stiffness(upper, lower);
                let found = found / (reduced * radius.sqrt());
                assert!((found - expected).abs() < 1e-7, "{degrees}: {found}");
            }
        }
    }

    /// A sphere on a cylinder of immense radius is one on a flat; on a cylinder of its own radius,
    /// the contact is stiffer than one of two spheres and softer than that.
    #[test]
    fn a_sphere_on_a_cylinder_is_between_two_spheres_and_a_flat() {
        let sphere = Face { elasticity: STEEL, curvature: 1e3, axis: None };
        let [flat, round] = [Face::flat(STEEL), sphere].map(|face| stiffness(sphere, face).0);
        let wide = stiffness(sphere, cylinder(1e3, 30.0)).0;
        assert!((wide / flat - 1.0).abs() < 1e-6, "{}", wide / flat);
        let even = stiffness(sphere, cylinder(1e-3, 30.0)).0;
        assert!(round < even && even < flat, "{round} {even} {flat}");
        assert!(is_line(cylinder(1e-3, 0.0), Face::flat(STEEL)));
        assert!(is_line(cylinder(1e-3, 20.0), cylinder(2e-3, 200.0)));
    }
}
