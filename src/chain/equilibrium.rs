//! A chain in its static state.

use std::sync::Arc;

use super::body::{Body, ChainSpec, End};
use super::contact::{Contact, Law};
use super::error::ChainError;
use super::magnet::{ChainMagnet, Pull};
use super::statics::{contact, loads};
use super::support::Support;

/// A chain in static equilibrium, the striker at rest where it first touches.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    // Clones have these in common.
    pub(super) bodies: Arc<[Body]>,
    pub(super) contacts: Arc<[Contact]>,
    /// Force on each body that the static contacts do not balance: the striker's weight (N).
    pub(super) residual: Arc<[f64]>,
    pub(super) striker: bool,
    /// Acceleration of free fall (m/s²).
    pub(super) gravity: f64,
    /// Forces that press on the first particle and against the last one (N).
    pub(super) ends: [f64; 2],
    pub(super) magnet: Option<ChainMagnet>,
    /// Whether the magnet's force changes as its particle moves.
    pub(super) follows: bool,
    /// What is behind the walls at the top and at the bottom.
    pub(super) supports: [Support; 2],
}

impl Chain {
    /// Puts the bodies together and solves the static state.
    ///
    /// # Errors
    /// [`ChainError`] when the chain is empty, two flat faces meet, or no static state exists.
    pub fn new(spec: &ChainSpec) -> Result<Self, ChainError> {
        let striker = spec.striker.is_some();
        if spec.particles.is_empty() {
            return Err(ChainError::Empty);
        }
        if striker && matches!(spec.top, End::Wall(_)) {
            return Err(ChainError::StrikerBehindWall);
        }
        for (support, (end, name)) in
            spec.effects.supports.iter().zip([(spec.top, "top"), (spec.bottom, "bottom")])
        {
            if support.moves() && !matches!(end, End::Wall(_)) {
                return Err(ChainError::SupportWithoutWall { end: name });
            }
        }
        let bodies: Vec<Body> = spec.striker.iter().chain(&spec.particles).cloned().collect();
        let mut loads = loads(spec, &bodies);
        let magnet = ChainMagnet::at_rest(spec, &bodies, &loads)?;
        if let Some((magnet, load)) =
            magnet.as_ref().and_then(|m| Some((m, loads.get_mut(m.body)?)))
        {
            *load += magnet.force;
        }
        let first = usize::from(striker);
        let top_force = match spec.top {
            End::Wall(_) => spec.wall_preload,
            End::Force(force) if !striker => force,
            End::Force(_) | End::Free => 0.0,
        };
        let mut contacts = Vec::with_capacity(bodies.len() + 1);
        let mut bears = 0.0;
        for j in 0..=bodies.len() {
            bears = if j <= first {
                if j == first { top_force } else { 0.0 }
            } else {
                bears + loads[j - 1]
            };
            contacts.push(contact(spec, &bodies, j, bears)?);
        }
        let mut residual = vec![0.0; bodies.len()];
        if let (true, Some(rest), Some(load)) = (striker, residual.first_mut(), loads.first()) {
            *rest = *load;
        }
        let end = |end: &End| if let End::Force(force) = end { *force } else { 0.0 };
        Ok(Self {
            bodies: bodies.into(),
            contacts: contacts.into(),
            residual: residual.into(),
            striker,
            gravity: spec.effects.gravity.map_or(0.0, |gravity| gravity.acceleration),
            ends: [end(&spec.top), end(&spec.bottom)],
            follows: spec.effects.magnet_law.is_some(),
            magnet,
            supports: spec.effects.supports.clone(),
        })
    }

    /// The bodies from top to bottom, the striker first.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The contacts from top to bottom: one more than bodies, those with the boundaries included.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Force on each body that the static contacts do not balance (N).
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// The magnet that pulls one of its bodies, if any.
    pub fn magnet(&self) -> Option<&ChainMagnet> {
        self.magnet.as_ref()
    }

    /// A magnet whose force changes as its body moves, with the index of that body.
    pub fn pull(&self) -> Option<(usize, &Pull)> {
        let magnet = self.magnet.as_ref().filter(|_| self.follows)?;
        Some((magnet.body, magnet.pull.as_ref()?))
    }

    /// Whether its forces are those of elastic contacts and constant loads alone.
    pub fn is_plain(&self) -> bool {
        !self.needs_general_method() && self.pull().is_none()
    }

    /// What is behind the walls at the top and at the bottom.
    pub fn supports(&self) -> &[Support; 2] {
        &self.supports
    }

    /// Whether a wall moves.
    pub fn has_moving_walls(&self) -> bool {
        self.supports.iter().any(Support::moves)
    }

    /// Whether a contact may yield.
    pub fn is_plastic(&self) -> bool {
        self.contacts.iter().any(|contact| contact.plastic.is_some())
    }

    /// Whether contacts follow another law than Hertz's.
    pub fn has_other_exponents(&self) -> bool {
        self.contacts.iter().any(|contact| matches!(contact.law, Law::Power(_)))
    }

    /// Whether its forces depend on time or history, for which the implicit method has no tangents,
    /// or on an exponent for which it was not tried.
    pub fn needs_explicit_method(&self) -> bool {
        self.has_moving_walls() || self.is_plastic() || self.has_other_exponents()
    }

    /// Whether its motion depends on more than positions, so that only the general methods serve.
    pub fn needs_general_method(&self) -> bool {
        self.is_dissipative() || self.needs_explicit_method()
    }

    /// Whether its contacts are linearised: all of them are, or none.
    pub fn is_linear(&self) -> bool {
        self.contacts.iter().any(|contact| contact.law == Law::Linearised)
    }

    /// Smallest mass of its bodies (kg).
    pub fn lightest(&self) -> f64 {
        self.bodies.iter().fold(f64::INFINITY, |least, body| least.min(body.mass))
    }

    /// Number of particles; the striker is none.
    pub fn particles(&self) -> usize {
        self.bodies.len() - usize::from(self.striker)
    }

    /// Whether body 0 is a striker.
    pub fn has_striker(&self) -> bool {
        self.striker
    }

    /// Index of the body that is particle `particle`, counted from 1.
    pub fn body_of(&self, particle: usize) -> usize {
        particle - usize::from(!self.striker)
    }

    /// Index of the contact with the wall at the bottom, if there is one.
    pub fn wall_contact(&self) -> Option<usize> {
        let last = self.contacts.len() - 1;
        self.contacts.get(last).filter(|c| c.stiffness > 0.0).map(|_| last)
    }

    /// Static distance between the centres of two particles, overlaps subtracted (m).
    pub fn distance(&self, upper: usize, lower: usize) -> f64 {
        let (from, to) = (self.body_of(upper.min(lower)), self.body_of(upper.max(lower)));
        let between = |pair: &[Body]| pair.iter().map(|b| 0.5 * b.length).sum::<f64>();
        let lengths: f64 = self.bodies[from..=to].windows(2).map(between).sum();
        let overlaps: f64 = self.contacts[from + 1..=to].iter().map(|c| c.static_overlap).sum();
        lengths - overlaps
    }

    /// Distance from a particle's centre to the wall at the bottom, overlaps subtracted (m).
    pub fn distance_to_wall(&self, particle: usize) -> f64 {
        let body = self.body_of(particle);
        let half = self.bodies.get(body).map_or(0.0, |b| 0.5 * b.length);
        let below: f64 = self.bodies[body + 1..].iter().map(|b| b.length).sum();
        let overlaps: f64 = self.contacts[body + 1..].iter().map(|c| c.static_overlap).sum();
        half + below - overlaps
    }
}
