//! What corrections of kinks ([`super::kinks`]) add to the error estimate: a share of themselves, and of what the quintic does not know.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::Lanes;
use super::lone::Lone;

/// Share of a correction that is counted as error: residuals measured on the shipped scenes stayed below (1).
pub const CORRECTION_SHARE: f64 = 0.01;
/// Share of the quintic's own uncertainty that is counted as error (1).
pub const MODEL_SHARE: f64 = 0.1;
/// How long it has to move bodies, as a share of the step (1).
pub const LATE: f64 = 0.3;

/// What corrections add to the error estimate, lane by lane.
#[derive(Clone, Copy)]
pub struct Guard<L: Lanes> {
    /// Of positions (m).
    pub position: L::V,
    /// Of velocities (m/s).
    pub velocity: L::V,
    /// Largest change of a position (m).
    pub moved: L::V,
}

impl<L: Lanes> Guard<L> {
    /// Nothing.
    #[inline(always)]
    pub fn none() -> Self {
        let none = L::splat(0.0);
        Self { position: none, velocity: none, moved: none }
    }

    /// What the correction of one contact adds, whose bodies are so mobile (1/kg), in a step of `h` (s): as [`super::kinks`] has it for rows of them.
    #[inline(always)]
    pub fn alone(&mut self, lone: &Lone, mobility: [f64; 2], h: f64) {
        let lighter = mobility[0].max(-mobility[1]);
        let [shift, kick] = [lone.pushes[0].abs(), lone.pushes[1].abs()];
        let model = MODEL_SHARE * lone.uncertainty;
        let velocity = L::splat(lighter * (CORRECTION_SHARE * kick).max(model));
        let position = L::splat(lighter * (CORRECTION_SHARE * shift).max(LATE * h * model));
        self.velocity = L::max(self.velocity, velocity);
        self.position = L::max(self.position, position);
        self.moved = L::max(self.moved, L::splat(lighter * shift));
    }
}
