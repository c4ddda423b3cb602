//! A pair's nodes and weights, as the loops read them.

use super::lanes::{Row, WIDTH};
use crate::integrate::nystrom::{NystromPair, Row as Terms};

/// Most stages of a pair.
const MOST_STAGES: usize = 16;

/// Weights of a pair's stages in rows.
pub type Weights = [Row; MOST_STAGES / WIDTH];

/// A pair's nodes and weights, one entry a stage.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    /// How many stages there are.
    pub stages: usize,
    /// Their times, fractions of the step (1).
    pub nodes: Weights,
    /// What they weigh in the velocities (1).
    pub velocity: Weights,
    /// What they weigh in the positions (1).
    pub position: Weights,
    /// What they weigh in the error estimate of the velocities (1).
    pub velocity_error: Weights,
    /// What they weigh in the error estimate of the positions (1).
    pub position_error: Weights,
}

impl Quadrature {
    /// Spreads a pair's weights out.
    #[must_use]
    pub fn of(pair: &NystromPair) -> Self {
        let spread = |terms: Terms| {
            let mut weights = Weights::default();
            for (stage, weight) in terms {
                weights[stage / WIDTH].0[stage % WIDTH] = *weight;
            }
            weights
        };
        let nodes: Vec<(usize, f64)> = pair.nodes.iter().copied().enumerate().collect();
        let mut nodes_of = Weights::default();
        for (stage, node) in nodes {
            nodes_of[stage / WIDTH].0[stage % WIDTH] = node;
        }
        let velocity = spread(pair.velocity);
        let velocity_error = spread(pair.velocity_error);
        let position_error = spread(pair.position_error);
        Self {
            stages: pair.nodes.len(),
            nodes: nodes_of,
            velocity,
            position: spread(pair.position),
            velocity_error,
            position_error,
        }
    }
}
