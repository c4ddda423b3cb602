//! From standard to expanded uncertainty: the coverage factor of 95 % by effective degrees of freedom.
//!
//! `U95 = t_0.975(nu) u`, `nu` by Welch and Satterthwaite, `nu = u^4 / sum of u_i^4/nu_i`.
//! Source: JCGM 100:2008, annex G (G.2b, and G.4.2: `nu` truncated to a whole number). Valid for sums of independent inputs
//! that are normal or many.

/// Coverage factor of a normal distribution's 95 % (1).
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Coverage factor of 95 % for `freedom` degrees of freedom: Student's `t`, two-sided (1).
///
/// One and two degrees in closed form; more by the expansion of M. Abramowitz, I. Stegun, "Handbook of Mathematical Functions"
/// (1964), Eq. 26.7.5, within 0.12 % at three degrees and closer beyond.
pub fn student_95(freedom: f64) -> f64 {
    let nu = freedom.floor().max(1.0);
    if nu < 2.0 {
        return 12.706_204_736_432_1;
    }
    if nu < 3.0 {
        return 4.302_652_729_696_14;
    }
    let z = NORMAL_95;
    let square = z * z;
    let terms = [
        (square + 1.0) / 4.0,
        ((5.0 * square + 16.0) * square + 3.0) / 96.0,
        (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0,
        ((((79.0 * square + 776.0) * square + 1482.0) * square - 1920.0) * square - 945.0)
            / 92160.0,
    ];
    // Horner's scheme in 1/nu.
    z * terms.iter().rev().fold(0.0, |sum, term| (sum + term) / nu) + z
}

/// Where the normal distribution has `share` of its probability below (1).
///
/// P. J. Acklam's rational approximation (2003), within 1.2e-9 of the value.
pub fn normal_quantile(share: f64) -> f64 {
    const CENTRE: ([f64; 6], [f64; 5]) = (
        [
            -39.696_830_286_653_76,
            220.946_098_424_520_5,
            -275.928_510_446_968_7,
            138.357_751_867_269,
            -30.664_798_066_147_16,
            2.506_628_277_459_239,
        ],
        [
            -54.476_098_798_224_06,
            161.585_836_858_040_9,
            -155.698_979_859_886_6,
            66.801_311_887_719_72,
            -13.280_681_552_885_72,
        ],
    );
    const TAIL: ([f64; 6], [f64; 4]) = (
        [
            -0.007_784_894_002_430_293,
            -0.322_396_458_041_136_5,
            -2.400_758_277_161_838,
            -2.549_732_539_343_734,
            4.374_664_141_464_968,
            2.938_163_982_698_783,
        ],
        [
            0.007_784_695_709_041_462,
            0.322_467_129_070_039_8,
            2.445_134_137_142_996,
            3.754_408_661_907_416,
        ],
    );
    const BREAK: f64 = 0.024_25;
    let horner = |coefficients: &[f64], x: f64| coefficients.iter().fold(0.0, |sum, c| sum * x + c);
    let tail = |share: f64| {
        let q = (-2.0 * share.ln()).sqrt();
        horner(&TAIL.0, q) / (horner(&TAIL.1, q) * q + 1.0)
    };
    if share < BREAK {
        tail(share)
    } else if share > 1.0 - BREAK {
        -tail(1.0 - share)
    } else {
        let q = share - 0.5;
        let r = q * q;
        horner(&CENTRE.0, r) * q / (horner(&CENTRE.1, r) * r + 1.0)
    }
}

/// Effective degrees of freedom of a sum of independent parts, each with its standard uncertainty and degrees of freedom (1).
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

    /// Against JCGM 100:2008, table G.2 (95 %), and its example H.1: 16 degrees for lengths of end gauges.
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
