//! What a system with switches tells, and what a method needs so that [`super::switching`] can cut
//! its steps.

use super::{Integrator, State, System};

/// What a switch depends on: the motion of two bodies against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sides {
    /// Index of the body above; none at a wall.
    pub above: Option<usize>,
    /// Index of the body below; none at a wall.
    pub below: Option<usize>,
    /// What users of the system call its place.
    pub place: usize,
}

/// How two bodies stand and move against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Position of the one above less that of the one below (m).
    pub difference: f64,
    /// Its rate (m/s).
    pub rate: f64,
}

/// A system with switches.
pub trait Switching {
    /// How many there are.
    fn switches(&self) -> usize;

    /// Whether `switch` is on.
    fn is_on(&self, switch: usize) -> bool;

    /// Changes `switch` in `state`, whose accounts book what that moves; another switch may follow.
    fn flip(&mut self, switch: usize, state: &mut State);

    /// What decides about `switch`.
    fn sides(&self, switch: usize) -> Sides;

    /// What is zero where `switch` should change, and not negative where it should be on (unit).
    fn margin(&self, switch: usize, motion: Motion) -> f64;

    /// Whether `switch` stands wrong and will not be right by itself.
    fn is_wrong(&self, switch: usize, motion: Motion) -> bool;

    /// By how much the acceleration of a body is wrong with `switch` wrong: when its margin's root
    /// is passed at the rate `closing` (m/s), or with the motion found `beyond` it (m/s²).
    fn error(&self, switch: usize, closing: f64, beyond: Motion) -> f64;
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

impl Sides {
    /// How its bodies stand and move in `state`.
    pub(super) fn of(&self, state: &State) -> Motion {
        let difference = |of: &[f64]| {
            self.above.map_or(0.0, |body| of[body]) - self.below.map_or(0.0, |body| of[body])
        };
        Motion { difference: difference(&state.position), rate: difference(&state.velocity) }
    }
}
