//! Time integration of `x'' = a(x, v)`: one file a method, one step at a time.
//!
//! `chain` supplies a [`System`]; `experiment` drives an [`Integrator`] and reads each step through
//! its [`Interpolant`], so that nothing downstream depends on where the integrator put its steps.
//! The equations are autonomous: no method sees the time but for bookkeeping.

pub mod control;
pub mod dormand_el_mikkawy_prince_86;
pub mod hermite;
mod method;
pub mod rodas;
pub mod runge_kutta;
pub mod splitting;
pub mod switching;
pub mod tableaus;
pub mod two_step;

pub use hermite::{COEFFICIENTS, Interpolant};
pub use method::{GeneralScheme, LosslessScheme, Method, Scheme};
pub use rodas::{Linearised, Rodas, Tridiagonal};
pub use switching::{Motion, Sides, Switching};
pub use two_step::Pacing;

/// A mechanical system of `len` coordinates.
pub trait System {
    /// Number of coordinates.
    fn len(&self) -> usize;

    /// Whether there is nothing to integrate.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the accelerations (m/s²) for the given positions (m) and velocities (m/s).
    fn accelerations(&mut self, position: &[f64], velocity: &[f64], acceleration: &mut [f64]);

    /// The distance (m) and speed (m/s) to which a relative error in this state refers: what the
    /// user reads is a contact's overlap, not the drift of the whole chain.
    fn scales(&self, position: &[f64], velocity: &[f64]) -> Scales;

    /// Whether the law has a kink between two states: a step across it is of low order, and an
    /// estimate of its error may vanish by accident.
    fn has_kink_between(&self, from: &State, to: &State) -> bool {
        let _ = (from, to);
        false
    }

    /// Highest angular frequency, or a bound of it, which decides on the first step: by default,
    /// speeds change distances in a radian (1/s).
    fn highest_frequency(&self, state: &State) -> f64 {
        let Scales { position, velocity } = self.scales(&state.position, &state.velocity);
        velocity / position
    }

    /// Its switches, if its law has any.
    fn switching(&mut self) -> Option<&mut dyn Switching> {
        None
    }

    /// Its tangent, if it can tell.
    fn linearised(&mut self) -> Option<&mut dyn Linearised> {
        None
    }
}

/// Magnitudes by which errors are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Typical overlap (m).
    pub position: f64,
    /// Typical speed (m/s).
    pub velocity: f64,
}

/// Positions and velocities at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Time since the striker's first contact (s).
    pub time: f64,
    /// Displacements from static equilibrium, downward positive (m).
    pub position: Vec<f64>,
    /// Velocities, downward positive (m/s).
    pub velocity: Vec<f64>,
}

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

    /// Position (m) and velocity (m/s) of `body` at the end of the last step.
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

impl Scales {
    /// Takes in the present ones: a rebound's speed stays the yardstick for what it left behind.
    pub(crate) fn widen(&mut self, now: Self) {
        self.position = self.position.max(now.position);
        self.velocity = self.velocity.max(now.velocity);
    }

    /// Whether errors can be measured by them.
    fn are_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite()
    }
}

/// Index of the first body whose state is not finite.
fn first_not_finite(position: &[f64], velocity: &[f64]) -> Option<usize> {
    position.iter().zip(velocity).position(|(x, v)| !(x.is_finite() && v.is_finite()))
}
