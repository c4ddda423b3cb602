//! Forces where somebody looks: inside a particle or in one contact, anywhere within an
//! integrator's step.

use std::sync::Arc;

use super::{Chain, Contact, Pull};
use crate::integrate::{COEFFICIENTS, Integrator, Interpolant};

/// Contacts that have to do with a probe: the two that it feels, and the next above and below.
const CONTACTS: usize = 4;

/// A weighted sum of two neighbouring contact forces: what a plate in a particle feels.
///
/// `N(xi) = F_above (1/2 - xi) + F_below (1/2 + xi)`, `xi` the plate's distance from the particle's
/// centre in units of its length, downward positive. A centred plate feels the mean; `xi = 1/2`
/// feels the contact below alone. Source: linear interpolation of the axial force in a rigidly
/// moving body of even mass.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceProbe {
    /// Shared with what is kept of steps.
    around: Arc<Around>,
}

/// What there is around a probe.
#[derive(Debug, PartialEq)]
struct Around {
    /// The next contacts above and below share in the accelerations that the rates of losses need,
    /// and in the rates of all accelerations.
    contacts: [Contact; CONTACTS],
    weights: [f64; 2],
    /// Index of the body between the two that are felt.
    body: usize,
    is_lossy: bool,
    /// Inverse mass (1/kg) and unbalanced acceleration (m/s²) of the body above, this one and the
    /// one below.
    inertia: [(f64, f64); 3],
    /// A magnet that follows one of these three bodies, by its place among them.
    pull: Option<(usize, Pull)>,
}

impl ForceProbe {
    /// The force inside particle `particle` (from 1) at offset `xi` (1, -0.5 to 0.5).
    pub fn inside(chain: &Chain, particle: usize, offset: f64) -> Option<Self> {
        let body = chain.body_of(particle);
        let contacts = [*chain.contacts().get(body)?, *chain.contacts().get(body + 1)?];
        chain.bodies().get(body)?;
        Some(Self::at(chain, body, contacts, [0.5 - offset, 0.5 + offset]))
    }

    /// The force in the contact above body `contact` (from 0).
    pub fn contact(chain: &Chain, contact: usize) -> Option<Self> {
        let above = contact.checked_sub(1)?;
        let contacts = [*chain.contacts().get(above)?, *chain.contacts().get(contact)?];
        Some(Self::at(chain, above, contacts, [0.0, 1.0]))
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

    /// The two contacts with the next one above and below.
    pub(super) fn neighbourhood(&self) -> &[Contact; CONTACTS] {
        &self.around.contacts
    }

    /// Inverse masses of the body above, this one and the one below (1/kg).
    pub(super) fn inverse_masses(&self) -> [f64; 3] {
        self.around.inertia.map(|(inverse_mass, _)| inverse_mass)
    }

    /// A magnet that follows the body above, this one or the one below, by its place among them.
    pub(super) fn pull(&self) -> Option<&(usize, Pull)> {
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
        terms.map(|((c, weight), closing)| weight * c.tangent_stiffness(0.0) * closing).sum()
    }

    /// Whether a contact it feels has a loss: its force may then jump.
    pub fn is_lossy(&self) -> bool {
        self.around.is_lossy
    }

    /// The probe's view of the integrator's last step, whose interpolation is prepared.
    pub fn over_step(&self, integrator: &dyn Integrator, bodies: usize) -> ForceSegment {
        let here = self.body();
        let motion = |index: Option<usize>| {
            index.filter(|i| *i < bodies).map_or(Interpolant::REST, |i| integrator.interpolant(i))
        };
        let beyond = |index: Option<usize>| motion(index.filter(|_| self.is_lossy()));
        let along = [
            beyond(here.checked_sub(2)),
            motion(here.checked_sub(1)),
            motion(Some(here)),
            motion(Some(here + 1)),
            beyond(Some(here + 2)),
        ];
        let (start, length) = integrator.last_step();
        let closed = [here.wrapping_sub(1), here, here + 1, here + 2]
            .map(|contact| integrator.was_on(contact));
        let pull = self.around.pull.as_ref().filter(|_| self.is_lossy());
        let pulled = pull.map(|(place, _)| Box::new(along[place + 1]));
        let anew = integrator.starts_anew();
        let (motion, around) = (Motion::between(&along), Arc::clone(&self.around));
        ForceSegment { around, start, length, motion, pulled, closed, anew }
    }
}

/// How the overlaps of the contacts around a probe change, and how fast, over a step: coefficients
/// of the powers of its fraction, four of the one (m), then four of the other (m/s). Side by side,
/// so that all polynomials are evaluated at once.
#[derive(Debug, Clone, PartialEq)]
struct Motion([[f64; 2 * CONTACTS]; COEFFICIENTS]);

impl Motion {
    fn between(bodies: &[Interpolant; CONTACTS + 1]) -> Self {
        Self(std::array::from_fn(|power| {
            std::array::from_fn(|lane| {
                let (above, below) = (&bodies[lane % CONTACTS], &bodies[lane % CONTACTS + 1]);
                if lane < CONTACTS {
                    above.position[power] - below.position[power]
                } else {
                    above.velocity[power] - below.velocity[power]
                }
            })
        }))
    }

    /// Changes (m) and rates (m/s) at the fraction `theta` of the step.
    fn at(&self, theta: f64) -> [[f64; CONTACTS]; 2] {
        let mut sums = [0.0; 2 * CONTACTS];
        for coefficients in self.0.iter().rev() {
            for (sum, coefficient) in sums.iter_mut().zip(coefficients) {
                *sum = *sum * theta + coefficient;
            }
        }
        let [a, b, c, d, rates @ ..] = sums;
        [[a, b, c, d], rates]
    }
}

/// A probe's dynamic force over one step, at any time within it.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceSegment {
    around: Arc<Around>,
    /// Start of the step (s).
    pub start: f64,
    /// Length of the step (s).
    pub length: f64,
    motion: Motion,
    /// The body that a magnet pulls as it moves.
    pulled: Option<Box<Interpolant>>,
    /// Whether each contact counted as closed.
    closed: [bool; CONTACTS],
    /// Whether a switch has changed just before the step: the force may have jumped.
    pub anew: bool,
}

impl ForceSegment {
    /// Dynamic force, the static one subtracted, at the fraction `theta` of the step (N).
    pub fn force(&self, theta: f64) -> f64 {
        let [changes, closing] = self.motion.at(theta);
        let Around { contacts, weights, is_lossy, .. } = &*self.around;
        let of = |i: usize| {
            let contact = &contacts[i];
            if *is_lossy {
                contact.lossy_force_change(changes[i], closing[i], self.closed[i])
            } else {
                contact.force_change(changes[i])
            }
        };
        weights[0] * of(1) + weights[1] * of(2)
    }

    /// Its rate of change at the fraction `theta` of the step (N/s).
    pub fn rate(&self, theta: f64) -> f64 {
        self.look(theta)[1]
    }

    /// Both. What closing speeds gain follows from the forces, for an interpolant's second
    /// derivative is nothing but rounding on the shortest steps (N, N/s).
    pub fn look(&self, theta: f64) -> [f64; 2] {
        let [changes, closing] = self.motion.at(theta);
        let Around { contacts, weights, is_lossy, inertia, .. } = &*self.around;
        let felt =
            |i: usize| contacts[i].lossy_change_and_slopes(changes[i], closing[i], self.closed[i]);
        let [(above, slopes_above), (below, slopes_below)] = [felt(1), felt(2)];
        let force = weights[0] * above + weights[1] * below;
        let mut gained = [0.0; 2];
        if *is_lossy {
            let beyond =
                |i: usize| contacts[i].lossy_force_change(changes[i], closing[i], self.closed[i]);
            let forces = [beyond(0), above, below, beyond(3)];
            let [upper, here, lower] = [0, 1, 2].map(|i| {
                let (inverse_mass, rest) = inertia[i];
                (forces[i] - forces[i + 1] + self.pull(i, theta)) * inverse_mass + rest
            });
            gained = [upper - here, here - lower];
        }
        let rates = [(1, slopes_above), (2, slopes_below)]
            .map(|(i, [stiffness, damping])| stiffness * closing[i] + damping * gained[i - 1]);
        [force, weights[0] * rates[0] + weights[1] * rates[1]]
    }

    /// What the magnet pulls body `i` of the three by beyond its static force (N).
    fn pull(&self, i: usize, theta: f64) -> f64 {
        match (&self.around.pull, &self.pulled) {
            (Some((place, pull)), Some(body)) if *place == i => pull.change(body.position(theta)),
            _ => 0.0,
        }
    }
}
