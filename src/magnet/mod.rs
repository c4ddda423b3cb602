//! Magnets that press the chain: the force on a ferromagnetic sphere over its distance.
//!
//! Stands beside `chain`: `scene` reads the files of `instruments/magnets`, `cli` answers questions
//! about them. Distance is that of the sphere's centre from the plane of the magnet's face, along
//! the axis, positive outside; a force is positive where the magnet attracts. `chain` lets a sphere
//! that moves feel it. A constant force is what the paper's calculations use; a ring's force falls
//! by 1.4 to 3.9 N a millimetre, nothing against the contacts' stiffness, but 3 to 8 % of 2.38 N
//! over 50 um of travel.

mod ring;
mod table;

pub use ring::{RingField, RingMagnet, Sphere, VACUUM_PERMEABILITY};
pub use table::{ForceTable, TableError};

use crate::numeric::roots::root;

/// Places at which a law is looked at to find where it takes a force.
const LAW_SAMPLES: u32 = 4000;

/// Temperature of a magnet whose file tells none (K).
const ROOM_TEMPERATURE: f64 = 293.15;

/// How a magnet's force depends on distance.
#[derive(Debug, Clone, PartialEq)]
pub enum ForceLaw {
    /// The same everywhere (N).
    Constant(f64),
    /// A ring and a soft sphere on its axis.
    Ring(RingMagnet, Sphere),
    /// Measured forces.
    Measured(ForceTable),
}

/// A magnet as its file describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Magnet {
    /// Name of its file.
    pub name: String,
    /// Where its numbers come from.
    pub source: String,
    /// The force.
    pub law: ForceLaw,
}

impl Magnet {
    /// Distances over which the law holds or is of interest: from the middle of a ring to an outer
    /// diameter from its face; a table's own; a constant force is shown over a millimetre (m).
    pub fn span(&self) -> [f64; 2] {
        match &self.law {
            ForceLaw::Constant(_) => [0.0, 1e-3],
            ForceLaw::Ring(ring, _) => [-0.5 * ring.length, 2.0 * ring.outer_radius],
            ForceLaw::Measured(table) => table.span(),
        }
    }

    /// Attraction at `distance` (m) and `temperature` (K), none outside a table (N).
    pub fn force(&self, distance: f64, temperature: f64) -> Option<f64> {
        match &self.law {
            ForceLaw::Constant(force) => Some(*force),
            ForceLaw::Ring(ring, sphere) => {
                let field = ring.at(temperature);
                Some(field.attraction(0.5 * ring.length + distance, sphere))
            }
            ForceLaw::Measured(table) => table.force(distance),
        }
    }

    /// Change of the force with distance at `distance` (m) and `temperature` (K), none outside a
    /// table (N/m).
    pub fn slope(&self, distance: f64, temperature: f64) -> Option<f64> {
        match &self.law {
            ForceLaw::Constant(_) => Some(0.0),
            ForceLaw::Ring(ring, sphere) => {
                let z = 0.5 * ring.length + distance;
                Some(ring.at(temperature).pull_slope(z, sphere) * z.signum())
            }
            ForceLaw::Measured(table) => table.slope(distance),
        }
    }

    /// Temperature at which its numbers hold: that of a ring's remanence, room temperature of
    /// others (K).
    pub fn stated_temperature(&self) -> f64 {
        match &self.law {
            ForceLaw::Ring(ring, _) => ring.reference_temperature,
            ForceLaw::Constant(_) | ForceLaw::Measured(_) => ROOM_TEMPERATURE,
        }
    }

    /// Lowest temperature at which a ring is no magnet: the Curie temperature of its material, or
    /// the one at which its stated coefficient leaves no remanence; infinite for others (K).
    pub fn temperature_limit(&self) -> f64 {
        let ForceLaw::Ring(ring, _) = &self.law else { return f64::INFINITY };
        if ring.temperature_coefficient < 0.0 {
            let zero = ring.reference_temperature - 1.0 / ring.temperature_coefficient;
            zero.min(ring.curie_temperature)
        } else {
            ring.curie_temperature
        }
    }

    /// Distances within the span at which the magnet attracts with `force` (N), the one nearest to
    /// the face first (m).
    pub fn distances(&self, force: f64, temperature: f64) -> Vec<f64> {
        let [near, far] = self.span();
        let place = |look: u32| near + (far - near) * f64::from(look) / f64::from(LAW_SAMPLES);
        let excess = |distance: f64| self.force(distance, temperature).map(|f| f - force);
        let mut found: Vec<f64> = (0..LAW_SAMPLES)
            .filter_map(|look| {
                let (low, high) = (place(look), place(look + 1));
                let (before, after) = (excess(low)?, excess(high)?);
                let crosses = (before > 0.0) != (after > 0.0);
                crosses.then(|| root(&|d| excess(d).unwrap_or(0.0), [low, high], [before, after]))
            })
            .collect();
        found.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        found
    }
}
