//! Contacts that yield: force by overlap and by the largest overlap before.
//!
//! Thornton: Hertz's law up to the overlap `d_y = (pi p/(2 E*))^2 R*`, where the pressure in the
//! middle reaches the yield pressure `p`, and beyond it `F = F_y + pi p R* (d - d_y)`. What has
//! been pressed to `d_m > d_y` by `F_m` unloads and reloads as a Hertz contact of the radius
//! `R_p = 4 E*/(3 F_m) ((2 F_m + F_y)/(2 pi p))^1.5`, up to `d_m`. Source: C. Thornton, J. Appl.
//! Mech. 64, 383 (1997). Walton and Braun: `F = k_1 d` on loading and `F = k_2 (d - d_p)` on
//! unloading, `k_1 = e^2 k_2`, whatever the speed; `k_1` is here `pi p R*`, the slope of Thornton's
//! law. Source: O. R. Walton, R. L. Braun, J. Rheol. 30, 949 (1986).
//!
//! Valid for spheres of perfectly plastic material with small contacts; `p` is taken as 1.6 times
//! the yield strength of the softer body (first yield below the surface), and grows to about 2.8
//! times it where all of the contact yields: forces beyond first yield are lower bounds. Strengths
//! are those of slow tests.

use std::f64::consts::PI;

use super::hertz;

/// A model of plastic contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlasticModel {
    /// Hertz's law up to first yield, a straight line beyond.
    Thornton,
    /// Straight lines, with this coefficient of restitution (1).
    WaltonBraun(f64),
}

/// `[effects.plasticity]`: contacts beyond the yield load of their softer body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plasticity {
    /// The law.
    pub model: PlasticModel,
    /// Whether a shot starts with the indentations that the shots before it have left.
    pub keeps_indentations: bool,
}

impl Plasticity {
    /// The law, with new contacts in every shot.
    pub fn new(model: PlasticModel) -> Self {
        Self { model, keeps_indentations: false }
    }
}

/// Indentations that a shot has left: law and largest overlap beyond first yield (m) of each
/// contact, none of those that stay elastic.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Indentations(pub(super) Vec<Option<(YieldLaw, f64)>>);

/// The plastic law of one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct YieldLaw {
    model: PlasticModel,
    /// `A` of Hertz's law (N/m^1.5).
    stiffness: f64,
    /// `E*` (Pa).
    reduced_modulus: f64,
    /// `p` (Pa).
    pressure: f64,
    /// Overlap of first yield (m).
    overlap: f64,
    /// Force of first yield (N).
    force: f64,
    /// `pi p R*` (N/m).
    slope: f64,
}

/// How a contact that has yielded unloads and reloads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unloading {
    /// Force by overlap beyond the residual one: `A` (N/m^1.5), or a slope (N/m).
    stiffness: f64,
    /// The exponent of that overlap (1).
    is_linear: bool,
    /// Overlap that remains without force (m).
    pub residual: f64,
}

impl Unloading {
    /// Force (N) and its slope (N/m) at `overlap` (m).
    pub fn force_and_slope(&self, overlap: f64) -> (f64, f64) {
        let beyond = (overlap - self.residual).max(0.0);
        if self.is_linear {
            let slope = if beyond > 0.0 { self.stiffness } else { 0.0 };
            (self.stiffness * beyond, slope)
        } else {
            (hertz::force(self.stiffness, beyond), hertz::tangent_stiffness(self.stiffness, beyond))
        }
    }

    /// Overlap under which it bears `force` (N) (m).
    pub fn overlap_of(&self, force: f64) -> f64 {
        let beyond = if self.is_linear {
            force / self.stiffness
        } else {
            hertz::overlap(self.stiffness, force)
        };
        self.residual + beyond
    }

    /// Elastic energy at `overlap` (m) (J).
    fn energy(&self, overlap: f64) -> f64 {
        let beyond = (overlap - self.residual).max(0.0);
        if self.is_linear {
            0.5 * self.stiffness * beyond * beyond
        } else {
            hertz::energy(self.stiffness, beyond)
        }
    }
}

impl YieldLaw {
    /// The law of a contact of stiffness `A` (N/m^1.5), reduced modulus (Pa) and reduced radius (m)
    /// whose softer body yields at a `pressure` (Pa).
    pub fn new(
        model: PlasticModel,
        stiffness: f64,
        (reduced_modulus, reduced_radius): (f64, f64),
        pressure: f64,
    ) -> Self {
        let slope = PI * pressure * reduced_radius;
        let overlap = match model {
            PlasticModel::Thornton => {
                (0.5 * PI * pressure / reduced_modulus).powi(2) * reduced_radius
            }
            PlasticModel::WaltonBraun(_) => 0.0,
        };
        let force = hertz::force(stiffness, overlap);
        Self { model, stiffness, reduced_modulus, pressure, overlap, force, slope }
    }

    /// Overlap at which it begins to yield (m).
    pub fn first_overlap(&self) -> f64 {
        self.overlap
    }

    /// Force (N) and its slope (N/m) on first loading beyond first yield, at `overlap` (m).
    pub fn loading(&self, overlap: f64) -> (f64, f64) {
        if overlap <= 0.0 {
            return (0.0, 0.0);
        }
        (self.force + self.slope * (overlap - self.overlap), self.slope)
    }

    /// The overlap under which it bears `force` (N) on first loading (m).
    pub fn overlap_of(&self, force: f64) -> f64 {
        if force <= self.force {
            hertz::overlap(self.stiffness, force)
        } else {
            self.overlap + (force - self.force) / self.slope
        }
    }

    /// How it unloads after the overlap `largest` (m), which is beyond first yield.
    pub fn unloading(&self, largest: f64) -> Unloading {
        let (force, _) = self.loading(largest);
        match self.model {
            PlasticModel::Thornton => {
                let ratio = (2.0 * force + self.force) / (2.0 * PI * self.pressure);
                let radius = 4.0 * self.reduced_modulus / (3.0 * force) * ratio.powf(1.5);
                let stiffness = 4.0 / 3.0 * self.reduced_modulus * radius.sqrt();
                let residual = largest - hertz::overlap(stiffness, force);
                Unloading { stiffness, is_linear: false, residual }
            }
            PlasticModel::WaltonBraun(restitution) => {
                let share = restitution * restitution;
                let stiffness = self.slope / share;
                Unloading { stiffness, is_linear: true, residual: largest * (1.0 - share) }
            }
        }
    }

    /// Elastic energy at `overlap` (m) after the `largest` one so far (m) (J).
    pub fn energy(&self, overlap: f64, largest: f64) -> f64 {
        let largest = largest.max(overlap);
        if largest <= self.overlap {
            hertz::energy(self.stiffness, overlap)
        } else {
            self.unloading(largest).energy(overlap)
        }
    }

    /// Energy lost by loading up to the overlap `largest` (m) (J).
    pub fn lost(&self, largest: f64) -> f64 {
        if largest <= self.overlap {
            return 0.0;
        }
        let beyond = largest - self.overlap;
        let work =
            0.4 * self.force * self.overlap + (self.force + 0.5 * self.slope * beyond) * beyond;
        work - self.unloading(largest).energy(largest)
    }
}

#[cfg(test)]
#[allow(clippy::unreadable_literal, reason = "digits as published")]
mod tests {
    use super::*;

    fn law(model: PlasticModel) -> YieldLaw {
        // A steel sphere of 10 mm on a flat: E* = 110 GPa, R* = 5 mm, p = 1.6 GPa.
        let stiffness = 4.0 / 3.0 * 110e9 * 5e-3_f64.sqrt();
        YieldLaw::new(model, stiffness, (110e9, 5e-3), 1.6e9)
    }

    /// `F_y = pi^3 p^3 R^2/(6 E*^2)`, Johnson's Eq. (6.9); the force and its slope go on from
    /// Hertz's without a jump, and unloading starts where loading ended.
    #[test]
    fn branches_join() {
        let law = law(PlasticModel::Thornton);
        let force = PI.powi(3) * 1.6e9_f64.powi(3) * 25e-6 / (6.0 * 110e9_f64 * 110e9);
        assert!((law.force / force - 1.0).abs() < 1e-14);
        let hertz = hertz::tangent_stiffness(law.stiffness, law.overlap);
        assert!((law.slope / hertz - 1.0).abs() < 1e-14);
        for factor in [1.0 + 1e-9, 2.0, 30.0] {
            let largest = factor * law.overlap;
            let (found, _) = law.unloading(largest).force_and_slope(largest);
            assert!((found / law.loading(largest).0 - 1.0).abs() < 1e-12, "{factor}");
        }
        // At first yield the unloading curve is the loading one.
        let unloading = law.unloading(law.overlap * (1.0 + 1e-12));
        assert!(unloading.residual.abs() < 1e-10 * law.overlap, "{}", unloading.residual);
    }

    /// Restitution by energies, `e^2 = elastic energy/work` at the largest overlap, against the
    /// closed form: two independent codes agree on these digits.
    #[test]
    fn restitution_is_that_of_thornton() {
        let law = law(PlasticModel::Thornton);
        let first = 0.4 * law.force * law.overlap;
        for (ratio, expected) in [
            (2.0, 0.93062588),
            (5.0, 0.77333690),
            (10.0, 0.65855834),
            (50.0, 0.44460644),
            (100.0, 0.37429896),
            (1000.0, 0.21070081),
        ] {
            // The kinetic energy is `ratio^2` times that of first yield:
            // slope beyond^2/2 + F_y beyond = energy - first.
            let more = (ratio * ratio - 1.0) * first;
            let (a, b) = (0.5 * law.slope, law.force);
            let beyond = 2.0 * more / (b + (b * b + 4.0 * a * more).sqrt());
            let largest = law.overlap + beyond;
            let energy = ratio * ratio * first;
            let restitution = ((energy - law.lost(largest)) / energy).sqrt();
            assert!((restitution - expected).abs() < 1e-8, "{ratio}: {restitution}");
        }
    }

    /// `e = sqrt(k_1/k_2)`, whatever the overlap.
    #[test]
    fn restitution_of_walton_and_braun_is_what_was_asked_for() {
        let law = law(PlasticModel::WaltonBraun(0.7));
        for largest in [1e-9, 1e-6, 1e-4] {
            let work = 0.5 * law.slope * largest * largest;
            let restitution = ((work - law.lost(largest)) / work).sqrt();
            assert!((restitution - 0.7).abs() < 1e-12, "{restitution}");
        }
    }
}
