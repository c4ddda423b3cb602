//! How far a chain of a group is that has steps of its own.

use super::Member;
use crate::integrate::{IntegrateError, Work};

/// How far it is.
#[derive(Debug, Clone)]
pub struct Progress {
    /// Time reached (s).
    pub time: f64,
    /// Time to reach (s).
    pub end: f64,
    /// Start and length of the step taken last (s).
    pub last_step: (f64, f64),
    pub counts: Work,
    /// Why it stopped, if it did.
    pub failed: Option<IntegrateError>,
}

impl Progress {
    /// Of `member`, at its start: forces have been evaluated once.
    pub fn new(member: &Member<'_>) -> Self {
        Self {
            time: 0.0,
            end: member.duration,
            last_step: (0.0, 0.0),
            counts: Work { force_evaluations: 1, ..Work::default() },
            failed: None,
        }
    }

    pub fn is_moving(&self) -> bool {
        self.time < self.end && self.failed.is_none()
    }

    /// A step of `length` was taken, to `next` (s).
    pub fn pass(&mut self, length: f64, next: f64) {
        self.last_step = (self.time, length);
        self.time = next;
        self.counts.steps += 1;
    }

    /// What it has cost, or why it failed.
    pub fn outcome(&self) -> Result<Work, IntegrateError> {
        self.failed.clone().map_or(Ok(self.counts), Err)
    }
}
