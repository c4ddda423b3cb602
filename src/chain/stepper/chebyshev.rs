//! The polynomial through values at the eight Chebyshev points between -1 and 1. Source: L. N. Trefethen, Approximation Theory and
//! Approximation Practice, SIAM (2013), chapters 3 and 4.

use super::force_track::COEFFICIENTS;

/// Chebyshev points to either side of 0.
pub const POINTS: usize = COEFFICIENTS / 2;

/// `cos(m pi/16)` (1).
pub const fn cosine(m: usize) -> f64 {
    const FIRST: [f64; 9] = [
        1.0,
        0.980_785_280_403_230_4,
        0.923_879_532_511_286_7,
        0.831_469_612_302_545_2,
        std::f64::consts::FRAC_1_SQRT_2,
        0.555_570_233_019_602_2,
        0.382_683_432_365_089_8,
        0.195_090_322_016_128_28,
        0.0,
    ];
    match m % 32 {
        m @ 0..=8 => FIRST[m],
        m @ 9..=16 => -FIRST[16 - m],
        m @ 17..=24 => -FIRST[m - 16],
        m => FIRST[32 - m],
    }
}

/// What the sum or the difference of the values at the Chebyshev points `k` to either side counts for in the coefficient of each power: even
/// powers go by sums, odd ones by differences (1).
pub const FROM_POINTS: [[f64; POINTS]; COEFFICIENTS] = from_points();

/// With `c_j = w_j sum_k cos(j (2k+1) pi/16) f_k` the polynomial is the sum of `c_j T_j`, whose coefficients `T_(j+1) = 2 x T_j - T_(j-1)` gives.
const fn from_points() -> [[f64; POINTS]; COEFFICIENTS] {
    let mut found = [[0.0; POINTS]; COEFFICIENTS];
    let (mut before, mut now) = ([0.0; COEFFICIENTS], [0.0; COEFFICIENTS]);
    now[0] = 1.0;
    let mut j = 0;
    while j < COEFFICIENTS {
        let weight = if j == 0 { 0.125 } else { 0.25 };
        let mut power = 0;
        while power < COEFFICIENTS {
            let mut k = 0;
            while k < POINTS {
                found[power][k] += now[power] * weight * cosine(j * (2 * k + 1));
                k += 1;
            }
            power += 1;
        }
        let mut next = [0.0; COEFFICIENTS];
        let mut power = 0;
        while power < COEFFICIENTS {
            let below = if power == 0 { 0.0 } else { now[power - 1] };
            next[power] = (if j == 0 { 1.0 } else { 2.0 }) * below - before[power];
            power += 1;
        }
        (before, now) = (now, next);
        j += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polynomials of the eight lowest powers are found again.
    #[test]
    fn what_goes_through_chebyshev_points_is_found_from_them() {
        for m in 0..32_u8 {
            let angle = f64::from(m) * std::f64::consts::PI / 16.0;
            assert!((cosine(usize::from(m)) - angle.cos()).abs() < 1e-15, "{m}");
        }
        for power in 0..8_u8 {
            for (of, weights) in (0_u8..).zip(FROM_POINTS) {
                let sum = (0..POINTS).map(|k| {
                    let far = cosine(2 * k + 1).powi(i32::from(power));
                    let near = (-cosine(2 * k + 1)).powi(i32::from(power));
                    weights[k] * if of % 2 == 0 { far + near } else { far - near }
                });
                let expected = f64::from(u8::from(of == power));
                let found: f64 = sum.sum();
                assert!((found - expected).abs() < 1e-13, "{power} {of}: {found}");
            }
        }
    }
}
