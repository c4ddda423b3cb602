//! The chain with losses as a system to integrate.
//!
//! Elastic forces come from the plan of the lossless system; each lossy contact adds its own. Behind the bodies stand accounts, one
//! for each kind of loss, whose rates are the powers, so that energies are integrated along with the motion, to its accuracy; and one
//! for the elastic energy that contacts held at zero force keep to themselves, booked when they are released or pressed again. Where a dashpot makes forces jump,
//! whether the contact is closed is a switch of the system, and not the sign of a vanishing overlap: the striker's contact
//! counts as closed at the start. Where contacts end at zero force, whether one is held there is another switch: a kink.

mod tangents;

use super::loss::{ContactLoss, EndOfContact, KINDS, Tangent, Touch};
use super::loss_plan::LossPlan;
use super::system::difference;
use super::{Chain, ChainSystem, Contact};
use crate::integrate::{Linearised, Motion, Pacing, Scales, Sides, State, Switching, System};

/// Accounts behind the bodies: one a kind of loss, and what contacts held at zero force keep.
pub const ACCOUNTS: usize = KINDS + 1;

/// A force below this share of its parts is zero but for rounding (1).
const GRAIN: f64 = 1e-10;

/// A contact with losses.
#[derive(Debug, Clone)]
struct Lossy {
    /// Its index, that of the body below it.
    index: usize,
    contact: Contact,
    loss: ContactLoss,
    /// Inverse masses of the bodies above and below, none at a wall (1/kg).
    inverse_mass: [f64; 2],
    closed: bool,
    /// Whether it is held at zero force.
    held: bool,
}

/// What may change within a run, of a lossy contact by its place in the list: it closes or opens; its force turns into a pull, where
/// it is held, or presses again.
#[derive(Debug, Clone, Copy)]
enum Change {
    Closes(usize),
    Pulls(usize),
}

/// A chain with losses, ready to be integrated.
#[derive(Debug, Clone)]
pub struct DissipativeSystem {
    elastic: ChainSystem,
    bodies: usize,
    contacts: Vec<Contact>,
    lossy: Vec<Lossy>,
    /// What all of them take where they stand now.
    plan: LossPlan,
    /// Those held at zero force, by their places in the list.
    held: Vec<usize>,
    /// Contacts whose forces jump, their place their index; and those that never pull, their places behind those of all contacts.
    switches: Vec<Change>,
    /// Speed that stands for one joule in the accounts, so that the error control weighs them as it does speeds (m/s/J).
    unit: f64,
    masses: Vec<f64>,
    /// Tangents at the last linearisation, one a contact.
    tangents: Vec<Tangent>,
}

impl DissipativeSystem {
    /// Lowers `chain`; `initial_velocity` (m/s) sets the scale of what is to come.
    pub fn new(chain: &Chain, initial_velocity: &[f64]) -> Self {
        let bodies = chain.bodies();
        let inverse = |index: Option<usize>| {
            index.and_then(|i| bodies.get(i)).map_or(0.0, |body| 1.0 / body.mass)
        };
        let lossy = chain.contacts().iter().enumerate().filter_map(|(index, contact)| {
            let inverse_mass = [inverse(index.checked_sub(1)), inverse(Some(index))];
            let (contact, closed, held) = (*contact, true, false);
            let lossy = |loss| Lossy { index, contact, loss, inverse_mass, closed, held };
            contact.loss.map(lossy)
        });
        let lossy: Vec<Lossy> = lossy.collect();
        // Whether a contact touches is settled before whether it pulls.
        let closes = (0..lossy.len()).filter(|i| lossy[*i].loss.jumps()).map(Change::Closes);
        let pulls = (0..lossy.len()).filter(|i| lossy[*i].loss.end == EndOfContact::ZeroForce);
        let switches = closes.chain(pulls.map(Change::Pulls)).collect();
        let elastic = ChainSystem::new(chain, initial_velocity);
        let plan = elastic.plan();
        let mut plan = LossPlan::new(plan.static_overlap.clone(), plan.inverse_mass.clone());
        for lossy in &lossy {
            lossy.enter(&mut plan);
        }
        Self {
            elastic,
            plan,
            held: Vec::with_capacity(lossy.len()),
            bodies: bodies.len(),
            contacts: chain.contacts().to_vec(),
            lossy,
            switches,
            unit: chain.account_unit(initial_velocity),
            masses: bodies.iter().map(|body| body.mass).collect(),
            tangents: vec![Tangent::default(); chain.contacts().len()],
        }
    }
}

impl System for DissipativeSystem {
    fn len(&self) -> usize {
        self.bodies + ACCOUNTS
    }

    fn accelerations(&mut self, position: &[f64], velocity: &[f64], acceleration: &mut [f64]) {
        let n = self.bodies;
        let (of_bodies, accounts) = acceleration.split_at_mut(n);
        self.elastic.accelerations(&position[..n], &velocity[..n], of_bodies);
        let Self { plan, held, lossy, elastic, .. } = self;
        let instead = held.iter().map(|i| {
            let Lossy { index, contact, .. } = &lossy[*i];
            (*index, -(contact.static_force + elastic.force_changes()[*index]))
        });
        let power = plan.add((&position[..n], &velocity[..n]), instead, of_bodies);
        accounts.fill(0.0);
        for (account, power) in accounts.iter_mut().zip(power) {
            *account = power * self.unit;
        }
    }

    fn scales(&self, position: &[f64], velocity: &[f64]) -> Scales {
        self.elastic.scales(&position[..self.bodies], &velocity[..self.bodies])
    }

    fn has_kink_between(&self, from: &State, to: &State) -> bool {
        let closing = |state: &State, j| difference(&state.velocity[..self.bodies], j) > 0.0;
        let turns = |lossy: &Lossy| {
            lossy.loss.power_force > 0.0 && closing(from, lossy.index) != closing(to, lossy.index)
        };
        self.elastic.has_kink_between(from, to) || self.lossy.iter().any(turns)
    }

    fn pacing(&self, state: &State) -> Pacing {
        self.elastic.pacing(state)
    }

    fn switching(&mut self) -> Option<&mut dyn Switching> {
        if self.switches.is_empty() { None } else { Some(self) }
    }

    fn linearised(&mut self) -> Option<&mut dyn Linearised> {
        Some(self)
    }
}

impl DissipativeSystem {
    fn of(&self, switch: usize) -> (Change, &Lossy) {
        let change = self.switches[switch];
        let (Change::Closes(i) | Change::Pulls(i)) = change;
        (change, &self.lossy[i])
    }
}

impl Lossy {
    /// Tells `plan` what it takes now.
    fn enter(&self, plan: &mut LossPlan) {
        let at_work = self.loss.at_work(self.closed, self.held);
        plan.set(self.index, self.contact.stiffness, &at_work);
    }

    fn touch(&self, change: f64, closing: f64) -> Touch {
        self.contact.touch(change, closing, self.closed)
    }

    /// What the contact's force would be if nothing held it, and the sum of its parts' magnitudes (N).
    fn unheld(&self, motion: Motion) -> (f64, f64) {
        let touch = self.touch(motion.difference, motion.rate);
        self.loss.unheld(self.contact.stiffness, touch)
    }
}

impl Switching for DissipativeSystem {
    fn switches(&self) -> usize {
        self.switches.len()
    }

    fn is_on(&self, switch: usize) -> bool {
        match self.of(switch) {
            (Change::Closes(_), lossy) => lossy.closed,
            (Change::Pulls(_), lossy) => !lossy.held,
        }
    }

    fn flip(&mut self, switch: usize, state: &mut State) {
        let (Change::Closes(i) | Change::Pulls(i)) = self.switches[switch];
        let lossy = &mut self.lossy[i];
        let before = lossy.held;
        match self.switches[switch] {
            Change::Closes(_) => {
                lossy.closed = !lossy.closed;
                // A contact that closes presses.
                lossy.held &= !lossy.closed;
            }
            Change::Pulls(_) => lossy.held = !lossy.held,
        }
        lossy.enter(&mut self.plan);
        if before != lossy.held {
            self.held.retain(|held| *held != i);
            self.held.extend(lossy.held.then_some(i));
        }
        let change = difference(&state.position[..self.bodies], lossy.index);
        let kept = self.unit * lossy.contact.energy(change);
        if let (true, Some(account)) = (before != lossy.held, state.velocity.last_mut()) {
            *account += if lossy.held { kept } else { -kept };
        }
    }

    fn sides(&self, switch: usize) -> Sides {
        let (change, lossy) = self.of(switch);
        Sides {
            above: lossy.index.checked_sub(1),
            below: Some(lossy.index).filter(|i| *i < self.bodies),
            place: match change {
                Change::Closes(_) => lossy.index,
                Change::Pulls(_) => self.contacts.len() + lossy.index,
            },
        }
    }

    fn margin(&self, switch: usize, motion: Motion) -> f64 {
        match self.of(switch) {
            (Change::Closes(_), lossy) => lossy.contact.static_overlap + motion.difference,
            (Change::Pulls(_), lossy) => lossy.unheld(motion).0,
        }
    }

    fn is_wrong(&self, switch: usize, motion: Motion) -> bool {
        match self.of(switch) {
            (Change::Closes(_), lossy) => {
                let overlap = lossy.contact.static_overlap + motion.difference;
                if lossy.closed {
                    overlap < 0.0 && motion.rate < 0.0
                } else {
                    overlap >= 0.0 && motion.rate > 0.0
                }
            }
            (Change::Pulls(_), lossy) => {
                let (force, parts) = lossy.unheld(motion);
                let seen = GRAIN * parts;
                let gap = lossy.contact.static_overlap + motion.difference <= 0.0;
                if lossy.held { force > seen || (gap && force == 0.0) } else { force < -seen }
            }
        }
    }

    fn error(&self, switch: usize, closing: f64, beyond: Motion) -> f64 {
        let (change, lossy) = self.of(switch);
        let force = match change {
            Change::Closes(_) => {
                let touch = Touch { overlap: 0.0, closing, elastic: 0.0, closed: true };
                lossy.loss.force(lossy.contact.stiffness, touch).abs()
            }
            Change::Pulls(_) => self.margin(switch, beyond).abs(),
        };
        force * lossy.inverse_mass[0].max(lossy.inverse_mass[1])
    }
}
