//! What the losses have taken, read from the accounts of a chain in motion.

use serde::Serialize;

use super::stability::overlap_with_neighbour;
use super::{ACCOUNTS, Chain, Contact, Energy, Indentations, LOSS_MODELS, State, Support};

/// Energy taken by the losses of a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Dissipated {
    /// By each loss that is on.
    pub losses: Vec<LossEntry>,
    /// Elastic energy that nobody gets back: what contacts held at zero force had when they were
    /// released (J).
    pub left_in_contacts: f64,
    /// What a drive has put in; none without one (J).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub work_of_drive: Option<f64>,
}

/// Places of the accounts behind the bodies of a chain whose motion depends on more than positions:
/// numbers that are integrated along with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Accounts {
    /// The first of the [`ACCOUNTS`] of losses, if there are losses.
    pub losses: Option<usize>,
    /// The time, if a wall moves by it.
    pub clock: Option<usize>,
    /// The first of those of contacts that may yield, one a contact: the largest overlaps beyond
    /// first yield.
    pub plastic: Option<usize>,
    /// Those of the walls at the top and at the bottom that move.
    pub ends: [Option<EndAccounts>; 2],
    /// Coordinates of bodies and accounts together.
    pub len: usize,
}

/// Places of the accounts of a wall that moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EndAccounts {
    /// Work that the wall does on the chain.
    pub work: usize,
    /// Displacement of a wall that gives way.
    pub face: Option<usize>,
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
    pub fn lost(&self) -> f64 {
        self.losses.iter().map(|entry| entry.energy).sum::<f64>() + self.left_in_contacts
    }

    /// All of it, less what a drive has put in: what the chain has less than at first (J).
    pub fn total(&self) -> f64 {
        self.lost() - self.work_of_drive.unwrap_or(0.0)
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
        let mut velocity = initial_velocity.to_vec();
        let accounts = self.accounts();
        velocity.resize(accounts.len, 0.0);
        for (contact, value) in
            self.contacts.iter().zip(accounts.plastic.map_or(&mut [][..], |at| &mut velocity[at..]))
        {
            *value = contact.static_largest();
        }
        State { time: 0.0, position: vec![0.0; velocity.len()], velocity }
    }

    /// Places of its accounts.
    pub fn accounts(&self) -> Accounts {
        let mut accounts = Accounts { len: self.bodies.len(), ..Accounts::default() };
        let mut place = |count: usize| {
            accounts.len += count;
            accounts.len - count
        };
        let losses = self.is_dissipative().then(|| place(ACCOUNTS));
        let clock = self.has_moving_walls().then(|| place(1));
        let ends = self.supports.each_ref().map(|support| {
            support
                .moves()
                .then(|| EndAccounts { work: place(1), face: support.backing().map(|_| place(1)) })
        });
        let plastic = self.is_plastic().then(|| place(self.contacts.len()));
        Accounts { losses, clock, plastic, ends, ..accounts }
    }

    /// Largest overlap of contact `j` beyond first yield up to `state`; 0 where it has not yielded
    /// (m).
    pub fn largest_overlap_of(&self, state: &State, j: usize) -> f64 {
        let (Some(first), Some(contact)) = (self.accounts().plastic, self.contacts.get(j)) else {
            return 0.0;
        };
        let Some(law) = &contact.plastic else { return 0.0 };
        let kept = state.velocity.get(first + j).copied().unwrap_or(0.0);
        let overlap = contact.static_overlap + self.overlap_change_in(state, j);
        if overlap > law.first_overlap() { kept.max(overlap) } else { kept }
    }

    /// Indentations that its contacts have in `state`.
    pub fn indentations(&self, state: &State) -> Indentations {
        let left = |(j, contact): (usize, &Contact)| {
            contact.plastic.map(|law| (law, self.largest_overlap_of(state, j)))
        };
        Indentations(self.contacts.iter().enumerate().map(left).collect())
    }

    /// Indentations that its contacts have at rest.
    pub fn indentations_at_rest(&self) -> Indentations {
        let at_rest =
            |contact: &Contact| contact.plastic.map(|law| (law, contact.static_largest()));
        Indentations(self.contacts.iter().map(at_rest).collect())
    }

    /// The chain at rest, its contacts indented; those that have another law than `indentations`
    /// say, of other bodies, are new.
    pub fn with_indentations(&self, indentations: &Indentations) -> Self {
        let is_same = indentations.0.len() == self.contacts.len();
        let after = |(j, contact): (usize, &Contact)| {
            let left = indentations.0.get(j).copied().flatten().filter(|_| is_same);
            let left = left.filter(|(law, _)| contact.plastic.as_ref() == Some(law));
            contact.after(left.map_or(0.0, |(_, largest)| largest))
        };
        let contacts = self.contacts.iter().enumerate().map(after).collect();
        Self { contacts, ..self.clone() }
    }

    /// Elastic energy of contact `j` in `state` (J).
    pub(super) fn contact_energy(&self, state: &State, j: usize) -> f64 {
        let Some(contact) = self.contacts.get(j) else { return 0.0 };
        let change = self.overlap_change_in(state, j);
        match &contact.plastic {
            Some(law) => {
                law.energy(contact.static_overlap + change, self.largest_overlap_of(state, j))
            }
            None => contact.energy(change),
        }
    }

    /// Speed that stands for a metre of a wall that gives way: the inverse of the overlap by a
    /// body that hits it at 1 m/s (1/s).
    pub(crate) fn face_rate(&self, end: usize) -> f64 {
        let (contact, body) = match end {
            0 => (self.contacts.first(), self.bodies.first()),
            _ => (self.contacts.last(), self.bodies.last()),
        };
        let overlap = contact.zip(body).map(|(c, b)| overlap_with_neighbour(c, b.mass, 1.0));
        overlap.map_or(1.0, f64::recip)
    }

    /// Displacements of the walls at the top and at the bottom in `state`, downward positive (m).
    pub fn walls(&self, state: &State) -> [f64; 2] {
        let ends = self.accounts().ends;
        [0, 1].map(|end| match &self.supports[end] {
            Support::Rigid => 0.0,
            Support::Driven(drive) => into_chain(end) * drive.at(state.time)[0],
            Support::Yielding(_) => {
                let face = ends[end].and_then(|end| state.velocity.get(end.face?));
                face.map_or(0.0, |value| value / self.face_rate(end))
            }
        })
    }

    /// Speed that stands for one joule in the accounts: the largest initial speed for the initial
    /// kinetic energy (m/s/J).
    pub(crate) fn account_unit(&self, initial_velocity: &[f64]) -> f64 {
        let moving = self.bodies.iter().zip(initial_velocity);
        let kinetic: f64 = moving.map(|(body, v)| 0.5 * body.mass * v * v).sum();
        let fastest = initial_velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let driven = self.drives().fold((kinetic, fastest), |(energy, speed), (contact, drive)| {
            let force = contact.static_force.max(contact.force_change(drive.amplitude));
            (energy + force * drive.amplitude, speed.max(drive.speed()))
        });
        let (energy, fastest) = driven;
        if energy > 0.0 { fastest / energy } else { 1.0 }
    }

    /// What the losses have taken up to `state`.
    pub fn dissipated(&self, state: &State, initial_velocity: &[f64]) -> Dissipated {
        let unit = self.account_unit(initial_velocity);
        let places = self.accounts();
        let accounts = places.losses.and_then(|first| state.velocity.get(first..first + ACCOUNTS));
        let accounts = accounts.unwrap_or_default();
        let on = |kind: usize| {
            let coefficient = |loss: super::ContactLoss| loss.coefficients()[kind];
            self.contacts.iter().any(|contact| contact.loss.map_or(0.0, coefficient) > 0.0)
        };
        let names = LOSS_MODELS.iter().map(|model| model.name);
        let entries = names.zip(accounts).enumerate();
        let losses = entries.filter(|(kind, _)| on(*kind));
        let losses = losses.map(|(_, (loss, value))| LossEntry { loss, energy: value / unit });
        let kept = accounts.get(ACCOUNTS - 1).map_or(0.0, |value| value / unit);
        let mut losses: Vec<LossEntry> = losses.collect();
        if places.plastic.is_some() {
            let lost = |(j, contact): (usize, &Contact)| {
                contact.plastic.map_or(0.0, |law| {
                    law.lost(self.largest_overlap_of(state, j)) - law.lost(contact.static_largest())
                })
            };
            let energy = self.contacts.iter().enumerate().map(lost).sum();
            losses.push(LossEntry { loss: "plasticity", energy });
        }
        let mut work_of_drive = None;
        let ends = self.supports.iter().zip(places.ends).zip(["top_wall", "bottom_wall"]);
        for ((support, place), name) in ends {
            let Some(value) = place.and_then(|place| state.velocity.get(place.work)) else {
                continue;
            };
            if support.drive().is_some() {
                *work_of_drive.get_or_insert(0.0) += value / unit;
            } else {
                losses.push(LossEntry { loss: name, energy: -value / unit });
            }
        }
        Dissipated { losses, left_in_contacts: kept, work_of_drive }
    }

    /// Energy of `state` without that in contacts held at zero force, which nobody gets back;
    /// `held` tells which are.
    pub fn free_energy(&self, state: &State, held: &dyn Fn(usize) -> bool) -> Energy {
        let mut energy = self.energy(state);
        for j in (0..self.contacts.len()).filter(|j| held(*j)) {
            energy.elastic -= self.contact_energy(state, j);
        }
        energy
    }
}

/// Sign of a displacement into the chain at an end: downward at the top (1).
pub(crate) fn into_chain(end: usize) -> f64 {
    if end == 0 { 1.0 } else { -1.0 }
}
