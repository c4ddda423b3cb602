//! Contacts of another exponent than Hertz's, as pure functions: `F = A overlap^p` while the bodies
//! overlap, 0 otherwise.
//!
//! Hollow spheres, rods of woodpiles, O-rings and rough surfaces follow such laws over the range in
//! which they were measured; `A` and `p` are the fit. Source: V. F. Nesterenko, Dynamics of
//! Heterogeneous Materials (2001), section 1.7.

/// Below this share of the static overlap, changes of energy are summed as a series (1).
const SERIES_SHARE: f64 = 0.05;
/// Terms of that series: the last is below rounding (1).
const TERMS: i32 = 20;

/// Force at `overlap` (m), for `A` (N/m^p) (N).
pub fn force(stiffness: f64, exponent: f64, overlap: f64) -> f64 {
    stiffness * overlap.max(0.0).powf(exponent)
}

/// Overlap under `force` (N) (m).
pub fn overlap(stiffness: f64, exponent: f64, force: f64) -> f64 {
    (force / stiffness).powf(exponent.recip())
}

/// `dF/d overlap` at `overlap` (m); 0 while open (N/m).
pub fn tangent_stiffness(stiffness: f64, exponent: f64, overlap: f64) -> f64 {
    if overlap > 0.0 { exponent * stiffness * overlap.powf(exponent - 1.0) } else { 0.0 }
}

/// Elastic energy at `overlap` (m): `A overlap^(p+1)/(p+1)` (J).
pub fn energy(stiffness: f64, exponent: f64, overlap: f64) -> f64 {
    stiffness * overlap.max(0.0).powf(exponent + 1.0) / (exponent + 1.0)
}

/// The overlap that takes `energy` (J) (m).
pub fn overlap_of_energy(stiffness: f64, exponent: f64, energy: f64) -> f64 {
    ((exponent + 1.0) * energy / stiffness).powf((exponent + 1.0).recip())
}

/// Change of the force when the overlap grows by `change` (m) over the static one, `rest` (m);
/// exact to rounding however small the change (N).
pub fn force_change(stiffness: f64, exponent: f64, rest: f64, change: f64) -> f64 {
    if rest == 0.0 {
        return force(stiffness, exponent, change);
    }
    // `A rest^p ((1 + e)^p - 1)`; an open contact has lost its whole static force.
    let grown = (exponent * (change / rest).max(-1.0).ln_1p()).exp_m1();
    force(stiffness, exponent, rest) * grown
}

/// Elastic energy above the static one less the work that the static force did where the overlap
/// has changed by `change` (m) from `rest` (m); exact to rounding however small the change (J).
///
/// With `e` the share of the change it is `A rest^(p+1)/(p+1) ((1 + e)^(p+1) - 1 - (p+1) e)`.
pub fn energy_change(stiffness: f64, exponent: f64, rest: f64, change: f64) -> f64 {
    if rest == 0.0 {
        return energy(stiffness, exponent, change);
    }
    let (share, power) = (change / rest, exponent + 1.0);
    let beyond = if share.abs() < SERIES_SHARE {
        let mut term = power * share;
        let terms = (1..TERMS).map(|k| {
            term *= share * (power - f64::from(k)) / f64::from(k + 1);
            term
        });
        terms.sum()
    } else {
        (1.0 + share).max(0.0).powf(power) - 1.0 - power * share
    };
    energy(stiffness, exponent, rest) * beyond
}
