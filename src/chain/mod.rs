//! The chain: bodies in a row, Hertz contacts between neighbours, and the static state they start
//! from.
//!
//! Stands between `scene`, which describes it, and `integrate`, which moves it. Body 0 is the
//! striker where there is one; contact `j` lies between bodies `j - 1` and `j`, contact 0 and the
//! last one touch the boundaries. State is the displacement from static equilibrium, downward
//! positive: 0.3 m of chain has an ulp that is 1e-8 of a 5 nm overlap, so absolute positions never
//! appear.
//!
//! Statics is exact: every contact force is the sum of the loads above it,
//! `N[j+1] = N[j] + load[j]`, and every overlap follows from its force in closed form.

mod contact;
pub mod effects;
mod energy;
mod error;
pub mod hertz;
mod ledger;
pub mod loss;
mod magnet;
mod probe;
pub mod probe_step;
pub mod simd;
mod stability;
mod statics;
mod system;

pub use contact::{Contact, Law};
pub use effects::{
    ContactOverride, EffectsSpec, Gravity, LOSS_MODELS, LinearisedContacts, LossKind, LossModel,
    LossSpec, MagnetForce, MagnetLaw, MagnetPreload, PlacedAt, PlacedMagnet,
};
pub use energy::Energy;
pub use error::ChainError;
pub use hertz::Elasticity;
pub use ledger::Dissipated;
pub use loss::{ContactLoss, EndOfContact};
pub use magnet::{ChainMagnet, Pull};
pub use probe::{ForceProbe, ForceSegment};
pub use stability::StabilityLimit;
pub use system::{ACCOUNTS, ChainSystem};

use std::sync::Arc;

use statics::{contact, loads};

/// A rigid body with two elastic faces.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// What the scene calls it; bodies of a kind have it in common.
    pub name: Arc<str>,
    /// Mass (kg).
    pub mass: f64,
    /// Extent along the chain (m).
    pub length: f64,
    /// Curvature of its faces, `1/R`; 0 is flat (1/m).
    pub curvature: f64,
    /// Elastic constants.
    pub elasticity: Elasticity,
    /// Uniaxial stress at which the material yields; none where that is not known (Pa).
    pub yield_strength: Option<f64>,
}

impl Body {
    /// The same shape and material, so many times as large (1).
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            mass: self.mass * factor.powi(3),
            length: self.length * factor,
            curvature: self.curvature / factor,
            ..self.clone()
        }
    }

    /// Whether the other is of the same kind and size; their masses may differ by what sits in
    /// them.
    pub fn is_alike(&self, other: &Self) -> bool {
        let shape = |body: &Self| [body.length.to_bits(), body.curvature.to_bits()];
        self.name == other.name && shape(self) == shape(other)
    }

    /// Whether it and the two after it are two kinds in turn, or of one kind and size.
    pub fn repeats_after(&self, second: &Self, third: &Self) -> bool {
        self.is_alike(third) && (self.name != second.name || self.is_alike(second))
    }
}

/// What stands at an end of the chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// Nothing.
    Free,
    /// A constant force that presses on the outermost particle, along the chain (N).
    Force(f64),
    /// A flat, immovable wall.
    Wall(Elasticity),
}

/// Everything that defines a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainSpec {
    /// The body that hits particle 1, if any.
    pub striker: Option<Body>,
    /// The particles from top to bottom.
    pub particles: Vec<Body>,
    /// What stands above particle 1.
    pub top: End,
    /// What stands below the last particle.
    pub bottom: End,
    /// Force with which a top wall presses in the static state (N).
    pub wall_preload: f64,
    /// Optional physics.
    pub effects: EffectsSpec,
}

/// A chain in static equilibrium, the striker at rest where it first touches.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    // Clones have these in common.
    bodies: Arc<[Body]>,
    contacts: Arc<[Contact]>,
    /// Force on each body that the static contacts do not balance: the striker's weight (N).
    residual: Arc<[f64]>,
    striker: bool,
    /// Acceleration of free fall (m/s²).
    gravity: f64,
    /// Forces that press on the first particle and against the last one (N).
    ends: [f64; 2],
    magnet: Option<ChainMagnet>,
    /// Whether the magnet's force changes as its particle moves.
    follows: bool,
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
        !self.is_dissipative() && self.pull().is_none()
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
