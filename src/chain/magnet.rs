//! The magnet of a chain: where and how hard it pulls at rest, and its pull on a particle that
//! moves in its field.
//!
//! The particle's distance from the magnet's face is `d = d0 - u`, `d0` at rest, `u` its
//! displacement, downward positive like the attraction: the force `F(d0 - u)` is a spring of
//! stiffness `F'(d0)`, negative where the attraction falls with distance. At rest `F(d0)` is a load
//! like any other. Where instead the distance `D` of the unloaded chain is known, the particle
//! sinks by all overlaps below it, and the static force is the smallest root of
//! `F(D - sum (N_j(F)/A_j)^(2/3)) = F`.

use super::effects::{MagnetForce, MagnetPreload, PlacedAt, PlacedMagnet};
use super::statics::contact;
use super::{Body, ChainError, ChainSpec, Contact, End};
use crate::magnet::{ForceLaw, ForceTable, RingField, Sphere};

/// Forces at which a static state is looked for.
const SAMPLES: u32 = 1000;
/// Halvings of the interval in which one is found: to the last bit.
const HALVINGS: usize = 60;

/// A magnet at a particle, in the static state.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainMagnet {
    /// Index of the body it pulls.
    pub body: usize,
    /// Static force, downward positive (N).
    pub force: f64,
    /// Its change with displacement and the place, where a magnet is described and not only its
    /// force.
    pub pull: Option<Pull>,
}

/// A force that depends on how far its particle has moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Pull {
    /// Distance of the particle's centre from the magnet's face at rest (m).
    pub distance: f64,
    field: Field,
    rest_force: f64,
    rest_energy: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Field {
    /// A ring, the sphere, and half the ring's length (m).
    Ring(RingField, Sphere, f64),
    Measured(ForceTable),
}

impl Field {
    fn of(placed: &PlacedMagnet) -> Option<Self> {
        match &placed.magnet.law {
            ForceLaw::Constant(_) => None,
            ForceLaw::Ring(ring, sphere) => {
                Some(Self::Ring(ring.at(placed.temperature), *sphere, 0.5 * ring.length))
            }
            ForceLaw::Measured(table) => Some(Self::Measured(table.clone())),
        }
    }

    /// Attraction toward the face, held beyond the ends of a table (N).
    fn force(&self, distance: f64) -> f64 {
        match self {
            Self::Ring(field, sphere, half) => field.pull(half + distance, sphere),
            Self::Measured(table) => table.held_force(distance),
        }
    }

    fn slope(&self, distance: f64) -> f64 {
        match self {
            Self::Ring(field, sphere, half) => field.pull_slope(half + distance, sphere),
            Self::Measured(table) => table.slope(distance).unwrap_or(0.0),
        }
    }

    fn energy(&self, distance: f64) -> f64 {
        match self {
            Self::Ring(field, sphere, half) => field.energy(half + distance, sphere),
            Self::Measured(table) => table.integral(distance),
        }
    }
}

impl Pull {
    fn new(field: Field, distance: f64) -> Self {
        let (rest_force, rest_energy) = (field.force(distance), field.energy(distance));
        Self { distance, field, rest_force, rest_energy }
    }

    /// Change of the force at the displacement `u` (m) from rest, downward positive (N).
    pub fn change(&self, u: f64) -> f64 {
        self.field.force(self.distance - u) - self.rest_force
    }

    /// Its slope against the displacement `u` (m) (N/m).
    pub fn slope(&self, u: f64) -> f64 {
        -self.field.slope(self.distance - u)
    }

    /// Energy of the particle at the displacement `u` (m), zero at rest (J).
    pub fn energy(&self, u: f64) -> f64 {
        self.field.energy(self.distance - u) - self.rest_energy
    }

    /// Distances between which the law is known (m).
    pub fn known(&self) -> [f64; 2] {
        match &self.field {
            Field::Ring(..) => [f64::NEG_INFINITY, f64::INFINITY],
            Field::Measured(table) => table.span(),
        }
    }
}

impl ChainMagnet {
    /// The magnet that `spec` calls for, at rest on `bodies` under these other `loads` (N).
    pub(super) fn at_rest(
        spec: &ChainSpec,
        bodies: &[Body],
        loads: &[f64],
    ) -> Result<Option<Self>, ChainError> {
        let Some(MagnetPreload { particle, force }) = &spec.effects.magnet_preload else {
            return Ok(None);
        };
        let body = particle - usize::from(spec.striker.is_none());
        let placed = match force {
            MagnetForce::Constant(force) => {
                return Ok(Some(Self { body, force: *force, pull: None }));
            }
            MagnetForce::Placed(placed) => placed,
        };
        let Some(field) = Field::of(placed) else { return Ok(None) };
        let reach = |distance| placed.magnet.force(distance, placed.temperature);
        let beyond = |distance| ChainError::MagnetBeyondTable { distance };
        let column = Column::below(body, spec, bodies, loads)?;
        let (distance, force) = match placed.at {
            PlacedAt::Rest(distance) | PlacedAt::Pull { distance, .. } => {
                (distance, reach(distance).ok_or(beyond(distance))?)
            }
            PlacedAt::Unloaded(distance) => column.settle(&field, distance)?,
        };
        reach(distance).ok_or(beyond(distance))?;
        column.holds(-field.slope(distance), force)?;
        Ok(Some(Self { body, force, pull: Some(Pull::new(field, distance)) }))
    }

    /// Energy of its body at the displacement `u` (m), zero at rest; `follows` tells whether the
    /// force changes on the way (J).
    pub(super) fn energy(&self, u: f64, follows: bool) -> f64 {
        match &self.pull {
            Some(pull) if follows => pull.energy(u),
            _ => -self.force * u,
        }
    }
}

/// The contacts below the magnet's body, down to a wall.
struct Column {
    /// Each, and what it bears without the magnet (N).
    contacts: Vec<(Contact, f64)>,
    wall: bool,
}

impl Column {
    fn below(
        body: usize,
        spec: &ChainSpec,
        bodies: &[Body],
        loads: &[f64],
    ) -> Result<Self, ChainError> {
        let wall = matches!(spec.bottom, End::Wall(_));
        let first = usize::from(spec.striker.is_some());
        let top = match spec.top {
            End::Wall(_) => spec.wall_preload,
            End::Force(force) if first == 0 => force,
            End::Force(_) | End::Free => 0.0,
        };
        let mut contacts = Vec::new();
        if wall {
            for j in body + 1..=bodies.len() {
                let bears = top + loads[first..j].iter().sum::<f64>();
                // Any force that presses tells the law.
                contacts.push((contact(spec, bodies, j, 1.0)?, bears));
            }
        }
        Ok(Self { contacts, wall })
    }

    /// How far the column gives under the magnet's `force` (N) and all other loads (m).
    fn sinks(&self, force: f64) -> f64 {
        let overlap =
            |(contact, bears): &(Contact, f64)| contact.overlap_under((bears + force).max(0.0));
        self.contacts.iter().map(overlap).sum()
    }

    /// Distance and force at rest of a body that stands at `distance` (m) before anything presses.
    fn settle(&self, field: &Field, distance: f64) -> Result<(f64, f64), ChainError> {
        if !self.wall {
            return Err(ChainError::MagnetWithoutWall);
        }
        let excess = |force: f64| field.force(distance - self.sinks(force)) - force;
        let most = (0..=SAMPLES)
            .map(|i| field.force(distance - self.sinks(1.0) * f64::from(i) / f64::from(SAMPLES)))
            .fold(0.0, f64::max);
        let look = |i: u32| 2.0 * most * f64::from(i) / f64::from(SAMPLES);
        let found = (0..SAMPLES).find(|i| excess(look(*i)) > 0.0 && excess(look(i + 1)) <= 0.0);
        let Some(found) = found else { return Err(ChainError::MagnetSnaps { distance }) };
        let (mut low, mut high) = (look(found), look(found + 1));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if excess(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok((distance - self.sinks(high), high))
    }

    /// Refuses a magnet whose pull grows by more a way (N/m) than the column does under its `force`
    /// (N).
    fn holds(&self, growth: f64, force: f64) -> Result<(), ChainError> {
        let gives = |(contact, bears): &(Contact, f64)| {
            let overlap = contact.overlap_under((bears + force).max(0.0));
            1.0 / contact.stiffness_at(overlap)
        };
        let stiffness = 1.0 / self.contacts.iter().map(gives).sum::<f64>();
        if self.wall && growth > stiffness {
            return Err(ChainError::MagnetUnstable { growth, stiffness });
        }
        Ok(())
    }
}
