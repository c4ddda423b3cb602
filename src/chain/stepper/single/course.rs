//! What moves in one chain, and how far the wave has come.

use crate::chain::stepper::dispatch::InstructionSet;
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::layout::{Along, Layout, Striped, Tiled};
use crate::chain::stepper::plan::Plan;
use crate::chain::stepper::workspace::Workspace;
use crate::integrate::Work;

/// Rows at rest behind the last that moves, whole tiles: within a step news travel a contact a stage, of which there are fewer than in these.
pub fn margin<Y: Layout>() -> usize {
    Y::TILE.max(2)
}

/// Speed from which a row is under way, as a share of the largest at the start: linear forces, and those without cancellation, send something
/// ahead however far, far below 1e-13 of the impact, under which nothing is a pulse (1).
pub const UNDER_WAY: f64 = 1e-30;

/// How a chain lies in rows.
#[derive(Debug, Clone, Copy)]
pub enum Laid {
    Along,
    Tiled,
    Striped,
}

/// What moves, and all that a step reads and writes.
pub struct Course {
    pub set: InstructionSet,
    pub laid: Laid,
    pub plan: Plan,
    /// Rows with nothing that is faster are ahead of the wave (m/s).
    pub quiet: f64,
    pub work: Workspace,
    /// Where the last step has ended (s).
    pub time: f64,
    pub counts: Work,
}

impl Course {
    /// Goes on with the rows that the motion has come near to.
    pub fn follow_front(&mut self) {
        let (live, all) = (self.plan.live, self.plan.all_rows());
        let margin = laid!(self.laid, Y => margin::<Y>());
        let ahead = live.saturating_sub(margin)..live;
        let moves = |row: &Row| row.0.iter().any(|v| v.abs() > self.quiet);
        if live < all && self.work.now.velocity()[ahead].iter().any(moves) {
            self.plan.live = (live + margin).min(all);
        }
    }

    /// Whether no row is ahead of the wave any more.
    pub fn is_all_under_way(&self) -> bool {
        self.plan.live == self.plan.all_rows()
    }

    /// First body whose state is not finite at the end of the step last tried.
    pub fn first_lost(&self) -> usize {
        let (positions, velocities) = self.work.next.seen();
        let lost = |index: &usize| {
            let (row, lane) = self.place(*index);
            !(positions[row].0[lane].is_finite() && velocities[row].0[lane].is_finite())
        };
        (0..WIDTH * self.plan.all_rows()).find(lost).unwrap_or(0)
    }

    /// Row and lane of entry `index`.
    pub fn place(&self, index: usize) -> (usize, usize) {
        laid!(self.laid, Y => Y::place(self.plan.all_rows(), index, 0))
    }

    /// The first `count` values of `rows`.
    pub fn flat(&self, rows: &[Row], count: usize) -> impl Iterator<Item = f64> {
        (0..count).map(|index| {
            let (row, lane) = self.place(index);
            rows[row].0[lane]
        })
    }
}
