//! The polynomial of degree 7 through values and slopes at -1 and 1 and through values at four places between.
//!
//! It is off by `f^(8)/8!` somewhere in between, times `(1 - x^2)^2 (x^2 - a) (x^2 - b)`, which these places keep as small as they can:
//! 0.019, where the eight Chebyshev points, which take twice as many values, come to 0.0078. Source: L. N. Trefethen, Approximation Theory and
//! Approximation Practice, SIAM (2013), chapters 5 and 11; the places are those where the three extremes are of one height, which a test holds.

use super::force_track::COEFFICIENTS;

/// Places between to either side of 0.
pub const BETWEEN: usize = 2;
/// Where they are (1).
pub const PLACES: [f64; BETWEEN] = [0.219_416_000_858_131, 0.627_122_457_090_862];
/// Coefficients of even powers, and of odd ones.
const HALF: usize = COEFFICIENTS / 2;

/// What counts for the coefficient of each even power: the sums of the values at the places to either side, and at both ends, and what the slope
/// at 1 exceeds that at -1 by (1).
pub const EVEN: [[f64; HALF]; HALF] = part(false);
/// What counts for the coefficient of each odd power: the same differences, and the sum of both slopes (1).
pub const ODD: [[f64; HALF]; HALF] = part(true);

/// Cubics in `u`, coefficient by coefficient, that are 1 in one thing and 0 in all others: in their values at `a`, `b` and 1, and in their slopes at 1.
const fn cubics() -> [[f64; HALF]; HALF] {
    let [a, b] = [PLACES[0] * PLACES[0], PLACES[1] * PLACES[1]];
    let slope = through([a, b, 1.0], (1.0 - a) * (1.0 - b));
    let quadratic = through([a, b, f64::INFINITY], (1.0 - a) * (1.0 - b));
    let steep = 1.0 / (1.0 - a) + 1.0 / (1.0 - b);
    let mut one = [0.0; HALF];
    let mut power = 0;
    while power < HALF {
        one[power] = quadratic[power] - steep * slope[power];
        power += 1;
    }
    let at_a = through([b, 1.0, 1.0], (a - b) * (a - 1.0) * (a - 1.0));
    let at_b = through([a, 1.0, 1.0], (b - a) * (b - 1.0) * (b - 1.0));
    [at_a, at_b, one, slope]
}

/// The polynomial with these roots over `scale`; one that is infinite counts for none.
const fn through(roots: [f64; 3], scale: f64) -> [f64; HALF] {
    let mut found = [0.0; HALF];
    found[0] = 1.0 / scale;
    let mut i = 0;
    while i < roots.len() {
        if roots[i].is_finite() {
            let mut power = HALF - 1;
            while power > 0 {
                found[power] = found[power - 1] - roots[i] * found[power];
                power -= 1;
            }
            found[0] *= -roots[i];
        }
        i += 1;
    }
    found
}

/// The even part is a cubic in `u = x^2`, whose slope at 1 is half as large in `u`; the odd part is `x` times one, whose slope at 1 is half of what
/// the part's exceeds its value by.
const fn part(is_odd: bool) -> [[f64; HALF]; HALF] {
    let [at_a, at_b, one, slope] = cubics();
    let mut found = [[0.0; HALF]; HALF];
    let mut power = 0;
    while power < HALF {
        let slope = 0.5 * slope[power];
        let [a, b, one] = if is_odd {
            [at_a[power] / PLACES[0], at_b[power] / PLACES[1], one[power] - slope]
        } else {
            [at_a[power], at_b[power], one[power]]
        };
        found[power] = [0.5 * a, 0.5 * b, 0.5 * one, 0.5 * slope];
        power += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polynomials of the eight lowest powers are found again.
    #[test]
    fn what_goes_through_all_that_is_known_is_found_from_it() {
        for power in 0..8_u8 {
            let exponent = i32::from(power);
            let sign = if power % 2 == 0 { 1.0 } else { -1.0 };
            let values = PLACES.map(|x| x.powi(exponent));
            let slope = f64::from(power);
            for (of, (weights, side)) in (0_u8..)
                .zip(EVEN.iter().zip(&ODD).flat_map(|(even, odd)| [(even, 1.0), (odd, -1.0)]))
            {
                // The value at -x is that at x times the sign, the slope times the other sign.
                let both = 1.0 + side * sign;
                let known = [both * values[0], both * values[1], both, slope * both];
                let found: f64 =
                    weights.iter().zip(known).map(|(weight, known)| weight * known).sum();
                let expected = f64::from(u8::from(of == power));
                assert!((found - expected).abs() < 1e-12, "{power} {of}: {found}");
            }
        }
    }

    /// No other places do better: the three extremes are of one height, and of signs in turn.
    #[test]
    fn places_between_are_the_best() {
        let [a, b] = PLACES.map(|x| x * x);
        let error = |u: f64| (1.0 - u).powi(2) * (u - a) * (u - b);
        let all = || (0..=100_000).map(|i| error(f64::from(i) / 100_000.0));
        let (highest, lowest) = (all().fold(0.0, f64::max), all().fold(0.0, f64::min));
        let outer = (0..=100_000).map(|i| b + (1.0 - b) * f64::from(i) / 100_000.0).map(error);
        for height in [highest, -lowest, outer.fold(0.0, f64::max), error(0.0)] {
            assert!((height - 0.018_934).abs() < 1e-6, "{height}");
        }
    }
}
