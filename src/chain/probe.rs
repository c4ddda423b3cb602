//! Forces where somebody looks: inside a particle or in one contact, anywhere within an integrator's step.

use super::{Chain, Contact};
use crate::integrate::{Integrator, Interpolant};

/// A weighted sum of two neighbouring contact forces: what a plate in a particle feels.
///
/// `N(xi) = F_above (1/2 - xi) + F_below (1/2 + xi)`, `xi` the plate's distance from the particle's centre in units of
/// its length, downward positive. A centred plate feels the mean; `xi = 1/2` feels the contact below alone.
/// Source: linear interpolation of the axial force in a rigidly moving body of even mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceProbe {
    contacts: [Contact; 2],
    weights: [f64; 2],
    /// Index of the body between the two contacts.
    body: usize,
}

impl ForceProbe {
    /// The force inside particle `particle` (from 1) at offset `xi` (1, -0.5 to 0.5).
    #[must_use]
    pub fn inside(chain: &Chain, particle: usize, offset: f64) -> Option<Self> {
        let body = chain.body_of(particle);
        let contacts = [*chain.contacts().get(body)?, *chain.contacts().get(body + 1)?];
        chain.bodies().get(body)?;
        Some(Self { contacts, weights: [0.5 - offset, 0.5 + offset], body })
    }

    /// The force in the contact above body `contact` (from 0).
    #[must_use]
    pub fn contact(chain: &Chain, contact: usize) -> Option<Self> {
        let above = contact.checked_sub(1)?;
        let contacts = [*chain.contacts().get(above)?, *chain.contacts().get(contact)?];
        Some(Self { contacts, weights: [0.0, 1.0], body: above })
    }

    /// Force at static equilibrium (N).
    #[must_use]
    pub fn static_force(&self) -> f64 {
        self.contacts.iter().zip(self.weights).map(|(c, w)| w * c.static_force).sum()
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
            probe: *self,
            start,
            length,
            bodies: [
                body(self.body.checked_sub(1)),
                body(Some(self.body)),
                body(Some(self.body + 1)),
            ],
            closed: [self.body, self.body + 1].map(|contact| integrator.was_on(contact)),
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
    /// Whether each of the two contacts counted as closed.
    closed: [bool; 2],
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
            let force = contact.lossy_force_change(overlaps[i], closing[i], self.closed[i]);
            self.probe.weights[i] * force
        };
        weighted(0) + weighted(1)
    }

    /// The closing accelerations are those of the interpolant.
    fn lossy_rate(&self, overlaps: [f64; 2], closing: [f64; 2], theta: f64) -> f64 {
        let accelerations = self.differences(|b| b.acceleration(theta, self.length));
        let weighted = |i: usize| {
            let contact = &self.probe.contacts[i];
            let elastic = contact.tangent_stiffness(overlaps[i]);
            let touch = contact.touch(overlaps[i], closing[i], self.closed[i]);
            let (stiffness, damping) = contact.loss.map_or((elastic, 0.0), |loss| {
                let tangent = loss.tangent(contact.stiffness, elastic, touch);
                (tangent.stiffness, tangent.damping)
            });
            self.probe.weights[i] * (stiffness * closing[i] + damping * accelerations[i])
        };
        weighted(0) + weighted(1)
    }
}
