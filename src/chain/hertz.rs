//! Hertz's contact between two smooth elastic bodies, as pure functions.
//!
//! `F = A overlap^1.5` while the bodies overlap, 0 otherwise, with `A = 4/3 Estar sqrt(Rstar)`,
//! `1/Estar = (1 - nu1^2)/E1 + (1 - nu2^2)/E2`, `1/Rstar = 1/R1 + 1/R2` (flat: `1/R = 0`). Source:
//! H. Hertz, J. reine angew. Math. 92, 156 (1882); as Eqs. (1) and (2) of Herbold et al. (2009).
//! Valid for small, smooth, frictionless, elastic contacts that are slow against the bodies' own
//! vibrations.

use serde::Serialize;

/// Elastic constants of an isotropic material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Elasticity {
    /// Young's modulus `E` (Pa).
    pub youngs_modulus: f64,
    /// Poisson's ratio `nu`, above -1 and below 0.5 (1).
    pub poissons_ratio: f64,
}

impl Elasticity {
    /// `(1 - nu^2)/E` (1/Pa).
    pub fn compliance(self) -> f64 {
        (1.0 - self.poissons_ratio * self.poissons_ratio) / self.youngs_modulus
    }
}

/// Stiffness `A` of the contact of two bodies with the given elasticities and curvatures `1/R`
/// (1/m), in `F = A overlap^1.5`; infinite for flat on flat, which is no Hertz contact (N/m^1.5).
pub fn stiffness(upper: (Elasticity, f64), lower: (Elasticity, f64)) -> f64 {
    let reduced_modulus = 1.0 / (upper.0.compliance() + lower.0.compliance());
    let reduced_radius = 1.0 / (upper.1 + lower.1);
    4.0 / 3.0 * reduced_modulus * reduced_radius.sqrt()
}

/// Pressure in the middle of a contact at first yield over the yield strength (1).
pub const YIELD_PRESSURE_FACTOR: f64 = 1.6;

/// Force at which the softer body begins to yield below the surface: `pi^3 R^2 p0^3 / (6 Estar^2)`,
/// `p0 = 1.6 Y`, `Y` its `yield_strength` (Pa) in slow uniaxial loading, `Estar` the reduced
/// modulus (Pa) and `R` the reduced radius (m) (N).
///
/// Source: K. L. Johnson, Contact Mechanics (1985), section 6.1; 1.6 holds for Poisson's ratio 0.3
/// and rises by a tenth towards 0.5. Materials that creep yield later in short impacts.
pub fn first_yield(reduced_modulus: f64, reduced_radius: f64, yield_strength: f64) -> f64 {
    let ratio = YIELD_PRESSURE_FACTOR * yield_strength / reduced_modulus;
    std::f64::consts::PI.powi(3) / 6.0 * reduced_radius.powi(2) * ratio.powi(3) * reduced_modulus
}

/// Contact force at `overlap` (m) for stiffness `A` (N/m^1.5); 0 for separated bodies (N).
pub fn force(stiffness: f64, overlap: f64) -> f64 {
    let closed = overlap.max(0.0);
    stiffness * closed * closed.sqrt()
}

/// Overlap under which the contact bears `force` (N), for stiffness `A` (N/m^1.5) (m).
pub fn overlap(stiffness: f64, force: f64) -> f64 {
    let root = cube_root(force / stiffness);
    root * root
}

/// The cube root of `value >= 0`, to rounding. `f64::cbrt` asks the processor first what it can do,
/// in six instructions `CPUID`: where it is a virtual one, 3.7 us each.
fn cube_root(value: f64) -> f64 {
    // The exponent is a rounded third: one step of Newton's method takes that back, as far as the
    // cube is exact.
    let root = value.powf(1.0 / 3.0);
    let (square, lost) = product(root, root);
    let (cube, lost_last) = product(square, root);
    let beyond = (cube - value) + lost_last + lost * root;
    let better = root - beyond / (3.0 * square);
    if better.is_finite() { better } else { root }
}

/// `a b`, and what rounding took from it: the two add up to it. Source: T. J. Dekker, Numer. Math.
/// 18, 224 (1971).
fn product(a: f64, b: f64) -> (f64, f64) {
    let halves = |value: f64| {
        let scaled = value * 134_217_729.0; // 2^27 + 1
        let upper = scaled - (scaled - value);
        (upper, value - upper)
    };
    let ((a_upper, a_lower), (b_upper, b_lower)) = (halves(a), halves(b));
    let rounded = a * b;
    let middle = (a_upper * b_upper - rounded) + a_upper * b_lower + a_lower * b_upper;
    (rounded, middle + a_lower * b_lower)
}

/// Elastic energy stored at `overlap` (m): `2/5 A overlap^2.5` (J).
pub fn energy(stiffness: f64, overlap: f64) -> f64 {
    let closed = overlap.max(0.0);
    0.4 * stiffness * closed * closed * closed.sqrt()
}

/// Change of the contact force when the overlap grows by `change` (m) over the static one, whose
/// square root is `static_root` (m^0.5); exact to rounding however small the change (N).
///
/// With `s = sqrt(overlap)` and `r = s + s0` this is `A change (r - s s0/r)` while closed. The
/// difference `A (s^3 - s0^3)` would lose as many digits as the wave is weaker than the preload:
/// nine for 1 nm/s under 1 kN.
pub fn force_change(stiffness: f64, static_root: f64, change: f64) -> f64 {
    force_and_tangent(stiffness, static_root, change).0
}

/// The same (N), and the contact's stiffness against further changes (N/m), as
/// [`tangent_stiffness`] has it.
#[inline]
pub fn force_and_tangent(stiffness: f64, static_root: f64, change: f64) -> (f64, f64) {
    let static_overlap = static_root * static_root;
    // An open contact has lost its whole static force, whatever the gap. A comparison, for `max`
    // would turn what is not a number into a gap.
    let change = if change < -static_overlap { -static_overlap } else { change };
    let root = (static_overlap + change).max(0.0).sqrt();
    let sum = root + static_root;
    let force = stiffness * change * (sum - root * static_root / sum.max(f64::MIN_POSITIVE));
    (force, 1.5 * stiffness * root)
}

/// Contact stiffness against small changes, `dF/d overlap = 3/2 A sqrt(overlap)` (N/m).
pub fn tangent_stiffness(stiffness: f64, overlap: f64) -> f64 {
    1.5 * stiffness * overlap.max(0.0).sqrt()
}

/// Largest overlap of two free bodies of reduced mass `reduced_mass` (kg) that meet with
/// `closing_speed` (m/s): `(5 mu v^2 / 4A)^(2/5)` (m).
pub fn collision_overlap(stiffness: f64, reduced_mass: f64, closing_speed: f64) -> f64 {
    (1.25 * reduced_mass * closing_speed * closing_speed / stiffness).powf(0.4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn force_change_agrees_with_the_plain_difference_and_opens() {
        let (a, d0) = (1.194e8, 7.35e-6_f64);
        for change in [-1e-5, -7.35e-6, -3e-6, -1e-9, 0.0, 1e-9, 4e-6, 2e-5] {
            let plain = force(a, d0 + change) - force(a, d0);
            let exact = force_change(a, d0.sqrt(), change);
            assert!((plain - exact).abs() <= 4e-15 * force(a, d0 + change.abs()), "{change}");
        }
        assert!((force_change(a, 0.0, 4e-6) - force(a, 4e-6)).abs() < 1e-15);
        assert!(force_change(a, 0.0, -1.0).abs() < f64::MIN_POSITIVE);
        assert!(force_change(a, 0.0, 0.0).abs() < f64::MIN_POSITIVE);
    }

    /// As the standard library's correctly rounded one, over all forces that a bench has, and
    /// beyond.
    #[test]
    #[allow(clippy::float_cmp, reason = "the same to the last bit")]
    fn cube_roots_are_those_of_the_standard_library() {
        for exponent in -1000..1000 {
            let value = 10.0_f64.powf(f64::from(exponent) / 50.0);
            assert_eq!(cube_root(value), value.cbrt(), "{value:e}");
        }
        assert_eq!(cube_root(0.0), 0.0);
        assert_eq!(cube_root(f64::INFINITY), f64::INFINITY);
        assert!(cube_root(f64::NAN).is_nan());
    }

    /// By hand from Johnson's Eqs. (4.24) and (6.9): `E* = 100 GPa`, `R* = 10 mm`, `Y = 1 GPa`, so
    /// that `p0 = 1.6 GPa` and `F = pi^3 (10 mm)^2 (1.6 GPa)^3 / (6 (100 GPa)^2) = 211.67 N`.
    #[test]
    fn first_yield_is_that_of_johnson() {
        let force = first_yield(100e9, 0.01, 1e9);
        assert!((force - 211.67).abs() < 0.005, "{force}");
    }

    #[test]
    fn overlap_inverts_force() {
        for f in [1e-9, 4.4e-3, 2.38, 1e3] {
            assert!((force(1.2e8, overlap(1.2e8, f)) / f - 1.0).abs() < 4e-16 * 4.0);
        }
    }
}
