//! Why a run has no result.

use crate::chain::StabilityLimit;
use crate::motion::IntegrateError;
use crate::quantity::engineering;

/// Most steps of a method with a step by hand: hours of work for a chain of the bench's size (1).
pub(super) const MAX_STEPS: f64 = 1e9;

/// Why a run has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RunError {
    /// A step chosen by hand is beyond what can be stable.
    #[error("found a step of {}, expected at most {}: the contact between {} and {} makes longer ones unstable", seconds(*step), cut(limit.step), limit.upper, limit.lower)]
    Unstable {
        /// The step (s).
        step: f64,
        /// The limit.
        limit: StabilityLimit,
    },
    /// A step chosen by hand would take too long.
    #[error(
        "found a step of {}, which takes {steps:.1e} steps, expected at most {MAX_STEPS:.0e} steps", seconds(*step)
    )]
    TooManySteps {
        /// The step (s).
        step: f64,
        /// Steps in the scene's duration (1).
        steps: f64,
    },
    /// The method chosen by hand takes forces to follow from positions alone.
    #[error(
        "found the method {method} for a scene with {losses}, expected one that lets forces depend on velocity: {expected}"
    )]
    NotForLosses {
        /// The method.
        method: &'static str,
        /// The losses that are on.
        losses: String,
        /// Methods that would do.
        expected: &'static str,
    },
    /// The method chosen by hand needs the tangent that only losses have.
    #[error(
        "found the method {method} for a scene without losses, expected any other: its implicit steps are for stiff losses"
    )]
    OnlyForLosses {
        /// The method.
        method: &'static str,
    },
    /// A step chosen by hand is beyond what losses let be stable.
    #[error(
        "found a step of {}, expected at most {}: losses, most of all between {} and {}, let velocities decay at up to {decay:.3e} 1/s, which makes longer ones unstable", seconds(*step), cut(limit.step), limit.upper, limit.lower
    )]
    UnstableLoss {
        /// The step (s).
        step: f64,
        /// The longest step (s), and the contact that limits it most.
        limit: StabilityLimit,
        /// The fastest decay (1/s).
        decay: f64,
    },
    /// The integrator could not go on.
    #[error(transparent)]
    Integrate(#[from] IntegrateError),
}

/// A step (s) in words, exact enough to be told from the longest one.
fn seconds(step: f64) -> String {
    engineering(step, "s", 7)
}

/// A longest step (s) in words that name no longer one.
fn cut(step: f64) -> String {
    engineering(rounded_down(step, 4), "s", 4)
}

/// `value`, rounded down to so many decimal `digits` (unit).
pub(super) fn rounded_down(value: f64, digits: i32) -> f64 {
    let unit = 10f64.powf(value.abs().log10().floor() - f64::from(digits - 1));
    (value / unit).floor() * unit
}
