//! The chain as a system to integrate: a plan of plain arrays, made once before the first step.

use super::{Chain, Law, hertz};
use crate::integrate::{Scales, State, System};

/// Contacts and masses laid out for the force loop. Bodies feel only changes against the static state, so constant
/// loads have vanished from it but for what statics leaves over, the striker's weight.
#[derive(Debug, Clone)]
pub struct ChainSystem {
    law: Law,
    /// `A` of each contact, or its tangent where contacts are linearised.
    stiffness: Vec<f64>,
    static_overlap: Vec<f64>,
    static_root: Vec<f64>,
    inverse_mass: Vec<f64>,
    residual_acceleration: Vec<f64>,
    /// Displacements with a resting ghost at each end, so that boundary contacts need no branch.
    displacement: Vec<f64>,
    force_change: Vec<f64>,
    /// Smallest meaningful overlap scale (m).
    overlap_floor: f64,
}

impl ChainSystem {
    /// Lowers `chain` to arrays; `initial_velocity` (m/s) sets the scale of what is to come.
    #[must_use]
    pub fn new(chain: &Chain, initial_velocity: &[f64]) -> Self {
        let contacts = chain.contacts();
        let bodies = chain.bodies();
        let law = if contacts.iter().any(|c| c.law == Law::Linearised) {
            Law::Linearised
        } else {
            Law::Hertz
        };
        let stiffness = |contact: &super::Contact| match law {
            Law::Hertz => contact.stiffness,
            Law::Linearised => contact.static_stiffness(),
        };
        Self {
            law,
            stiffness: contacts.iter().map(stiffness).collect(),
            static_overlap: contacts.iter().map(|c| c.static_overlap).collect(),
            static_root: contacts.iter().map(|c| c.static_overlap.sqrt()).collect(),
            inverse_mass: bodies.iter().map(|b| 1.0 / b.mass).collect(),
            residual_acceleration: chain
                .residual
                .iter()
                .zip(bodies)
                .map(|(force, body)| force / body.mass)
                .collect(),
            displacement: vec![0.0; bodies.len() + 2],
            force_change: vec![0.0; contacts.len()],
            overlap_floor: chain.impact_overlap(initial_velocity),
        }
    }
}

impl System for ChainSystem {
    fn len(&self) -> usize {
        self.inverse_mass.len()
    }

    fn accelerations(&mut self, position: &[f64], _velocity: &[f64], acceleration: &mut [f64]) {
        let n = self.inverse_mass.len();
        self.displacement[1..=n].copy_from_slice(position);
        let above = &self.displacement[..=n];
        let below = &self.displacement[1..];
        let changes = above.iter().zip(below).map(|(above, below)| above - below);
        let contacts = self.force_change.iter_mut().zip(changes).zip(&self.stiffness);
        match self.law {
            Law::Hertz => {
                for (((force, change), stiffness), root) in contacts.zip(&self.static_root) {
                    *force = hertz::force_change(*stiffness, *root, change);
                }
            }
            Law::Linearised => {
                for ((force, change), stiffness) in contacts {
                    *force = stiffness * change;
                }
            }
        }
        let forces = self.force_change.iter().zip(&self.force_change[1..]);
        let bodies = self.inverse_mass.iter().zip(&self.residual_acceleration);
        for (a, ((above, below), (inverse_mass, residual))) in
            acceleration.iter_mut().zip(forces.zip(bodies))
        {
            *a = (above - below) * inverse_mass + residual;
        }
    }

    fn jerks(&mut self, state: &State, jerk: &mut [f64]) -> bool {
        let rest = 0.0;
        let ghosted = |values: &[f64]| -> Vec<f64> {
            std::iter::once(rest).chain(values.iter().copied()).chain([rest]).collect()
        };
        let (position, velocity) = (ghosted(&state.position), ghosted(&state.velocity));
        for (j, rate) in self.force_change.iter_mut().enumerate() {
            let closing = velocity[j] - velocity[j + 1];
            let overlap = self.static_overlap[j] + position[j] - position[j + 1];
            *rate = closing
                * match self.law {
                    Law::Hertz => hertz::tangent_stiffness(self.stiffness[j], overlap),
                    Law::Linearised => self.stiffness[j],
                };
        }
        let rates = self.force_change.iter().zip(&self.force_change[1..]);
        for (jerk, ((above, below), inverse_mass)) in
            jerk.iter_mut().zip(rates.zip(&self.inverse_mass))
        {
            *jerk = (above - below) * inverse_mass;
        }
        true
    }

    fn scales(&self, position: &[f64], velocity: &[f64]) -> Scales {
        let n = self.inverse_mass.len();
        let at = |index: usize| {
            if index == 0 || index > n { 0.0 } else { position[index - 1] }
        };
        let mut overlap = self.overlap_floor;
        for (j, (stiffness, static_overlap)) in
            self.stiffness.iter().zip(&self.static_overlap).enumerate()
        {
            if *stiffness > 0.0 {
                // A gap's width is no overlap: count an open contact as having lost its static one.
                overlap = overlap.max((at(j) - at(j + 1)).max(-static_overlap).abs());
            }
        }
        let speed = velocity.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        Scales { position: overlap, velocity: speed }
    }
}
