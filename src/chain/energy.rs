//! Where the chain's energy is.
//!
//! Kinetic `sum m v^2/2`, elastic `sum 2/5 A overlap^2.5`, and the work of the constant loads, `- sum f u`. A load that
//! statics balances is the difference of two static contact forces, so its work needs no list of loads:
//! `sum f u = sum N (change of overlap) + striker's weight * u`. The sum of all three is conserved without losses.

use serde::Serialize;

use super::Chain;
use crate::integrate::State;

/// The chain's energy by kind.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Energy {
    /// Of motion (J).
    pub kinetic: f64,
    /// In the contacts, static overlaps included (J).
    pub elastic: f64,
    /// Of gravity and other constant loads, zero at static equilibrium (J).
    pub potential: f64,
}

impl Energy {
    /// What is conserved where nothing is lost (J).
    #[must_use]
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.potential
    }
}

impl Chain {
    /// Overlap change of contact `j` at the displacements `position` (m).
    #[must_use]
    pub fn overlap_change(&self, position: &[f64], j: usize) -> f64 {
        // Behind the bodies there may be accounts.
        let bodies = position.get(..self.bodies.len()).unwrap_or(position);
        let at = |index: Option<usize>| index.and_then(|i| bodies.get(i)).copied().unwrap_or(0.0);
        at(j.checked_sub(1)) - at(Some(j))
    }

    /// Force in contact `j` at these displacements (m) and velocities (m/s), static part and losses included; `closed`
    /// tells whether it counts as closed (N).
    #[must_use]
    pub fn contact_force(&self, position: &[f64], velocity: &[f64], j: usize, closed: bool) -> f64 {
        self.contacts.get(j).map_or(0.0, |contact| {
            let change = self.overlap_change(position, j);
            let closing = self.overlap_change(velocity, j);
            contact.static_force + contact.lossy_force_change(change, closing, closed)
        })
    }

    /// Energy of `state`.
    #[must_use]
    pub fn energy(&self, state: &State) -> Energy {
        let kinetic = self.bodies.iter().zip(&state.velocity);
        let mut energy = Energy {
            kinetic: kinetic.map(|(body, v)| 0.5 * body.mass * v * v).sum(),
            ..Energy::default()
        };
        for (j, contact) in self.contacts.iter().enumerate() {
            let change = self.overlap_change(&state.position, j);
            energy.elastic += contact.energy(change);
            // An end force's own work and the share of it that the static contacts seem to do cancel.
            if contact.stiffness > 0.0 {
                energy.potential -= contact.static_force * change;
            }
        }
        for (force, u) in self.residual.iter().zip(&state.position) {
            energy.potential -= force * u;
        }
        energy
    }

    /// Energy of `state` above that of static equilibrium, without the digits that the two share (J).
    #[must_use]
    pub fn energy_above_static(&self, state: &State) -> f64 {
        let kinetic = self.bodies.iter().zip(&state.velocity).map(|(b, v)| 0.5 * b.mass * v * v);
        let elastic = self.contacts.iter().enumerate().filter(|(_, c)| c.stiffness > 0.0);
        let elastic =
            elastic.map(|(j, c)| c.energy_change(self.overlap_change(&state.position, j)));
        let loads = self.residual.iter().zip(&state.position).map(|(force, u)| force * u);
        kinetic.sum::<f64>() + elastic.sum::<f64>() - loads.sum::<f64>()
    }

    /// Total momentum of `state`, downward positive (kg m/s).
    #[must_use]
    pub fn momentum(&self, state: &State) -> f64 {
        self.bodies.iter().zip(&state.velocity).map(|(body, v)| body.mass * v).sum()
    }
}
