//! The force at a probe over one step of any method.

use std::sync::Arc;

use super::hermite::{COEFFICIENTS, Interpolant, derivative, horner};
use super::integrator::Integrator;
use crate::chain::probe::{Around, CONTACTS};
use crate::chain::{ForceProbe, Past};

/// The probe's view of the integrator's last step, whose interpolation is prepared.
pub fn over_step(probe: &ForceProbe, integrator: &dyn Integrator, bodies: usize) -> ForceSegment {
    let here = probe.body();
    let (start, length) = integrator.last_step();
    // Beside the outermost bodies are walls.
    let motion = |index: Option<usize>| match index {
        None => integrator.wall(0),
        Some(index) if index < bodies => integrator.interpolant(index),
        Some(_) => integrator.wall(1),
    };
    let beyond = |is_there: bool, index: Option<usize>| {
        if is_there && probe.is_lossy() { motion(index) } else { Interpolant::REST }
    };
    let along = [
        beyond(here > 0, here.checked_sub(2)),
        motion(here.checked_sub(1)),
        motion(Some(here)),
        motion(Some(here + 1)),
        beyond(here + 1 < bodies, Some(here + 2)),
    ];
    let slope = |wall: &Interpolant, is_beside: bool| {
        if is_beside { derivative(&wall.velocity, length) } else { [0.0; COEFFICIENTS] }
    };
    let walls = [slope(&along[1], here == 0), slope(&along[3], here + 1 == bodies)];
    let past = [here.wrapping_sub(1), here, here + 1, here + 2].map(|contact| {
        let account = probe.around().plastic.filter(|_| contact <= bodies);
        let largest = account.map(|first| integrator.interpolant(first + contact).velocity(0.0));
        Past { closed: integrator.was_on(contact), largest: largest.unwrap_or(0.0) }
    });
    let pull = probe.around().pull.as_ref().filter(|_| probe.is_lossy());
    let pulled = pull.map(|(place, _)| Box::new(along[place + 1]));
    let anew = integrator.starts_anew();
    let (motion, around) = (Motion::between(&along), Arc::clone(probe.around()));
    ForceSegment { around, start, length, motion, walls, pulled, past, anew }
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
    /// Accelerations of walls beside the probe's body: coefficients of the powers of the step's
    /// fraction (m/s²).
    walls: [[f64; COEFFICIENTS]; 2],
    /// The body that a magnet pulls as it moves.
    pulled: Option<Box<Interpolant>>,
    /// Whether each contact counted as closed, and its largest overlap before.
    past: [Past; CONTACTS],
    /// Whether a switch has changed just before the step: the force may have jumped.
    pub anew: bool,
}

impl ForceSegment {
    /// Dynamic force, the static one subtracted, at the fraction `theta` of the step (N).
    pub fn force(&self, theta: f64) -> f64 {
        let [changes, closing] = self.motion.at(theta);
        let Around { contacts, weights, .. } = &*self.around;
        let of = |i: usize| contacts[i].lossy_force_change(changes[i], closing[i], self.past[i]);
        weights[0] * of(1) + weights[1] * of(2)
    }

    /// Its rate of change at the fraction `theta` of the step (N/s).
    pub fn rate(&self, theta: f64) -> f64 {
        self.force_and_rate(theta)[1]
    }

    /// Both. What closing speeds gain follows from the forces, for an interpolant's second
    /// derivative is nothing but rounding on the shortest steps (N, N/s).
    pub fn force_and_rate(&self, theta: f64) -> [f64; 2] {
        let [changes, closing] = self.motion.at(theta);
        let Around { contacts, weights, is_lossy, inertia, .. } = &*self.around;
        let felt =
            |i: usize| contacts[i].lossy_change_and_slopes(changes[i], closing[i], self.past[i]);
        let [(above, slopes_above), (below, slopes_below)] = [felt(1), felt(2)];
        let force = weights[0] * above + weights[1] * below;
        let mut gained = [0.0; 2];
        if *is_lossy {
            let beyond =
                |i: usize| contacts[i].lossy_force_change(changes[i], closing[i], self.past[i]);
            let forces = [beyond(0), above, below, beyond(3)];
            let [upper, here, lower] = [0, 1, 2].map(|i| {
                let (inverse_mass, rest) = inertia[i];
                (forces[i] - forces[i + 1] + self.pull(i, theta)) * inverse_mass + rest
            });
            let [top, bottom] = self.walls.each_ref().map(|wall| horner(wall, theta));
            gained = [upper + top - here, here - lower - bottom];
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
