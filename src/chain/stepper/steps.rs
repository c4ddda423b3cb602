//! How a chain's steps are chosen.

use std::marker::PhantomData;

use super::dispatch::{InstructionSet, dispatch};
use super::layout::Layout;
use super::plan::Plan;
use super::splits::TANGENT;
use super::tasks::Jerks;
use super::workspace::{Parts, Workspace};
use crate::integrate::control::StepControl;
use crate::integrate::splitting::Splitting;
use crate::integrate::{Pair, Scheme};

/// The first step, as a fraction of overlap over speed (1).
const FIRST_STEP: f64 = 1e-3;
/// The same where contacts are watched, so that it is made shorter if need be (1).
const FIRST_STEP_WATCHED: f64 = 0.03;
/// A step grows at most by this factor: the error estimate knows nothing of how sharply a force sets in that begins at zero
/// overlap. With 5 instead of 3, first peaks of a chain under gravity were five to ten times as far off at 1e-6 to 1e-9 (1).
const GROWTH: f64 = 3.0;
/// A corrected position that moved by less than this share of the tolerance keeps its acceleration (1).
pub const UNMOVED: f64 = 0.03;

/// What fixed steps are taken to be after: forces are computed so that rounding stays below (1).
const FINEST: f64 = 1e-11;
/// Fixed steps that are taken without a look at what has come of them.
pub const AT_ONCE: u32 = 64;

/// The accuracy that forces are computed for (1).
pub fn finest_asked(scheme: Scheme) -> f64 {
    match scheme {
        Scheme::Pair(_, tolerance) | Scheme::Paced(_, tolerance) => tolerance,
        Scheme::Splitting(..) => FINEST,
    }
}

/// Finds the gradients of the accelerations where `work` is, if the first kick of `method` goes by them.
pub fn find_gradients<Y: Layout>(
    set: InstructionSet,
    method: &Splitting,
    (plan, work): (&Plan, &mut Workspace),
) {
    let Parts { position, acceleration, gradient, .. } = work.now.parts();
    if method.gradients.first().is_some_and(|weight| *weight != 0.0) {
        let (at, layout) = ((&*position, &*acceleration), PhantomData);
        dispatch(set, Jerks::<Y> { plan, at, out: gradient, layout });
        // Kicks are weighed for two thirds of them.
        gradient.iter_mut().flat_map(|row| &mut row.0).for_each(|value| *value /= TANGENT);
    }
}

/// The control of a chain that starts from `scales` of overlap (m) and speed (m/s), its contacts watched or not.
pub fn control(scales: (f64, f64), pair: Pair, watched: bool) -> StepControl {
    let share = if watched { FIRST_STEP_WATCHED } else { FIRST_STEP };
    StepControl::new(share * scales.0 / scales.1, pair.coefficients().error_order).growing(GROWTH)
}

/// How many tolerated errors an error of 1 m, or of 1 m/s, is (1/m, s/m).
pub fn worth(tolerance: f64, scales: (f64, f64)) -> [f64; 2] {
    [1.0 / (tolerance * scales.0), 1.0 / (tolerance * scales.1)]
}
