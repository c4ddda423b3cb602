//! What an impact will do, estimated before the first step: the scale of overlaps, and the longest stable step.

use super::{Chain, Contact, hertz};

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

impl Chain {
    /// The overlap that bodies with these velocities (m/s) will reach: the yardstick for errors. 0 where nothing moves (m).
    ///
    /// For each moving body the larger of two closed forms: `v/omega` on its static contacts, and the two-body
    /// collision for contacts without preload.
    pub fn impact_overlap(&self, velocity: &[f64]) -> f64 {
        self.impacts(velocity).map(|(_, overlap)| overlap).fold(0.0, f64::max)
    }

    /// By how much that impact raises the force of a contact, at most: [`Self::impact_overlap`] in newtons. 0 where nothing moves (N).
    pub fn impact_force(&self, velocity: &[f64]) -> f64 {
        let forces = self.impacts(velocity).map(|(contact, overlap)| contact.force_change(overlap));
        forces.fold(0.0, f64::max)
    }

    /// Contacts beside moving bodies, and the overlap (m) that they will reach.
    fn impacts<'a>(&'a self, velocity: &'a [f64]) -> impl Iterator<Item = (&'a Contact, f64)> {
        let moving = self.bodies.iter().zip(velocity).enumerate().filter(|(_, (_, v))| **v != 0.0);
        moving.flat_map(|(index, (body, speed))| {
            let sides = self.contacts[index..index + 2].iter().filter(|c| c.stiffness > 0.0);
            sides.map(|contact| (contact, collision_overlap(contact, body.mass, *speed)))
        })
    }

    /// Names of what stands above and below contact `j`.
    pub(crate) fn beside(&self, j: usize) -> (String, String) {
        let name = |index: Option<usize>| {
            let body = index.and_then(|index| self.bodies.get(index));
            body.map_or("the wall", |body| &*body.name).to_owned()
        };
        (name(j.checked_sub(1)), name(Some(j)))
    }

    /// The longest step that a method could survive whose longest stable step times angular frequency is `reach` (1).
    ///
    /// The frequency is the highest of the whole chain, linearised: each contact at its static overlap or, next to a moving body,
    /// at the overlap of the coming collision. The contact that is named is the one that would be fastest with its two bodies alone.
    pub fn stability_limit(&self, velocity: &[f64], reach: f64) -> Option<StabilityLimit> {
        let mut fastest: Option<(f64, StabilityLimit)> = None;
        let mut stiffnesses = vec![0.0; self.contacts.len()];
        for (j, contact) in self.contacts.iter().enumerate() {
            let sides = [j.checked_sub(1), Some(j)].map(|i| i.filter(|i| *i < self.bodies.len()));
            let [upper, lower] = sides.map(|i| i.and_then(|i| self.bodies.get(i)));
            let inverse: f64 = [upper, lower].iter().flatten().map(|b| 1.0 / b.mass).sum();
            let speed = |i: &usize| velocity.get(*i).copied().unwrap_or(0.0).abs();
            let closing = sides.iter().flatten().map(speed).fold(0.0, f64::max);
            if contact.stiffness == 0.0 {
                continue;
            }
            let dynamic = hertz::collision_overlap(contact.stiffness, 1.0 / inverse, closing);
            let overlap = contact.static_overlap.max(dynamic);
            let stiffness = hertz::tangent_stiffness(contact.stiffness, overlap);
            if let Some(entry) = stiffnesses.get_mut(j) {
                *entry = stiffness;
            }
            let square = stiffness * inverse;
            if square > 0.0 && fastest.as_ref().is_none_or(|(most, _)| square > *most) {
                let (upper, lower) = self.beside(j);
                let limit = StabilityLimit { step: 0.0, upper, lower };
                fastest = Some((square, limit));
            }
        }
        let (square, limit) = fastest?;
        let step = reach / self.highest_square(&stiffnesses, square).sqrt();
        Some(StabilityLimit { step, ..limit })
    }

    /// Square of the highest angular frequency with these contact stiffnesses (N/m), at least `least` (1/s²), by bisection on
    /// the count of negative pivots (1/s²). Source: W. Givens, J. ACM 4, 298 (1957), on Sturm sequences of tridiagonal matrices.
    fn highest_square(&self, stiffnesses: &[f64], least: f64) -> f64 {
        let rows = || self.bodies.iter().zip(stiffnesses.windows(2));
        // No eigenvalue exceeds the largest sum of a row's magnitudes.
        let (mut low, mut high) = (least, least);
        for (body, pair) in rows() {
            high = high.max(2.0 * (pair[0] + pair[1]) / body.mass);
        }
        while high - low > 1e-12 * high {
            let middle = 0.5 * (low + high);
            let mut pivot = f64::INFINITY;
            // Negative pivots of K - middle M are eigenvalues below.
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
}

/// Dynamic overlap of one contact when a body of `mass` runs into it with `speed`.
fn collision_overlap(contact: &Contact, mass: f64, speed: f64) -> f64 {
    let free = hertz::collision_overlap(contact.stiffness, 0.5 * mass, speed);
    if contact.static_overlap == 0.0 {
        return free;
    }
    free.min(speed.abs() * (mass / contact.static_stiffness()).sqrt())
}
