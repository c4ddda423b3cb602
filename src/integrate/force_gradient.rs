//! A splitting of order 4 with force gradients: three force evaluations a step, two of them with
//! the gradient of the accelerations along themselves, which costs about as much again.
//!
//! The velocity form of Omelyan, Mryglod and Folk with three drifts, gradients in the inner kicks
//! alone. Two conditions of order 4 fix the kicks and the gradients' weight. The first drift is
//! chosen for stability: with others a linear oscillator grows where a step is about half an
//! oscillation; with this one both roots of `trace + 2` coincide, at 3.155 rad, and steps are
//! stable up to 7.70 rad. Source: I. P. Omelyan, I. M. Mryglod, R. Folk, Phys. Rev. E 66, 026701
//! (2002).
//!
//! The first step is taken in three parts: a striker's contact begins at zero overlap, where its
//! force has no second derivative.

use super::splitting::Splitting;

/// First drift, as a fraction of the step (1).
const DRIFT: f64 = 0.289_680_263_734;
/// Drifts lead to 0, `a`, `1 - a` and 1, of whose squares the kicks make 1/3 (1).
const OUTER_KICK: f64 = {
    let squares = DRIFT * DRIFT + (1.0 - DRIFT) * (1.0 - DRIFT);
    (1.0 / 3.0 - 0.5 * squares) / (1.0 - squares)
};
const INNER_KICK: f64 = 0.5 - OUTER_KICK;
/// With all pairs of kicks, each weighed by the drift between them, gradients come to 1/6 (1).
const GRADIENT: f64 = {
    let inner = INNER_KICK * INNER_KICK * (1.0 - 2.0 * DRIFT);
    0.5 * (1.0 / 6.0 - (OUTER_KICK * OUTER_KICK + 2.0 * OUTER_KICK * INNER_KICK + inner))
};

/// The method's fractions.
pub static FORCE_GRADIENT: Splitting = Splitting {
    name: "force-gradient",
    source: "I. P. Omelyan, I. M. Mryglod, R. Folk, Phys. Rev. E 66, 026701 (2002); first drift chosen for stability",
    order: 4,
    kicks: &[OUTER_KICK, INNER_KICK, INNER_KICK, OUTER_KICK],
    drifts: &[DRIFT, 1.0 - 2.0 * DRIFT, DRIFT],
    gradients: &[0.0, GRADIENT, GRADIENT, 0.0],
    first_step: &[0.25, 0.5, 1.0],
    stability: 7.70,
};
