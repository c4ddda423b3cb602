//! The dispersion relation of a linear diatomic chain: what passes, what does not, how fast.
//!
//! `omega^2 = beta/(m M) [m + M -+ sqrt(m^2 + M^2 + 2 m M cos(k a))]`: minus is the acoustic
//! branch, plus the optical one; between `f1` and `f2` nothing travels. Source: Herbold et al.
//! (2009), Eqs (7) to (10). Valid for dynamic forces far below the static one.

use std::f64::consts::TAU;

/// A chain of light and heavy masses in turn, or of equal ones, joined by equal springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiatomicChain {
    /// The lighter mass `m` (kg).
    pub light_mass: f64,
    /// The heavier mass `M` (kg).
    pub heavy_mass: f64,
    /// Stiffness `beta` of every contact (N/m).
    pub stiffness: f64,
    /// Exponent `p` of the law that the stiffness is of, 1.5 for Hertz's (1).
    pub exponent: f64,
    /// Length `a` of a cell (m).
    pub cell: f64,
}

impl DiatomicChain {
    /// The chain of contacts that is this one under the preload `now` (N), under another one,
    /// `force` (N).
    ///
    /// `F = A overlap^p` has the stiffness `p F/overlap`: it goes with the power `1 - 1/p` of the
    /// force, and cells give by the overlaps.
    pub fn pressed(&self, now: f64, force: f64) -> Self {
        let stiffness = self.stiffness * (force / now).powf(1.0 - 1.0 / self.exponent);
        let overlap = |force: f64, stiffness: f64| self.exponent * force / stiffness;
        let given = overlap(force, stiffness) - overlap(now, self.stiffness);
        Self { stiffness, cell: self.cell - 2.0 * given, ..*self }
    }

    /// Top of the acoustic branch `f1`, the band gap's lower edge (Hz).
    pub fn gap_bottom(&self) -> f64 {
        (2.0 * self.stiffness / self.heavy_mass).sqrt() / TAU
    }

    /// Bottom of the optical branch `f2`, the band gap's upper edge (Hz).
    pub fn gap_top(&self) -> f64 {
        (2.0 * self.stiffness / self.light_mass).sqrt() / TAU
    }

    /// Top of the optical branch `f3`, above which nothing travels (Hz).
    pub fn cutoff(&self) -> f64 {
        self.gap_bottom().hypot(self.gap_top())
    }

    /// Edges of the bands from below, with their names: `f1`, `f2` and `f3`; of equal masses, which
    /// leave no gap, `f3` alone (Hz).
    pub fn edges(&self) -> Vec<(&'static str, f64)> {
        let cutoff = ("f3", self.cutoff());
        if self.has_gap() {
            vec![("f1", self.gap_bottom()), ("f2", self.gap_top()), cutoff]
        } else {
            vec![cutoff]
        }
    }

    /// Whether the masses differ, so that there is a band gap.
    pub fn has_gap(&self) -> bool {
        self.light_mass < self.heavy_mass
    }

    /// Beads of the smallest part that repeats: two, of equal masses one.
    pub fn beads_per_cell(&self) -> usize {
        if self.has_gap() { 2 } else { 1 }
    }

    /// Length of the smallest part that repeats (m).
    pub fn period(&self) -> f64 {
        0.5 * self.cell * self.beads_per_cell() as f64
    }

    /// The branches with their names, each frequency at the phase `k` times [`Self::period`]
    /// (rad) (Hz). Equal beads have one, `f3 sin(k a/2)`, with `a` from bead to bead.
    pub fn branches(&self, phase: f64) -> Vec<(&'static str, f64)> {
        if self.has_gap() {
            vec![("acoustic branch", self.acoustic(phase)), ("optical branch", self.optical(phase))]
        } else {
            vec![("equal beads", self.cutoff() * (0.5 * phase).sin())]
        }
    }

    /// Frequency of the mode that lives in the gap at a free end with a light mass (Hz).
    pub fn surface_mode(&self) -> f64 {
        self.cutoff() / 2.0_f64.sqrt()
    }

    /// Long-wave sound speed `a sqrt(beta / (2 (m + M)))` (m/s).
    pub fn sound_speed(&self) -> f64 {
        self.cell * (self.stiffness / (2.0 * (self.light_mass + self.heavy_mass))).sqrt()
    }

    /// Frequency of the acoustic branch at the phase `k a` a cell (rad) (Hz).
    pub fn acoustic(&self, phase: f64) -> f64 {
        // Of the two roots this is the one that cancels: take it from the product of both.
        let (m, big_m) = (self.light_mass, self.heavy_mass);
        let product = 2.0 * self.stiffness.powi(2) / (m * big_m) * (1.0 - phase.cos());
        (product / (TAU * self.optical(phase)).powi(2)).sqrt() / TAU
    }

    /// Frequency of the optical branch at the phase `k a` a cell (rad) (Hz).
    pub fn optical(&self, phase: f64) -> f64 {
        let (m, big_m) = (self.light_mass, self.heavy_mass);
        let root = (m * m + big_m * big_m + 2.0 * m * big_m * phase.cos()).sqrt();
        (self.stiffness / (m * big_m) * (m + big_m + root)).sqrt() / TAU
    }

    /// How strongly a frequency (Hz) that does not travel dies out: natural logarithm of the
    /// amplitude ratio from cell to cell; 0 for one that travels (1).
    pub fn decay(&self, frequency: f64) -> f64 {
        let (m, big_m) = (self.light_mass, self.heavy_mass);
        let omega_squared = (TAU * frequency).powi(2);
        let shifted = omega_squared * m * big_m / self.stiffness - (m + big_m);
        let cosine = (shifted * shifted - m * m - big_m * big_m) / (2.0 * m * big_m);
        if cosine.abs() > 1.0 { cosine.abs().acosh() } else { 0.0 }
    }
}
