//! How a chain's steps are taken.

use super::burst::{Burst, Taken};
use super::course::Course;
use super::paced::InSteps;
use super::paired::Paired;
use super::split::Split;
use crate::chain::stepper::notes::Notes;
use crate::integrate::IntegrateError;

/// A method at work.
pub enum Drive {
    Paired(Box<Paired>),
    Split(Split),
    Paced(Box<InSteps>),
}

impl Drive {
    /// Takes a step, not beyond `end`; returns its start and length (s).
    pub fn step(&mut self, course: &mut Course, end: f64) -> Result<(f64, f64), IntegrateError> {
        let one = &mut Burst { end, pause: end, most: 1, notes: &mut Notes::default() };
        match self {
            Self::Paired(paired) => Ok(paired.take(course, one)?.last),
            Self::Split(split) => Ok((course.time, split.step(course, end)?)),
            Self::Paced(paced) => Ok(paced.take(course, one)?.last),
        }
    }

    /// Takes steps at once, if there are any that can be; all rows are under way.
    pub fn several(
        &mut self,
        course: &mut Course,
        burst: &mut Burst,
    ) -> Result<Option<Taken>, IntegrateError> {
        match self {
            Self::Paired(paired) => Ok(Some(paired.take(course, burst)?)),
            Self::Split(split) => split.several(course, burst),
            Self::Paced(paced) => Ok(Some(paced.take(course, burst)?)),
        }
    }

    /// Start, length and end of the step that was `before` the last, and taken at once with it (s).
    pub fn times(&self, before: usize) -> [f64; 3] {
        match self {
            Self::Paired(paired) => paired.times(before),
            Self::Split(split) => split.times(before),
            Self::Paced(paced) => paced.times(before),
        }
    }

    /// Steps tried in which contacts opened or closed; fixed ones do not ask.
    pub fn events(&self) -> Option<u64> {
        match self {
            Self::Paired(paired) => Some(paired.events),
            Self::Split(_) => None,
            Self::Paced(paced) => Some(paced.events),
        }
    }
}
