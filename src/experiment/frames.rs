//! The whole chain at coarse, even times.

use super::grid::Grid;
use crate::chain::Chain;
use crate::chain::{Past, State};
use crate::motion::kernel::VectorStepper;
use crate::motion::{Integrator, Interpolant};

/// Contact forces at coarse, even times: the whole chain as a film.
#[derive(Debug, Clone)]
pub struct Frames {
    /// When the frames were taken.
    pub grid: Grid,
    /// Force in each contact at each time, static part included; nothing before the first frame
    /// (N).
    pub contact_forces: Vec<Vec<f64>>,
    /// Displacement of each body at each time; nothing before the first frame (m).
    pub displacements: Vec<Vec<f64>>,
    count: usize,
}

impl Frames {
    /// Frames that begin with the chain at rest but for these velocities (m/s), if a frame is due
    /// at the start.
    pub fn new(chain: &Chain, grid: Grid, velocities: &[f64]) -> Self {
        let mut frames =
            Self { grid, contact_forces: Vec::new(), displacements: Vec::new(), count: 0 };
        if grid.time(0) <= 0.0 {
            let State { position, velocity, .. } = chain.initial_state(velocities);
            let largest =
                |j| chain.accounts().plastic.map_or(0.0, |first: usize| velocity[first + j]);
            let past = |j| Past { closed: true, largest: largest(j) };
            frames.take(chain, [[0.0; 2]; 2], (&position, &velocity), &past);
        }
        frames
    }

    /// Makes room for the first frame.
    fn begin(&mut self, chain: &Chain) {
        if self.count == 0 {
            self.contact_forces = vec![Vec::new(); chain.contacts().len()];
            self.displacements = vec![Vec::new(); chain.bodies().len()];
        }
    }

    /// Takes every frame that falls into the integrator's last step.
    pub fn follow(&mut self, chain: &Chain, integrator: &dyn Integrator) {
        let (start, length) = integrator.last_step();
        let end = integrator.time();
        if self.next() > end {
            return;
        }
        let motion: Vec<Interpolant> =
            (0..chain.bodies().len()).map(|body| integrator.interpolant(body)).collect();
        let walls = [0, 1].map(|end| integrator.wall(end));
        while self.next() <= end {
            let theta = (self.next() - start) / length;
            let walls = walls.map(|wall| [wall.position(theta), wall.velocity(theta)]);
            let position: Vec<f64> = motion.iter().map(|m| m.position(theta)).collect();
            let velocity: Vec<f64> = motion.iter().map(|m| m.velocity(theta)).collect();
            let past = |contact| past_of(chain, integrator, contact);
            self.take(chain, walls, (&position, &velocity), &past);
        }
    }

    /// The same for the vector path.
    pub fn take_step(&mut self, chain: &Chain, stepper: &mut VectorStepper) {
        let (start, length) = stepper.last_step();
        while self.next() <= stepper.time() {
            self.begin(chain);
            let theta = (self.next() - start) / length;
            let (positions, changes) = stepper.frame(theta);
            let forces = chain.contacts().iter().zip(changes);
            for (track, (contact, change)) in self.contact_forces.iter_mut().zip(forces) {
                track.push(contact.static_force + change);
            }
            for (track, x) in self.displacements.iter_mut().zip(positions) {
                track.push(x);
            }
            self.count += 1;
        }
    }

    /// When the next frame is due (s).
    pub fn next(&self) -> f64 {
        self.grid.time(self.count)
    }

    fn take(
        &mut self,
        chain: &Chain,
        walls: [[f64; 2]; 2],
        motion: (&[f64], &[f64]),
        past: &dyn Fn(usize) -> Past,
    ) {
        let (position, velocity) = motion;
        self.begin(chain);
        for (j, forces) in self.contact_forces.iter_mut().enumerate() {
            let force = chain.contact_force_between(walls, position, velocity, j, past(j));
            forces.push(force);
        }
        for (track, x) in self.displacements.iter_mut().zip(position) {
            track.push(*x);
        }
        self.count += 1;
    }
}

/// What decides on the force of a contact of `chain` over the integrator's last step beside its
/// motion.
pub(super) fn past_of(chain: &Chain, integrator: &dyn Integrator, contact: usize) -> Past {
    let account = chain.accounts().plastic.map(|first| first + contact);
    let largest = account.map_or(0.0, |place| integrator.interpolant(place).velocity(0.0));
    Past { closed: integrator.was_on(contact), largest }
}
