//! Largest contact forces and displacements of a run, from every step of the integrator and so
//! independent of the number of frames.
//!
//! Between the ends of a step an overlap is largest where its closing speed is zero, which is found
//! on the step's interpolant.

use crate::chain::Chain;
use crate::motion::{Integrator, Interpolant};
use crate::numeric::roots::root;

/// Times in a step at which the force of a contact with losses is evaluated besides its ends (1).
const LOSSY_SAMPLE_TIMES: [f64; 3] = [0.25, 0.5, 0.75];
/// A force exceeds the larger of those at the ends of its step by less than this factor (1).
const MAX_RISE_IN_STEP: f64 = 1.5;
/// The force of a contact with losses is sampled within a step in which it changes by more than
/// this share (1).
const MIN_CHANGE_SHARE: f64 = 1e-3;

/// Largest contact forces, and the displacements of the body that a magnet follows.
#[derive(Debug, Clone)]
pub struct Extremes {
    /// Largest force in each contact, static part and losses included (N).
    pub forces: Vec<f64>,
    /// Least and largest displacement of the body that a magnet follows; zero without one (m).
    pub pulled: [f64; 2],
    /// Position (m) and velocity (m/s) of each body at the end of the last step.
    ends: Vec<[f64; 2]>,
}

impl Extremes {
    /// Those of a chain at rest but for these velocities (m/s).
    pub fn new(chain: &Chain, velocities: &[f64]) -> Self {
        Self {
            forces: chain.contacts().iter().map(|contact| contact.static_force).collect(),
            pulled: [0.0; 2],
            ends: velocities.iter().map(|velocity| [0.0, *velocity]).collect(),
        }
    }

    /// Takes in the last step of `integrator`, whose interpolation is prepared.
    pub fn take_step(&mut self, chain: &Chain, integrator: &dyn Integrator) {
        let now: Vec<[f64; 2]> = (0..self.ends.len()).map(|body| integrator.body(body)).collect();
        let motion = |body: Option<usize>| {
            body.filter(|body| *body < now.len()).map(|b| integrator.interpolant(b))
        };
        for (j, (contact, largest)) in chain.contacts().iter().zip(&mut self.forces).enumerate() {
            if contact.stiffness == 0.0 {
                continue;
            }
            let [before, after] = [&self.ends, &now].map(|ends| difference(ends, j));
            let closed = integrator.was_on(j);
            let force = |[change, closing]: [f64; 2]| {
                contact.static_force + contact.lossy_force_change(change, closing, closed)
            };
            let (start, end) = (force(before), force(after));
            let at_ends = start.max(end);
            *largest = largest.max(at_ends);
            let turns = before[1] > 0.0 && after[1] <= 0.0;
            let is_lossy = contact.loss.is_some();
            let may_exceed = is_lossy
                && (start - end).abs() > MIN_CHANGE_SHARE * at_ends
                && MAX_RISE_IN_STEP * at_ends > *largest;
            if !(turns || may_exceed) {
                continue;
            }
            let [above, below] =
                [j.checked_sub(1), Some(j)].map(|body| motion(body).unwrap_or(Interpolant::REST));
            let at = |theta: f64| {
                let change = above.position(theta) - below.position(theta);
                [change, above.velocity(theta) - below.velocity(theta)]
            };
            if turns {
                let theta = root(&|theta| at(theta)[1], [0.0, 1.0], [before[1], after[1]]);
                *largest = largest.max(force(at(theta)));
            }
            for theta in LOSSY_SAMPLE_TIMES.into_iter().filter(|_| is_lossy) {
                *largest = largest.max(force(at(theta)));
            }
        }
        if let Some((body, _)) = chain.pull() {
            let (before, after) = (self.ends[body], now[body]);
            self.widen(after[0]);
            if before[1] * after[1] < 0.0 {
                let path = integrator.interpolant(body);
                let rates = [before[1], after[1]];
                self.widen(path.position(root(&|theta| path.velocity(theta), [0.0, 1.0], rates)));
            }
        }
        self.ends = now;
    }

    fn widen(&mut self, displacement: f64) {
        let [least, largest] = self.pulled;
        self.pulled = [least.min(displacement), largest.max(displacement)];
    }
}

/// Overlap change of contact `j` (m) and its rate (m/s).
fn difference(ends: &[[f64; 2]], j: usize) -> [f64; 2] {
    let of =
        |body: Option<usize>| body.and_then(|body| ends.get(body)).copied().unwrap_or([0.0; 2]);
    let (above, below) = (of(j.checked_sub(1)), of(Some(j)));
    [above[0] - below[0], above[1] - below[1]]
}
