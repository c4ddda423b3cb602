//! How fast contacts are, for steps of two lengths.

use super::{Chain, hertz};
use crate::integrate::Pacing;
use crate::integrate::two_step::StiffContact;

/// A contact and its bodies, as the coming impact finds it.
#[derive(Debug, Clone, Copy)]
struct Spring {
    /// Stiffness (N/m).
    stiffness: f64,
    /// Inverse mass of the body above (1/kg).
    above: f64,
    /// Of the one below (1/kg).
    below: f64,
}

impl Spring {
    /// Square of its angular frequency between its two bodies (1/s²).
    fn square(&self) -> f64 {
        self.stiffness * (self.above + self.below)
    }
}

impl Chain {
    /// How fast the chain is when its bodies have these velocities (m/s): each contact at its static overlap and that of a collision at the
    /// largest speed besides.
    ///
    /// What overlaps do to each other's accelerations, `K_j (1/m_above + 1/m_below)` and `K_(j-1)/m_above`, `K_(j+1)/m_below`, has no eigenvalue above the
    /// largest sum of a row's magnitudes: the square of the frequency that is told. For a long chain of two kinds of bodies that is the highest.
    pub fn pacing(&self, velocity: &[f64]) -> Pacing {
        let mut springs = self.springs(velocity);
        let squares = springs.iter().map(Spring::square).enumerate();
        let stiffest = squares.max_by(|a, b| a.1.total_cmp(&b.1));
        let none = |springs: &[Spring]| Pacing { frequency: highest(springs).sqrt(), stiff: None };
        let Some((j, square)) = stiffest else { return none(&springs) };
        let stiffness = std::mem::take(&mut springs[j].stiffness);
        let (frequency, own) = (highest(&springs).sqrt(), square.sqrt());
        // In a chain of contacts that are all alike it is the root of 1/2 of it.
        if own <= frequency {
            springs[j].stiffness = stiffness;
            return none(&springs);
        }
        let bodies = [j.checked_sub(1), Some(j).filter(|j| *j < self.bodies.len())];
        let static_overlap = self.contacts[j].static_overlap;
        Pacing { frequency, stiff: Some(StiffContact { bodies, static_overlap, frequency: own }) }
    }

    fn springs(&self, velocity: &[f64]) -> Vec<Spring> {
        let speed = velocity.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let inverse_masses = self.bodies.iter().map(|body| 1.0 / body.mass).chain([0.0]);
        // Of one kind after another: neighbours are mostly alike.
        let (mut above, mut last) = (0.0, ([0; 2], 0.0));
        let spring = |(contact, below): (&super::Contact, f64)| {
            let above = std::mem::replace(&mut above, below);
            let (stiffness, mobility) = (contact.stiffness, above + below);
            let kind = [stiffness, mobility].map(f64::to_bits);
            if kind != last.0 && stiffness > 0.0 {
                last = (kind, hertz::collision_overlap(stiffness, 1.0 / mobility, speed));
            }
            let stiffness = contact.tangent_stiffness(last.1);
            Spring { stiffness, above, below }
        };
        self.contacts.iter().zip(inverse_masses).map(spring).collect()
    }
}

/// A bound of the square of the highest angular frequency (1/s²).
fn highest(springs: &[Spring]) -> f64 {
    let beside = |j: Option<usize>| j.and_then(|j| springs.get(j)).map_or(0.0, |s| s.stiffness);
    let sum = |(j, spring): (usize, &Spring)| {
        let above = beside(j.checked_sub(1)) * spring.above;
        spring.square() + above + beside(Some(j + 1)) * spring.below
    };
    springs.iter().enumerate().map(sum).fold(0.0, f64::max)
}
