//! Distances along the chain at rest, for `run`, `arrivals`, `compare`, sweeps and the screen's
//! cursors.
//!
//! `d = sum of lengths - sum of static overlaps + o2 L2 - o1 L1`, offsets `o` of the plates in
//! lengths `L` of their hosts, downward positive. `Scene::distance` adds the uncertainty.

use crate::chain::Chain;

/// Host of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Site {
    /// Embedded in a particle, counted from 1.
    Particle(usize),
    /// Between the last particle and the wall.
    Wall,
}

/// Place of a plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlatePlace {
    /// Its host.
    pub site: Site,
    /// Distance from the host's centre in lengths of the host, downward positive (1).
    pub offset: f64,
    /// Standard uncertainty of the offset (1).
    pub offset_u: f64,
}

impl PlatePlace {
    /// Height above the bottom wall; `None` for a particle beyond the chain (m).
    fn height(self, chain: &Chain) -> Option<f64> {
        let Site::Particle(particle) = self.site else { return Some(0.0) };
        if !(1..=chain.particles()).contains(&particle) {
            return None;
        }
        let length = chain.bodies().get(chain.body_of(particle))?.length;
        Some(chain.distance_to_wall(particle) - self.offset * length)
    }

    /// Derivative of the height by the length of `particle` (1).
    ///
    /// It leaves out that static overlaps change, too: by a third of overlap over diameter, less
    /// than a thousandth.
    pub(super) fn height_per_length(self, particle: usize) -> f64 {
        match self.site {
            Site::Particle(host) if host == particle => 0.5 - self.offset,
            Site::Particle(host) if host < particle => 1.0,
            _ => 0.0,
        }
    }
}

/// Distance down `chain` at rest between two plates, negative upward (m).
pub fn distance(chain: &Chain, from: PlatePlace, to: PlatePlace) -> Option<f64> {
    Some(from.height(chain)? - to.height(chain)?)
}
