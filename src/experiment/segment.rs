//! A force over one step, and what of it is kept: maxima between two looks, and steps in which it
//! exceeded all before.

use super::roots::refine_maximum;
use crate::motion::ForceSegment;
use crate::motion::probe_step::{ContactPair, StepOverlaps};
use crate::numeric::roots::root;

/// A force over one step. Steps resolve the stiffest contact, or they would not be accepted, so a
/// force turns at most twice between two of the places in
/// [`SAMPLE_TIMES`](crate::motion::probe_step::SAMPLE_TIMES).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// Of any method: which of [`ForceHistory::general`].
    General(usize),
    /// Of the vector path.
    Lossless(StepOverlaps),
}

/// A place, and what it felt in steps that no span describes.
#[derive(Debug, Clone)]
pub struct ForceHistory {
    place: ContactPair,
    general: Vec<ForceSegment>,
}

/// A maximum, between two looks at a step's force or at a known time.
#[derive(Debug, Clone, Copy)]
pub struct Bracket {
    pub segment: Segment,
    /// Where it begins and ends, in fractions of the step (1).
    pub between: [f64; 2],
    /// Rates of change there: it rises, and falls or turns (N/s).
    pub rates: [f64; 2],
    /// Upper bound of its value (N).
    pub most: f64,
    /// Whether no force before was as large: others are not the first peak, for the force that
    /// exceeded them came down from a maximum.
    pub exceeds_all: bool,
}

/// A step in which a force exceeded all before.
#[derive(Debug, Clone, Copy)]
pub struct Rise {
    pub segment: Segment,
    /// The largest force (N).
    pub reached: f64,
    /// At which fraction of the step it was (1).
    pub top: f64,
}

impl ForceHistory {
    /// Nothing yet.
    pub fn nothing(place: ContactPair) -> Self {
        Self { place, general: Vec::new() }
    }

    /// Has a step of any method among its own.
    pub fn keep(&mut self, segment: ForceSegment) -> Segment {
        self.general.push(segment);
        Segment::General(self.general.len() - 1)
    }

    /// Lets the step that came last go.
    pub fn release(&mut self) {
        self.general.pop();
    }

    /// Dynamic force at the fraction `theta` of `segment` (N).
    pub fn force(&self, segment: &Segment, theta: f64) -> f64 {
        match segment {
            Segment::General(index) => self.general[*index].force(theta),
            Segment::Lossless(span) => self.place.force_and_rate(span, theta)[0],
        }
    }

    /// Its rate of change there (N/s).
    pub fn rate(&self, segment: &Segment, theta: f64) -> f64 {
        match segment {
            Segment::General(index) => self.general[*index].rate(theta),
            Segment::Lossless(span) => self.place.force_and_rate(span, theta)[1],
        }
    }

    /// When that is (s).
    pub fn time(&self, segment: &Segment, theta: f64) -> f64 {
        let start = match segment {
            Segment::General(index) => self.general[*index].start,
            Segment::Lossless(span) => span.start,
        };
        start + theta * self.length(segment)
    }

    /// Length of the step (s).
    fn length(&self, segment: &Segment) -> f64 {
        match segment {
            Segment::General(index) => self.general[*index].length,
            Segment::Lossless(span) => span.length,
        }
    }

    /// Fraction of the step and force of a maximum (1, N).
    pub fn top(&self, maximum: &Bracket) -> (f64, f64) {
        let Bracket { segment, between, rates, .. } = maximum;
        let theta = if between[1] > between[0] {
            root(&|theta| self.rate(segment, theta), *between, *rates)
        } else {
            between[0]
        };
        (theta, self.force(segment, theta))
    }

    /// The same sooner, the force to its last bits but not the place, where the maximum begins and
    /// ends at looks with the forces `ends` (N).
    pub fn height(&self, maximum: &Bracket, ends: Option<[f64; 2]>) -> (f64, f64) {
        let Bracket { segment, between, rates, .. } = maximum;
        let width = (between[1] - between[0]) * self.length(segment);
        let rate = |theta| self.rate(segment, theta);
        let found = ends
            .and_then(|ends| refine_maximum(&rate, *between, *rates, (ends[1] - ends[0]) / width));
        found.map_or_else(|| self.top(maximum), |theta| (theta, self.force(segment, theta)))
    }
}
