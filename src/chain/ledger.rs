//! What the losses have taken, read from the accounts of a chain in motion.

use serde::Serialize;

use super::{ACCOUNTS, Chain, Energy, LOSS_MODELS, State};

/// Energy taken by the losses of a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Dissipated {
    /// By each loss that is on.
    pub losses: Vec<LossEntry>,
    /// Elastic energy that nobody gets back: what contacts held at zero force had when they were
    /// released (J).
    pub left_in_contacts: f64,
}

/// One loss's account.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LossEntry {
    /// Name of the effect.
    pub loss: &'static str,
    /// What it has taken (J).
    pub energy: f64,
}

impl Dissipated {
    /// All of it (J).
    pub fn total(&self) -> f64 {
        self.losses.iter().map(|entry| entry.energy).sum::<f64>() + self.left_in_contacts
    }
}

impl Chain {
    /// Whether a contact has a loss: forces then depend on velocities.
    pub fn is_dissipative(&self) -> bool {
        self.contacts.iter().any(|contact| contact.loss.is_some())
    }

    /// The state at rest in static equilibrium but for `initial_velocity` (m/s), with room for the
    /// accounts.
    pub fn initial_state(&self, initial_velocity: &[f64]) -> State {
        let accounts = if self.is_dissipative() { ACCOUNTS } else { 0 };
        let mut velocity = initial_velocity.to_vec();
        velocity.resize(self.bodies.len() + accounts, 0.0);
        State { time: 0.0, position: vec![0.0; velocity.len()], velocity }
    }

    /// Speed that stands for one joule in the accounts: the largest initial speed for the initial
    /// kinetic energy (m/s/J).
    pub(crate) fn account_unit(&self, initial_velocity: &[f64]) -> f64 {
        let moving = self.bodies.iter().zip(initial_velocity);
        let kinetic: f64 = moving.map(|(body, v)| 0.5 * body.mass * v * v).sum();
        let fastest = initial_velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        if kinetic > 0.0 { fastest / kinetic } else { 1.0 }
    }

    /// What the losses have taken up to `state`.
    pub fn dissipated(&self, state: &State, initial_velocity: &[f64]) -> Dissipated {
        let unit = self.account_unit(initial_velocity);
        let accounts = state.velocity.get(self.bodies.len()..).unwrap_or_default();
        let on = |kind: usize| {
            let coefficient = |loss: super::ContactLoss| loss.coefficients()[kind];
            self.contacts.iter().any(|contact| contact.loss.map_or(0.0, coefficient) > 0.0)
        };
        let names = LOSS_MODELS.iter().map(|model| model.name);
        let entries = names.zip(accounts).enumerate();
        let losses = entries.filter(|(kind, _)| on(*kind));
        let losses = losses.map(|(_, (loss, value))| LossEntry { loss, energy: value / unit });
        let kept = accounts.get(ACCOUNTS - 1).map_or(0.0, |value| value / unit);
        Dissipated { losses: losses.collect(), left_in_contacts: kept }
    }

    /// Energy of `state` without that in contacts held at zero force, which nobody gets back;
    /// `held` tells which are.
    pub fn free_energy(&self, state: &State, held: &dyn Fn(usize) -> bool) -> Energy {
        let mut energy = self.energy(state);
        for (j, contact) in self.contacts.iter().enumerate().filter(|(j, _)| held(*j)) {
            energy.elastic -= contact.energy(self.overlap_change(&state.position, j));
        }
        energy
    }
}
