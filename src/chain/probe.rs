//! Forces where somebody looks: inside a particle or in one contact, anywhere within an integrator's step.

use std::sync::Arc;

use super::{Chain, Contact, Pull};
use crate::integrate::{Integrator, Interpolant};

/// A weighted sum of two neighbouring contact forces: what a plate in a particle feels.
///
/// `N(xi) = F_above (1/2 - xi) + F_below (1/2 + xi)`, `xi` the plate's distance from the particle's centre in units of
/// its length, downward positive. A centred plate feels the mean; `xi = 1/2` feels the contact below alone.
/// Source: linear interpolation of the axial force in a rigidly moving body of even mass.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceProbe {
    contacts: [Contact; 2],
    weights: [f64; 2],
    /// Index of the body between the two contacts.
    body: usize,
    /// The next contacts above and below, which share in the accelerations that the rates of losses need, and in the rates of all accelerations.
    outer: [Contact; 2],
    /// Inverse mass (1/kg) and unbalanced acceleration (m/s²) of the body above, this one and the one below.
    inertia: [(f64, f64); 3],
    /// A magnet that follows one of these three bodies, by its place among them.
    pull: Option<(usize, Arc<Pull>)>,
}

impl ForceProbe {
    /// The force inside particle `particle` (from 1) at offset `xi` (1, -0.5 to 0.5).
    #[must_use]
    pub fn inside(chain: &Chain, particle: usize, offset: f64) -> Option<Self> {
        let body = chain.body_of(particle);
        let contacts = [*chain.contacts().get(body)?, *chain.contacts().get(body + 1)?];
        chain.bodies().get(body)?;
        Some(Self::at(chain, body, contacts, [0.5 - offset, 0.5 + offset]))
    }

    /// The force in the contact above body `contact` (from 0).
    #[must_use]
    pub fn contact(chain: &Chain, contact: usize) -> Option<Self> {
        let above = contact.checked_sub(1)?;
        let contacts = [*chain.contacts().get(above)?, *chain.contacts().get(contact)?];
        Some(Self::at(chain, above, contacts, [0.0, 1.0]))
    }

    fn at(chain: &Chain, body: usize, contacts: [Contact; 2], weights: [f64; 2]) -> Self {
        let contact = |j: Option<usize>| {
            j.and_then(|j| chain.contacts().get(j)).copied().unwrap_or(Contact::OPEN)
        };
        let inertia = |i: Option<usize>| {
            let found = i.and_then(|i| chain.bodies().get(i).zip(chain.residual.get(i)));
            found.map_or((0.0, 0.0), |(body, rest)| (1.0 / body.mass, rest / body.mass))
        };
        let outer = [contact(body.checked_sub(1)), contact(Some(body + 2))];
        let inertia = [inertia(body.checked_sub(1)), inertia(Some(body)), inertia(Some(body + 1))];
        let pull = chain.pull().and_then(|(pulled, pull)| {
            let place = (pulled + 1).checked_sub(body).filter(|place| *place < 3)?;
            Some((place, Arc::new(pull.clone())))
        });
        Self { contacts, weights, body, outer, inertia, pull }
    }

    /// The two contacts that are felt, the one above first.
    #[must_use]
    pub fn contacts(&self) -> &[Contact; 2] {
        &self.contacts
    }

    /// What each of them weighs (1).
    #[must_use]
    pub fn weights(&self) -> &[f64; 2] {
        &self.weights
    }

    /// Index of the body between them.
    #[must_use]
    pub fn body(&self) -> usize {
        self.body
    }

    /// The two contacts with the next one above and below.
    pub(super) fn neighbourhood(&self) -> [Contact; 4] {
        let ([above, below], [first, last]) = (self.contacts, self.outer);
        [first, above, below, last]
    }

    /// Inverse masses of the body above, this one and the one below (1/kg).
    pub(super) fn inverse_masses(&self) -> [f64; 3] {
        self.inertia.map(|(inverse_mass, _)| inverse_mass)
    }

    /// Force at static equilibrium (N).
    #[must_use]
    pub fn static_force(&self) -> f64 {
        self.contacts.iter().zip(self.weights).map(|(c, w)| w * c.static_force).sum()
    }

    /// How fast the force changes when the chain is let go: nothing has moved yet, and bodies have these velocities (m/s) (N/s).
    #[must_use]
    pub fn starting_rate(&self, velocities: &[f64]) -> f64 {
        let velocity = |body: Option<usize>| body.and_then(|b| velocities.get(b)).copied();
        let here = self.body;
        let [above, here, below] =
            [here.checked_sub(1), Some(here), Some(here + 1)].map(|b| velocity(b).unwrap_or(0.0));
        let terms = self.contacts.iter().zip(self.weights).zip([above - here, here - below]);
        terms.map(|((c, weight), closing)| weight * c.tangent_stiffness(0.0) * closing).sum()
    }

    /// Whether a contact it feels has a loss: its force may then jump.
    #[must_use]
    pub fn is_lossy(&self) -> bool {
        self.contacts.iter().any(|contact| contact.loss.is_some())
    }

    /// The probe's view of the integrator's last step, whose interpolation is prepared.
    #[must_use]
    pub fn over_step(&self, integrator: &dyn Integrator, bodies: usize) -> ForceSegment {
        let body = |index: Option<usize>| {
            index.filter(|i| *i < bodies).map_or(Interpolant::REST, |i| integrator.interpolant(i))
        };
        let (start, length) = integrator.last_step();
        ForceSegment {
            probe: self.clone(),
            start,
            length,
            bodies: [
                body(self.body.checked_sub(1)),
                body(Some(self.body)),
                body(Some(self.body + 1)),
            ],
            outer: [self.body.checked_sub(2), Some(self.body + 2)]
                .map(|index| body(index.filter(|_| self.is_lossy()))),
            closed: [self.body.wrapping_sub(1), self.body, self.body + 1, self.body + 2]
                .map(|contact| integrator.was_on(contact)),
        }
    }
}

/// A probe's dynamic force over one step, at any time within it.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceSegment {
    probe: ForceProbe,
    /// Start of the step (s).
    pub start: f64,
    /// Length of the step (s).
    pub length: f64,
    bodies: [Interpolant; 3],
    /// The bodies beyond; at rest where they are not needed.
    outer: [Interpolant; 2],
    /// Whether each contact counted as closed, the outer ones first and last.
    closed: [bool; 4],
}

impl ForceSegment {
    /// Dynamic force, the static one subtracted, at the fraction `theta` of the step (N).
    #[must_use]
    pub fn force(&self, theta: f64) -> f64 {
        if self.probe.is_lossy() {
            return self.lossy_force(theta);
        }
        let [above, here, below] = self.bodies.map(|b| b.position(theta));
        let terms = self.probe.contacts.iter().zip(self.probe.weights);
        terms
            .zip([above - here, here - below])
            .map(|((contact, weight), change)| weight * contact.force_change(change))
            .sum()
    }

    /// Its rate of change at the fraction `theta` of the step (N/s).
    #[must_use]
    pub fn rate(&self, theta: f64) -> f64 {
        let overlaps = self.differences(|b| b.position(theta));
        let closing = self.differences(|b| b.velocity(theta));
        if self.probe.is_lossy() {
            return self.lossy_rate(overlaps, closing, theta);
        }
        let terms = self.probe.contacts.iter().zip(self.probe.weights);
        terms
            .zip(overlaps.into_iter().zip(closing))
            .map(|((contact, weight), (change, closing))| {
                weight * contact.tangent_stiffness(change) * closing
            })
            .sum()
    }

    /// Differences over the two contacts.
    fn differences(&self, of: impl Fn(&Interpolant) -> f64) -> [f64; 2] {
        let [above, here, below] = self.bodies.each_ref().map(of);
        [above - here, here - below]
    }

    fn lossy_force(&self, theta: f64) -> f64 {
        let overlaps = self.differences(|b| b.position(theta));
        let closing = self.differences(|b| b.velocity(theta));
        let weighted = |i: usize| {
            let contact = &self.probe.contacts[i];
            let force = contact.lossy_force_change(overlaps[i], closing[i], self.closed[i + 1]);
            self.probe.weights[i] * force
        };
        weighted(0) + weighted(1)
    }

    /// How fast the closing speeds of the two contacts change: from the forces, for an interpolant's second derivative is nothing but
    /// rounding on the shortest steps.
    fn closing_accelerations(&self, theta: f64) -> [f64; 2] {
        let ([a, b, c], [first, last]) = (&self.bodies, &self.outer);
        let bodies = [first, a, b, c, last].map(|m| (m.position(theta), m.velocity(theta)));
        let [above, below] = self.probe.outer;
        let contacts = [above, self.probe.contacts[0], self.probe.contacts[1], below];
        let mut forces = [0.0; 4];
        for (i, (force, contact)) in forces.iter_mut().zip(&contacts).enumerate() {
            let (upper, lower) = (bodies[i], bodies[i + 1]);
            let (change, closing) = (upper.0 - lower.0, upper.1 - lower.1);
            *force = contact.lossy_force_change(change, closing, self.closed[i]);
        }
        let acceleration = |i: usize| {
            let (inverse_mass, rest) = self.probe.inertia[i];
            let pull = self.probe.pull.as_ref().filter(|(place, _)| *place == i);
            let pulled = pull.map_or(0.0, |(_, pull)| pull.change(bodies[i + 1].0));
            (forces[i] - forces[i + 1] + pulled) * inverse_mass + rest
        };
        [acceleration(0) - acceleration(1), acceleration(1) - acceleration(2)]
    }

    fn lossy_rate(&self, overlaps: [f64; 2], closing: [f64; 2], theta: f64) -> f64 {
        let accelerations = self.closing_accelerations(theta);
        let weighted = |i: usize| {
            let contact = &self.probe.contacts[i];
            let elastic = contact.tangent_stiffness(overlaps[i]);
            let touch = contact.touch(overlaps[i], closing[i], self.closed[i + 1]);
            let (stiffness, damping) = contact.loss.map_or((elastic, 0.0), |loss| {
                let tangent = loss.tangent(contact.stiffness, elastic, touch);
                (tangent.stiffness, tangent.damping)
            });
            self.probe.weights[i] * (stiffness * closing[i] + damping * accelerations[i])
        };
        weighted(0) + weighted(1)
    }
}
