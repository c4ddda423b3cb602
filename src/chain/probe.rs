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
}

impl ForceSegment {
    /// Dynamic force, the static one subtracted, at the fraction `theta` of the step (N).
    #[must_use]
    pub fn force(&self, theta: f64) -> f64 {
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
        let [above, here, below] = self.bodies.map(|b| b.position(theta));
        let [above_v, here_v, below_v] = self.bodies.map(|b| b.velocity(theta));
        let overlaps = [above - here, here - below];
        let closing = [above_v - here_v, here_v - below_v];
        let terms = self.probe.contacts.iter().zip(self.probe.weights);
        terms
            .zip(overlaps.into_iter().zip(closing))
            .map(|((contact, weight), (change, closing))| {
                weight * contact.tangent_stiffness(change) * closing
            })
            .sum()
    }
}
