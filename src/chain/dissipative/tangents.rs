//! What an implicit method needs to know of a chain with losses.

use super::DissipativeSystem;
use crate::chain::loss::Tangent;
use crate::chain::system::difference;
use crate::integrate::{Linearised, State, Tridiagonal};

impl Linearised for DissipativeSystem {
    fn bodies(&self) -> usize {
        self.bodies
    }

    fn linearise(&mut self, state: &State) {
        let [position, velocity] = [&state.position, &state.velocity].map(|of| &of[..self.bodies]);
        for (j, (tangent, contact)) in self.tangents.iter_mut().zip(&self.contacts).enumerate() {
            let stiffness = contact.tangent_stiffness(difference(position, j));
            *tangent = Tangent { stiffness, ..Tangent::default() };
        }
        for lossy in &self.lossy {
            let [change, closing] = [position, velocity].map(|of| difference(of, lossy.index));
            let tangent = &mut self.tangents[lossy.index];
            let touch = lossy.touch(change, closing);
            let stiffnesses = (lossy.contact.stiffness, tangent.stiffness);
            *tangent = lossy.loss.tangent_as(stiffnesses, touch, lossy.held);
        }
    }

    fn assemble(&mut self, shift: f64, matrix: &mut Tridiagonal) {
        let coupling = |j: usize| shift * self.tangents[j].damping + self.tangents[j].stiffness;
        for (i, mass) in self.masses.iter().enumerate() {
            matrix.diagonal[i] = shift * shift * mass + coupling(i) + coupling(i + 1);
        }
        for i in 1..self.bodies {
            matrix.off_diagonal[i - 1] = -coupling(i);
        }
    }

    fn masses(&self) -> &[f64] {
        &self.masses
    }

    fn forces_of(&mut self, position: &[f64], out: &mut [f64]) {
        let position = &position[..self.bodies];
        let force = |j: usize| self.tangents[j].stiffness * difference(position, j);
        let mut above = force(0);
        for (i, out) in out.iter_mut().enumerate().take(self.bodies) {
            let below = force(i + 1);
            *out = above - below;
            above = below;
        }
    }

    fn account_rates(&mut self, position: &[f64], velocity: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let [position, velocity] = [position, velocity].map(|of| &of[..self.bodies]);
        for lossy in &self.lossy {
            let [change, closing] = [position, velocity].map(|of| difference(of, lossy.index));
            let tangent = &self.tangents[lossy.index];
            let slopes = tangent.power_by_overlap.iter().zip(&tangent.power_by_closing);
            for (out, (by_overlap, by_closing)) in out.iter_mut().zip(slopes) {
                *out += self.unit * (by_overlap * change + by_closing * closing);
            }
        }
    }
}
