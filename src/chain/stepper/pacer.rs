//! Which paced step comes next, of a chain in rows.

use super::around::row_of;
use super::lanes::Row;
use super::workspace::Motion;
use crate::integrate::Pacing;
use crate::integrate::pace::{Beat, Course, NOTHING};

/// A chain's steps, and its stiff contact, which they go by.
#[derive(Debug, Clone)]
pub struct Pacer {
    pub beat: Beat,
    pub stiff: Option<Stiff>,
}

/// A contact in rows.
#[derive(Debug, Clone, Copy)]
pub struct Stiff {
    /// Row and lane of it and of the body below.
    pub at: (usize, usize),
    /// Those of the body above; none at the top.
    pub above: Option<(usize, usize)>,
    /// (m)
    static_overlap: f64,
}

impl Stiff {
    /// How it moves, given positions (m), velocities (m/s) and accelerations (m/s²) in the rows of the body above and of the one below.
    #[inline]
    pub fn course(&self, [above, below]: [[&Row; 3]; 2]) -> Course {
        let across = |which: usize| {
            let over = self.above.map_or(0.0, |(_, lane)| above[which].0[lane]);
            over - below[which].0[self.at.1]
        };
        let overlap = self.static_overlap + across(0);
        Course { overlap, closing: across(1), bend: across(2) }
    }
}

impl Pacer {
    /// The steps that `tolerance` (1) asks of a chain that moves as `now`, whose bodies and contacts stand where `place` tells.
    pub fn new(
        pacing: &Pacing,
        tolerance: f64,
        now: &Motion,
        place: impl Fn(usize) -> (usize, usize),
    ) -> Self {
        let stiff = pacing.stiff.map(|stiff| {
            let [above, _] = stiff.bodies;
            // A contact stands where the body below does, or at the end would.
            let at = place(above.map_or(0, |above| above + 1));
            let static_overlap = stiff.static_overlap;
            Stiff { at, above: above.map(&place), static_overlap }
        });
        let beat = Beat::new(pacing, tolerance, course_of(stiff, |row| row_of(now.moving(), row)));
        Self { beat, stiff }
    }

    /// How the stiff contact moves, given how rows stand and move; as if there were none if `of` does not know its rows.
    pub fn course<'a>(&self, of: impl Fn(usize) -> Option<[&'a Row; 3]>) -> Course {
        course_of(self.stiff, of)
    }

    /// How many steps are as long as the next, up to `most`, as [`Beat::alike`] tells from how the chain moves `now`.
    pub fn alike(&self, now: &Motion, times: [f64; 2], most: usize) -> usize {
        self.beat.alike(self.course(|row| row_of(now.moving(), row)), times, most)
    }

    /// A step has come to `next`.
    pub fn pass(&mut self, next: &Motion) {
        self.beat.pass(self.course(|row| row_of(next.moving(), row)));
    }
}

fn course_of<'a>(stiff: Option<Stiff>, of: impl Fn(usize) -> Option<[&'a Row; 3]>) -> Course {
    let course = |stiff: Stiff| {
        let below = of(stiff.at.0)?;
        let above = stiff.above.map_or(Some(below), |(row, _)| of(row))?;
        Some(stiff.course([above, below]))
    };
    stiff.and_then(course).unwrap_or(NOTHING)
}
