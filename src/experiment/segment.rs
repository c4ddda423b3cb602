//! A force over one step, and what of it is kept: maxima between two looks, and steps in which it exceeded all before.

use super::turn::root;
use crate::chain::ForceSegment;
use crate::chain::stepper::{Place, Span};

/// A force over one step. Steps resolve the stiffest contact, or they would not be accepted, so a force turns at most twice
/// between two of the places in [`LOOKED_AT`](crate::chain::stepper::LOOKED_AT).
#[derive(Debug, Clone)]
pub enum Segment {
    /// Of any method.
    General(Box<ForceSegment>),
    /// Of the stepper for lossless chains.
    Lossless(Span),
}

/// A maximum, between two looks at a step's force or at a known time.
#[derive(Debug, Clone)]
pub struct Bracket {
    pub segment: Segment,
    /// Where it begins, in fractions of the step (1).
    pub low: f64,
    /// Where it ends (1).
    pub high: f64,
    /// The larger of the forces at both ends (N).
    pub near: f64,
}

/// A step in which a force exceeded all before.
#[derive(Debug, Clone)]
pub struct Rise {
    pub segment: Segment,
    /// The largest force (N).
    pub reached: f64,
    /// At which fraction of the step it was (1).
    pub top: f64,
}

impl Segment {
    /// Dynamic force that `place` feels at the fraction `theta` of the step (N).
    pub fn force(&self, place: &Place, theta: f64) -> f64 {
        match self {
            Self::General(segment) => segment.force(theta),
            Self::Lossless(span) => place.force(span, theta),
        }
    }

    /// Its rate of change there (N/s).
    pub fn rate(&self, place: &Place, theta: f64) -> f64 {
        match self {
            Self::General(segment) => segment.rate(theta),
            Self::Lossless(span) => place.rate(span, theta),
        }
    }

    /// When that is (s).
    pub fn time(&self, theta: f64) -> f64 {
        let (start, length) = match self {
            Self::General(segment) => (segment.start, segment.length),
            Self::Lossless(span) => (span.start, span.length),
        };
        start + theta * length
    }
}

impl Bracket {
    /// Fraction of the step and force of the maximum that `place` feels (1, N).
    pub fn top(&self, place: &Place) -> (f64, f64) {
        let theta = if self.high > self.low {
            root(&|theta| self.segment.rate(place, theta), self.low, self.high)
        } else {
            self.low
        };
        (theta, self.segment.force(place, theta))
    }
}
