//! From standard to expanded uncertainty: the coverage factor of 95 % by effective degrees of
//! freedom.
//!
//! `U95 = t_0.975(nu) u`, `nu` by Welch and Satterthwaite, `nu = u^4 / sum of u_i^4/nu_i`. Source:
//! JCGM 100:2008, annex G (G.2b, and G.4.2: `nu` truncated to a whole number). Valid for sums of
//! independent inputs that are normal or many.

use std::f64::consts::{SQRT_2, TAU};

use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::erf::{erfc, erfc_inv};
use statrs::function::gamma::checked_gamma_ur;

/// Coverage factor of a normal distribution's 95 % (1).
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Freedom from which on the series of Student's `t` has 12 digits (1).
const SERIES_FREEDOM: f64 = 1e4;
/// Halvings of the interval from 0 to 16, which holds `t_0.975` of any freedom, to its last bits.
const HALVINGS: usize = 56;

/// Coverage factor of 95 % for `freedom` degrees of freedom: Student's `t`, two-sided (1).
///
/// By bisection of the distribution function: the inverse that statrs has does not end for some
/// freedoms. From `SERIES_FREEDOM` on `t = z + (z^3 + z)/(4 nu) + (5 z^5 + 16 z^3 + 3 z)/(96
/// nu^2)` with the normal quantile `z` (Abramowitz and Stegun 1964, 26.7.5).
pub fn student_95(freedom: f64) -> f64 {
    let nu = freedom.floor().max(1.0);
    if nu >= SERIES_FREEDOM {
        let z = NORMAL_95;
        let cube = z.powi(3);
        let second = (5.0 * z.powi(5) + 16.0 * cube + 3.0 * z) / (96.0 * nu);
        return z + ((cube + z) / 4.0 + second) / nu;
    }
    let Ok(student) = StudentsT::new(0.0, 1.0, nu) else { return f64::NAN };
    let (mut low, mut high) = (0.0, 16.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if student.cdf(middle) < 0.975 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Value below which a normal distribution has `share` of its probability (1).
pub fn normal_quantile(share: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * share)
}

/// Share of the normal distribution below `z` (1).
pub fn normal_share(z: f64) -> f64 {
    0.5 * erfc(-z / SQRT_2)
}

/// Probability that a chi-squared variable with `freedom` degrees of freedom exceeds `value` (1).
pub fn chi_squared_beyond(value: f64, freedom: f64) -> f64 {
    checked_gamma_ur(0.5 * freedom, 0.5 * value.max(f64::MIN_POSITIVE)).unwrap_or(f64::NAN)
}

/// Half-width of the interval that holds 95 % of a sum of two parts, a normal one and one that is
/// evenly distributed within `half_width` (unit) either way; `u` is the standard uncertainty of
/// both together (unit).
///
/// `P(|x| <= h) = (s/a) [G((h + a)/s) - G((h - a)/s)] - 1` with the normal part's `s`, the
/// half-width `a` and `G(z) = z Phi(z) + phi(z)`; without the normal part 95 % of the half-width.
/// Source: the integral of the normal distribution over the even one (JCGM 101:2008, 6.4.2 and
/// 6.4.7, give both).
pub fn expanded_95(u: f64, half_width: f64) -> f64 {
    /// Smallest part of the whole that counts (1).
    const NEGLIGIBLE: f64 = 1e-3;
    let (s, a) = ((u * u - half_width * half_width / 3.0).max(0.0).sqrt(), half_width);
    if a <= NEGLIGIBLE * u || !u.is_finite() {
        return NORMAL_95 * u;
    }
    if s <= NEGLIGIBLE * u {
        return 0.95 * a;
    }
    let integral = |z: f64| z * normal_share(z) + (-0.5 * z * z).exp() / TAU.sqrt();
    let held = |h: f64| s / a * (integral((h + a) / s) - integral((h - a) / s)) - 1.0;
    let (mut low, mut high) = (0.0, 2.0 * u);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if held(middle) < 0.95 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Half-width of the even part of a sum of a normal and an even one, from its standard uncertainty
/// (unit) and its fourth cumulant (unit^4), to which the normal part adds nothing and the even one
/// `-2 a^4/15` (unit).
pub fn even_half_width(u: f64, fourth_cumulant: f64) -> f64 {
    (-7.5 * fourth_cumulant).max(0.0).sqrt().sqrt().min(3f64.sqrt() * u)
}

/// Effective degrees of freedom of a sum of independent parts, each with its standard uncertainty
/// and degrees of freedom (1).
pub fn effective_freedom(parts: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let (mut variance, mut fourth) = (0.0, 0.0);
    for (u, freedom) in parts {
        variance += u * u;
        fourth += u.powi(4) / freedom;
    }
    if fourth > 0.0 { variance * variance / fourth } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against draws, a linear congruence's: the interval holds 95 % of sums of both parts,
    /// whatever their sizes.
    #[test]
    fn intervals_of_normal_and_even_parts_hold_95_per_cent() {
        let mut state = 5_u64;
        let mut even = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        for (s, a) in [(1.0, 0.0), (1.0, 0.3), (1.0, 1.0), (1.0, 3.0), (0.1, 1.0), (0.0, 1.0)] {
            let u = f64::hypot(s, a / 3f64.sqrt());
            let half = expanded_95(u, a);
            let mut inside = 0;
            for _ in 0..100_000 {
                let normal = (-2.0 * even().ln()).sqrt() * (TAU * even()).cos();
                let off: f64 = s * normal + a * (2.0 * even() - 1.0);
                inside += i32::from(off.abs() <= half);
            }
            // 0.07 % of binomial scatter.
            assert!((f64::from(inside) / 1e5 - 0.95).abs() < 0.003, "{s} {a}: {inside}");
        }
        // EA-4/02 M:2022, S9.14: a dominant even part has k = 1.65.
        assert!((expanded_95(1.0, 3f64.sqrt()) - 1.65).abs() < 0.006);
    }

    /// Against the closed forms for 1, 2 and 4 degrees (Shaw 2006), and between 9,999 degrees by
    /// the distribution function and the series: the inverse that a library has went on for ever
    /// for some, and with it `calibrate`.
    #[test]
    fn coverage_factors_are_found_for_any_freedom() {
        let one = (0.475 * std::f64::consts::PI).tan();
        let two = 0.95 * (2.0 / 0.0975_f64).sqrt();
        let root = 0.0975_f64.sqrt();
        let four = 2.0 * ((root.acos() / 3.0).cos() / root - 1.0).sqrt();
        for (freedom, factor) in [(1.0, one), (2.0, two), (4.0, four)] {
            assert!((student_95(freedom) / factor - 1.0).abs() < 1e-12, "{freedom}");
        }
        let mut before = f64::INFINITY;
        for freedom in (1..12_000).map(f64::from).chain((5..300).map(|power| 10f64.powi(power))) {
            let factor = student_95(freedom);
            // From 1e8 on the change is below the last bits.
            assert!(factor <= before && factor >= NORMAL_95, "{freedom}: {factor} {before}");
            before = factor;
        }
        let (below, above) = (student_95(9_999.0), student_95(10_000.0));
        // (z^3 + z)/4 (1/nu - 1/(nu + 1)) = 2.37251e-8, and 5.6e-12 from the next term.
        assert!((below - above - 2.37308e-8).abs() < 1e-12, "{below} {above}");
    }

    /// Against a table (Abramowitz and Stegun 1964, table 26.8): 5 % lie beyond 3.841, 11.071 and
    /// 18.307 for 1, 5 and 10 degrees; for two `exp(-x/2)`.
    #[test]
    fn chi_squared_is_that_of_the_tables() {
        for (freedom, value) in [(1.0, 3.84146), (5.0, 11.07050), (10.0, 18.30704)] {
            assert!((chi_squared_beyond(value, freedom) - 0.05).abs() < 1e-6, "{freedom}");
        }
        assert!((chi_squared_beyond(3.0, 2.0) - (-1.5_f64).exp()).abs() < 1e-12);
    }

    /// Against JCGM 100:2008, table G.2 (95 %), and its example H.1: 16 degrees for lengths of end
    /// gauges.
    #[test]
    fn coverage_factors_are_those_of_the_gum() {
        let table = [
            (1.0, 12.71),
            (2.0, 4.30),
            (3.0, 3.18),
            (4.0, 2.78),
            (5.0, 2.57),
            (10.0, 2.23),
            (20.0, 2.09),
            (50.0, 2.01),
        ];
        for (freedom, factor) in table {
            assert!(
                (student_95(freedom) - factor).abs() < 0.006,
                "{freedom}: {}",
                student_95(freedom)
            );
        }
        for (share, quantile) in
            [(0.975, NORMAL_95), (0.5, 0.0), (0.841_344_746, 1.0), (0.001_349_898, -3.0)]
        {
            assert!((normal_quantile(share) - quantile).abs() < 1e-7, "{share}");
        }
        assert!((student_95(3.9) - student_95(3.0)).abs() < 1e-12, "truncated");
        assert!((student_95(f64::INFINITY) - 1.96).abs() < 1e-4);
        // H.1.6: u = 32, parts 25 (18 degrees), 9.7 (25.6), 2.9 (50), 16.6 (2).
        let found = effective_freedom([(25.0, 18.0), (9.7, 25.6), (2.9, 50.0), (16.6, 2.0)]);
        assert!((found - 16.7).abs() < 0.7, "{found}");
    }
}
