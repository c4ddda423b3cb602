//! The chain as a system to integrate: a plan of plain arrays, made once before the first step.

use super::kernel::{Plan, accelerate};
use super::simd::InstructionSet;
use super::{Chain, Contact, Law, hertz};
use crate::integrate::{Pacing, Scales, State, System};

/// A chain ready to be integrated. Bodies feel only changes against the static state, so constant loads have vanished
/// from the plan but for what statics leaves over, the striker's weight.
#[derive(Debug, Clone)]
pub struct ChainSystem {
    plan: Plan,
    set: InstructionSet,
    /// Displacements and velocities with a resting ghost at each end, so that boundary contacts need no branch.
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    force_change: Vec<f64>,
    /// Smallest meaningful overlap scale (m).
    overlap_floor: f64,
    pacing: Pacing,
}

impl ChainSystem {
    /// Lowers `chain` to arrays; `initial_velocity` (m/s) sets the scale of what is to come.
    pub fn new(chain: &Chain, initial_velocity: &[f64]) -> Self {
        let contacts = chain.contacts();
        let bodies = chain.bodies();
        let law = if chain.is_linear() { Law::Linearised } else { Law::Hertz };
        let stiffness = |contact: &Contact| match law {
            Law::Hertz => contact.stiffness,
            Law::Linearised => contact.static_stiffness(),
        };
        let residual = chain.residual.iter().zip(bodies);
        let plan = Plan {
            law,
            stiffness: contacts.iter().map(stiffness).collect(),
            static_overlap: contacts.iter().map(|c| c.static_overlap).collect(),
            static_root: contacts.iter().map(|c| c.static_overlap.sqrt()).collect(),
            inverse_mass: bodies.iter().map(|b| 1.0 / b.mass).collect(),
            residual_acceleration: residual.map(|(force, body)| force / body.mass).collect(),
        };
        Self {
            plan,
            set: InstructionSet::best(),
            displacement: vec![0.0; bodies.len() + 2],
            velocity: vec![0.0; bodies.len() + 2],
            force_change: vec![0.0; contacts.len()],
            overlap_floor: chain.impact_overlap(initial_velocity),
            pacing: chain.pacing(initial_velocity),
        }
    }

    /// Contacts and masses.
    pub(super) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Change of each contact's force against the static one at the accelerations asked for last (N).
    pub(super) fn force_changes(&self) -> &[f64] {
        &self.force_change
    }
}

impl System for ChainSystem {
    fn len(&self) -> usize {
        self.plan.inverse_mass.len()
    }

    fn accelerations(&mut self, position: &[f64], _velocity: &[f64], acceleration: &mut [f64]) {
        self.displacement[1..=position.len()].copy_from_slice(position);
        let Self { plan, displacement, force_change, .. } = self;
        accelerate(self.set, plan, displacement, force_change, acceleration);
    }

    fn jerks(&mut self, state: &State, jerk: &mut [f64]) -> bool {
        let n = self.len();
        self.displacement[1..=n].copy_from_slice(&state.position);
        self.velocity[1..=n].copy_from_slice(&state.velocity);
        let (x, v, plan) = (&self.displacement, &self.velocity, &self.plan);
        for (j, rate) in self.force_change.iter_mut().enumerate() {
            let overlap = plan.static_overlap[j] + x[j] - x[j + 1];
            let stiffness = match plan.law {
                Law::Hertz => hertz::tangent_stiffness(plan.stiffness[j], overlap),
                Law::Linearised => plan.stiffness[j],
            };
            *rate = stiffness * (v[j] - v[j + 1]);
        }
        let rates = self.force_change.iter().zip(&self.force_change[1..]);
        for (jerk, ((above, below), inverse_mass)) in
            jerk.iter_mut().zip(rates.zip(&plan.inverse_mass))
        {
            *jerk = (above - below) * inverse_mass;
        }
        true
    }

    fn scales(&self, position: &[f64], velocity: &[f64]) -> Scales {
        let above = std::iter::once(&0.0).chain(position);
        let below = position.iter().chain([&0.0]);
        let contacts = self.plan.stiffness.iter().zip(&self.plan.static_overlap);
        let mut overlap = self.overlap_floor;
        for ((above, below), (stiffness, static_overlap)) in above.zip(below).zip(contacts) {
            // A gap's width is no overlap: count an open contact as having lost its static one.
            let change = (above - below).max(-static_overlap).abs();
            if *stiffness > 0.0 && change > overlap {
                overlap = change;
            }
        }
        let speed = velocity.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        Scales { position: overlap, velocity: speed }
    }

    fn has_kink_between(&self, from: &State, to: &State) -> bool {
        let Plan { law, static_overlap, .. } = &self.plan;
        let mut contacts = static_overlap.iter().enumerate();
        let is_open = |state: &State, j: usize, overlap: f64| {
            overlap + difference(&state.position[..self.len()], j) < 0.0
        };
        *law == Law::Hertz && contacts.any(|(j, o)| is_open(from, j, *o) != is_open(to, j, *o))
    }

    fn pacing(&self, _state: &State) -> Pacing {
        self.pacing
    }
}

/// Value of the body above contact `j` less that of the one below; walls rest (unit).
pub(super) fn difference(of_bodies: &[f64], j: usize) -> f64 {
    let at = |body: Option<usize>| body.and_then(|body| of_bodies.get(body)).copied();
    at(j.checked_sub(1)).unwrap_or(0.0) - at(Some(j)).unwrap_or(0.0)
}
