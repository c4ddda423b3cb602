//! Forces inside a particle or in one contact.

use std::sync::Arc;

use super::{Chain, Contact, Pull};

/// Contacts that have to do with a probe: the two that it feels, and the next above and below.
pub(crate) const CONTACTS: usize = 4;

/// A weighted sum of two neighbouring contact forces: what a plate in a particle feels.
///
/// `N(xi) = F_above (1/2 - xi) + F_below (1/2 + xi)`, `xi` the plate's distance from the particle's
/// centre in units of its length, downward positive. A centred plate measures the mean, one at
/// `xi = 1/2` the contact below alone. Source: linear interpolation of the axial force in a rigidly
/// moving body of even mass.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceProbe {
    /// Shared with what is kept of steps.
    around: Arc<Around>,
}

/// Contacts, bodies and magnet around a probe.
#[derive(Debug, PartialEq)]
pub struct Around {
    /// The next contacts above and below share in the accelerations that the rates of losses need,
    /// and in the rates of all accelerations.
    pub(crate) contacts: [Contact; CONTACTS],
    pub(crate) weights: [f64; 2],
    /// Index of the body between the two that are felt.
    pub(crate) body: usize,
    pub(crate) is_lossy: bool,
    /// The first account of contacts that may yield.
    pub(crate) plastic: Option<usize>,
    /// Inverse mass (1/kg) and unbalanced acceleration (m/s²) of the body above, this one and the
    /// one below.
    pub(crate) inertia: [(f64, f64); 3],
    /// A magnet that follows one of these three bodies, by its place among them.
    pub(crate) pull: Option<(usize, Pull)>,
}

impl ForceProbe {
    /// The force inside particle `particle` (from 1) at offset `xi` (1, -0.5 to 0.5).
    pub fn inside(chain: &Chain, particle: usize, offset: f64) -> Option<Self> {
        let body = chain.body_of(particle);
        let contacts = [*chain.contacts().get(body)?, *chain.contacts().get(body + 1)?];
        chain.bodies().get(body)?;
        Some(Self::at(chain, body, contacts, [0.5 - offset, 0.5 + offset]))
    }

    /// The force in the contact above body `contact` (from 0): contact 0 is that of a top wall.
    pub fn contact(chain: &Chain, contact: usize) -> Option<Self> {
        let Some(above) = contact.checked_sub(1) else {
            let contacts = [*chain.contacts().first()?, *chain.contacts().get(1)?];
            return Some(Self::at(chain, 0, contacts, [1.0, 0.0]));
        };
        let contacts = [*chain.contacts().get(above)?, *chain.contacts().get(contact)?];
        Some(Self::at(chain, above, contacts, [0.0, 1.0]))
    }

    /// The net force of both contacts on particle `particle` (from 1), which accelerates it.
    pub fn net(chain: &Chain, particle: usize) -> Option<Self> {
        let body = chain.body_of(particle);
        let contacts = [*chain.contacts().get(body)?, *chain.contacts().get(body + 1)?];
        chain.bodies().get(body)?;
        Some(Self::at(chain, body, contacts, [1.0, -1.0]))
    }

    fn at(chain: &Chain, body: usize, [above, below]: [Contact; 2], weights: [f64; 2]) -> Self {
        let contact = |j: Option<usize>| {
            j.and_then(|j| chain.contacts().get(j)).copied().unwrap_or(Contact::OPEN)
        };
        let inertia = |i: Option<usize>| {
            let found = i.and_then(|i| chain.bodies().get(i).zip(chain.residual.get(i)));
            found.map_or((0.0, 0.0), |(body, rest)| (1.0 / body.mass, rest / body.mass))
        };
        let pull = chain.pull().and_then(|(pulled, pull)| {
            let place = (pulled + 1).checked_sub(body).filter(|place| *place < 3)?;
            Some((place, pull.clone()))
        });
        let around = Around {
            contacts: [contact(body.checked_sub(1)), above, below, contact(Some(body + 2))],
            weights,
            body,
            is_lossy: above.loss.is_some() || below.loss.is_some(),
            plastic: chain.accounts().plastic,
            inertia: [inertia(body.checked_sub(1)), inertia(Some(body)), inertia(Some(body + 1))],
            pull,
        };
        Self { around: Arc::new(around) }
    }

    /// The two contacts that are felt, the one above first.
    pub fn contacts(&self) -> [&Contact; 2] {
        let [_, above, below, _] = &self.around.contacts;
        [above, below]
    }

    /// What each of them weighs (1).
    pub fn weights(&self) -> &[f64; 2] {
        &self.around.weights
    }

    /// Index of the body between them.
    pub fn body(&self) -> usize {
        self.around.body
    }

    /// What there is around it.
    pub(crate) fn around(&self) -> &Arc<Around> {
        &self.around
    }

    /// The two contacts with the next one above and below.
    pub(crate) fn neighbourhood(&self) -> &[Contact; CONTACTS] {
        &self.around.contacts
    }

    /// Inverse masses of the body above, this one and the one below (1/kg).
    pub(crate) fn inverse_masses(&self) -> [f64; 3] {
        self.around.inertia.map(|(inverse_mass, _)| inverse_mass)
    }

    /// A magnet that follows the body above, this one or the one below, by its place among them.
    pub(crate) fn pull(&self) -> Option<&(usize, Pull)> {
        self.around.pull.as_ref()
    }

    /// Force at static equilibrium (N).
    pub fn static_force(&self) -> f64 {
        self.contacts().iter().zip(self.weights()).map(|(c, w)| w * c.static_force).sum()
    }

    /// How fast the force changes when the chain is let go: nothing has moved yet, and bodies have
    /// these velocities (m/s) (N/s).
    pub fn starting_rate(&self, velocities: &[f64]) -> f64 {
        let velocity = |body: Option<usize>| body.and_then(|b| velocities.get(b)).copied();
        let here = self.body();
        let [above, here, below] =
            [here.checked_sub(1), Some(here), Some(here + 1)].map(|b| velocity(b).unwrap_or(0.0));
        let terms = self.contacts().into_iter().zip(self.weights());
        let terms = terms.zip([above - here, here - below]);
        terms.map(|((c, weight), closing)| weight * c.starting_slope() * closing).sum()
    }

    /// Whether a contact it feels has a loss: its force may then jump.
    pub fn is_lossy(&self) -> bool {
        self.around.is_lossy
    }
}
