//! What all methods have in common: one step at a time, and its interpolation.

use super::hermite::Interpolant;
use super::system::System;
use crate::chain::State;

/// What a run has cost so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Accepted steps.
    pub steps: u64,
    /// Steps tried and thrown away by the error control.
    pub rejected: u64,
    /// Evaluations of all contact forces of the chain.
    pub force_evaluations: u64,
}

impl Work {
    /// Whether it is no more than `most` evaluations, by `time` (s).
    ///
    /// # Errors
    /// [`IntegrateError::TooMuchWork`] where it is.
    pub fn within(&self, most: u64, time: f64) -> Result<(), IntegrateError> {
        if self.force_evaluations > most {
            return Err(IntegrateError::TooMuchWork { time, most });
        }
        Ok(())
    }
}

/// Why an integration stopped short.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IntegrateError {
    /// A position or velocity is infinite or not a number.
    #[error(
        "the state of body {body} stopped being a number at t = {time:e} s: the step is too long, or the scene beyond what numbers hold"
    )]
    NotFinite {
        /// Index of the first such body.
        body: usize,
        /// A time at which it still was (s).
        time: f64,
    },
    /// The error control asks for steps that rounding swallows.
    #[error(
        "at t = {time:e} s the error control asks for a step of {step:e} s, below rounding: the accuracy asked for is out of reach"
    )]
    StepTooSmall {
        /// Time (s).
        time: f64,
        /// Step that was asked for (s).
        step: f64,
    },
    /// It has taken more than it was allowed.
    #[error("at t = {time:e} s more than {most} evaluations of all forces were taken")]
    TooMuchWork {
        /// Time (s).
        time: f64,
        /// Evaluations that were allowed.
        most: u64,
    },
}

/// A method at work on a system.
pub trait Integrator {
    /// The present time (s).
    fn time(&self) -> f64;

    /// The present state.
    fn state(&self) -> State;

    /// Takes one step, not beyond `end` (s).
    ///
    /// # Errors
    /// [`IntegrateError`] when the state stops being finite or no step is short enough.
    fn step(&mut self, end: f64) -> Result<(), IntegrateError>;

    /// Takes steps up to `end` (s), all but the last unseen: for those who want nothing but where
    /// it leads.
    ///
    /// # Errors
    /// Those of [`Integrator::step`].
    fn advance(&mut self, end: f64) -> Result<(), IntegrateError> {
        while self.time() < end {
            self.step(end)?;
        }
        Ok(())
    }

    /// Prepares the interpolation of the last step; may evaluate forces. Called at most once a
    /// step, and only for steps that somebody reads.
    fn prepare_interpolation(&mut self);

    /// Position and velocity of `body` over the last step; after
    /// [`Integrator::prepare_interpolation`].
    fn interpolant(&self, body: usize) -> Interpolant;

    /// Motion of the wall at an end, 0 at the top and 1 at the bottom, over the last step; after
    /// [`Integrator::prepare_interpolation`].
    fn wall(&self, end: usize) -> Interpolant {
        let _ = end;
        Interpolant::REST
    }

    /// Position (m) and velocity of `body` at the end of the last step (m/s).
    fn body(&self, body: usize) -> [f64; 2];

    /// Start and length of the last step (s).
    fn last_step(&self) -> (f64, f64);

    /// What it has cost so far.
    fn work(&self) -> Work;

    /// Whether a switch has changed just before the last step: forces may have jumped.
    fn starts_anew(&self) -> bool {
        false
    }

    /// Whether the system's switch at `place` was on over the last step; places without a switch
    /// always are.
    fn was_on(&self, place: usize) -> bool {
        let _ = place;
        true
    }

    /// Whether it is on now.
    fn is_on(&self, place: usize) -> bool {
        let _ = place;
        true
    }
}

/// A method that can start anew from another state.
pub trait Restart: Integrator {
    /// The system.
    fn system(&mut self) -> &mut dyn System;

    /// Where it is.
    fn reached(&self) -> &State;

    /// Starts anew at `state`, with the step that the last one suggested.
    fn restart(&mut self, state: &State);

    /// Error of velocities that the control tolerates in a step; 0 without a control (m/s).
    fn tolerated(&self) -> f64;
}

/// Index of the first body whose state is not finite.
pub fn first_not_finite(position: &[f64], velocity: &[f64]) -> Option<usize> {
    position.iter().zip(velocity).position(|(x, v)| !(x.is_finite() && v.is_finite()))
}
