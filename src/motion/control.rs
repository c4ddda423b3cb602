//! The choice of steps: fixed ones, or control by the estimated local error; shared by all methods.

use super::integrator::IntegrateError;
use super::system::{Scales, System};
use crate::chain::State;

/// A step is chosen to meet the tolerance with this margin (1).
const SAFETY_FACTOR: f64 = 0.8;
/// A step shrinks at most by this factor (1).
const MIN_CHANGE: f64 = 0.2;
/// Default limit on the growth of a step; [`StepControl::growing`] sets a smaller one (1).
const MAX_CHANGE: f64 = 5.0;
/// Shortest step, in multiples of the rounding error of the time. A shorter one, shrunk by
/// [`SAFETY_FACTOR`] after a rejection, could round to the same step, and the run would never end
/// (1).
const MIN_STEP_ROUNDINGS: f64 = 4.0;

/// A rest of an interval shorter than this share of a step is part of the step (1).
pub const REMAINDER: f64 = 1e-6;

/// Fixed steps: their ends are `origin + count * step`, never a running sum; the end of an interval
/// starts a new count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    step: f64,
    origin: f64,
    count: u64,
    /// Ends of the first step's parts that are still to come (1).
    cuts: &'static [f64],
}

impl Clock {
    /// Steps of `step` (s) from `origin` (s) on, the first one in parts that end at `cuts` (1).
    pub fn new(step: f64, origin: f64, cuts: &'static [f64]) -> Self {
        Self { step, origin, count: 0, cuts }
    }

    /// Starts anew at `time` (s).
    pub fn restart(&mut self, time: f64) {
        (self.origin, self.count) = (time, 0);
    }

    /// Length of the next step from `time` on, and where it ends, not beyond `end` (s).
    pub fn next(&mut self, time: f64, end: f64) -> (f64, f64) {
        if let Some((cut, rest)) = self.cuts.split_first() {
            let next = self.origin + cut * self.step;
            if self.is_before(next, end) {
                (self.cuts, self.count) = (rest, u64::from(rest.is_empty()));
                return (next - time, next);
            }
        } else {
            let next = self.origin + (self.count + 1) as f64 * self.step;
            if self.is_before(next, end) {
                self.count += 1;
                return (self.step, next);
            }
        }
        (self.origin, self.count, self.cuts) = (end, 0, &[]);
        (end - time, end)
    }

    /// Whether a step that ends at `time` (s) leaves some of the interval; what is nothing but the
    /// rounding of the times is taken along, not stepped over on its own.
    fn is_before(&self, time: f64, end: f64) -> bool {
        time + REMAINDER * self.step < end
    }
}

/// State of the step size controller.
#[derive(Debug, Clone)]
pub struct StepControl {
    step: f64,
    /// A step grows at most by this factor (1).
    growth: f64,
    /// No step is longer than this (s).
    longest: f64,
    /// The step is scaled by the error to this power, -1/(p + 1) for an error estimate of order p
    /// (1).
    exponent: f64,
    after_rejection: bool,
    /// Body whose values were not finite at the last attempt.
    non_finite: Option<usize>,
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
        Self {
            step,
            growth: MAX_CHANGE,
            longest: f64::INFINITY,
            exponent,
            after_rejection: false,
            non_finite: None,
        }
    }

    /// Lets steps grow by no more than `growth` (1).
    pub fn growing(self, growth: f64) -> Self {
        Self { growth, ..self }
    }

    /// Lets no step be longer than `longest` (s).
    pub fn up_to(self, longest: f64) -> Self {
        Self { longest, step: self.step.min(longest), ..self }
    }

    /// The step to try from `start` towards `end` (s).
    ///
    /// # Errors
    /// [`IntegrateError`] when rounding of the time would swallow the step, so that a run would
    /// never end.
    #[inline]
    pub fn trial(&self, start: f64, end: f64) -> Result<Trial, IntegrateError> {
        // If what would remain of the interval is only rounding error, the step goes to its end.
        let cut_short = self.step * (1.0 + REMAINDER) >= end - start;
        let next = if cut_short { end } else { start + self.step };
        // The step that is taken is the difference of the rounded times.
        let length = next - start;
        // The last step of an interval may be arbitrarily short.
        if length > 0.0 && (cut_short || length > MIN_STEP_ROUNDINGS * f64::EPSILON * end.abs()) {
            return Ok(Trial { length, next, cut_short });
        }
        Err(match self.non_finite {
            Some(body) => IntegrateError::NotFinite { body, time: start },
            None => IntegrateError::StepTooSmall { time: start, step: length },
        })
    }

    /// Judges a trial by its error in multiples of the tolerance (1), and chooses the next step.
    /// `non_finite` names a body whose values are not finite; called only if the error is not
    /// finite.
    #[inline]
    pub fn accepts(
        &mut self,
        trial: Trial,
        error: f64,
        non_finite: impl FnOnce() -> usize,
    ) -> bool {
        self.non_finite = (!error.is_finite()).then(non_finite);
        let change = if error.is_finite() {
            (SAFETY_FACTOR * error.powf(self.exponent)).clamp(MIN_CHANGE, self.growth)
        } else {
            MIN_CHANGE
        };
        let accepted = error <= 1.0;
        let wanted = if accepted && self.after_rejection { change.min(1.0) } else { change };
        // A step cut short by the interval's end says nothing against longer ones.
        let least = if accepted && trial.cut_short { self.step } else { 0.0 };
        self.step = (trial.length * wanted).max(least).min(self.longest);
        self.after_rejection = !accepted;
        accepted
    }
}

/// The first step, as a fraction of position scale over speed scale: a striker's contact may have
/// just begun (1).
const FIRST_STEP: f64 = 1e-3;
/// First step of a system at rest times its highest angular frequency (rad).
const FIRST_STEP_AT_REST: f64 = 0.01;

/// The first step of a system with these scales; if it is at rest, from its highest angular
/// `frequency` in rad/s (s).
pub fn first_step(scales: Scales, frequency: f64) -> f64 {
    let step = FIRST_STEP * scales.position / scales.velocity;
    if step.is_finite() && step > 0.0 { step } else { FIRST_STEP_AT_REST / frequency }
}

/// The first step of `system` from `state` on (s).
pub fn first_step_of(system: &dyn System, state: &State) -> f64 {
    let scales = system.scales(&state.position, &state.velocity);
    first_step(scales, system.highest_frequency(state))
}

/// Largest of the errors of a position (m) and a velocity (m/s) relative to `scales`; infinite
/// where anything is not a number (1).
pub fn relative_error([position, velocity]: [f64; 2], scales: Scales) -> f64 {
    // A system at rest has zero scale and zero error: no 0/0.
    let ratio = |error: f64, scale: f64| if error == 0.0 { 0.0 } else { error / scale };
    let (x, v) = (ratio(position, scales.position), ratio(velocity, scales.velocity));
    // A sum, since `max` ignores NaN.
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

/// `value += increment`, keeping the rounding error in `compensation`. Source: W. Kahan, Commun.
/// ACM 8, 40 (1965).
pub fn add_compensated(value: &mut f64, compensation: &mut f64, increment: f64) {
    let increment = increment - *compensation;
    let sum = *value + increment;
    *compensation = (sum - *value) - increment;
    *value = sum;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps that always fail end with an error, at any start time.
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
