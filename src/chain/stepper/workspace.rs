//! What a step reads and writes.

use super::lanes::Row;
use crate::integrate::Scheme;

/// Most stages of a pair between the ends of a step.
pub const BETWEEN: usize = 7;

/// A row at each of them, side by side in memory.
pub type Between = [Row; BETWEEN];

/// One end of a step, in rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Displacements (m).
    pub position: Vec<Row>,
    /// Velocities (m/s).
    pub velocity: Vec<Row>,
    /// What rounding took from the displacements (m).
    pub lost_position: Vec<Row>,
    /// What rounding took from the velocities (m/s).
    pub lost_velocity: Vec<Row>,
    /// Which contacts are closed, a bit each.
    pub closed: Vec<u8>,
    /// Forces of the contacts (N): steps of short chains go on from them, all others leave them as they were first.
    pub force: Vec<Row>,
    /// Accelerations (m/s²).
    pub acceleration: Vec<Row>,
    /// Gradients of the accelerations along themselves, for methods that ask for them (m/s⁴).
    pub gradient: Vec<Row>,
}

/// Largest magnitudes: of each lane where lanes are chains, of the whole chain in every lane otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Largest {
    /// Change of an overlap (m).
    pub overlap: Row,
    /// Speed (m/s).
    pub speed: Row,
    /// Estimated error of a position or a velocity, as a multiple of the tolerated one (1).
    pub error: Row,
    /// How far a correction has moved a body (m), where there was one.
    pub moved: Row,
}

/// All arrays of a run; made once.
#[derive(Debug, Clone, PartialEq)]
pub struct Workspace {
    /// Where the step starts.
    pub now: Box<Motion>,
    /// Where it ends.
    pub next: Box<Motion>,
    /// Accelerations at the stages between (m/s²), for methods that have any; once they have been summed, what kinks have missed.
    pub between: Vec<Between>,
    /// Estimated error of each position (m).
    pub error_position: Vec<Row>,
    /// Estimated error of each velocity (m/s).
    pub error_velocity: Vec<Row>,
    /// Overlaps where the step ends (m).
    pub overlap: Vec<Row>,
    /// Contacts that changed sides in the step last tried, a bit each; those left whose kinks are put right.
    pub changed: Vec<u8>,
    /// Contacts that did not, but may have been on the other side in between, a bit each.
    pub doubtful: Vec<u8>,
    /// Largest magnitudes of the step last tried.
    pub largest: Largest,
    /// Whether all velocities of the step last tried are finite, a bit for each lane.
    pub finite: u8,
}

impl Motion {
    /// Positions (m) and velocities (m/s).
    #[must_use]
    pub fn seen(&self) -> (&[Row], &[Row]) {
        (&self.position, &self.velocity)
    }

    fn at_rest(rows: usize, gradients: usize) -> Self {
        let zeros = || vec![Row::default(); rows];
        Self {
            position: zeros(),
            velocity: zeros(),
            lost_position: zeros(),
            lost_velocity: zeros(),
            closed: vec![0; rows],
            force: zeros(),
            acceleration: zeros(),
            gradient: vec![Row::default(); gradients],
        }
    }
}

impl Workspace {
    /// Error of the step last tried in lane `lane`, in multiples of the tolerated one; infinite where anything is not a number (1).
    #[inline]
    #[must_use]
    pub fn error(&self, lane: usize) -> f64 {
        let error = self.largest.error.0[lane];
        // `max` hides what is not a number; the sum that `finite` has seen does not.
        let known = self.finite & (1 << lane) != 0 && !error.is_nan();
        if known { error } else { f64::INFINITY }
    }

    /// Makes the step's end the present; what was the start stays where interpolation finds it.
    #[inline]
    pub fn turn(&mut self) {
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Everything at rest, in `rows` rows, with what `scheme` needs.
    #[must_use]
    pub fn new(rows: usize, scheme: Scheme) -> Self {
        let (between, gradients) = match scheme {
            Scheme::Pair(..) => (rows, 0),
            Scheme::Splitting(method, _) if method.gradients.is_empty() => (0, 0),
            Scheme::Splitting(..) => (0, rows),
        };
        let motion = || Box::new(Motion::at_rest(rows, gradients));
        Self {
            now: motion(),
            next: motion(),
            between: vec![[Row::default(); BETWEEN]; between],
            error_position: vec![Row::default(); rows],
            error_velocity: vec![Row::default(); rows],
            overlap: vec![Row::default(); rows],
            changed: vec![0; rows],
            doubtful: vec![0; rows],
            largest: Largest::default(),
            finite: 0,
        }
    }
}
