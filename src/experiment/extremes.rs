//! Largest contact forces and displacements of a run, from every step of the integrator and so
//! independent of the number of frames.
//!
//! Between the ends of a step an overlap is largest where its closing speed is zero, which is found
//! on the step's interpolant.

use super::frames::past_of;
use crate::chain::{Chain, Contact, Past};
use crate::motion::{Integrator, Interpolant};
use crate::numeric::roots::root;

/// Times in a step at which the force of a contact with losses is evaluated besides its ends (1).
const LOSSY_SAMPLE_TIMES: [f64; 3] = [0.25, 0.5, 0.75];
/// A force exceeds the larger of those at the ends of its step by less than this factor (1).
const MAX_RISE_IN_STEP: f64 = 1.5;
/// The closing speed within a step exceeds those at both ends by less than this factor (1).
const MAX_SPEED_RISE: f64 = 2.0;
/// The force of a contact with losses is sampled within a step in which it changes by more than
/// this share (1).
const MIN_CHANGE_SHARE: f64 = 1e-3;

/// Largest contact forces, and the displacements of the body that a magnet follows.
#[derive(Debug, Clone)]
pub struct Extremes {
    /// Largest change of the overlap of each contact without losses, whose force grows with it (m).
    changes: Vec<f64>,
    /// Largest force in each contact with losses, static part and losses included (N).
    lossy_forces: Vec<f64>,
    /// Least and largest displacement of the body that a magnet follows; zero without one (m).
    pub pulled: [f64; 2],
    /// Time of the end of the last step (s).
    time: f64,
    /// Position (m) and velocity (m/s) of each body at the end of the last step.
    ends: Vec<[f64; 2]>,
    /// The same at the end of the present one.
    now: Vec<[f64; 2]>,
    /// The same of the walls at the top and at the bottom at the end of the last step.
    walls: [[f64; 2]; 2],
}

impl Extremes {
    /// Those of a chain at rest but for these velocities (m/s).
    pub fn new(chain: &Chain, velocities: &[f64]) -> Self {
        let contacts = chain.contacts();
        Self {
            changes: vec![0.0; contacts.len()],
            lossy_forces: contacts.iter().map(|contact| contact.static_force).collect(),
            pulled: [0.0; 2],
            time: 0.0,
            ends: velocities.iter().map(|velocity| [0.0, *velocity]).collect(),
            now: Vec::with_capacity(velocities.len()),
            walls: [[0.0; 2]; 2],
        }
    }

    /// Largest force in each contact of `chain`, static part and losses included (N).
    pub fn forces(&self, chain: &Chain) -> Vec<f64> {
        let both = self.changes.iter().zip(&self.lossy_forces);
        let force = |(contact, (change, lossy)): (&Contact, (&f64, &f64))| match contact.loss {
            None => {
                let before = contact.static_largest();
                contact.static_force + contact.force_change_after(*change, before).0
            }
            Some(_) => *lossy,
        };
        chain.contacts().iter().zip(both).map(force).collect()
    }

    /// Takes in the last step of `integrator`, whose interpolation is prepared.
    pub fn take_step(&mut self, chain: &Chain, integrator: &dyn Integrator) {
        self.now.clear();
        self.now.extend((0..self.ends.len()).map(|body| integrator.body(body)));
        let length = integrator.time() - self.time;
        self.time = integrator.time();
        let walls_before = self.walls;
        if chain.has_moving_walls() {
            let wall = |end| integrator.wall(end);
            self.walls = [0, 1].map(wall).map(|wall| [wall.position(1.0), wall.velocity(1.0)]);
        }
        let [mut before_above, last_before] = walls_before;
        let [mut after_above, last_after] = self.walls;
        for (j, contact) in chain.contacts().iter().enumerate() {
            let before_below = self.ends.get(j).copied().unwrap_or(last_before);
            let after_below = self.now.get(j).copied().unwrap_or(last_after);
            let before = difference(before_above, before_below);
            let after = difference(after_above, after_below);
            (before_above, after_above) = (before_below, after_below);
            if contact.stiffness == 0.0 {
                continue;
            }
            let turns = before[1] > 0.0 && after[1] <= 0.0;
            if contact.loss.is_none() {
                let largest = &mut self.changes[j];
                *largest = largest.max(before[0]).max(after[0]);
                let rise = MAX_SPEED_RISE * (before[1] - after[1]) * length;
                if turns && before[0].max(after[0]) + rise > *largest {
                    let at = between(integrator, self.ends.len(), j);
                    *largest = largest.max(turning(&at, before[1], after[1])[0]);
                }
                continue;
            }
            let past = past_of(chain, integrator, j);
            self.take_lossy(contact, integrator, (j, past), (before, after), turns);
        }
        if let Some((body, _)) = chain.pull() {
            let (before, after) = (self.ends[body], self.now[body]);
            self.widen(after[0]);
            if before[1] * after[1] < 0.0 {
                let path = integrator.interpolant(body);
                let rates = [before[1], after[1]];
                self.widen(path.position(root(&|theta| path.velocity(theta), [0.0, 1.0], rates)));
            }
        }
        std::mem::swap(&mut self.ends, &mut self.now);
    }

    /// The largest force of a contact with losses in the step, from its ends and, where it may be
    /// larger in between, from samples and the turn.
    fn take_lossy(
        &mut self,
        contact: &Contact,
        integrator: &dyn Integrator,
        (j, past): (usize, Past),
        (before, after): ([f64; 2], [f64; 2]),
        turns: bool,
    ) {
        let force = |[change, closing]: [f64; 2]| {
            contact.static_force + contact.lossy_force_change(change, closing, past)
        };
        let (start, end) = (force(before), force(after));
        let at_ends = start.max(end);
        let largest = &mut self.lossy_forces[j];
        *largest = largest.max(at_ends);
        let may_exceed = (start - end).abs() > MIN_CHANGE_SHARE * at_ends
            && MAX_RISE_IN_STEP * at_ends > *largest;
        if turns || may_exceed {
            let at = between(integrator, self.ends.len(), j);
            if turns {
                *largest = largest.max(force(turning(&at, before[1], after[1])));
            }
            for theta in LOSSY_SAMPLE_TIMES {
                *largest = largest.max(force(at(theta)));
            }
        }
    }

    fn widen(&mut self, displacement: f64) {
        let [least, largest] = self.pulled;
        self.pulled = [least.min(displacement), largest.max(displacement)];
    }
}

/// Overlap change (m) and its rate (m/s) of the contact between two bodies.
fn difference(above: [f64; 2], below: [f64; 2]) -> [f64; 2] {
    [above[0] - below[0], above[1] - below[1]]
}

/// The same of contact `j` in a chain of so many `bodies`, at a share of the last step.
fn between(integrator: &dyn Integrator, bodies: usize, j: usize) -> impl Fn(f64) -> [f64; 2] {
    let motion = |body: usize| integrator.interpolant(body);
    let above = j.checked_sub(1).map_or_else(|| integrator.wall(0), motion);
    let below = if j < bodies { motion(j) } else { integrator.wall(1) };
    move |theta| {
        let at = |path: &Interpolant| [path.position(theta), path.velocity(theta)];
        difference(at(&above), at(&below))
    }
}

/// How contact `j` is at that share where its closing speed, which is first above zero and then not
/// (m/s), is zero.
fn turning(at: &dyn Fn(f64) -> [f64; 2], start: f64, end: f64) -> [f64; 2] {
    at(root(&|theta| at(theta)[1], [0.0, 1.0], [start, end]))
}
