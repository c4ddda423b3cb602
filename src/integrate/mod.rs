//! Time integration of `x'' = a(x, v)`: one file a method, one step at a time.
//!
//! `chain` supplies a [`System`]; `experiment` drives an [`Integrator`] and reads each step through its
//! [`Interpolant`], so that nothing downstream depends on where the integrator put its steps. The
//! equations are autonomous: no method sees the time but for bookkeeping.

pub mod dormand_prince_853;
pub mod interpolant;
pub mod velocity_verlet;

use std::fmt;

pub use dormand_prince_853::DormandPrince853;
pub use interpolant::Interpolant;
pub use velocity_verlet::VelocityVerlet;

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

    /// The distance (m) and speed (m/s) to which a relative error in this state refers: what the user reads is
    /// a contact's overlap, not the drift of the whole chain.
    fn scales(&self, position: &[f64], velocity: &[f64]) -> Scales;
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

/// Why an integration stopped short.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IntegrateError {
    /// A position or velocity is infinite or not a number.
    #[error(
        "the state of body {body} stopped being a number at t = {time:e} s: the step is too long for this chain"
    )]
    NotFinite {
        /// Index of the first such body.
        body: usize,
        /// Time at the start of the step (s).
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
}

/// The methods a scene or a user may name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Velocity Verlet with a fixed step: order 2, symplectic.
    VelocityVerlet {
        /// The step (s).
        step: f64,
    },
    /// Dormand and Prince's embedded Runge-Kutta pair of orders 8(5,3) with error control.
    DormandPrince853 {
        /// Tolerated error of a step, relative to [`Scales`] (1).
        tolerance: f64,
    },
}

impl Method {
    /// Name as written in scenes, options and recordings.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::VelocityVerlet { .. } => VelocityVerlet::NAME,
            Self::DormandPrince853 { .. } => DormandPrince853::NAME,
        }
    }

    /// Publication that defines the method.
    #[must_use]
    pub fn source(&self) -> &'static str {
        match self {
            Self::VelocityVerlet { .. } => VelocityVerlet::SOURCE,
            Self::DormandPrince853 { .. } => DormandPrince853::SOURCE,
        }
    }

    /// Starts the method on `system` at `state`.
    #[must_use]
    pub fn start<'a>(
        &self,
        system: Box<dyn System + 'a>,
        state: State,
    ) -> Box<dyn Integrator + 'a> {
        match *self {
            Self::VelocityVerlet { step } => Box::new(VelocityVerlet::new(system, state, step)),
            Self::DormandPrince853 { tolerance } => {
                Box::new(DormandPrince853::new(system, state, tolerance))
            }
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::VelocityVerlet { step } => write!(f, "{} (step {step:e} s)", self.name()),
            Self::DormandPrince853 { tolerance } => {
                write!(f, "{} (step tolerance {tolerance:.1e})", self.name())
            }
        }
    }
}

/// A method at work on a system.
pub trait Integrator {
    /// The present state.
    fn state(&self) -> &State;

    /// Takes one step, not beyond `end` (s).
    ///
    /// # Errors
    /// [`IntegrateError`] when the state stops being finite or no step is short enough.
    fn step(&mut self, end: f64) -> Result<(), IntegrateError>;

    /// Prepares the interpolation of the last step; may evaluate forces. Called at most once a step, and
    /// only for steps that somebody reads.
    fn prepare_interpolation(&mut self);

    /// Position and velocity of `body` over the last step; after [`Integrator::prepare_interpolation`].
    fn interpolant(&self, body: usize) -> Interpolant;

    /// Start and length of the last step (s).
    fn last_step(&self) -> (f64, f64);

    /// What it has cost so far.
    fn work(&self) -> Work;
}

/// Index of the first body whose state is not finite.
fn first_not_finite(position: &[f64], velocity: &[f64]) -> Option<usize> {
    position.iter().zip(velocity).position(|(x, v)| !(x.is_finite() && v.is_finite()))
}
