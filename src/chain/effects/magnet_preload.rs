//! A magnet that pulls one ferromagnetic particle: with a constant force, or as a ring or a
//! measured table says.
//!
//! The constant force is what the paper's calculations use. Source: Herbold et al. (2009), section
//! II; Daraio et al., Phys. Rev. E 73, 026610 (2006). The other two stand in `crate::magnet`; in
//! the static state they are a constant force as well, and [`super::MagnetLaw`] lets them change as
//! the particle moves.

use super::Effect;
use crate::magnet::Magnet;
use crate::quantity::engineering;

/// What a temperature in kelvin is above one in degrees Celsius.
const ZERO_CELSIUS: f64 = 273.15;

/// `[effects.magnet_preload]`
#[derive(Debug, Clone, PartialEq)]
pub struct MagnetPreload {
    /// The particle it acts on, counted from 1 at the top.
    pub particle: usize,
    /// Its force, downward positive.
    pub force: MagnetForce,
}

/// How hard a magnet pulls.
#[derive(Debug, Clone, PartialEq)]
pub enum MagnetForce {
    /// The same everywhere (N).
    Constant(f64),
    /// As a magnet does at its place.
    Placed(PlacedMagnet),
}

/// A ring or a measured table at its place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedMagnet {
    /// The magnet.
    pub magnet: Magnet,
    /// Its temperature (K).
    pub temperature: f64,
    /// Distance of the particle's centre from its face.
    pub at: PlacedAt,
}

/// When the distance from the magnet's face was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlacedAt {
    /// In the static state, all loads on (m).
    Rest(f64),
    /// With bodies that only touch, before anything presses (m).
    Unloaded(f64),
    /// Where it pulls with this force in the static state.
    Pull {
        /// The force (N).
        force: f64,
        /// The distance that it follows from (m).
        distance: f64,
    },
}

impl PlacedMagnet {
    /// Moves the magnet to where it pulls with `force` (N) at rest, of several places to the
    /// nearest to where it was.
    pub fn moved_to(&self, force: f64, present: f64) -> Option<Self> {
        let places = self.magnet.distances(force, self.temperature);
        let nearest = places
            .into_iter()
            .min_by(|a, b| (a - present).abs().total_cmp(&(b - present).abs()))?;
        Some(Self { at: PlacedAt::Rest(nearest), ..self.clone() })
    }
}

impl Effect for MagnetPreload {
    fn name(&self) -> &'static str {
        "magnet_preload"
    }

    fn summary(&self) -> String {
        match &self.force {
            MagnetForce::Constant(force) => {
                format!("{} on particle {}", engineering(*force, "N", 4), self.particle)
            }
            MagnetForce::Placed(PlacedMagnet { magnet, temperature, at }) => {
                let (distance, when) = match at {
                    PlacedAt::Rest(distance) | PlacedAt::Pull { distance, .. } => {
                        (distance, "at rest")
                    }
                    PlacedAt::Unloaded(distance) => (distance, "before anything presses"),
                };
                let distance = engineering(*distance, "m", 4);
                let (name, particle) = (&magnet.name, self.particle);
                let celsius = temperature - ZERO_CELSIUS;
                format!(
                    "{name}, its face {distance} from particle {particle} {when}, at {celsius:.1} °C"
                )
            }
        }
    }
}
