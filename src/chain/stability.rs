//! What an impact will do, estimated before the first step: the scale of overlaps, and the longest
//! steps that methods survive.
//!
//! Steps are limited by the highest angular frequency of the chain and by the fastest decay of
//! velocities. Both follow from the largest eigenvalue of `M^-1 S`, `S` tridiagonal with
//! `s[i] + s[i+1]` on the diagonal and `-s[i]` beside it: stiffnesses `s = k` give the square of
//! the frequency, slopes of the losses against the closing speed `s = c` the decay. For a diatomic
//! chain of dashpots the decay is `2 gamma (1/m + 1/M)`. It is found by bisection on the count of
//! negative pivots. Source: W. Givens, J. ACM 4, 298 (1957), on Sturm sequences of tridiagonal
//! matrices.

use super::{Chain, Contact, Drive};

/// Relative width at which the bisection for an eigenvalue ends (1).
const EIGENVALUE_TOLERANCE: f64 = 1e-12;

/// A step beyond which a method cannot be stable.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityLimit {
    /// The longest step (s).
    pub step: f64,
    /// The body above that contact.
    pub upper: String,
    /// The body below it, or the wall.
    pub lower: String,
}

/// Speeds at which contacts close at most if the bodies beside them have these velocities in
/// whatever direction: their sum (m/s).
fn closing_speed(velocity: &[f64], j: usize) -> f64 {
    let speed = |i: Option<usize>| i.and_then(|i| velocity.get(i)).map_or(0.0, |v| v.abs());
    speed(j.checked_sub(1)) + speed(Some(j))
}

/// Largest speed at which neighbours with these velocities meet (m/s).
fn fastest(velocity: &[f64]) -> f64 {
    (0..=velocity.len()).map(|j| closing_speed(velocity, j)).fold(0.0, f64::max)
}

impl Chain {
    /// The overlap that bodies with these velocities (m/s) will reach, by which errors are
    /// measured. 0 where nothing moves (m).
    ///
    /// For each moving body the larger of two closed forms: `v/omega` on its static contacts, and
    /// the two-body collision for contacts without preload.
    pub fn impact_overlap(&self, velocity: &[f64]) -> f64 {
        let driven = self.drives().map(|(_, drive)| drive.amplitude).fold(0.0, f64::max);
        self.impacts(velocity).map(|(_, overlap)| overlap).fold(driven, f64::max)
    }

    /// By how much that impact raises the force of a contact, at most: [`Self::impact_overlap`] in
    /// newtons. 0 where nothing moves (N).
    pub fn impact_force(&self, velocity: &[f64]) -> f64 {
        let driven = self.drives().map(|(contact, drive)| (contact, drive.amplitude));
        let impacts = self.impacts(velocity).chain(driven);
        impacts.map(|(contact, overlap)| contact.force_change(overlap)).fold(0.0, f64::max)
    }

    /// Drives, each with the contact beside it.
    pub fn drives(&self) -> impl Iterator<Item = (&Contact, &Drive)> {
        let contacts = [self.contacts.first(), self.contacts.last()];
        let ends = contacts.into_iter().flatten().zip(&self.supports);
        ends.filter_map(|(contact, support)| Some((contact, support.drive()?)))
    }

    /// Contacts beside moving bodies, and the overlap (m) that they will reach.
    fn impacts<'a>(&'a self, velocity: &'a [f64]) -> impl Iterator<Item = (&'a Contact, f64)> {
        let moving = self.bodies.iter().zip(velocity).enumerate().filter(|(_, (_, v))| **v != 0.0);
        moving.flat_map(|(index, (body, speed))| {
            let sides = self.contacts[index..index + 2].iter().filter(|c| c.stiffness > 0.0);
            sides.map(|contact| (contact, overlap_with_neighbour(contact, body.mass, *speed)))
        })
    }

    /// What is above and below contact `j`: kinds, where both are the same with the particles'
    /// numbers.
    pub(crate) fn beside(&self, j: usize) -> (String, String) {
        let body = |index: Option<usize>| index.and_then(|index| self.bodies.get(index));
        let is_same = body(j.checked_sub(1)).map(|b| &b.name) == body(Some(j)).map(|b| &b.name);
        let name = |index: Option<usize>| match (body(index), index) {
            (Some(body), Some(index)) if is_same => {
                let particle = index + usize::from(!self.striker);
                format!("{} {particle}", body.name)
            }
            (body, _) => body.map_or("the wall", |body| &*body.name).to_owned(),
        };
        (name(j.checked_sub(1)), name(Some(j)))
    }

    /// Inverse masses of the bodies above and below contact `j`; zero for walls (1/kg).
    pub(crate) fn inverse_masses(&self, j: usize) -> [f64; 2] {
        [j.checked_sub(1), Some(j)]
            .map(|i| i.and_then(|i| self.bodies.get(i)).map_or(0.0, |body| 1.0 / body.mass))
    }

    /// The longest step that a method survives whose longest stable step times angular frequency is
    /// `reach` (1).
    ///
    /// The frequency is the highest of the whole chain, linearised: each contact at its static
    /// overlap or, next to a moving body, at the overlap of the coming collision. The contact that
    /// is named would be fastest with its two bodies alone.
    pub fn stability_limit(&self, velocity: &[f64], reach: f64) -> Option<StabilityLimit> {
        let stiffness = |(j, contact): (usize, &Contact)| {
            if contact.stiffness == 0.0 {
                return 0.0;
            }
            let closing = closing_speed(velocity, j);
            let mobility: f64 = self.inverse_masses(j).iter().sum();
            let dynamic = contact.collision_overlap(1.0 / mobility, closing);
            contact.stiffness_at(contact.static_overlap.max(dynamic))
        };
        let stiffnesses: Vec<f64> = self.contacts.iter().enumerate().map(stiffness).collect();
        self.limit(&stiffnesses, |square| reach / square.sqrt())
    }

    /// The longest step that a method survives whose longest stable step times decay is `reach`
    /// (1), by [`Self::fastest_decay`]; none without losses.
    pub fn decay_limit(&self, velocity: &[f64], reach: f64) -> Option<StabilityLimit> {
        self.limit(&self.dampings(velocity), |decay| reach / decay)
    }

    /// The `step` that follows from the largest eigenvalue with these `coefficients` of the
    /// contacts, and the contact that has the largest with its two bodies alone.
    fn limit(&self, coefficients: &[f64], step: impl Fn(f64) -> f64) -> Option<StabilityLimit> {
        let alone = |(j, s): (usize, &f64)| (j, s * self.inverse_masses(j).iter().sum::<f64>());
        let alone = coefficients.iter().enumerate().map(alone).filter(|(_, value)| *value > 0.0);
        let (j, _) = alone.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?;
        let (upper, lower) = self.beside(j);
        Some(StabilityLimit { step: step(self.largest_eigenvalue(coefficients)), upper, lower })
    }

    /// The fastest decay of any pattern of velocities, with all lossy contacts closed and at the
    /// overlaps and speeds that bodies with these velocities (m/s) will reach; 0 without losses
    /// (1/s).
    pub fn fastest_decay(&self, velocity: &[f64]) -> f64 {
        self.largest_eigenvalue(&self.dampings(velocity))
    }

    /// The largest eigenvalue of `M^-1 S` for these coefficients of the contacts (unit).
    fn largest_eigenvalue(&self, coefficients: &[f64]) -> f64 {
        let rows = || self.bodies.iter().zip(coefficients.windows(2));
        // No eigenvalue exceeds the largest sum of a row's magnitudes.
        let sums = rows().map(|(body, pair)| 2.0 * (pair[0] + pair[1]) / body.mass);
        let (mut low, mut high) = (0.0, sums.fold(0.0, f64::max));
        while high - low > EIGENVALUE_TOLERANCE * high {
            let middle = 0.5 * (low + high);
            let mut pivot = f64::INFINITY;
            // Negative pivots of S - middle M are eigenvalues below.
            let all_below = rows().all(|(body, pair)| {
                pivot = pair[0] + pair[1] - middle * body.mass - pair[0] * pair[0] / pivot;
                pivot < 0.0
            });
            if all_below {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }

    /// The largest decay of any contact, its two bodies taken alone, in units of its own angular
    /// frequency: twice its damping ratio; 0 without losses (1).
    pub fn largest_damping(&self, velocity: &[f64]) -> f64 {
        let speed = fastest(velocity);
        let ratio = |(j, slope): (usize, f64)| {
            let (overlap, mobility) = self.largest_overlap(j, speed);
            let stiffness = self.contacts[j].stiffness_at(overlap);
            if slope > 0.0 { slope * (mobility / stiffness).sqrt() } else { 0.0 }
        };
        self.dampings(velocity).into_iter().enumerate().map(ratio).fold(0.0, f64::max)
    }

    /// The larger of contact `j`'s static overlap and that of a collision at `speed` (m/s) (m), and
    /// its inverse reduced mass (1/kg).
    fn largest_overlap(&self, j: usize, speed: f64) -> (f64, f64) {
        let (contact, mobility): (_, f64) =
            (&self.contacts[j], self.inverse_masses(j).iter().sum());
        let dynamic = contact.collision_overlap(1.0 / mobility, speed);
        (contact.static_overlap.max(dynamic), mobility)
    }

    /// Slopes of the contacts' losses against the closing speed, at the larger of their static
    /// overlap and that of a collision at the largest of these velocities (m/s) (N s/m).
    fn dampings(&self, velocity: &[f64]) -> Vec<f64> {
        let speed = fastest(velocity);
        let slope = |(j, contact): (usize, &Contact)| {
            let slope = |loss: super::ContactLoss| {
                loss.damping(contact.stiffness, self.largest_overlap(j, speed).0, speed)
            };
            contact.loss.map_or(0.0, slope)
        };
        self.contacts.iter().enumerate().map(slope).collect()
    }
}

/// Dynamic overlap of one contact when a body of `mass` (kg) runs into it with `speed` (m/s) (m).
pub(super) fn overlap_with_neighbour(contact: &Contact, mass: f64, speed: f64) -> f64 {
    let free = contact.collision_overlap(0.5 * mass, speed);
    if contact.static_overlap == 0.0 {
        return free;
    }
    free.min(speed.abs() * (mass / contact.static_stiffness()).sqrt())
}
