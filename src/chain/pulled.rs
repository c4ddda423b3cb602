//! A chain whose magnet's force follows its particle: any other system of the chain, and one more force.
//!
//! A chain without [`super::MagnetLaw`] is never wrapped, and pays nothing for it.

use super::magnet::Pull;
use crate::integrate::{Linearised, Pacing, Scales, State, Switching, System, Tridiagonal};

/// A system with a pull on one of its bodies.
pub struct PulledSystem {
    inner: Box<dyn System>,
    pull: Pull,
    body: usize,
    /// Inverse mass of that body (1/kg).
    inverse_mass: f64,
    masses: Vec<f64>,
    /// Slope of the pull at the last linearisation (N/m).
    tangent: f64,
}

impl PulledSystem {
    /// `inner`, the system of bodies with these `masses` (kg), with `pull` on `body`.
    pub fn new(inner: Box<dyn System>, pull: Pull, body: usize, masses: Vec<f64>) -> Self {
        let inverse_mass = masses.get(body).map_or(0.0, |mass| 1.0 / mass);
        Self { inner, pull, body, inverse_mass, masses, tangent: 0.0 }
    }
}

impl System for PulledSystem {
    fn len(&self) -> usize {
        self.inner.len()
    }

    fn accelerations(&mut self, position: &[f64], velocity: &[f64], acceleration: &mut [f64]) {
        self.inner.accelerations(position, velocity, acceleration);
        acceleration[self.body] += self.pull.change(position[self.body]) * self.inverse_mass;
    }

    fn jerks(&mut self, state: &State, jerk: &mut [f64]) -> bool {
        let slope = self.pull.slope(state.position[self.body]);
        let known = self.inner.jerks(state, jerk);
        jerk[self.body] += slope * state.velocity[self.body] * self.inverse_mass;
        known
    }

    fn scales(&self, position: &[f64], velocity: &[f64]) -> Scales {
        self.inner.scales(position, velocity)
    }

    fn pacing(&self, state: &State) -> Pacing {
        self.inner.pacing(state)
    }

    fn switching(&mut self) -> Option<&mut dyn Switching> {
        self.inner.switching()
    }

    fn linearised(&mut self) -> Option<&mut dyn Linearised> {
        if self.inner.linearised().is_some() { Some(self) } else { None }
    }
}

impl Linearised for PulledSystem {
    fn bodies(&self) -> usize {
        self.masses.len()
    }

    fn linearise(&mut self, state: &State) {
        self.tangent = self.pull.slope(state.position[self.body]);
        if let Some(inner) = self.inner.linearised() {
            inner.linearise(state);
        }
    }

    fn assemble(&mut self, shift: f64, matrix: &mut Tridiagonal) {
        if let Some(inner) = self.inner.linearised() {
            inner.assemble(shift, matrix);
        }
        matrix.diagonal[self.body] -= self.tangent;
    }

    fn masses(&self) -> &[f64] {
        &self.masses
    }

    fn forces_of(&mut self, position: &[f64], out: &mut [f64]) {
        if let Some(inner) = self.inner.linearised() {
            inner.forces_of(position, out);
        }
        out[self.body] += self.tangent * position[self.body];
    }

    fn account_rates(&mut self, position: &[f64], velocity: &[f64], out: &mut [f64]) {
        if let Some(inner) = self.inner.linearised() {
            inner.account_rates(position, velocity, out);
        }
    }
}
