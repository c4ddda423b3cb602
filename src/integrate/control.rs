//! Choosing steps by the error they make: shared by all methods that estimate their own error.

use super::splitting::REMAINDER;
use super::{IntegrateError, Scales, State, System};

/// A step is chosen to meet the tolerance with this margin (1).
const SAFETY: f64 = 0.8;
/// A step shrinks at most by this factor (1).
const SMALLEST_CHANGE: f64 = 0.2;
/// A step grows at most by this factor where nobody asks for less (1).
const LARGEST_CHANGE: f64 = 5.0;
/// The shortest step, in units of the clock's rounding: of shorter ones, shrunk by [`SAFETY`], the clock would show the same again (1).
const SHORTEST: f64 = 4.0;

/// The controller: knows the next step and what the last attempts ran into.
#[derive(Debug, Clone)]
pub struct StepControl {
    step: f64,
    /// A step grows at most by this factor (1).
    growth: f64,
    /// Step changes go as the error to this power (1).
    exponent: f64,
    after_rejection: bool,
    /// Body whose values were not numbers at the last attempt.
    lost: Option<usize>,
}

/// A step about to be tried.
#[derive(Debug, Clone, Copy)]
pub struct Trial {
    /// Its length (s).
    pub length: f64,
    /// Time at its end (s).
    pub next: f64,
    /// Whether the end of the interval made it shorter than the controller wanted.
    cut_short: bool,
}

impl StepControl {
    /// Starts with `step` (s); a step's error goes as its length to the power `error_order + 1`.
    pub fn new(step: f64, error_order: u8) -> Self {
        let exponent = -1.0 / f64::from(error_order + 1);
        Self { step, growth: LARGEST_CHANGE, exponent, after_rejection: false, lost: None }
    }

    /// Lets steps grow by no more than `growth` (1).
    pub fn growing(self, growth: f64) -> Self {
        Self { growth, ..self }
    }

    /// The step to try from `start` towards `end` (s).
    ///
    /// # Errors
    /// [`IntegrateError`] when the clock's rounding would swallow the step, so that a run would never end.
    #[inline]
    pub fn trial(&self, start: f64, end: f64) -> Result<Trial, IntegrateError> {
        // A remainder that is nothing but the rounding of the times is taken along.
        let cut_short = self.step * (1.0 + REMAINDER) >= end - start;
        let next = if cut_short { end } else { start + self.step };
        // The step that is taken is the one that the clock shows, rounding included.
        let length = next - start;
        // The rest of an interval may be as short as it likes.
        if length > 0.0 && (cut_short || length > SHORTEST * f64::EPSILON * end.abs()) {
            return Ok(Trial { length, next, cut_short });
        }
        Err(match self.lost {
            Some(body) => IntegrateError::NotFinite { body, time: start },
            None => IntegrateError::StepTooSmall { time: start, step: length },
        })
    }

    /// Judges a trial by its error in multiples of the tolerance (1), and chooses the next step. `lost` names a body whose
    /// values are not numbers, asked for only where the error is none.
    #[inline]
    pub fn accepts(&mut self, trial: Trial, error: f64, lost: impl FnOnce() -> usize) -> bool {
        self.lost = (!error.is_finite()).then(lost);
        let change = if error.is_finite() {
            (SAFETY * error.powf(self.exponent)).clamp(SMALLEST_CHANGE, self.growth)
        } else {
            SMALLEST_CHANGE
        };
        let accepted = error <= 1.0;
        let wanted = if accepted && self.after_rejection { change.min(1.0) } else { change };
        // A step cut short by the interval's end says nothing against longer ones.
        let least = if accepted && trial.cut_short { self.step } else { 0.0 };
        self.step = (trial.length * wanted).max(least);
        self.after_rejection = !accepted;
        accepted
    }
}

/// The first step, as a fraction of position scale over speed scale: a striker's contact may have just begun (1).
const FIRST_STEP: f64 = 1e-3;
/// The first step of a system at rest, as a fraction of its fastest oscillation in radians (1).
const FIRST_STEP_AT_REST: f64 = 0.01;

/// The first step of a system with these scales, or of one at rest with this highest angular `frequency` (1/s) (s).
pub fn first_step(scales: Scales, frequency: f64) -> f64 {
    let step = FIRST_STEP * scales.position / scales.velocity;
    if step.is_finite() && step > 0.0 { step } else { FIRST_STEP_AT_REST / frequency }
}

/// The first step of `system` from `state` on (s).
pub fn first_step_of(system: &dyn System, state: &State) -> f64 {
    let scales = system.scales(&state.position, &state.velocity);
    first_step(scales, system.pacing(state).frequency)
}

/// Largest of the errors of a position (m) and a velocity (m/s) relative to `scales`; infinite where anything is not a number (1).
pub fn relative_error([position, velocity]: [f64; 2], scales: Scales) -> f64 {
    // A system at rest has no scale, and makes no error.
    let ratio = |error: f64, scale: f64| if error == 0.0 { 0.0 } else { error / scale };
    let (x, v) = (ratio(position, scales.position), ratio(velocity, scales.velocity));
    // A sum, for `max` would hide what is not a number.
    if (x + v).is_finite() && scales.are_finite() { x.max(v) } else { f64::INFINITY }
}

/// Largest magnitude; infinite if any value is not a number, which `f64::max` would hide (unit).
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(
        0.0,
        |most: f64, value| {
            if value.is_nan() { f64::INFINITY } else { most.max(value.abs()) }
        },
    )
}

/// `value += increment`, keeping in `lost` what rounding takes. Source: W. Kahan, Commun. ACM 8, 40 (1965).
pub fn add_compensated(value: &mut f64, lost: &mut f64, increment: f64) {
    let increment = increment - *lost;
    let sum = *value + increment;
    *lost = (sum - *value) - increment;
    *value = sum;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step that fails however short it is, anywhere in the clock's numbers: shrinking ends where the clock would swallow it.
    #[test]
    fn failing_steps_come_to_an_end() {
        for start in [0.0, 1e-9, 0.5, 1.0 - f64::EPSILON, 1.0, 0.017_833_755_280_965_09, 1.99] {
            for (error, length) in [(1.0 + f64::EPSILON, 1e-3), (1.1062, 1e-7), (f64::NAN, 1.0)] {
                for end in [start + 1e-18, start + 3.0 * f64::EPSILON, start + 0.0022, 2.0] {
                    let mut control = StepControl::new(length, 4);
                    let tries = (0..1_000).take_while(|_| {
                        control
                            .trial(start, end)
                            .is_ok_and(|trial| !control.accepts(trial, error, || 0))
                    });
                    assert!(tries.count() < 1_000, "from {start} to {end}, {error}");
                }
            }
        }
    }
}
