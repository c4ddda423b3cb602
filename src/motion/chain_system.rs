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
//!
//! Walls that move ([`Support`]) have accounts, too: one for the work that each does, one for the
//! displacement of a wall that gives way, `x_w' = F/Z + 2 g`, and one for the time, of which a
//! drive's displacement is a function, so that the equations stay autonomous. What has departed
//! into a rod is kept, step by step, until its far end returns it.

use std::collections::VecDeque;

use super::hermite::{COEFFICIENTS, Interpolant, horner, nodes, through_nodes};
use super::system::{Linearised, Motion, Scales, Sides, Switching, System, Tridiagonal, Turning};
use super::two_step::pacing;
use crate::chain::loss::{KINDS, Tangent, Touch};
use crate::chain::{
    ACCOUNTS, Accounts, Chain, Contact, ContactLoss, EndAccounts, EndOfContact, Law, Past, Pull,
    State, Support, Unloading, YieldLaw, into_chain,
};

/// A force below this share of its parts is zero but for rounding (1).
const ROUNDING_SHARE: f64 = 1e-10;

/// Iterations for the force on a wall that gives way under a contact with losses, at most.
const WALL_ITERATIONS: usize = 50;

/// How a contact that may yield loads.
#[derive(Debug, Clone, Copy)]
struct Yielding {
    law: YieldLaw,
    /// Largest overlap beyond first yield so far; 0 where it has not yielded (m).
    largest: f64,
    /// How it unloads from there; none on first loading.
    unloading: Option<Unloading>,
}

impl Yielding {
    /// Overlap beyond which it yields (m).
    fn level(&self) -> f64 {
        self.largest.max(self.law.first_overlap())
    }
}

/// A wall that moves.
#[derive(Debug, Clone)]
struct Wall {
    support: Support,
    accounts: EndAccounts,
    /// Speed that stands for a metre of its displacement in the account (1/s).
    face_rate: f64,
    /// Velocities that departed into a rod, by step: start and length (s), and coefficients of the
    /// powers of the step's fraction (m/s).
    departed: VecDeque<((f64, f64), [f64; COEFFICIENTS])>,
}

impl Wall {
    /// The velocity that returns from a rod's far end at `time` (s) (m/s).
    fn returning(&self, time: f64) -> f64 {
        let Some(echo) = self.support.backing().and_then(|backing| backing.echo) else {
            return 0.0;
        };
        let departed = time - echo.delay;
        let after = self.departed.partition_point(|((start, _), _)| *start <= departed);
        let step = after.checked_sub(1).and_then(|place| self.departed.get(place));
        step.map_or(0.0, |((start, length), velocity)| {
            echo.reflection * horner(velocity, (departed - start) / length)
        })
    }
}

/// What may change within a run, of a contact: it closes or opens; its force turns into a pull,
/// where it is held, or presses again; it goes from first loading, where it may yield, to unloading
/// or back.
#[derive(Debug, Clone, Copy)]
enum Change {
    Closes(usize),
    Pulls(usize),
    Yields(usize),
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
    /// How contacts load that may yield, none of others.
    yielding: Vec<Option<Yielding>>,
    /// How far each contact is from opening at rest (m).
    travel: Vec<f64>,
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
    /// Smallest meaningful speed: a drive's (m/s).
    speed_floor: f64,
    highest_frequency: f64,
    accounts: Accounts,
    /// The walls at the top and at the bottom that move.
    walls: [Option<Wall>; 2],
    /// Acceleration of the state that keeps the time: its velocity over this is the time (m/s²).
    clock_rate: f64,
    longest_step: f64,
}

impl ChainSystem {
    /// The system of `chain`; `initial_velocity` (m/s) sets the scale of what is to come.
    pub fn new(chain: &Chain, initial_velocity: &[f64]) -> Self {
        let contacts = chain.contacts().to_vec();
        let losses = || contacts.iter().enumerate().filter_map(|(j, c)| Some((j, c.loss?)));
        // Whether a contact touches is decided before whether it pulls.
        let closes = losses().filter(|(_, loss)| loss.jumps()).map(|(j, _)| Change::Closes(j));
        let pulls = losses().filter(|(_, loss)| loss.end == EndOfContact::ZeroForce);
        let yields = contacts.iter().enumerate().filter(|(_, contact)| contact.plastic.is_some());
        let yields = yields.map(|(j, _)| Change::Yields(j));
        let switches = closes.chain(pulls.map(|(j, _)| Change::Pulls(j))).chain(yields).collect();
        let start = chain.initial_state(initial_velocity);
        let yielding = |(j, contact): (usize, &Contact)| {
            let law = contact.plastic?;
            let largest = chain.largest_overlap_of(&start, j);
            let unloading = (largest > 0.0).then(|| law.unloading(largest));
            Some(Yielding { law, largest, unloading })
        };
        let yielding = contacts.iter().enumerate().map(yielding).collect();
        let residual = chain.residual().iter().zip(chain.bodies());
        let accounts = chain.accounts();
        let wall = |end: usize| {
            let support = chain.supports()[end].clone();
            let face_rate = chain.face_rate(end);
            let departed = VecDeque::new();
            accounts.ends[end].map(|accounts| Wall { support, accounts, face_rate, departed })
        };
        let overlap_floor = chain.impact_overlap(initial_velocity);
        let speed_floor = chain.drives().map(|(_, drive)| drive.speed()).fold(0.0, f64::max);
        let longest = chain.supports().iter().map(Support::longest_step);
        Self {
            masses: chain.bodies().iter().map(|body| body.mass).collect(),
            residual: residual.map(|(force, body)| force / body.mass).collect(),
            pull: chain.pull().map(|(body, pull)| (body, pull.clone())),
            is_lossy: chain.is_dissipative(),
            closed: vec![true; contacts.len()],
            held: vec![false; contacts.len()],
            yielding,
            travel: contacts.iter().map(Contact::static_travel).collect(),
            switches,
            unit: chain.account_unit(initial_velocity),
            tangents: vec![Tangent::default(); contacts.len()],
            pull_slope: 0.0,
            overlap_floor,
            speed_floor,
            accounts,
            walls: [wall(0), wall(1)],
            // A second weighs no more than its rounding may.
            clock_rate: if speed_floor > 0.0 {
                speed_floor * speed_floor / overlap_floor
            } else {
                1.0
            },
            longest_step: longest.fold(f64::INFINITY, f64::min),
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

    /// The end whose wall moves at contact `j`.
    fn moving_end(&self, j: usize) -> Option<usize> {
        let end = usize::from(j != 0);
        ((j == 0 || j == self.bodies()) && self.walls[end].is_some()).then_some(end)
    }

    /// The time in a state with these values behind the bodies (s).
    fn time(&self, velocity: &[f64]) -> f64 {
        self.accounts.clock.map_or(0.0, |place| velocity[place] / self.clock_rate)
    }

    /// Displacement (m) and velocity (m/s) of the walls at the top and at the bottom.
    fn wall_motions(&self, position: &[f64], velocity: &[f64]) -> [[f64; 2]; 2] {
        [0, 1].map(|end| {
            let Some(wall) = &self.walls[end] else { return [0.0; 2] };
            let body = if end == 0 { 0 } else { self.bodies() - 1 };
            let face = wall.accounts.face.map_or(0.0, |place| velocity[place] / wall.face_rate);
            self.wall_motion(end, wall, [position[body], velocity[body]], face, self.time(velocity))
        })
    }

    /// Displacement (m) and velocity (m/s) of a wall beside a body at a position (m) and velocity
    /// (m/s); of one that gives way, `face` is the displacement (m).
    fn wall_motion(
        &self,
        end: usize,
        wall: &Wall,
        body: [f64; 2],
        face: f64,
        time: f64,
    ) -> [f64; 2] {
        let sign = into_chain(end);
        match &wall.support {
            Support::Rigid => [0.0; 2],
            Support::Driven(drive) => drive.at(time).map(|value| sign * value),
            Support::Yielding(backing) => {
                // A returning wave moves a face without force at twice its own velocity.
                let unforced = 2.0 * wall.returning(time);
                let (change, closing) = (sign * (face - body[0]), sign * (unforced - body[1]));
                let j = if end == 0 { 0 } else { self.bodies() };
                let force = self.force_on_yielding(j, change, closing, 1.0 / backing.impedance);
                [face, unforced - sign * force / backing.impedance]
            }
        }
    }

    /// Change of the force in contact `j`, beside a wall of this mobility (m/N/s) that would close
    /// it at `closing` (m/s) if it did not give way (N).
    fn force_on_yielding(&self, j: usize, change: f64, closing: f64, mobility: f64) -> f64 {
        let contact = &self.contacts[j];
        let elastic = self.elastic_change(j, change);
        if contact.loss.is_none() {
            return elastic;
        }
        if self.held[j] {
            return -contact.static_force;
        }
        // Newton's method on `F = F(closing - F/Z)`, whose difference has a slope of at least 1.
        let free = Contact { loss: contact.loss.map(ContactLoss::unheld_end), ..*contact };
        let largest = self.yielding[j].filter(|y| y.unloading.is_some()).map_or(0.0, |y| y.largest);
        let past = Past { closed: self.closed[j], largest };
        let mut force = elastic;
        for _ in 0..WALL_ITERATIONS {
            let (found, [_, damping]) =
                free.lossy_change_and_slopes(change, closing - mobility * force, past);
            let step = (force - found) / (1.0 + mobility * damping);
            force -= step;
            if step.abs() <= f64::EPSILON * force.abs() {
                break;
            }
        }
        force
    }

    /// How contact `j` stands and moves, of bodies at these positions (m) and velocities (m/s),
    /// with the accounts behind them.
    fn contact_motion(&self, j: usize, position: &[f64], velocity: &[f64]) -> Motion {
        let (x, v) = (self.of_bodies(position), self.of_bodies(velocity));
        let mut motion = Motion { difference: difference(x, j), rate: difference(v, j) };
        if let Some(end) = self.moving_end(j) {
            let [displacement, speed] = self.wall_motions(position, velocity)[end];
            motion.difference += into_chain(end) * displacement;
            motion.rate += into_chain(end) * speed;
        }
        motion
    }

    /// Change of the elastic force of contact `j` by a `change` of its overlap (m) (N).
    fn elastic_change(&self, j: usize, change: f64) -> f64 {
        let contact = &self.contacts[j];
        match &self.yielding[j] {
            None => contact.force_change(change),
            Some(Yielding { unloading: None, .. }) => contact.loading_change(change).0,
            Some(Yielding { unloading: Some(unloading), .. }) => {
                let (force, _) = unloading.force_and_slope(contact.static_overlap + change);
                force - contact.static_force
            }
        }
    }

    /// The smaller mass of the bodies at contact `j` (kg).
    fn lightest_at(&self, j: usize) -> f64 {
        let masses = [j.checked_sub(1), Some(j)].map(|i| i.and_then(|i| self.masses.get(i)));
        masses.into_iter().flatten().fold(f64::INFINITY, |least, m| least.min(*m))
    }

    /// How far contact `j` is from opening where it has closed by `change` (m) (m).
    fn overlap(&self, j: usize, change: f64) -> f64 {
        let residual = self.yielding[j].and_then(|yielding| yielding.unloading);
        self.contacts[j].static_approach() + change - residual.map_or(0.0, |u| u.residual)
    }

    fn touch(&self, j: usize, motion: Motion) -> Touch {
        let elastic = self.contacts[j].static_force + self.elastic_change(j, motion.difference);
        let overlap = self.overlap(j, motion.difference);
        Touch { overlap, closing: motion.rate, elastic, closed: self.closed[j] }
    }
}

impl System for ChainSystem {
    fn len(&self) -> usize {
        self.accounts.len
    }

    fn accelerations(&mut self, position: &[f64], velocity: &[f64], acceleration: &mut [f64]) {
        let (of_bodies, accounts) = acceleration.split_at_mut(self.bodies());
        let (x, v) = (self.of_bodies(position), self.of_bodies(velocity));
        of_bodies.copy_from_slice(&self.residual);
        let walls = self.wall_motions(position, velocity);
        let mut work = [0.0; 2];
        let mut power = [0.0; KINDS];
        let mut above = 0.0;
        for (j, contact) in self.contacts.iter().enumerate() {
            let end = self.moving_end(j);
            let mut change = difference(x, j);
            if let Some(end) = end {
                change += into_chain(end) * walls[end][0];
            }
            let mut force = self.elastic_change(j, change);
            if let Some(loss) = contact.loss {
                if self.held[j] {
                    force = -contact.static_force;
                } else {
                    let mut closing = difference(v, j);
                    if let Some(end) = end {
                        closing += into_chain(end) * walls[end][1];
                    }
                    let overlap = self.overlap(j, change);
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
            if let Some(end) = end {
                work[end] = into_chain(end) * (contact.static_force + force) * walls[end][1];
            }
            above = force;
        }
        if let Some((body, pull)) = &self.pull {
            of_bodies[*body] += pull.change(x[*body]) / self.masses[*body];
        }
        accounts.fill(0.0);
        if self.accounts.losses.is_some() {
            for (account, power) in accounts.iter_mut().zip(power) {
                *account = power * self.unit;
            }
        }
        if let Some(clock) = self.accounts.clock {
            acceleration[clock] = self.clock_rate;
        }
        for ((wall, motion), work) in self.walls.iter().zip(walls).zip(work) {
            let Some(Wall { accounts, face_rate, .. }) = wall else { continue };
            acceleration[accounts.work] = work * self.unit;
            if let Some(face) = accounts.face {
                acceleration[face] = motion[1] * face_rate;
            }
        }
    }

    fn scales(&self, position: &[f64], velocity: &[f64]) -> Scales {
        let (x, v) = (self.of_bodies(position), self.of_bodies(velocity));
        let contacts = self.contacts.iter().enumerate().filter(|(_, c)| c.stiffness > 0.0);
        // A gap's width is no overlap: an open contact has lost its static one.
        let change = |j: usize| match self.moving_end(j) {
            Some(_) => self.contact_motion(j, position, velocity).difference,
            None => difference(x, j),
        };
        let changes = contacts.map(|(j, _)| change(j).max(-self.travel[j]).abs());
        let velocity = v.iter().fold(self.speed_floor, |most: f64, v| most.max(v.abs()));
        Scales { position: changes.fold(self.overlap_floor, f64::max), velocity }
    }

    fn has_kink_between(&self, from: &State, to: &State) -> bool {
        let [start, end] = [from, to].map(|state| self.time(&state.velocity));
        let breaks = self.walls.iter().flatten().filter_map(|wall| wall.support.drive());
        let mut breaks = breaks.flat_map(|drive| drive.signal.breaks());
        if breaks.any(|time| start < time && time < end) {
            return true;
        }
        self.contacts.iter().enumerate().any(|(j, contact)| {
            let [from, to] =
                [from, to].map(|state| self.contact_motion(j, &state.position, &state.velocity));
            let is_open = |of: Motion| self.overlap(j, of.difference) < 0.0;
            let bends = |of: Motion| {
                let overlap = contact.static_overlap + of.difference;
                self.yielding[j].is_some_and(|yielding| overlap > yielding.level())
            };
            let opens = contact.law != Law::Linearised && is_open(from) != is_open(to);
            let turns = || (from.rate > 0.0) != (to.rate > 0.0);
            opens
                || bends(from) != bends(to)
                || (contact.loss.is_some_and(|loss| loss.power_force > 0.0) && turns())
        })
    }

    fn highest_frequency(&self, _: &State) -> f64 {
        self.highest_frequency
    }

    fn longest_step(&self) -> f64 {
        self.longest_step
    }

    fn wall(
        &self,
        end: usize,
        (start, length): (f64, f64),
        motion: &dyn Fn(usize) -> Interpolant,
    ) -> Interpolant {
        let Some(wall) = &self.walls[end] else { return Interpolant::REST };
        let body = motion(if end == 0 { 0 } else { self.bodies() - 1 });
        let face = wall.accounts.face.map(|place| motion(place).velocity);
        let face = face.map(|values| values.map(|value| value / wall.face_rate));
        let motions = nodes().map(|theta| {
            let beside = [body.position(theta), body.velocity(theta)];
            let face = face.map_or(0.0, |face| horner(&face, theta));
            self.wall_motion(end, wall, beside, face, start + theta * length)
        });
        Interpolant {
            position: face.unwrap_or_else(|| through_nodes(motions.map(|[x, _]| x))),
            velocity: through_nodes(motions.map(|[_, v]| v)),
        }
    }

    fn has_memory(&self) -> bool {
        let walls = self.walls.iter().flatten();
        walls.filter_map(|wall| wall.support.backing()).any(|backing| backing.echo.is_some())
    }

    fn remember(&mut self, (start, length): (f64, f64), walls: [Interpolant; 2]) {
        for (wall, motion) in self.walls.iter_mut().zip(walls) {
            let Some(wall) = wall else { continue };
            let Some(echo) = wall.support.backing().and_then(|backing| backing.echo) else {
                continue;
            };
            let departing = nodes()
                .map(|theta| motion.velocity(theta) - wall.returning(start + theta * length));
            // A step that was cut is followed by one from the cut on.
            while wall.departed.back().is_some_and(|((begun, _), _)| *begun >= start) {
                wall.departed.pop_back();
            }
            wall.departed.push_back(((start, length), through_nodes(departing)));
            let is_over =
                |((begun, taken), _): &((f64, f64), _)| begun + taken < start - echo.delay;
            while wall.departed.front().is_some_and(is_over) {
                wall.departed.pop_front();
            }
        }
    }

    fn switching(&mut self) -> Option<&mut dyn Switching> {
        if self.switches.is_empty() { None } else { Some(self) }
    }

    fn linearised(&mut self) -> Option<&mut dyn Linearised> {
        let has_tangents = self.accounts.clock.is_none() && self.accounts.plastic.is_none();
        if self.is_lossy && has_tangents { Some(self) } else { None }
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
        let (Change::Closes(j) | Change::Pulls(j) | Change::Yields(j)) = change;
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
            Change::Yields(j) => self.yielding[j].is_none_or(|y| y.unloading.is_none()),
        }
    }

    fn flip(&mut self, switch: usize, state: &mut State) {
        let (what, j, contact, _) = self.of(switch);
        let change = self.contact_motion(j, &state.position, &state.velocity).difference;
        let overlap = contact.static_overlap + change;
        let kept = match &self.yielding[j] {
            Some(yielding) => yielding.law.energy(overlap, yielding.largest),
            None => contact.energy(change),
        };
        let kept = self.unit * kept;
        let before = self.held[j];
        match what {
            Change::Closes(_) => {
                self.closed[j] = !self.closed[j];
                // A contact that closes presses.
                self.held[j] &= !self.closed[j];
            }
            Change::Pulls(_) => self.held[j] = !before,
            Change::Yields(_) => {
                let account = self.accounts.plastic.and_then(|at| state.velocity.get_mut(at + j));
                let (Some(yielding), Some(account)) = (&mut self.yielding[j], account) else {
                    return;
                };
                if yielding.unloading.take().is_none() {
                    yielding.largest = yielding.level().max(overlap);
                    yielding.unloading = Some(yielding.law.unloading(yielding.largest));
                    *account = yielding.largest;
                }
            }
        }
        let account = self.accounts.losses.map(|first| first + ACCOUNTS - 1);
        let account = account.and_then(|place| state.velocity.get_mut(place));
        if let (true, Some(account)) = (before != self.held[j], account) {
            *account += if self.held[j] { kept } else { -kept };
        }
    }

    fn sides(&self, switch: usize) -> Sides {
        let place = match self.switches[switch] {
            Change::Closes(j) => j,
            Change::Pulls(j) => self.contacts.len() + j,
            Change::Yields(j) => 2 * self.contacts.len() + j,
        };
        let j = place % self.contacts.len();
        Sides { above: j.checked_sub(1), below: Some(j).filter(|i| *i < self.bodies()), place }
    }

    fn motion(&self, switch: usize, state: &State) -> Motion {
        let (Change::Closes(j) | Change::Pulls(j) | Change::Yields(j)) = self.switches[switch];
        self.contact_motion(j, &state.position, &state.velocity)
    }

    fn turning(&self, switch: usize) -> Turning {
        let Change::Yields(j) = self.switches[switch] else { return Turning::Irrelevant };
        match &self.yielding[j] {
            Some(yielding) if yielding.unloading.is_none() => {
                Turning::Changes(yielding.level() - self.contacts[j].static_overlap)
            }
            _ => Turning::MayChange,
        }
    }

    fn turn_error(&self, switch: usize, turn: f64, end: Motion) -> f64 {
        let (_, j, contact, _) = self.of(switch);
        let Some(Yielding { law, .. }) = self.yielding[j] else { return 0.0 };
        let unloading = law.unloading(contact.static_overlap + turn);
        let (unloaded, _) = unloading.force_and_slope(contact.static_overlap + end.difference);
        let loaded = contact.static_force + contact.loading_change(end.difference).0;
        (loaded - unloaded).abs() / self.lightest_at(j)
    }

    fn margin(&self, switch: usize, motion: Motion) -> f64 {
        match self.of(switch) {
            (Change::Closes(_), j, ..) => self.overlap(j, motion.difference),
            (Change::Pulls(_), j, _, loss) => self.unheld(j, loss, motion).0,
            (Change::Yields(_), j, contact, _) => match self.yielding[j] {
                Some(Yielding { unloading: Some(_), largest, .. }) => {
                    contact.static_overlap + motion.difference - largest
                }
                _ => 1.0,
            },
        }
    }

    fn is_wrong(&self, switch: usize, motion: Motion) -> bool {
        let (change, j, contact, loss) = self.of(switch);
        let overlap = self.overlap(j, motion.difference);
        match change {
            Change::Closes(_) if self.closed[j] => overlap < 0.0 && motion.rate < 0.0,
            Change::Closes(_) => overlap >= 0.0 && motion.rate > 0.0,
            Change::Yields(_) => {
                let overlap = contact.static_overlap + motion.difference;
                self.yielding[j].is_some_and(|yielding| {
                    if yielding.unloading.is_some() {
                        return overlap > yielding.largest && motion.rate > 0.0;
                    }
                    let is_beyond = overlap > yielding.level() || yielding.largest > 0.0;
                    is_beyond && motion.rate < 0.0
                })
            }
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
            Change::Yields(_) => {
                contact.loading_change(beyond.difference).0
                    - self.elastic_change(j, beyond.difference)
            }
        };
        force.abs() / self.lightest_at(j)
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
            let touch = contact.touch(change, closing, Past::of(self.closed[j]));
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
