//! The chain as a system to integrate by any method: every contact law, losses, and a magnet that
//! follows its particle.
//!
//! Bodies carry changes against the static state, so constant loads have vanished but for what
//! statics leaves over, the striker's weight. Behind the bodies of a chain with losses are
//! accounts: one for each kind of loss, whose rates are the powers, so that dissipated energies are
//! integrated along with the motion, to its accuracy; and one for the elastic energy of contacts
//! held at zero force, booked when they are held and released. Where forces jump, whether a contact
//! is closed is a switch of the system, not the sign of a vanishing overlap: the striker's contact
//! counts as closed at the start. Where contacts end at zero force, whether one is held there is
//! another switch: a kink.

use super::system::{Linearised, Motion, Scales, Sides, Switching, System, Tridiagonal};
use super::two_step::pacing;
use crate::chain::loss::{KINDS, Tangent, Touch};
use crate::chain::{ACCOUNTS, Chain, Contact, ContactLoss, EndOfContact, Law, Pull, State};

/// A force below this share of its parts is zero but for rounding (1).
const ROUNDING_SHARE: f64 = 1e-10;

/// What may change within a run, of a contact: it closes or opens; its force turns into a pull,
/// where it is held, or presses again.
#[derive(Debug, Clone, Copy)]
enum Change {
    Closes(usize),
    Pulls(usize),
}

/// A chain ready to be integrated.
#[derive(Debug, Clone)]
pub struct ChainSystem {
    contacts: Vec<Contact>,
    masses: Vec<f64>,
    /// Acceleration of each body that statics does not balance (m/s²).
    residual: Vec<f64>,
    /// A magnet that follows the body of this index.
    pull: Option<(usize, Pull)>,
    is_lossy: bool,
    /// Whether each contact counts as closed, and whether it is held at zero force.
    closed: Vec<bool>,
    held: Vec<bool>,
    switches: Vec<Change>,
    /// Speed that stands for one joule in the accounts, so that the error control weighs them as it
    /// does speeds (m/s/J).
    unit: f64,
    /// Tangents at the last linearisation, one a contact, and the slope of the magnet's force
    /// (N/m).
    tangents: Vec<Tangent>,
    pull_slope: f64,
    /// Smallest meaningful overlap scale (m).
    overlap_floor: f64,
    highest_frequency: f64,
}

impl ChainSystem {
    /// The system of `chain`; `initial_velocity` (m/s) sets the scale of what is to come.
    pub fn new(chain: &Chain, initial_velocity: &[f64]) -> Self {
        let contacts = chain.contacts().to_vec();
        let losses = || contacts.iter().enumerate().filter_map(|(j, c)| Some((j, c.loss?)));
        // Whether a contact touches is decided before whether it pulls.
        let closes = losses().filter(|(_, loss)| loss.jumps()).map(|(j, _)| Change::Closes(j));
        let pulls = losses().filter(|(_, loss)| loss.end == EndOfContact::ZeroForce);
        let switches = closes.chain(pulls.map(|(j, _)| Change::Pulls(j))).collect();
        let residual = chain.residual().iter().zip(chain.bodies());
        Self {
            masses: chain.bodies().iter().map(|body| body.mass).collect(),
            residual: residual.map(|(force, body)| force / body.mass).collect(),
            pull: chain.pull().map(|(body, pull)| (body, pull.clone())),
            is_lossy: chain.is_dissipative(),
            closed: vec![true; contacts.len()],
            held: vec![false; contacts.len()],
            switches,
            unit: chain.account_unit(initial_velocity),
            tangents: vec![Tangent::default(); contacts.len()],
            pull_slope: 0.0,
            overlap_floor: chain.impact_overlap(initial_velocity),
            highest_frequency: pacing(chain, initial_velocity).frequency,
            contacts,
        }
    }

    fn bodies(&self) -> usize {
        self.masses.len()
    }

    /// Positions or velocities of the bodies, without the accounts behind them (unit).
    fn of_bodies<'a>(&self, values: &'a [f64]) -> &'a [f64] {
        &values[..self.bodies()]
    }

    fn touch(&self, j: usize, motion: Motion) -> Touch {
        self.contacts[j].touch(motion.difference, motion.rate, self.closed[j])
    }
}

impl System for ChainSystem {
    fn len(&self) -> usize {
        self.bodies() + if self.is_lossy { ACCOUNTS } else { 0 }
    }

    fn accelerations(&mut self, position: &[f64], velocity: &[f64], acceleration: &mut [f64]) {
        let (of_bodies, accounts) = acceleration.split_at_mut(self.bodies());
        let (x, v) = (self.of_bodies(position), self.of_bodies(velocity));
        of_bodies.copy_from_slice(&self.residual);
        let mut power = [0.0; KINDS];
        let mut above = 0.0;
        for (j, contact) in self.contacts.iter().enumerate() {
            let change = difference(x, j);
            let mut force = contact.force_change(change);
            if let Some(loss) = contact.loss {
                if self.held[j] {
                    force = -contact.static_force;
                } else {
                    let closing = difference(v, j);
                    let overlap = contact.static_overlap + change;
                    let touch = Touch { overlap, closing, elastic: 0.0, closed: self.closed[j] };
                    for (power, term) in power.iter_mut().zip(loss.terms(contact.stiffness, touch))
                    {
                        force += term;
                        *power += term * closing;
                    }
                }
            }
            if let Some(i) = j.checked_sub(1) {
                of_bodies[i] += (above - force) / self.masses[i];
            }
            above = force;
        }
        if let Some((body, pull)) = &self.pull {
            of_bodies[*body] += pull.change(x[*body]) / self.masses[*body];
        }
        accounts.fill(0.0);
        for (account, power) in accounts.iter_mut().zip(power) {
            *account = power * self.unit;
        }
    }

    fn scales(&self, position: &[f64], velocity: &[f64]) -> Scales {
        let (x, v) = (self.of_bodies(position), self.of_bodies(velocity));
        let contacts = self.contacts.iter().enumerate().filter(|(_, c)| c.stiffness > 0.0);
        // A gap's width is no overlap: an open contact has lost its static one.
        let changes = contacts.map(|(j, c)| difference(x, j).max(-c.static_overlap).abs());
        let velocity = v.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        Scales { position: changes.fold(self.overlap_floor, f64::max), velocity }
    }

    fn has_kink_between(&self, from: &State, to: &State) -> bool {
        let [x, y] = [from, to].map(|state| self.of_bodies(&state.position));
        let [v, w] = [from, to].map(|state| self.of_bodies(&state.velocity));
        self.contacts.iter().enumerate().any(|(j, contact)| {
            let is_open = |of| contact.static_overlap + difference(of, j) < 0.0;
            let opens = contact.law == Law::Hertz && is_open(x) != is_open(y);
            let turns = || (difference(v, j) > 0.0) != (difference(w, j) > 0.0);
            opens || (contact.loss.is_some_and(|loss| loss.power_force > 0.0) && turns())
        })
    }

    fn highest_frequency(&self, _: &State) -> f64 {
        self.highest_frequency
    }

    fn switching(&mut self) -> Option<&mut dyn Switching> {
        if self.switches.is_empty() { None } else { Some(self) }
    }

    fn linearised(&mut self) -> Option<&mut dyn Linearised> {
        if self.is_lossy { Some(self) } else { None }
    }
}

/// Value of the body above contact `j` less that of the one below; walls rest (unit).
fn difference(of_bodies: &[f64], j: usize) -> f64 {
    let at = |body: Option<usize>| body.and_then(|body| of_bodies.get(body)).copied();
    at(j.checked_sub(1)).unwrap_or(0.0) - at(Some(j)).unwrap_or(0.0)
}

impl ChainSystem {
    /// What `switch` changes, its contact and the contact's loss, which contacts with switches
    /// have.
    fn of(&self, switch: usize) -> (Change, usize, &Contact, ContactLoss) {
        let change = self.switches[switch];
        let (Change::Closes(j) | Change::Pulls(j)) = change;
        let contact = &self.contacts[j];
        (change, j, contact, contact.loss.unwrap_or(ContactLoss::NONE))
    }

    /// Force that the contact would have if nothing held it, and the sum of its parts' magnitudes
    /// (N).
    fn unheld(&self, j: usize, loss: ContactLoss, motion: Motion) -> (f64, f64) {
        loss.unheld(self.contacts[j].stiffness, self.touch(j, motion))
    }
}

impl Switching for ChainSystem {
    fn switches(&self) -> usize {
        self.switches.len()
    }

    fn is_on(&self, switch: usize) -> bool {
        match self.switches[switch] {
            Change::Closes(j) => self.closed[j],
            Change::Pulls(j) => !self.held[j],
        }
    }

    fn flip(&mut self, switch: usize, state: &mut State) {
        let (change, j, contact, _) = self.of(switch);
        let kept = self.unit * contact.energy(difference(self.of_bodies(&state.position), j));
        let before = self.held[j];
        match change {
            Change::Closes(_) => {
                self.closed[j] = !self.closed[j];
                // A contact that closes presses.
                self.held[j] &= !self.closed[j];
            }
            Change::Pulls(_) => self.held[j] = !before,
        }
        if let (true, Some(account)) = (before != self.held[j], state.velocity.last_mut()) {
            *account += if self.held[j] { kept } else { -kept };
        }
    }

    fn sides(&self, switch: usize) -> Sides {
        let place = match self.switches[switch] {
            Change::Closes(j) => j,
            Change::Pulls(j) => self.contacts.len() + j,
        };
        let j = place % self.contacts.len();
        Sides { above: j.checked_sub(1), below: Some(j).filter(|i| *i < self.bodies()), place }
    }

    fn margin(&self, switch: usize, motion: Motion) -> f64 {
        match self.of(switch) {
            (Change::Closes(_), _, contact, _) => contact.static_overlap + motion.difference,
            (Change::Pulls(_), j, _, loss) => self.unheld(j, loss, motion).0,
        }
    }

    fn is_wrong(&self, switch: usize, motion: Motion) -> bool {
        let (change, j, contact, loss) = self.of(switch);
        let overlap = contact.static_overlap + motion.difference;
        match change {
            Change::Closes(_) if self.closed[j] => overlap < 0.0 && motion.rate < 0.0,
            Change::Closes(_) => overlap >= 0.0 && motion.rate > 0.0,
            Change::Pulls(_) => {
                let (force, parts) = self.unheld(j, loss, motion);
                let rounding = ROUNDING_SHARE * parts;
                if self.held[j] {
                    force > rounding || (overlap <= 0.0 && force == 0.0)
                } else {
                    force < -rounding
                }
            }
        }
    }

    fn error(&self, switch: usize, closing: f64, beyond: Motion) -> f64 {
        let (change, j, contact, loss) = self.of(switch);
        let force = match change {
            Change::Closes(_) => {
                let touch = Touch { overlap: 0.0, closing, elastic: 0.0, closed: true };
                loss.force(contact.stiffness, touch)
            }
            Change::Pulls(_) => self.margin(switch, beyond),
        };
        let masses = [j.checked_sub(1), Some(j)].map(|i| i.and_then(|i| self.masses.get(i)));
        force.abs() / masses.into_iter().flatten().fold(f64::INFINITY, |least, m| least.min(*m))
    }
}

impl Linearised for ChainSystem {
    fn bodies(&self) -> usize {
        self.masses.len()
    }

    fn linearise(&mut self, state: &State) {
        let (x, v) = (self.of_bodies(&state.position), self.of_bodies(&state.velocity));
        let tangent = |(j, contact): (usize, &Contact)| {
            let (change, closing) = (difference(x, j), difference(v, j));
            let stiffness = contact.tangent_stiffness(change);
            let Some(loss) = contact.loss else {
                return Tangent { stiffness, ..Tangent::default() };
            };
            let touch = contact.touch(change, closing, self.closed[j]);
            loss.tangent_as((contact.stiffness, stiffness), touch, self.held[j])
        };
        self.tangents = self.contacts.iter().enumerate().map(tangent).collect();
        self.pull_slope = self.pull.as_ref().map_or(0.0, |(body, pull)| pull.slope(x[*body]));
    }

    fn assemble(&mut self, shift: f64, matrix: &mut Tridiagonal) {
        let coupling = |j: usize| shift * self.tangents[j].damping + self.tangents[j].stiffness;
        for (i, mass) in self.masses.iter().enumerate() {
            matrix.diagonal[i] = shift * shift * mass + coupling(i) + coupling(i + 1);
        }
        for (i, beside) in matrix.off_diagonal.iter_mut().enumerate() {
            *beside = -coupling(i + 1);
        }
        if let Some((body, _)) = &self.pull {
            matrix.diagonal[*body] -= self.pull_slope;
        }
    }

    fn masses(&self) -> &[f64] {
        &self.masses
    }

    fn forces_of(&mut self, position: &[f64], out: &mut [f64]) {
        let x = self.of_bodies(position);
        let force = |j: usize| self.tangents[j].stiffness * difference(x, j);
        for (i, out) in out[..x.len()].iter_mut().enumerate() {
            *out = force(i) - force(i + 1);
        }
        if let Some((body, _)) = &self.pull {
            out[*body] += self.pull_slope * x[*body];
        }
    }

    fn account_rates(&mut self, position: &[f64], velocity: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let (x, v) = (self.of_bodies(position), self.of_bodies(velocity));
        for (j, tangent) in self.tangents.iter().enumerate() {
            let (change, closing) = (difference(x, j), difference(v, j));
            let slopes = tangent.power_by_overlap.iter().zip(&tangent.power_by_closing);
            for (out, (by_overlap, by_closing)) in out.iter_mut().zip(slopes) {
                *out += self.unit * (by_overlap * change + by_closing * closing);
            }
        }
    }
}
