//! The chain with losses as a system to integrate.
//!
//! Elastic forces come from the plan of the lossless system; each lossy contact adds its own. Behind the bodies stand accounts, one
//! for each kind of loss, whose rates are the powers, so that energies are integrated along with the motion, to its accuracy; and one
//! for the elastic energy that contacts held at zero force keep to themselves, booked when they are released or pressed again. Where a dashpot makes forces jump,
//! whether the contact is closed is a switch of the system, and not the sign of a vanishing overlap: the striker's contact
//! counts as closed at the start. Where contacts end at zero force, whether one is held there is another switch: a kink.

use super::loss::{ContactLoss, EndOfContact, KINDS, Taken, Tangent, Touch};
use super::{Chain, ChainSystem, Contact};
use crate::integrate::{Linearised, Motion, Scales, Sides, State, Switching, System, Tridiagonal};

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
    #[must_use]
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
        Self {
            elastic: ChainSystem::new(chain, initial_velocity),
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

/// Overlap change of contact `j` and its rate.
fn motion(position: &[f64], velocity: &[f64], bodies: usize, j: usize) -> (f64, f64) {
    let at = |values: &[f64], index: Option<usize>| {
        index.filter(|i| *i < bodies).and_then(|i| values.get(i)).copied().unwrap_or(0.0)
    };
    let difference = |values: &[f64]| at(values, j.checked_sub(1)) - at(values, Some(j));
    (difference(position), difference(velocity))
}

impl System for DissipativeSystem {
    fn len(&self) -> usize {
        self.bodies + ACCOUNTS
    }

    fn accelerations(&mut self, position: &[f64], velocity: &[f64], acceleration: &mut [f64]) {
        let n = self.bodies;
        let (of_bodies, accounts) = acceleration.split_at_mut(n);
        self.elastic.accelerations(&position[..n], &velocity[..n], of_bodies);
        accounts.fill(0.0);
        for lossy in &self.lossy {
            let (change, closing) = motion(position, velocity, n, lossy.index);
            let Taken { force, power } = lossy.loss.taken_as(
                lossy.contact.stiffness,
                lossy.touch(change, closing),
                lossy.held,
            );
            let [above, below] = lossy.inverse_mass;
            if let Some(a) = lossy.index.checked_sub(1).and_then(|i| of_bodies.get_mut(i)) {
                *a -= force * above;
            }
            if let Some(a) = of_bodies.get_mut(lossy.index) {
                *a += force * below;
            }
            for (account, power) in accounts.iter_mut().zip(power) {
                *account += power * self.unit;
            }
        }
    }

    fn scales(&self, position: &[f64], velocity: &[f64]) -> Scales {
        self.elastic.scales(&position[..self.bodies], &velocity[..self.bodies])
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
        let (change, _) = motion(&state.position, &state.velocity, self.bodies, lossy.index);
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
        let margin = self.margin(switch, motion);
        match self.of(switch) {
            (Change::Closes(_), Lossy { closed: true, .. }) => margin < 0.0 && motion.rate < 0.0,
            (Change::Closes(_), _) => margin >= 0.0 && motion.rate > 0.0,
            (Change::Pulls(_), lossy) => {
                let seen = GRAIN * lossy.unheld(motion).1;
                let gap = lossy.contact.static_overlap + motion.difference <= 0.0;
                if lossy.held { margin > seen || (gap && margin == 0.0) } else { margin < -seen }
            }
        }
    }

    fn error(&self, switch: usize, closing: f64, beyond: Motion) -> f64 {
        let (change, lossy) = self.of(switch);
        let force = match change {
            Change::Closes(_) => {
                let touch = Touch { overlap: 0.0, closing, elastic: 0.0, closed: true };
                lossy.loss.taken(lossy.contact.stiffness, touch).force.abs()
            }
            Change::Pulls(_) => self.margin(switch, beyond).abs(),
        };
        force * lossy.inverse_mass[0].max(lossy.inverse_mass[1])
    }
}

impl Linearised for DissipativeSystem {
    fn bodies(&self) -> usize {
        self.bodies
    }

    fn linearise(&mut self, state: &State) {
        let n = self.bodies;
        for (j, (tangent, contact)) in self.tangents.iter_mut().zip(&self.contacts).enumerate() {
            let (change, _) = motion(&state.position, &state.velocity, n, j);
            let stiffness = contact.tangent_stiffness(change);
            *tangent = Tangent { stiffness, ..Tangent::default() };
        }
        for lossy in &self.lossy {
            let (change, closing) = motion(&state.position, &state.velocity, n, lossy.index);
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
        let zeros = &self.masses;
        let force =
            |j: usize| self.tangents[j].stiffness * motion(position, zeros, self.bodies, j).0;
        let mut above = force(0);
        for (i, out) in out.iter_mut().enumerate().take(self.bodies) {
            let below = force(i + 1);
            *out = above - below;
            above = below;
        }
    }

    fn account_rates(&mut self, position: &[f64], velocity: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for lossy in &self.lossy {
            let (change, closing) = motion(position, velocity, self.bodies, lossy.index);
            let tangent = &self.tangents[lossy.index];
            let slopes = tangent.power_by_overlap.iter().zip(&tangent.power_by_closing);
            for (out, (by_overlap, by_closing)) in out.iter_mut().zip(slopes) {
                *out += self.unit * (by_overlap * change + by_closing * closing);
            }
        }
    }
}
