//! Sampled velocities of bodies and walls.

use super::grid::Grid;
use crate::motion::Integrator;

/// What a velocity is sampled of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mover {
    /// The body of this index.
    Body(usize),
    /// The wall at the top (0) or at the bottom (1).
    Wall(usize),
}

/// A velocity at the times of the sample grid.
#[derive(Debug, Clone)]
pub struct MotionRecord {
    /// What moves.
    pub mover: Mover,
    /// Velocity, downward positive (m/s).
    pub samples: Vec<f64>,
}

impl MotionRecord {
    /// Takes in the last step of `integrator`, whose interpolation is prepared.
    pub(super) fn take(&mut self, integrator: &dyn Integrator, grid: Grid) {
        let (start, length) = integrator.last_step();
        let end = integrator.time();
        let mut time = grid.time(self.samples.len());
        if time > end {
            return;
        }
        let path = match self.mover {
            Mover::Body(body) => integrator.interpolant(body),
            Mover::Wall(wall) => integrator.wall(wall),
        };
        while time <= end {
            self.samples.push(path.velocity((time - start) / length));
            time = grid.time(self.samples.len());
        }
    }
}
