//! The chain: bodies in a row, Hertz contacts between neighbours, and the static state they start from.
//!
//! Stands between `scene`, which describes it, and `integrate`, which moves it. Body 0 is the striker where
//! there is one; contact `j` lies between bodies `j - 1` and `j`, contact 0 and the last one touch the boundaries.
//! State is the displacement from static equilibrium, downward positive: 0.3 m of chain has an ulp that is 1e-8 of
//! a 5 nm overlap, so absolute positions never appear.
//!
//! Statics is exact: every contact force is the sum of the loads above it, `N[j+1] = N[j] + load[j]`, and every
//! overlap follows from its force in closed form.

mod contact;
mod damping;
mod dissipative;
pub mod effects;
mod energy;
mod error;
pub mod hertz;
mod impact;
mod kernel;
mod ledger;
pub mod loss;
mod probe;
pub mod stepper;
mod system;

pub use contact::{Contact, Law};
pub use dissipative::DissipativeSystem;
pub use effects::{
    ContactOverride, Dashpot, Effect, EffectsSpec, Gravity, KuwabaraKono, LinearisedContacts,
    LossSpec, MagnetPreload, PowerLawLoss,
};
pub use energy::Energy;
pub use error::ChainError;
pub use hertz::Elasticity;
pub use impact::StabilityLimit;
pub use ledger::Dissipated;
pub use loss::{ContactLoss, EndOfContact};
pub use probe::{ForceProbe, ForceSegment};
pub use system::ChainSystem;

/// A rigid body with two elastic faces.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// What the scene calls it.
    pub name: String,
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
    bodies: Vec<Body>,
    contacts: Vec<Contact>,
    /// Force on each body that the static contacts do not balance: the striker's weight (N).
    residual: Vec<f64>,
    striker: bool,
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
        let loads = loads(spec, &bodies);
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
        Ok(Self { bodies, contacts, residual, striker })
    }

    /// The bodies from top to bottom, the striker first.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The contacts from top to bottom: one more than bodies, those with the boundaries included.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Smallest mass of its bodies (kg).
    #[must_use]
    pub fn lightest(&self) -> f64 {
        self.bodies.iter().fold(f64::INFINITY, |least, body| least.min(body.mass))
    }

    /// Number of particles; the striker is none.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.bodies.len() - usize::from(self.striker)
    }

    /// Whether body 0 is a striker.
    #[must_use]
    pub fn has_striker(&self) -> bool {
        self.striker
    }

    /// Index of the body that is particle `particle`, counted from 1.
    #[must_use]
    pub fn body_of(&self, particle: usize) -> usize {
        particle - usize::from(!self.striker)
    }

    /// Index of the contact with the wall at the bottom, if there is one.
    #[must_use]
    pub fn wall_contact(&self) -> Option<usize> {
        let last = self.contacts.len() - 1;
        self.contacts.get(last).filter(|c| c.stiffness > 0.0).map(|_| last)
    }

    /// Static distance between the centres of two particles, overlaps subtracted (m).
    #[must_use]
    pub fn distance(&self, upper: usize, lower: usize) -> f64 {
        let (from, to) = (self.body_of(upper.min(lower)), self.body_of(upper.max(lower)));
        let between = |pair: &[Body]| pair.iter().map(|b| 0.5 * b.length).sum::<f64>();
        let lengths: f64 = self.bodies[from..=to].windows(2).map(between).sum();
        let overlaps: f64 = self.contacts[from + 1..=to].iter().map(|c| c.static_overlap).sum();
        lengths - overlaps
    }

    /// Distance from a particle's centre to the wall at the bottom, overlaps subtracted (m).
    #[must_use]
    pub fn distance_to_wall(&self, particle: usize) -> f64 {
        let body = self.body_of(particle);
        let half = self.bodies.get(body).map_or(0.0, |b| 0.5 * b.length);
        let below: f64 = self.bodies[body + 1..].iter().map(|b| b.length).sum();
        let overlaps: f64 = self.contacts[body + 1..].iter().map(|c| c.static_overlap).sum();
        half + below - overlaps
    }
}

/// Constant force on each body from effects and end forces, downward positive (N).
fn loads(spec: &ChainSpec, bodies: &[Body]) -> Vec<f64> {
    let masses: Vec<f64> = bodies.iter().map(|b| b.mass).collect();
    let mut loads = vec![0.0; bodies.len()];
    for effect in spec.effects.active() {
        effect.add_load(&masses, spec.striker.is_some(), &mut loads);
    }
    // Below a striker the end force has no face of its own to press on: it pulls on particle 1.
    if let (End::Force(force), true, Some(load)) =
        (spec.top, spec.striker.is_some(), loads.get_mut(1))
    {
        *load += force;
    }
    loads
}

/// Contact `j`, between bodies `j - 1` and `j`, under the static force `bears` (N).
fn contact(spec: &ChainSpec, bodies: &[Body], j: usize, bears: f64) -> Result<Contact, ChainError> {
    let side = |body: &Body| (body.elasticity, body.curvature, body.name.clone());
    let wall = |end: &End, name: &str| match end {
        End::Wall(elasticity) => Some((*elasticity, 0.0, name.to_owned())),
        End::Free | End::Force(_) => None,
    };
    let upper = match j.checked_sub(1) {
        Some(above) => bodies.get(above).map(side),
        None => wall(&spec.top, "the top wall"),
    };
    let lower = bodies.get(j).map(side).or_else(|| wall(&spec.bottom, "the bottom wall"));
    let (Some(upper), Some(lower)) = (upper, lower) else {
        return open_end(spec, bodies, j, bears);
    };
    let stiffness = hertz::stiffness((upper.0, upper.1), (lower.0, lower.1));
    if !stiffness.is_finite() {
        return Err(ChainError::FlatOnFlat { upper: upper.2, lower: lower.2 });
    }
    if bears < 0.0 {
        return Err(ChainError::Pulling { body: lower.2, force: bears });
    }
    let law = match spec.effects.linearised_contacts {
        Some(LinearisedContacts) if bears == 0.0 => {
            return Err(ChainError::NothingToLinearise { body: lower.2 });
        }
        Some(LinearisedContacts) => Law::Linearised,
        None => Law::Hertz,
    };
    let static_overlap = hertz::overlap(stiffness, bears);
    let short =
        |name: &'_ str| if name.ends_with(" wall") { "wall".to_owned() } else { name.to_owned() };
    let yields = |body: Option<&Body>| body.and_then(|body| body.yield_strength);
    let strengths = [yields(j.checked_sub(1).and_then(|i| bodies.get(i))), yields(bodies.get(j))];
    let softest = strengths.into_iter().flatten().reduce(f64::min);
    let yield_force = softest
        .map(|strength| hertz::first_yield((upper.0, upper.1), (lower.0, lower.1), strength));
    let loss = spec.effects.loss_between(&short(&upper.2), &short(&lower.2));
    if loss.is_some() && law == Law::Linearised {
        return Err(ChainError::LossWithoutEnd { body: lower.2 });
    }
    Ok(Contact { stiffness, static_force: bears, static_overlap, law, loss, yield_force })
}

/// The place of a contact where nothing stands; at the bottom the loads must have cancelled.
fn open_end(
    spec: &ChainSpec,
    bodies: &[Body],
    j: usize,
    bears: f64,
) -> Result<Contact, ChainError> {
    if j == bodies.len() {
        let support = if let End::Force(force) = spec.bottom { force } else { 0.0 };
        let rest = bears - support;
        if rest.abs() > 1e-12 * (bears.abs() + support.abs()) {
            return Err(ChainError::Unbalanced { rest });
        }
    }
    // An end force presses on the outermost face without giving: a plate next to it feels it.
    Ok(Contact { static_force: bears, ..Contact::OPEN })
}
