//! The chain with losses as a system to integrate.
//!
//! Elastic forces come from the plan of the lossless system; each lossy contact adds its own. Behind the bodies stand accounts, one
//! for each kind of loss and one for the elastic energy that contacts held at zero force give up: their rates are the
//! powers, so energies are integrated along with the motion, to its accuracy. Where a dashpot makes forces jump,
//! whether the contact is closed is a switch of the system, and not the sign of a vanishing overlap: the striker's contact
//! counts as closed at the start.

use super::loss::{ContactLoss, KINDS, Taken, Tangent, Touch};
use super::{Chain, ChainSystem, Contact};
use crate::integrate::{Linearised, Scales, Sides, State, Switching, System, Tridiagonal};

/// Accounts behind the bodies: one a kind of loss, and what contacts held at zero force give up.
pub const ACCOUNTS: usize = KINDS + 1;

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
}

/// A chain with losses, ready to be integrated.
#[derive(Debug, Clone)]
pub struct DissipativeSystem {
    elastic: ChainSystem,
    bodies: usize,
    contacts: Vec<Contact>,
    lossy: Vec<Lossy>,
    /// Places in `lossy` of the contacts whose forces jump.
    switches: Vec<usize>,
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
            let lossy = |loss| Lossy { index, contact: *contact, loss, inverse_mass, closed: true };
            contact.loss.map(lossy)
        });
        let lossy: Vec<Lossy> = lossy.collect();
        let switches = (0..lossy.len()).filter(|i| lossy[*i].loss.jumps()).collect();
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

impl Lossy {
    fn touch(&self, change: f64, closing: f64) -> Touch {
        self.contact.touch(change, closing, self.closed)
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
        accounts.fill(0.0);
        for lossy in &self.lossy {
            let (change, closing) = motion(position, velocity, n, lossy.index);
            let Taken { force, power, released } =
                lossy.loss.taken(lossy.contact.stiffness, lossy.touch(change, closing));
            let [above, below] = lossy.inverse_mass;
            if let Some(a) = lossy.index.checked_sub(1).and_then(|i| of_bodies.get_mut(i)) {
                *a -= force * above;
            }
            if let Some(a) = of_bodies.get_mut(lossy.index) {
                *a += force * below;
            }
            for (account, power) in accounts.iter_mut().zip(power.into_iter().chain([released])) {
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

impl Switching for DissipativeSystem {
    fn switches(&self) -> usize {
        self.switches.len()
    }

    fn is_on(&self, switch: usize) -> bool {
        self.lossy[self.switches[switch]].closed
    }

    fn flip(&mut self, switch: usize) {
        let closed = &mut self.lossy[self.switches[switch]].closed;
        *closed = !*closed;
    }

    fn sides(&self, switch: usize) -> Sides {
        let lossy = &self.lossy[self.switches[switch]];
        Sides {
            above: lossy.index.checked_sub(1),
            below: Some(lossy.index).filter(|i| *i < self.bodies),
            margin: lossy.contact.static_overlap,
            place: lossy.index,
        }
    }

    fn jump(&self, switch: usize, closing: f64) -> f64 {
        let lossy = &self.lossy[self.switches[switch]];
        let touch = Touch { overlap: 0.0, closing, elastic: 0.0, closed: true };
        let force = lossy.loss.taken(lossy.contact.stiffness, touch).force.abs();
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
            *tangent = lossy.loss.tangent(lossy.contact.stiffness, tangent.stiffness, touch);
        }
    }

    fn assemble(&self, shift: f64, matrix: &mut Tridiagonal) {
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

    fn forces_of(&self, position: &[f64], out: &mut [f64]) {
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

    fn account_rates(&self, position: &[f64], velocity: &[f64], out: &mut [f64]) {
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
