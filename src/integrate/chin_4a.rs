//! Chin's splitting with a force gradient, his algorithm 4A: order 4, two force evaluations a step, one of them with the gradient of the
//! accelerations along themselves.
//!
//! A drift to mid-step, where two thirds of the kick are given, with the gradient, and one to the end: of all splittings of order 4 that step forward only it
//! takes the fewest evaluations. Errors are tens of times those of [`super::force_gradient`] in steps of the same length, and less than half of PEFRL's: it pays
//! for coarse errors, in steps near the edge of stability. `tests/it/order.rs` measures the order and the errors.
//!
//! The first step is taken in three parts, as with all force gradients.

use super::force_gradient::FORCE_GRADIENT;
use super::splitting::Splitting;

/// The method's fractions.
pub static CHIN_4A: Splitting = Splitting {
    name: "chin-4a",
    source: "S. A. Chin, Phys. Lett. A 226, 344 (1997), algorithm 4A",
    order: 4,
    kicks: &[1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0],
    drifts: &[0.5, 0.5],
    gradients: &[0.0, 1.0 / 36.0, 0.0],
    // The trace of a step of a linear oscillator is `2 - s + s^2/12 - s^3/432`, `s` the square of this: it comes to -2 where `s` is 12.
    stability: 3.464,
    ..FORCE_GRADIENT
};
