//! What a step reads and writes.

use super::around::Rows;
use super::lanes::Row;
use super::parts;
use super::sweep::Pause;
use crate::integrate::Scheme;

/// Most stages of a pair between the ends of a step.
pub const BETWEEN: usize = 7;

/// A row at each of them, side by side in memory.
pub type Between = [Row; BETWEEN];

/// One end of a step, in rows: all in one piece of memory, for asking for four or six takes a short chain's set-up longer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motion {
    rows: Vec<Row>,
    count: usize,
    has_gradients: bool,
    /// Which contacts are closed, a bit each.
    pub closed: Vec<u8>,
}

/// The parts of a motion, to be written.
pub struct Parts<'a> {
    /// Displacements (m).
    pub position: &'a mut [Row],
    /// Velocities (m/s).
    pub velocity: &'a mut [Row],
    /// Accelerations (m/s²).
    pub acceleration: &'a mut [Row],
    /// Forces of the contacts (N): steps of short chains go on from them, all others leave them as they were first.
    pub force: &'a mut [Row],
    /// What rounding took from the displacements (m), under a pair.
    pub lost_position: &'a mut [Row],
    /// What rounding took from the velocities (m/s), under a pair.
    pub lost_velocity: &'a mut [Row],
    /// Which contacts are closed, a bit each.
    pub closed: &'a mut [u8],
    /// Two thirds of the gradients of the accelerations along themselves, for methods that ask for them (m/s⁴).
    pub gradient: &'a mut [Row],
}

/// How many parts of a motion are rows, whatever the method.
const PARTS: usize = 4;
/// How many more under a pair, which keeps what rounding takes.
const LOST: usize = 2;

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
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Workspace {
    /// Where the step starts; in a box, so that a step's turn moves pointers only.
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
    /// Where sweeps pause, in fixed steps.
    pub pauses: Vec<Pause>,
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
    #[inline]
    fn part(&self, index: usize) -> &[Row] {
        &self.rows[index * self.count..][..self.count]
    }

    /// Displacements (m).
    #[inline]
    #[must_use]
    pub fn position(&self) -> &[Row] {
        self.part(0)
    }

    /// Velocities (m/s).
    #[inline]
    #[must_use]
    pub fn velocity(&self) -> &[Row] {
        self.part(1)
    }

    /// Accelerations (m/s²).
    #[inline]
    #[must_use]
    pub fn acceleration(&self) -> &[Row] {
        self.part(2)
    }

    /// Forces of the contacts (N).
    #[inline]
    #[must_use]
    pub fn force(&self) -> &[Row] {
        self.part(3)
    }

    /// What rounding took from the displacements (m), under a pair.
    #[inline]
    #[must_use]
    pub fn lost_position(&self) -> &[Row] {
        self.part(4)
    }

    /// What rounding took from the velocities (m/s), under a pair.
    #[inline]
    #[must_use]
    pub fn lost_velocity(&self) -> &[Row] {
        self.part(5)
    }

    /// Two thirds of the gradients of the accelerations along themselves, for methods that ask for them (m/s⁴).
    #[inline]
    #[must_use]
    pub fn gradient(&self) -> &[Row] {
        self.part(PARTS)
    }

    /// All of it, to be written; what the method does not have is empty.
    #[inline]
    pub fn parts(&mut self) -> Parts<'_> {
        let (mut rows, count) = (self.rows.as_mut_slice(), self.count);
        let mut next = || rows.split_off_mut(..count).unwrap_or_default();
        Parts {
            position: next(),
            velocity: next(),
            acceleration: next(),
            force: next(),
            gradient: if self.has_gradients { next() } else { Default::default() },
            lost_position: next(),
            lost_velocity: next(),
            closed: &mut self.closed,
        }
    }

    /// Positions (m) and velocities (m/s).
    #[must_use]
    pub fn seen(&self) -> (&[Row], &[Row]) {
        (self.position(), self.velocity())
    }

    /// The same and accelerations (m/s²).
    #[must_use]
    pub fn moving(&self) -> Rows<'_> {
        [self.position(), self.velocity(), self.acceleration()]
    }

    fn rest(&mut self, count: usize, (lost, has_gradients): (usize, bool)) {
        let parts = PARTS + lost + usize::from(has_gradients);
        (self.count, self.has_gradients) = (count, has_gradients);
        anew(&mut self.rows, parts * count);
        anew(&mut self.closed, count);
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
        let mut work = Self::default();
        work.rest(rows, scheme);
        work
    }

    /// As [`Self::new`] has it, in the memory that there is.
    pub fn rest(&mut self, rows: usize, scheme: Scheme) {
        let (judged, more, pauses) = match scheme {
            Scheme::Pair(..) => (rows, (LOST, false), 0),
            Scheme::Splitting(method, _) | Scheme::Paced(method, _) => {
                (0, (0, !method.gradients.is_empty()), parts::pauses(method, rows))
            }
        };
        self.now.rest(rows, more);
        self.next.rest(rows, more);
        anew(&mut self.between, judged);
        anew(&mut self.error_position, judged);
        anew(&mut self.error_velocity, judged);
        anew(&mut self.overlap, judged);
        anew(&mut self.pauses, pauses);
        anew(&mut self.changed, judged);
        anew(&mut self.doubtful, judged);
        (self.largest, self.finite) = (Largest::default(), 0);
    }
}

/// Has `values` be `count` that are not yet known.
pub fn anew<T: Clone + Default>(values: &mut Vec<T>, count: usize) {
    values.clear();
    values.resize(count, T::default());
}
