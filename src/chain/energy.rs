//! Where the chain's energy is.
//!
//! Kinetic `sum m v^2/2`, elastic `sum 2/5 A overlap^2.5`, and what the loads' work has to come
//! from, each apart: gravity `- g sum m u`, the magnet `- F u`, or the field's own energy where its
//! force follows the particle, and forces that press on the ends. All but the elastic energy are
//! zero at static equilibrium. A wall does not move, so its preload does no work. The sum is
//! conserved without losses.

use serde::Serialize;

use super::{Body, Chain, Past, State};

/// The chain's energy by kind.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Energy {
    /// Of motion (J).
    pub kinetic: f64,
    /// In the contacts, static overlaps included (J).
    pub elastic: f64,
    /// Of gravity: less the work it has done since static equilibrium (J).
    pub gravity: f64,
    /// Of the magnet: less the work it has done since static equilibrium (J).
    pub magnet: f64,
    /// Of forces that press on the chain's ends: less the work they have done since static
    /// equilibrium (J).
    pub end_forces: f64,
}

impl Energy {
    /// What is conserved where nothing is lost (J).
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.gravity + self.magnet + self.end_forces
    }
}

impl Chain {
    /// Overlap change of contact `j` at the displacements `position` (m).
    pub fn overlap_change(&self, position: &[f64], j: usize) -> f64 {
        // Behind the bodies there may be accounts.
        let bodies = position.get(..self.bodies.len()).unwrap_or(position);
        let at = |index: Option<usize>| index.and_then(|i| bodies.get(i)).copied().unwrap_or(0.0);
        at(j.checked_sub(1)) - at(Some(j))
    }

    /// Overlap change of contact `j` in `state`, a moving wall's displacement included (m).
    pub fn overlap_change_in(&self, state: &State, j: usize) -> f64 {
        let change = self.overlap_change(&state.position, j);
        let last = self.bodies.len();
        if !self.has_moving_walls() || (j > 0 && j < last) {
            return change;
        }
        let [top, bottom] = self.walls(state);
        change + if j == 0 { top } else { -bottom }
    }

    /// Force in contact `j` at these displacements (m) and velocities (m/s), static part and losses
    /// included; `closed` is true if the contact counts as closed (N).
    pub fn contact_force(&self, position: &[f64], velocity: &[f64], j: usize, closed: bool) -> f64 {
        self.contact_force_between([[0.0; 2]; 2], position, velocity, j, Past::of(closed))
    }

    /// The same with `walls` at the top and at the bottom at these displacements (m) and velocities
    /// (m/s), of a contact with this `past` (N).
    pub fn contact_force_between(
        &self,
        walls: [[f64; 2]; 2],
        position: &[f64],
        velocity: &[f64],
        j: usize,
        past: Past,
    ) -> f64 {
        let wall = |part: usize| {
            let top = if j == 0 { walls[0][part] } else { 0.0 };
            top - if j == self.bodies.len() { walls[1][part] } else { 0.0 }
        };
        self.contacts.get(j).map_or(0.0, |contact| {
            let change = self.overlap_change(position, j) + wall(0);
            let closing = self.overlap_change(velocity, j) + wall(1);
            contact.static_force + contact.lossy_force_change(change, closing, past)
        })
    }

    /// Energy of `state`.
    pub fn energy(&self, state: &State) -> Energy {
        let sum = |of: &dyn Fn(usize, &Body) -> f64| {
            self.bodies.iter().enumerate().map(|(i, body)| of(i, body)).sum::<f64>()
        };
        let at = |values: &[f64], i: usize| values.get(i).copied().unwrap_or(0.0);
        let u = |i: usize| at(&state.position, i);
        let [above, below] = self.ends;
        Energy {
            kinetic: sum(&|i, body| 0.5 * body.mass * at(&state.velocity, i).powi(2)),
            elastic: (0..self.contacts.len()).map(|j| self.contact_energy(state, j)).sum(),
            gravity: -self.gravity * sum(&|i, body| body.mass * u(i)),
            magnet: self.magnet.as_ref().map_or(0.0, |m| m.energy(u(m.body), self.follows)),
            end_forces: below * u(self.bodies.len() - 1) - above * u(usize::from(self.striker)),
        }
    }

    /// Energy of `state` above that of static equilibrium, without the digits that the two share
    /// (J).
    pub fn energy_above_static(&self, state: &State) -> f64 {
        let kinetic = self.bodies.iter().zip(&state.velocity).map(|(b, v)| 0.5 * b.mass * v * v);
        let elastic = self.contacts.iter().enumerate().filter(|(_, c)| c.stiffness > 0.0);
        let elastic = elastic.map(|(j, c)| c.energy_change(self.overlap_change_in(state, j)));
        let loads = self.residual.iter().zip(&state.position).map(|(force, u)| force * u);
        // A constant pull is balanced by the contacts; what it does beyond that is its own.
        let pull = self.pull().map_or(0.0, |(body, pull)| {
            let u = state.position.get(body).copied().unwrap_or(0.0);
            pull.energy(u) + self.magnet().map_or(0.0, |magnet| magnet.force * u)
        });
        kinetic.sum::<f64>() + elastic.sum::<f64>() - loads.sum::<f64>() + pull
    }

    /// Total momentum of `state`, downward positive (kg m/s).
    pub fn momentum(&self, state: &State) -> f64 {
        self.bodies.iter().zip(&state.velocity).map(|(body, v)| body.mass * v).sum()
    }
}
